// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>

#include "capstan/model/torque_law.hpp"

namespace capstan::test {

inline auto fixed_of(const TorqueLawParameters<double>& law) -> TorqueLawParameters<Q24> {
  const auto rounded = [](double value) { return Q24::from_double(value); };
  TorqueLawParameters<Q24> fixed;
  std::transform(law.coefficients.begin(), law.coefficients.end(), fixed.coefficients.begin(), rounded);
  std::transform(law.shapes.begin(), law.shapes.end(), fixed.shapes.begin(), rounded);
  return fixed;
}

/// Parameters of a torque law by their names.
class TorqueLawBuilder {
 public:
  auto coefficient(const std::string& term, const std::string& name, double value) -> TorqueLawBuilder& {
    law_.coefficients.at(place(term, name, [](const auto& info) { return info.coefficients; })) = value;
    return *this;
  }
  auto shape(const std::string& term, const std::string& name, double value) -> TorqueLawBuilder& {
    law_.shapes.at(place(term, name, [](const auto& info) { return info.shapes; })) = value;
    return *this;
  }
  template <typename Scalar>
  [[nodiscard]] auto parameters() const -> TorqueLawParameters<Scalar> {
    if constexpr (std::is_same_v<Scalar, double>) {
      return law_;
    } else {
      return fixed_of(law_);
    }
  }

 private:
  template <typename Members>
  static auto place(const std::string& term, const std::string& name, Members&& members) -> std::size_t {
    std::size_t next = 0;
    std::size_t found = TorqueTerms::kCoefficients + TorqueTerms::kShapes;
    TorqueTerms::for_each<double>([&]<typename Term>() {
      for (const auto& info : members(Term::kInfo)) {
        found = term == kTorqueTermName<Term>.data() && name == info.name ? next : found;
        ++next;
      }
    });
    if (found >= next) {
      throw std::out_of_range(term + "." + name + " is in no torque law");
    }
    return found;
  }

  TorqueLawParameters<double> law_;
};

}  // namespace capstan::test
