// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/plant/told_torques.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>

#include "capstan/firmware/control/force_control.hpp"
#include "capstan/firmware/estimate/error_bar.hpp"
#include "capstan/tests/model/support.hpp"
#include "capstan/tests/tools/plant/plant_joint.hpp"
#include "capstan/tests/tools/run/by_hand.hpp"
#include "capstan/tools/identify/force_section.hpp"

namespace capstan::tools::plant {
namespace {

/// What `apply` sets.
auto config_of(const std::string& text) -> ForceConfig {
  const auto q = [](double x) { return Q24::from_double(x); };
  ForceConfig config;
  if (force_model(text, "joint.toml") == "pull_push") {
    const PullPushFit fit = read_pull_push(text, "joint.toml");
    config.law = static_cast<std::int32_t>(ForceLawKind::kPullPush);
    config.eta_top = q(fit.law.eta_top);
    config.eta_bottom = q(fit.law.eta_bottom);
    config.pretension_nm = q(fit.law.pretension_nm);
    config.ratio = q(fit.law.ratio);
    config.friction_nm = q(std::max(fit.friction_nm, 0.0));
    config.offset_nm = q(fit.offset_nm);
  } else {
    const auto table = read_preisach(text, "joint.toml");
    config.law = static_cast<std::int32_t>(ForceLawKind::kPreisach);
    config.grid.levels = table.levels;
    for (std::size_t row = 0; row < table.levels; ++row) {
      config.grid.inputs[row] = q(table.inputs[row]);
      for (std::size_t column = 0; column <= row; ++column) {
        config.grid.set_force(row, column, q(table.force(row, column)));
      }
    }
  }
  const auto error = read_force_error(text, "joint.toml").value_or(ForceErrorNumbers{}).values;
  config.error = {q(error[0]), q(error[1]), q(error[2]), q(error[3])};
  return config;
}

}  // namespace

auto force_log_of(const std::string& learning, std::uint64_t seed, double spring_nm_per_rad) -> AxisLog {
  constexpr double kStrokeS = 10.0;
  sim::PlantParameters plant = drawn_plant(seed);
  plant.environment.kind = sim::EnvironmentKind::kLocked;
  const double reach = pull_of(plant);
  if (std::isfinite(spring_nm_per_rad)) {
    plant.environment = {.kind = sim::EnvironmentKind::kSpring, .stiffness = spring_nm_per_rad};
  }
  if (learning == "pull_push") {  // strokes that become smaller: inner loops too
    return test::turn_by_hand(plant, 100.0, [reach](double t) {
      return test::triangle(reach * (1.0 - 0.007 * std::min(t, 100.0)), 1.0 / kStrokeS)(t);
    });
  }
  if (learning == "preisach") {  // to both ends, then from the lower end to one level after another and back
    return test::turn_by_hand(plant, 120.0, [reach](double t) {
      const double number = std::floor(t / kStrokeS);
      const double share = t / kStrokeS - number;
      if (number < 1.0) {
        return test::triangle(reach, 1.0 / kStrokeS)(t);
      }
      const double rise = 0.2 * (number - 1.0) * (1.0 - std::abs(2.0 * share - 1.0));
      return reach * (number < 2.0 ? -share : -1.0 + std::min(rise, 2.0));
    });
  }
  // First once to both ends: a Preisach law knows its past from there on.
  const capstan::test::RandomMultisine motion(static_cast<std::uint32_t>(seed), 1.0, 0.03, 0.4);
  return test::turn_by_hand(plant, 70.0, [reach, &motion](double t) {
    return t < kStrokeS ? test::triangle(1.03 * reach, 1.0 / kStrokeS)(t)
                        : 0.9 * reach * std::tanh(3.0 * motion(t) + std::sin(0.5 * (t - kStrokeS)));
  });
}

auto force_file_of(const std::string& model, std::uint64_t seed) -> std::string {
  const AxisLog log = force_log_of(model, seed, std::numeric_limits<double>::infinity());
  return with_force_section(
      "", model == "preisach" ? force_section(fit_preisach({log})) : force_section(fit_pull_push({log})));
}

auto told_torque_errors(const std::string& section, const AxisLog& log) -> ToldErrors {
  const auto config = std::make_unique<ForceConfig>(config_of(section));
  const auto law = std::make_unique<ForceControl>(*config);
  ForceErrorBar bar;
  ToldCount count;
  for (Eigen::Index i = 0; i < log.samples(); ++i) {
    const Q24 motor = Q24::from_double(log.tau_nm[i]);
    law->rt_observe(motor);
    const double width = bar.rt_step(config->error, motor, law->estimate()).to_double();
    count.add(std::abs(log.effort[i] - law->estimate().force.to_double()), width);
  }
  return count.result();
}

void ask_torque_error_bars(std::uint64_t first, int joints) {
  std::vector<double> held;
  for (int i = 0; i < joints; ++i) {
    const std::uint64_t seed = first + static_cast<std::uint64_t>(i);
    for (const std::string model : {"pull_push", "preisach"}) {
      try {
        const std::string law = force_file_of(model, seed);
        for (const double spring : {std::numeric_limits<double>::infinity(), 2.0, 0.5}) {
          const ToldErrors told = told_torque_errors(law, force_log_of("", seed, spring));
          if (told.told > 0.0) {
            held.push_back(told.held);
          }
          std::printf("seed %llu %s, tip on %g Nm/rad: told of %.3f, held %.3f, mean width %.5f Nm, error %.5f Nm\n",
                      static_cast<unsigned long long>(seed), model.c_str(), spring, told.told, told.held, told.width,
                      told.error);
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
