// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "capstan/tools/diagnose/candidate.hpp"
#include "capstan/tools/support/random.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

using Column = Eigen::VectorXd;

/// Signals with what several probes share.
class Probes {
 public:
  Probes(const Preparation& p, const Catalogue& catalogue, const LawResidual& residual)
      : p_(p), catalogue_(catalogue), s_(p.signals), residual_(residual) {
    direction_ = 2.0 * s_.forward.array() - 1.0;
    q1_range_ = s_.q1.maxCoeff() - s_.q1.minCoeff();
    tau_range_ = s_.tau.maxCoeff() - s_.tau.minCoeff();
    span_s_ = s_.time_s.tail(1)[0] + p.coarse_period_s;
  }

  auto all() -> std::vector<Candidate> {
    if (catalogue_.target() == TargetKind::kEffort) {
      of_speed();
      of_friction();
      of_effort();
    } else {
      of_direction();
      of_ratio();
      of_torque();
      of_other_axes();
    }
    of_angle();
    of_time();
    of_timing();
    of_further_axes();
    return std::move(candidates_);
  }

 private:
  auto rows() const -> Eigen::Index { return s_.q1.size(); }
  auto coarse_fitted() const -> Column {
    return decimated(moving_mean(residual_.fitted, p_.noncausal.log_rows(), p_.smoothing), p_.factor);
  }

  void add(const std::string& name, std::vector<std::vector<Column>> variants, Sign sign = Sign::kAny,
           std::vector<std::string> special_cases = {}) {
    Candidate candidate;
    candidate.name = name;
    candidate.special_cases = std::move(special_cases);
    for (auto& columns : variants) {
      Variant variant;
      variant.columns.resize(rows(), static_cast<Eigen::Index>(columns.size()));
      for (std::size_t i = 0; i < columns.size(); ++i) {
        variant.columns.col(static_cast<Eigen::Index>(i)) = columns[i];
      }
      if (variant.columns.cwiseAbs().maxCoeff() > 0.0 && variant.columns.allFinite()) {
        variant.columns = p_.interpolated(std::move(variant.columns));
        candidate.signs.assign(columns.size(), sign);
        candidate.variants.push_back(std::move(variant));
      }
    }
    if (!candidate.variants.empty()) {
      candidates_.push_back(std::move(candidate));
    }
  }

  /// A column for the forward and one for the backward strokes.
  auto by_direction(const Column& column) const -> std::vector<Column> {
    return {column.cwiseProduct(s_.forward), column.cwiseProduct((1.0 - s_.forward.array()).matrix())};
  }

  auto low_pass(const Column& signal, double time_constant_s) const -> Column {
    Column filtered(rows());
    const double keep = std::exp(-p_.coarse_period_s / time_constant_s);
    double x = signal[0];
    for (Eigen::Index i = 0; i < rows(); ++i) {
      x = keep * x + (1.0 - keep) * signal[i];
      filtered[i] = x;
    }
    return filtered;
  }

  void of_direction() {
    add("coulomb_friction", {{direction_}}, Sign::kNonPositive);  // the other sign is pretension_offset
    std::vector<std::vector<Column>> stribeck;
    const double fastest = s_.dq1.cwiseAbs().maxCoeff();
    for (const double share : {0.02, 0.06, 0.2}) {
      const auto ratio = s_.dq1.array() / (share * fastest);
      stribeck.push_back({(direction_.array() * (-ratio.square()).exp()).matrix()});
    }
    add("stribeck_friction", std::move(stribeck));
    // The two directions apart: a lag of one direction alone, or of one sign in both, is no less foreign.
    add("curved_drag",
        {by_direction(s_.dq1.array().abs().sqrt().matrix()), by_direction(s_.dq1.array().square().matrix())});
  }

