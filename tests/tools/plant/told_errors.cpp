// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/plant/told_errors.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "capstan/firmware/estimate/error_bar.hpp"
#include "capstan/tests/tools/plant/plant_joint.hpp"
#include "capstan/tools/identify/identify.hpp"

namespace capstan::tools::plant {
namespace {

auto bar_of(const JointFile& law) -> ErrorBarConfig {
  const auto& values = law.fit.value().error_bar.value().values;
  const auto raw = [&](std::size_t i) { return Q24::from_double(values[i]); };
  return {raw(0), raw(1), raw(2), raw(3), raw(4), raw(5)};
}

}  // namespace

void ToldCount::add(double error, double width) {
  all_ += 1.0;
  if (width >= 0.0) {
    told_ += 1.0;
    held_ += error <= width ? 1.0 : 0.0;
    widths_ += width;
    squares_ += error * error;
  }
}

auto ToldCount::result() const -> ToldErrors {
  return told_ == 0.0 ? ToldErrors{}
                      : ToldErrors{.told = told_ / all_,
                                   .held = held_ / told_,
                                   .width = widths_ / told_,
                                   .error = std::sqrt(squares_ / told_)};
}

void print_held(std::vector<double> held) {
  if (!held.empty()) {
    std::sort(held.begin(), held.end());
    std::printf("held (asked 0.95): median %.3f, one in ten below %.3f, least %.3f\n", held[held.size() / 2],
                held[held.size() / 10], held.front());
  }
}

auto told_errors(const JointFile& law, const AxisLog& log) -> ToldErrors {
  const ErrorBarConfig config = bar_of(law);
  MotionLaw<Q24> motion(SamplePeriod<Q24>(static_cast<std::int32_t>(std::lround(log.rate_hz()))),
                        to_fixed(motion_parameters(law)));
  ErrorBar bar;
  ToldCount count;
  const Eigen::VectorXd measured = log.measured();
  for (Eigen::Index i = 0; i < measured.size(); ++i) {
    const double estimate =
        motion.update(Q24::from_double(log.q1_rad[i]), Q24::from_double(log.tau_nm[i])).q2_reported.to_double();
    const double width = bar.rt_step(config, motion.sample()).to_double();
    count.add(std::abs(measured[i] - estimate), width);
  }
  return count.result();
}

void ask_error_bars(std::uint64_t first, int joints) {
  std::vector<double> held;
  for (int i = 0; i < joints; ++i) {
    const std::uint64_t seed = first + static_cast<std::uint64_t>(i);
    const sim::PlantParameters plant = drawn_plant(seed);
    for (const std::string model : {"kinematic", "pseudo_kinematic", "tendon"}) {
      try {
        const AxisLog log = log_of(plant, PlantMotion::kIdentify, seed);
        const JointFile law = identify({log}, form_of_model(model, {log})).joint;
        for (const PlantMotion motion : {PlantMotion::kDecaying, PlantMotion::kLadder}) {
          const ToldErrors told = told_errors(law, log_of(plant, motion, seed + 1));
          held.push_back(told.held);
          std::printf("seed %llu %s, %s: told of %.3f, held %.3f, mean width %.5f rad, error %.5f rad\n",
                      static_cast<unsigned long long>(seed), model.c_str(), name_of(motion).c_str(), told.told,
                      told.held, told.width, told.error);
          std::fflush(stdout);
        }
      } catch (const std::exception& error) {
        std::printf("seed %llu %s: %s\n", static_cast<unsigned long long>(seed), model.c_str(), error.what());
      }
    }
  }
  print_held(std::move(held));
}

}  // namespace capstan::tools::plant
