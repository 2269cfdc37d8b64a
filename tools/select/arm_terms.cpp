// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/arm_terms.hpp"

#include <array>
#include <cmath>

namespace capstan::tools {
namespace {

/// Of a joint, in SI units.
struct Motion {
  double q = 0.0, v = 0.0, a = 0.0;

  explicit Motion(const Sample<double>& sample) : q(sample.q1), v(sample.dq1), a(kPerThousand * sample.ddq1) {}

 private:
  static constexpr double kPerThousand = 1000.0;  // samples have krad/s2
};

/// A function of an angle or a way, and its derivative.
struct Shaped {
  double value = 0.0, slope = 0.0;
};

auto cosine(double q, double order) -> Shaped {
  return {std::cos(order * q), -order * std::sin(order * q)};
}
auto sine(double q, double order) -> Shaped {
  return {std::sin(order * q), order * std::cos(order * q)};
}
auto way(double q) -> Shaped {
  return {q, 1.0};
}
auto square(double q) -> Shaped {
  return {q * q, 2.0 * q};
}

/// The effort of T = J(q_o) v^2 / 2.
auto changed_inertia(const Shaped& j, const Motion& own, const Motion& other) -> double {
  return j.value * own.a + j.slope * other.v * own.v;
}
/// Of T = m(q_o) v v_o.
auto passed_on(const Shaped& m, const Motion& other) -> double {
  return m.value * other.a + m.slope * other.v * other.v;
}
/// Of T = C(q) v_o^2 / 2.
auto centrifugal(const Shaped& c, const Motion& other) -> double {
  return -0.5 * c.slope * other.v * other.v;
}

auto posture_of_a_turn(const Motion& own, const Motion& other) -> std::array<double, 16> {
  return {changed_inertia(cosine(other.q, 1.0), own, other),
          changed_inertia(sine(other.q, 1.0), own, other),
          changed_inertia(cosine(other.q, 2.0), own, other),
          changed_inertia(sine(other.q, 2.0), own, other),
          passed_on(cosine(other.q, 1.0), other),
          passed_on(sine(other.q, 1.0), other),
          std::cos(own.q) * other.a,
          std::sin(own.q) * other.a,
          centrifugal(cosine(own.q, 1.0), other),
          centrifugal(sine(own.q, 1.0), other),
          centrifugal(cosine(own.q, 2.0), other),
          centrifugal(sine(own.q, 2.0), other),
          std::cos(own.q + other.q),
          std::sin(own.q + other.q),
          std::cos(own.q - other.q),
          std::sin(own.q - other.q)};
}

auto posture_of_a_slide(const Motion& own, const Motion& other) -> std::array<double, 7> {
  return {passed_on(cosine(other.q, 1.0), other),
          passed_on(sine(other.q, 1.0), other),
          own.q * other.a,
          centrifugal(way(own.q), other),
          centrifugal(square(own.q), other),
          std::cos(other.q),
          std::sin(other.q)};
}

auto reach_of_a_turn(const Motion& own, const Motion& other) -> std::array<double, 7> {
  return {changed_inertia(way(other.q), own, other),
          changed_inertia(square(other.q), own, other),
          passed_on(way(other.q), other),
          std::cos(own.q) * other.a,
          std::sin(own.q) * other.a,
          other.q * std::cos(own.q),
          other.q * std::sin(own.q)};
}

/// One row of regressors for each pair of samples.
template <typename Row>
auto by_row(Row row_of) -> std::function<Eigen::MatrixXd(const Samples&, const Samples&)> {
  return [row_of](const Samples& own, const Samples& other) {
    constexpr std::size_t kColumns = std::tuple_size_v<decltype(row_of(Motion(own[0]), Motion(other[0])))>;
    Eigen::MatrixXd columns(static_cast<Eigen::Index>(own.size()), static_cast<Eigen::Index>(kColumns));
    for (std::size_t i = 0; i < own.size(); ++i) {
      const std::array<double, kColumns> row = row_of(Motion(own[i]), Motion(other[i]));
      columns.row(static_cast<Eigen::Index>(i)) = Eigen::Map<const Eigen::RowVectorXd>(row.data(), kColumns);
    }
    return columns;
  };
}

auto free_number(const char* name, const char* unit, const char* doc) -> CoefficientInfo {
  return {name, unit, Sign::kAny, doc};
}

auto arm_term(const char* name) -> CatalogueTerm {
  CatalogueTerm term;
  term.name = name;
  term.equation = "d/dt dT/dv - dT/dq + dV/dq of T = J(q_o) v^2 / 2 + m(q_o) v v_o + n(q) v v_o + C(q) v_o^2 / 2";
  term.source = "Lagrange's equation of two joints of an arm";
  term.confusable_with = "inertia and gravity where the other joint hardly moves";
  term.exciting_motion = "both joints over most of their range, fast, at frequencies without a common multiple";
  return term;
}

}  // namespace

auto posture_coupling(bool of_linear) -> CatalogueTerm {
  CatalogueTerm term = arm_term("posture_coupling");
  if (of_linear) {
    term.coefficients = {free_number("passed_on_cosine", "kgm", "mass that passes the other's acceleration on"),
                         free_number("passed_on_sine", "kgm", "a quarter of its turn later"),
                         free_number("passed_on_way", "kg", "the same, by this way"),
                         free_number("centrifugal", "kgm", "mass times its distance from the other's axis"),
                         free_number("centrifugal_way", "kg", "the same, by this way"),
                         free_number("weight_cosine", "N", "weight along the slide, by the other's angle"),
                         free_number("weight_sine", "N", "a quarter of its turn later")};
    term.pair_columns = by_row(posture_of_a_slide);
    return term;
  }
  term.coefficients = {free_number("inertia_cosine", "kgm2", "this joint's inertia, by the other's angle"),
                       free_number("inertia_sine", "kgm2", "a quarter of its turn later"),
                       free_number("inertia_cosine_2", "kgm2", "this joint's inertia, by twice the other's angle"),
                       free_number("inertia_sine_2", "kgm2", "a quarter of its turn later"),
                       free_number("passed_on_cosine", "kgm2", "what passes acceleration on, by the other's angle"),
                       free_number("passed_on_sine", "kgm2", "a quarter of its turn later"),
                       free_number("passed_on_own_cosine", "kgm2", "what passes acceleration on, by this angle"),
                       free_number("passed_on_own_sine", "kgm2", "a quarter of its turn later"),
                       free_number("centrifugal_cosine", "kgm2", "the other's inertia, by this angle"),
                       free_number("centrifugal_sine", "kgm2", "a quarter of its turn later"),
                       free_number("centrifugal_cosine_2", "kgm2", "the other's inertia, by twice this angle"),
                       free_number("centrifugal_sine_2", "kgm2", "a quarter of its turn later"),
                       free_number("weight_sum_cosine", "Nm", "weight that both turn the same way"),
                       free_number("weight_sum_sine", "Nm", "a quarter of its turn later"),
                       free_number("weight_difference_cosine", "Nm", "weight that they turn against each other"),
                       free_number("weight_difference_sine", "Nm", "a quarter of its turn later")};
  term.pair_columns = by_row(posture_of_a_turn);
  return term;
}

auto reach_coupling() -> CatalogueTerm {
  CatalogueTerm term = arm_term("reach_coupling");
  term.coefficients = {free_number("inertia_way", "kgm", "this joint's inertia, by how far the other is out"),
                       free_number("inertia_square", "kg", "mass that the other moves out"),
                       free_number("passed_on_way", "kg", "what passes acceleration on, by the other's way"),
                       free_number("passed_on_own_cosine", "kgm", "what passes acceleration on, by this angle"),
                       free_number("passed_on_own_sine", "kgm", "a quarter of its turn later"),
                       free_number("weight_cosine", "N", "weight that the other moves out"),
                       free_number("weight_sine", "N", "a quarter of this turn later")};
  term.pair_columns = by_row(reach_of_a_turn);
  return term;
}

auto posture_parts(bool of_linear) -> std::vector<std::vector<std::size_t>> {
  if (of_linear) {
    return {{0, 1}, {2}, {3}, {4}, {5, 6}};
  }
  return {{0, 1}, {2, 3}, {4, 5}, {6, 7}, {8, 9}, {10, 11}, {12, 13}, {14, 15}};
}

auto reach_parts() -> std::vector<std::vector<std::size_t>> {
  return {{0}, {1}, {2}, {3, 4}, {5, 6}};
}

}  // namespace capstan::tools