  /// Of an effort: drag that is not in proportion to the speed, and what pulls back.
  void of_speed() {
    const auto v = s_.dq1.array();
    const double fastest = v.abs().maxCoeff();
    std::vector<std::vector<Column>> thinning;
    for (const double share : {0.03, 0.1, 0.3}) {
      thinning.push_back({(v / (1.0 + v.abs() / (share * fastest))).matrix()});
    }
    add("shear_thinning", std::move(thinning), Sign::kAny, {"coulomb_friction"});  // which it is at no speed at all
    std::vector<std::vector<Column>> relaxing;
    for (const double time_s : {0.1, 0.3, 1.0, 3.0, 10.0}) {
      if (time_s < span_s_ / 3.0) {
        relaxing.push_back({s_.q1 - low_pass(s_.q1, time_s)});
      }
    }
    add("relaxation", std::move(relaxing));
  }

  /// Of an effort: what depends on the effort of the law itself.
  void of_effort() {
    const Column fitted = coarse_fitted();
    const double size = rms(fitted);
    std::vector<std::vector<Column>> zones;
    for (const double share : {0.1, 0.3, 1.0}) {
      zones.push_back({fitted.array().max(-share * size).min(share * size).matrix()});
    }
    add("dead_zone", std::move(zones));
    add("load_dependent_friction", {{direction_.cwiseProduct(fitted.cwiseAbs())}});
  }

  /// Of an effort: friction that is not the same everywhere and always, less what is.
  void of_friction() {
    const auto place = (s_.q1.array() - s_.q1.mean()) / q1_range_;
    const auto side = direction_.array();
    auto varied = [&side](const auto& by) { return std::vector<Column>{(side * (by - by.mean())).matrix()}; };
    add("angle_dependent_friction", {varied(place), varied(place.abs()), varied(place.square())});
    const auto time = s_.time_s.array() / span_s_ - 0.5;
    add("wear", {varied(time), {(s_.dq1.array() * time).matrix()}});
    const auto pull = s_.ddq1.array();
    add("inertia_change", {{(pull * place).matrix(), (pull * place.square()).matrix()},
                           {(pull * s_.q1.array().sin()).matrix(), (pull * s_.q1.array().cos()).matrix()}});
  }

  /// Slow changes in time of any form: a level, and up to so many half waves over the rows to learn from. Waves that
  /// ran on beyond these would be anything at their ends.
  auto half_waves(int count) const -> std::vector<Column> {
    const Blocks learned = p_.split.learned();
    const double start_s = s_.time_s[learned.front().begin];
    const auto share = (s_.time_s.array() - start_s) / (s_.time_s[learned.back().end - 1] - start_s);
    std::vector<Column> waves;
    for (int k = 0; k <= count; ++k) {
      waves.push_back((std::numbers::pi * k * share).cos().matrix());
    }
    return waves;
  }

  /// Of a joint angle: a ratio that changes along the way, as that of a drum that is not round.
  void of_ratio() {
    constexpr int kBends = 17;
    std::vector<std::vector<Column>> bends;
    for (int i = 1; i < kBends; ++i) {
      const double at = s_.q1.minCoeff() + q1_range_ * i / kBends;
      bends.push_back({(s_.q1.array() - at).max(0.0).matrix()});
    }
    add("bent_ratio", std::move(bends));
    const auto place = s_.q1.array() - s_.q1.mean();
    add("curved_ratio", {{place.square().matrix(), place.cube().matrix()}}, Sign::kAny, {"gravity"});
  }

  void of_torque() {
    if (tau_range_ <= 0.0) {
      return;
    }
    const Column place = s_.q1.array() - s_.q1.mean();
    add("angle_dependent_friction", {by_direction(s_.tau.cwiseProduct(s_.q1)),
                                     by_direction(s_.tau.cwiseProduct(s_.q1.cwiseAbs())),
                                     {direction_.cwiseProduct(place), direction_.cwiseProduct(place.cwiseAbs())}});
    const Column share_of_time = s_.time_s / span_s_;
    add("wear", {by_direction(s_.tau.cwiseProduct(share_of_time))});
    const double largest = s_.tau.cwiseAbs().maxCoeff();
    std::vector<std::vector<Column>> one_sided = {{s_.tau.cwiseAbs2()}};
    for (const double share : {0.0, 0.15, 0.3, 0.5, 0.7}) {
      one_sided.push_back({(s_.tau.array() - share * largest).max(0.0).matrix()});
      one_sided.push_back({(s_.tau.array() + share * largest).min(0.0).matrix()});
    }
    add("one_sided_stiffness", std::move(one_sided));
  }

