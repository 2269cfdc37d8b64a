// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/replay/replay.hpp"

#include <cmath>

#include "capstan/tools/identify/conditioning.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

template <typename Scalar, typename ToScalar, typename ToDouble>
auto run(const AxisLog& log, MotionLaw<Scalar> law, ToScalar&& to_scalar, ToDouble&& to_double) -> Replayed {
  Replayed result{Eigen::VectorXd(log.samples()), Eigen::VectorXd(log.samples()), 0};
  Eigen::Index i = 0;
  for (const auto& logged : measured_series(log)) {
    Measured<Scalar> now;
    now.q1 = to_scalar(logged.q1);
    now.tau = to_scalar(logged.tau);
    for (std::size_t slot = 0; slot < kMostOthers; ++slot) {
      const auto& other = logged.others[slot];
      now.others[slot] = {.q1 = to_scalar(other.q1), .tau = to_scalar(other.tau), .forward = other.forward};
    }
    if (log.temperature_c.size() > 0) {
      now.temperature = to_scalar(logged.temperature);
    }
    const Estimate<Scalar> estimate = law.update(now);
    result.q2[i] = to_double(estimate.q2);
    result.reported[i] = to_double(estimate.q2_reported);
    result.saturated += estimate.saturated ? 1 : 0;
    ++i;
  }
  return result;
}

}  // namespace

auto replay(const AxisLog& log, const LawParameters<double>& law, Arithmetic arithmetic) -> Replayed {
  if (arithmetic == Arithmetic::kDouble) {
    auto same = [](double x) { return x; };
    return run(log, MotionLaw<double>(SamplePeriod<double>(log.period_s), law), same, same);
  }
  if (std::abs(log.rate_hz() / kFirmwareRateHz - 1.0) > 0.01) {
    throw Refusal(log.name + ": the log runs at " + rounded(log.rate_hz()) +
                  " Hz and the firmware's arithmetic is made for " + std::to_string(kFirmwareRateHz) +
                  " Hz; replay it with --arithmetic double");
  }
  const MotionLaw<Q24> fixed(SamplePeriod<Q24>(kFirmwareRateHz), to_fixed(law));
  return run(
      log, fixed, [](double x) { return Q24::from_double(x); }, [](Q24 x) { return x.to_double(); });
}

auto columns_of(int axis, const Replayed& replayed) -> LogColumns {
  LogColumns columns;
  columns.add(axis_column(axis, "q2_est_rad"), replayed.q2);
  if (replayed.q2 != replayed.reported) {
    columns.add(axis_column(axis, "q2_reported_est_rad"), replayed.reported);
  }
  return columns;
}

}  // namespace capstan::tools
