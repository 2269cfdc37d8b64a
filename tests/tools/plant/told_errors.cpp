// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/plant/told_errors.hpp"

#include <cmath>

#include "capstan/firmware/estimate/error_bar.hpp"

namespace capstan::tools::plant {
namespace {

auto bar_of(const JointFile& law) -> ErrorBarConfig {
  const auto& values = law.fit.value().error_bar.value().values;
  const auto raw = [&](std::size_t i) { return Q24::from_double(values[i]); };
  return {raw(0), raw(1), raw(2), raw(3), raw(4), raw(5)};
}

}  // namespace

auto told_errors(const JointFile& law, const AxisLog& log) -> ToldErrors {
  const ErrorBarConfig config = bar_of(law);
  MotionLaw<Q24> motion(SamplePeriod<Q24>(static_cast<std::int32_t>(std::lround(log.rate_hz()))),
                        to_fixed(motion_parameters(law)));
  ErrorBar bar;
  ToldErrors all;
  double samples = 0.0;
  double squares = 0.0;
  const Eigen::VectorXd measured = log.measured();
  for (Eigen::Index i = 0; i < measured.size(); ++i) {
    const double estimate =
        motion.update(Q24::from_double(log.q1_rad[i]), Q24::from_double(log.tau_nm[i])).q2_reported.to_double();
    const double width = bar.rt_step(config, motion.sample()).to_double();
    if (width >= 0.0) {
      const double error = std::abs(measured[i] - estimate);
      samples += 1.0;
      squares += error * error;
      all.held += error <= width ? 1.0 : 0.0;
      all.width_rad += width;
    }
  }
  all.told = samples / static_cast<double>(measured.size());
  if (samples > 0.0) {
    all.held /= samples;
    all.width_rad /= samples;
    all.error_rad = std::sqrt(squares / samples);
  }
  return all;
}

}  // namespace capstan::tools::plant
