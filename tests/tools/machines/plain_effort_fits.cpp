// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <memory>

#include "capstan/tests/tools/machines/plain_columns.hpp"
#include "capstan/tests/tools/machines/plain_fits.hpp"
#include "capstan/tests/tools/play_operator.hpp"
#include "capstan/tools/select/effort_design.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools::machines {
namespace {

/// What the fits of an effort share: its motion through the cubic that the effort is seen through.
struct Axis {
  explicit Axis(const AxisLog& log) : q(log.q1_rad), one(Eigen::VectorXd::Ones(q.size())), tau(log.tau_nm) {
    constexpr double kWindowS = 0.12;
    const auto samples = std::max<Eigen::Index>(7, static_cast<Eigen::Index>(kWindowS / log.period_s) | 1);
    const LocalCubic cubic(samples / 2);
    v = cubic.derivative(q, 1) / log.period_s;
    a = cubic.derivative(q, 2) / (log.period_s * log.period_s);
    y = log.motion_alone() ? cubic.derivative(log.effort, 0) : log.measured();
    top = quantile(v.cwiseAbs(), 0.99);
    s = (v.array() / (0.02 * top)).tanh();
  }
  /// s |v / top|^p
  [[nodiscard]] auto power(double p) const -> Eigen::VectorXd { return s.array() * (v.array().abs() / top).pow(p); }
  /// The motor's torque so many samples later, held at the ends.
  [[nodiscard]] auto late(Eigen::Index by) const -> Eigen::VectorXd {
    return Eigen::VectorXd::NullaryExpr(
        tau.size(), [&](Eigen::Index i) { return tau[std::clamp<Eigen::Index>(i - by, 0, tau.size() - 1)]; });
  }
  Eigen::VectorXd q, one, tau, v, a, s, y;
  double top = 0.0;
};

}  // namespace

auto plain_effort_fits(const AxisLog& log) -> std::vector<PlainFit> {
  const auto x = std::make_shared<Axis>(log);
  std::vector<PlainFit> fits;
  const auto add = [&](const char* name, std::vector<Columns> all) {
    fits.push_back({name, [x, all = std::move(all)](Eigen::Index rows) { return best_of(all, x->y, rows); }});
  };
  const Columns rigid = {x->a, x->v, x->s, x->one};
  const auto beside = [&](const Columns& more) {
    Columns columns = rigid;
    columns.insert(columns.end(), more.begin(), more.end());
    return columns;
  };
  const Eigen::VectorXd sine = x->q.array().sin();
  const Eigen::VectorXd cosine = x->q.array().cos();
  std::vector<Columns> powers, weights_and_powers, plays;
  for (const double p : {0.1, 0.2, 0.33, 0.5, 0.7}) {
    powers.push_back({x->a, x->v, x->one, x->power(p)});
    weights_and_powers.push_back(beside({sine, cosine, x->power(p)}));
  }
  const double range = x->q.maxCoeff() - x->q.minCoeff();
  for (const double width : geometric(range / 300.0, range / 5.0, 20)) {
    plays.push_back(beside({(x->q - test::play_of(x->q, width)) / width}));
  }
  add("inertia+viscous", {{x->a, x->v}});
  add("+Coulomb+offset", {rigid});
  add("+asymmetry", {beside({x->v.cwiseMax(0.0)})});
  add("+gravity", {beside({sine, cosine})});
  add("+spring", {beside({x->q})});
  add("power law", powers);
  add("+gravity+power", weights_and_powers);
  add("+play", plays);
  return fits;
}

auto plain_gear_fits(const AxisLog& log) -> std::vector<PlainFit> {
  constexpr Eigen::Index kMostLate = 3;
  const auto x = std::make_shared<Axis>(log);
  std::vector<PlainFit> fits;
  fits.push_back({"gain", [x](Eigen::Index rows) { return fitted({x->tau, x->one}, x->y, rows); }});
  const auto add = [&](const char* name, auto columns) {
    std::vector<Columns> all;
    for (Eigen::Index by = -kMostLate; by <= kMostLate; ++by) {
      all.push_back(columns(x->late(by)));
    }
    fits.push_back({name, [x, all = std::move(all)](Eigen::Index rows) { return best_of(all, x->y, rows); }});
  };
  using Torque = const Eigen::VectorXd&;
  const auto with_load = [x](Torque t) -> Columns { return {t, x->s, x->s.cwiseProduct(t.cwiseAbs()), x->one}; };
  add("gain+skew", [x](Torque t) -> Columns { return {t, x->one}; });
  add("+Coulomb", [x](Torque t) -> Columns { return {t, x->s, x->one}; });
  add("+load friction", with_load);
  add("+saturation", [with_load](Torque t) -> Columns {
    Columns columns = with_load(t);
    columns.emplace_back(t.cwiseProduct(t.cwiseAbs()));
    return columns;
  });
  return fits;
}

}  // namespace capstan::tools::machines
