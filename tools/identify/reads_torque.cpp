// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/reads_torque.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/identify/conditioning.hpp"

namespace capstan::tools {
namespace {

constexpr double kPeriodS = 0.01;

/// More than any table is over, so that each is seen from end to end.
constexpr double kMostNm = 1000.0;

/// A motor that goes to and fro, under torques of many sizes or under none.
auto made_up(double most_nm) -> Samples {
  constexpr Eigen::Index kRows = 1000;
  AxisLog log;
  log.period_s = kPeriodS;
  log.time_s = Eigen::VectorXd::LinSpaced(kRows, 0.0, kPeriodS * (kRows - 1));
  log.q1_rad = (3.0 * log.time_s.array()).sin();
  log.tau_nm = most_nm * (7.0 * log.time_s.array()).sin() * (0.4 * log.time_s.array()).sin();
  return causal_samples(log, {});
}

}  // namespace

auto reads_torque(const LawForm& form) -> bool {
  static const Samples kWith = made_up(kMostNm);
  static const Samples kWithout = made_up(0.0);
  return std::any_of(form.terms.begin(), form.terms.end(), [&form](const std::string& name) {
    const CatalogueTerm& term = form.catalogue->term(name);
    if (!term.columns) {
      return false;  // of an input or of an output
    }
    const Shapes shapes = form.shapes_of(term);
    return term.columns(kWith, kPeriodS, shapes) != term.columns(kWithout, kPeriodS, shapes);
  });
}

}  // namespace capstan::tools
