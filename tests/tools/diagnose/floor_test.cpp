// SPDX-License-Identifier: Apache-2.0
// The floor beside a healthy joint's law: tests of verdicts without one are in verdict_test.cpp.
#include <gtest/gtest.h>

#include "capstan/tests/tools/diagnose/small_evidence.hpp"
#include "capstan/tools/diagnose/verdict.hpp"

namespace capstan::tools {
namespace {

TEST(FloorByTheHealthyLaw, IsNoHigherThanWhatItLeftOfItsOwnLogs) {
  const Preparation p = test::preparation_of(20, {});
  Diagnosis d;
  d.verdict = Verdict::kEffect;
  d.noise_floor = 0.1;  // what comes and goes from cycle to cycle
  d.after.rmse = 0.05;
  d.reason = "The law lacks gravity; what remains cannot be distinguished from noise.";
  JointFile healthy;
  bound_floor_by(healthy, p, d);  // nobody wrote it down
  EXPECT_EQ(d.noise_floor, 0.1);
  healthy.fit.emplace();
  healthy.fit->rmse = 0.02;
  bound_floor_by(healthy, p, d);
  EXPECT_EQ(d.noise_floor, 0.02);
  EXPECT_EQ(d.floor_from, "law");
  Search search;
  search.effects.emplace_back().name = "gravity";
  reconcile(p, search, {}, d);
  EXPECT_EQ(d.reason, "The law lacks gravity; no effect of the catalogue lowers the error further.");
}

TEST(FloorByTheHealthyLaw, IsThatOfANoisierSensor) {
  Preparation p = test::preparation_of(20, {});
  for (Eigen::Index i = 0; i < p.target.size(); ++i) {
    p.target[i] = i % 2 == 0 ? 0.05 : -0.05;
  }
  Diagnosis d;
  d.noise_floor = 0.06;
  JointFile healthy;
  healthy.fit.emplace();
  healthy.fit->rmse = 0.02;
  bound_floor_by(healthy, p, d);
  EXPECT_EQ(d.noise_floor, 0.06);
}

}  // namespace
}  // namespace capstan::tools