  void of_angle() {
    std::vector<std::vector<Column>> spots;
    constexpr int kSpots = 9;
    for (int i = 0; i < kSpots; ++i) {
      const double centre = s_.q1.minCoeff() + q1_range_ * (0.5 + i) / kSpots;
      const auto offset = (s_.q1.array() - centre) / (0.7 * q1_range_ / kSpots);
      const Column bell = (-offset.square()).exp().matrix();
      spots.push_back({bell, bell.cwiseProduct(direction_)});
    }
    add("local_spot", std::move(spots));
  }

  auto reversals() const -> int {
    const auto forward = s_.forward.array() > 0.5;
    return static_cast<int>((forward.head(rows() - 1) != forward.tail(rows() - 1)).count());
  }

  void of_time() {
    // Slower than the motion, or it could be the motion's own doing.
    if (const int waves = std::min(10, reversals() / 4); waves > 2) {
      add("wander", {half_waves(waves)}, Sign::kAny, {"offset", "thermal_drift"});
    }
    add("ratio_change", {{s_.q1.cwiseProduct((s_.time_s.array() / span_s_ - 0.5).matrix())}});
    std::vector<std::vector<Column>> steps;
    constexpr int kSteps = 16;
    for (int i = 1; i < kSteps; ++i) {
      const Column later = (s_.time_s.array() > span_s_ * i / kSteps).cast<double>().matrix();
      const double share = stacked(later, p_.split.learned()).mean();
      if (share > 0.0) {                           // else it comes after all that is looked at
        steps.push_back({later.array() - share});  // the mean is an offset, and not foreign
      }
    }
    add("jump", std::move(steps));
  }

  /// The motor's own measurement is late: the opposite of transport_delay.
  void of_timing() {
    if (catalogue_.target() ==
        TargetKind::kEffort) {  // the law has the acceleration already, so what leads is the jerk
      add("motor_delay", {{local_slope(s_.ddq1, 1, p_.coarse_period_s)}}, Sign::kNonNegative);
      return;
    }
    const Column fitted = coarse_fitted();
    add("motor_delay", {{local_slope(fitted, 1, p_.coarse_period_s)}}, Sign::kNonNegative);
    std::vector<std::vector<Column>> swings;
    for (const double frequency_hz : {2.0, 4.0, 8.0}) {
      for (const double damping : {0.1, 0.4}) {
        swings.push_back({resonant(fitted, 2.0 * std::numbers::pi * frequency_hz, damping) - fitted});
      }
    }
    // Far above the motion it is these, and nobody could tell.
    add("resonance", std::move(swings), Sign::kNonNegative,
        {"transport_delay", "load_inertia", "transmission_viscous"});
  }

  /// What a mass on a spring makes of a motion: x'' = w^2 (signal - x) - 2 d w x', by small steps.
  auto resonant(const Column& signal, double frequency_rad_s, double damping) const -> Column {
    const auto steps = static_cast<int>(std::ceil(20.0 * frequency_rad_s * p_.coarse_period_s));
    const double step = p_.coarse_period_s / steps;
    Column moved(rows());
    double x = signal[0];
    double speed = 0.0;
    for (Eigen::Index i = 0; i < rows(); ++i) {
      for (int k = 1; k <= steps; ++k) {
        const double share = static_cast<double>(k) / steps;
        const double at = i == 0 ? signal[0] : signal[i - 1] + share * (signal[i] - signal[i - 1]);
        speed += step * (frequency_rad_s * frequency_rad_s * (at - x) - 2.0 * damping * frequency_rad_s * speed);
        x += step * speed;
      }
      moved[i] = x;
    }
    return moved;
  }

