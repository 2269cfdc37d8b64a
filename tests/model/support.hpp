// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <random>
#include <string_view>

#include "capstan/model/motion_law.hpp"

namespace capstan::test {

/// Lets a typed test say `number<TypeParam>(0.5)` and `value_of(x)` whatever the number format.
template <typename Scalar>
constexpr auto number(double value) -> Scalar {
  return ScalarTraits<Scalar>::from(value);
}
constexpr auto value_of(double x) -> double {
  return x;
}
template <typename Rep, int Frac>
constexpr auto value_of(Fixed<Rep, Frac> x) -> double {
  return x.to_double();
}

/// One unit in the last place of Q24.
constexpr double kLsb = 1.0 / 16777216.0;

template <typename Scalar>
constexpr auto one_khz() -> SamplePeriod<Scalar> {
  if constexpr (std::is_same_v<Scalar, double>) {
    return SamplePeriod<double>(0.001);
  } else {
    return SamplePeriod<Q24>(1000);
  }
}

/// A term of one shape, at 1 kHz.
template <template <typename> typename Term, typename Scalar>
auto make_term(double shape) -> Term<Scalar> {
  return Term<Scalar>(one_khz<Scalar>(), {number<Scalar>(shape)});
}

/// Law parameters by the names of the catalogue, so that a test does not depend on the order of terms.
class LawBuilder {
 public:
  auto coefficient(std::string_view term, std::string_view name, double value) -> LawBuilder& {
    parameters_.coefficients.at(find<SumTerms>(term, name, 0, [](const auto& info) { return info.coefficients; })) =
        value;
    return *this;
  }
  auto shape(std::string_view term, std::string_view name, double value) -> LawBuilder& {
    auto shapes = [](const auto& info) { return info.shapes; };
    std::size_t index = find<InputTerms>(term, name, 0, shapes);
    if (index >= kShapeCount) {
      index = find<SumTerms>(term, name, InputTerms::kShapes, shapes);
    }
    if (index >= kShapeCount) {
      index = find<OutputTerms>(term, name, InputTerms::kShapes + SumTerms::kShapes, shapes);
    }
    parameters_.shapes.at(index) = value;
    return *this;
  }
  auto conditioner(double direction_threshold_rad, double rate_time_constant_s) -> LawBuilder& {
    parameters_.conditioner = {direction_threshold_rad, rate_time_constant_s};
    return *this;
  }

  template <typename Scalar>
  [[nodiscard]] auto parameters() const -> LawParameters<Scalar> {
    LawParameters<Scalar> result;
    for (std::size_t i = 0; i < kCoefficientCount; ++i) {
      result.coefficients[i] = number<Scalar>(parameters_.coefficients[i]);
    }
    for (std::size_t i = 0; i < kShapeCount; ++i) {
      result.shapes[i] = number<Scalar>(parameters_.shapes[i]);
    }
    result.conditioner.direction_threshold_rad = number<Scalar>(parameters_.conditioner.direction_threshold_rad);
    result.conditioner.rate_time_constant_s = number<Scalar>(parameters_.conditioner.rate_time_constant_s);
    return result;
  }
  template <typename Scalar>
  [[nodiscard]] auto law() const -> MotionLaw<Scalar> {
    return MotionLaw<Scalar>(one_khz<Scalar>(), parameters<Scalar>());
  }

 private:
  /// Flat index of a parameter, or past every index if the list has no such term; `at` then throws and fails the test.
  template <typename List, typename Members>
  static auto find(std::string_view term, std::string_view name, std::size_t first, Members&& members) -> std::size_t {
    std::size_t next = first;
    std::size_t found = kCoefficientCount + kShapeCount;
    List::template for_each<double>([&]<typename Term>() {
      for (const auto& member : members(Term::kInfo)) {
        found = term == Term::kInfo.name && name == member.name ? next : found;
        ++next;
      }
    });
    return found;
  }

  LawParameters<double> parameters_;
};

/// Sum of sines with random frequencies and phases, at most `amplitude` in magnitude.
class RandomMultisine {
 public:
  RandomMultisine(std::uint32_t seed, double amplitude, double low_hz, double high_hz) : scale_(amplitude / kTones) {
    std::mt19937 engine(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (std::size_t i = 0; i < kTones; ++i) {
      omega_[i] = 2.0 * kPi * low_hz * std::pow(high_hz / low_hz, unit(engine));
      phase_[i] = 2.0 * kPi * unit(engine);
    }
  }
  [[nodiscard]] auto operator()(double t) const -> double {
    double sum = 0.0;
    for (std::size_t i = 0; i < kTones; ++i) {
      sum += std::sin(omega_[i] * t + phase_[i]);
    }
    return scale_ * sum;
  }

 private:
  static constexpr double kPi = 3.14159265358979323846;
  static constexpr std::size_t kTones = 8;
  double scale_;
  std::array<double, kTones> omega_{};
  std::array<double, kTones> phase_{};
};

}  // namespace capstan::test
