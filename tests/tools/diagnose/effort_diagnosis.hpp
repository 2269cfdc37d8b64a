// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>

#include "capstan/tests/tools/synthetic_effort.hpp"
#include "capstan/tools/diagnose/diagnosis.hpp"

namespace capstan::tools {

using test::EffortRequest;
using test::EffortTruth;

inline auto diagnosis_of(EffortTruth truth, std::uint64_t seed = 1) -> Diagnosis {
  EffortRequest request;
  request.truth = truth;
  request.seed = seed;
  return diagnose({test::synthetic_effort_log(request)}, {});
}

inline auto names_of(const Diagnosis& d) -> std::vector<std::string> {
  std::vector<std::string> names;
  for (const auto& effect : d.effects) {
    names.push_back(effect.name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

inline auto coefficient_of(const Diagnosis& d, const std::string& term, std::size_t i = 0) -> double {
  return d.law.parameters.coefficients[d.law.catalogue->term(term).first_coefficient + i];
}

inline auto shape_of(const Diagnosis& d, const std::string& term) -> double {
  return d.law.parameters.shapes[d.law.catalogue->term(term).first_shape];
}

inline void expect_named(const Diagnosis& d, const std::vector<std::string>& names) {
  EXPECT_EQ(d.verdict, Verdict::kEffect) << d.reason;
  EXPECT_EQ(names_of(d), names) << d.reason;
  EXPECT_LT(d.ratio_ci95[1], 1.0);
  EXPECT_LT(d.after.rmse, d.before.rmse);
  EXPECT_EQ(d.base_model, "rigid_dynamics");
  EXPECT_EQ(d.unit, "Nm");
}

}  // namespace capstan::tools