  /// Another axis changes elasticity, ratio or drag of this joint.
  void of_other_axes() {
    std::vector<std::vector<Column>> changed;
    const Column place = s_.q1.array() - s_.q1.mean();
    for (const auto& side : s_.side) {
      if (side.name.rfind("axis", 0) == 0) {
        const Column other = side.values.array() - side.values.mean();
        for (const Column* own : {&s_.tau, &s_.dq1, &place}) {
          changed.push_back(by_direction(own->cwiseProduct(other)));
        }
      }
    }
    add("coupled_stiffness", std::move(changed));
  }

  /// Axes beside the one that axis_coupling looks at. The name is the column's, so that a user can ask for it.
  void of_further_axes() {
    const auto& others = p_.logs.front().others;
    const std::string looked_at = others.empty() ? "" : "axis" + std::to_string(others.front().number) + "/";
    for (const auto& side : s_.side) {
      const bool of_an_axis = side.name.rfind("axis", 0) == 0;
      if (of_an_axis && (looked_at.empty() || side.name.rfind(looked_at, 0) != 0)) {
        const Column centred = side.values.array() - side.values.mean();
        add(side.name, {{centred}, {centred, local_slope(centred, 1, p_.coarse_period_s)}});
      }
    }
  }

  const Preparation& p_;
  const Catalogue& catalogue_;
  const CoarseSignals& s_;
  const LawResidual& residual_;
  Column direction_;
  double q1_range_ = 0.0, tau_range_ = 0.0, span_s_ = 0.0;
  std::vector<Candidate> candidates_;
};

auto unit_range(const Eigen::VectorXd& x) -> Eigen::VectorXd {
  const double range = x.maxCoeff() - x.minCoeff();
  return range > 0.0 ? Eigen::VectorXd((x.array() - x.minCoeff()) / range)
                     : Eigen::VectorXd(Eigen::VectorXd::Zero(x.size()));
}

}  // namespace

auto probe_candidates(const Preparation& p, const Catalogue& catalogue, const LawResidual& residual)
    -> std::vector<Candidate> {
  return Probes(p, catalogue, residual).all();
}

auto flexible_features(const CoarseSignals& signals, TargetKind target) -> Eigen::MatrixXd {
  constexpr Eigen::Index kBumps = 32;
  constexpr Eigen::Index kTimeBumps = 6;
  constexpr double kWidth = 0.35;  // of each signal's range
  Eigen::MatrixXd inputs(signals.q1.size(), 5);
  const bool effort = target == TargetKind::kEffort;  // then the torque is no input, and the way since a reversal is
  inputs << unit_range(signals.q1), unit_range(signals.dq1), unit_range(effort ? signals.ddq1 : signals.tau),
      unit_range(signals.forward), unit_range(effort ? Eigen::VectorXd(signals.q1 - signals.q1_rev) : signals.tau_rev);
  Eigen::MatrixXd features(inputs.rows(), kBumps + kTimeBumps);
  Random random(0x5EEDu);
  for (Eigen::Index i = 0; i < kBumps; ++i) {
    // Centred where the motion has been, so that no bump is empty.
    const auto at = static_cast<Eigen::Index>(random.uniform() * static_cast<double>(inputs.rows()));
    const Eigen::MatrixXd offset = (inputs.rowwise() - inputs.row(std::min(at, inputs.rows() - 1))) / kWidth;
    features.col(i) = (-0.5 * offset.rowwise().squaredNorm()).array().exp().matrix();
  }
  const Eigen::VectorXd time = unit_range(signals.time_s);
  for (Eigen::Index i = 0; i < kTimeBumps; ++i) {
    features.col(kBumps + i) = (std::numbers::pi * static_cast<double>(i + 1) * time.array()).cos().matrix();
  }
  return features;
}

}  // namespace capstan::tools
