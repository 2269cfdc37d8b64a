// SPDX-License-Identifier: Apache-2.0
// The motion that a diagnosis asks for next is a scenario that the simulated joint carries out.
#include "capstan/tools/diagnose/next_experiment.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <sstream>

#include "capstan/boards/common/file_banks.hpp"
#include "capstan/tools/log/csv_log.hpp"
#include "capstan/tools/run/run.hpp"

namespace capstan::tools {
namespace {

/// Of a joint that went from 0.1 to 0.5 rad, at 0.6 rad/s at most.
auto open_diagnosis(Verdict verdict) -> Diagnosis {
  Diagnosis d;
  d.verdict = verdict;
  d.next_experiment = "Record this.";
  d.target = "axis0/q2_rad";
  d.rate_hz = 100.0;
  const Eigen::VectorXd time = Eigen::VectorXd::LinSpaced(6000, 0.0, 59.99);
  d.traces.measured = 0.3 + 0.2 * (3.0 * time.array()).sin();
  d.traces.q1 = 2.0 * d.traces.measured;
  return d;
}

auto run(const std::string& text) -> CsvLog {
  std::ostringstream log;
  FileBanks banks = FileBanks::temporary();
  static_cast<void>(run_scenario(sim::parse_scenario(text, "next_experiment.toml"), {}, banks, &log));
  return CsvLog::parse(log.str(), "next.csv");
}

TEST(NextExperiment, OfAnUnknownEffectIsAScenarioThatStaysWhereTheJointHasBeen) {
  const std::string text = next_scenario(open_diagnosis(Verdict::kUnknown));
  const CsvLog log = run(text);
  const Eigen::VectorXd angle = log.column("axis0/q2_ref_rad");
  const Eigen::VectorXd time = log.time();
  EXPECT_GT(time.tail(1)[0], 60.0);
  EXPECT_LT(angle.maxCoeff(), 0.51);
  const Eigen::Index n = angle.size();
  constexpr Eigen::Index kStart = 2000;  // on the way from 0 to where the motion is
  EXPECT_GT(angle.segment(kStart, n - 2 * kStart).minCoeff(), 0.09);
  const Eigen::VectorXd speed =
      (angle.segment(kStart + 10, n - 2 * kStart) - angle.segment(kStart, n - 2 * kStart)) / 0.01;
  EXPECT_GT(speed.maxCoeff(), 0.3);
  EXPECT_LT(speed.maxCoeff(), 1.5 * 0.6);  // where one segment leads over into the next
}

TEST(NextExperiment, OfAnAmbiguousAnswerHasWhatTellsTheCandidatesApartAndNoMore) {
  Diagnosis d = open_diagnosis(Verdict::kAmbiguous);
  d.effects.push_back({"transport_delay", {"transmission_viscous"}});
  const std::string text = next_scenario(d);
  EXPECT_NE(text.find("speed_ladder"), std::string::npos);
  EXPECT_NE(text.find("multisine"), std::string::npos);
  EXPECT_EQ(text.find("reversal_staircase"), std::string::npos);
  EXPECT_NE(text.find("repeat = 4"), std::string::npos);
  d.effects[0] = {"thermal_drift", {"viscoelastic_creep"}};
  EXPECT_NE(next_scenario(d).find("repeat = 8"), std::string::npos);
}

TEST(NextExperiment, IsMadeForAnUnfitLogTooAndForNothingThatIsSettled) {
  Diagnosis d = open_diagnosis(Verdict::kDataUnfit);
  d.traces = {};
  EXPECT_NE(next_scenario(d).find("does not say how far"), std::string::npos);
  EXPECT_GT(run(next_scenario(d)).time().size(), 1000);
  d.next_experiment.reset();
  EXPECT_TRUE(next_scenario(d).empty());
}

TEST(NextExperiment, OfANamedEffectIsTheMotionForParametersThatStandForEachOther) {
  Diagnosis d = open_diagnosis(Verdict::kEffect);
  d.next_experiment.reset();
  ConfusedPair pair{
      "inertia.inertia", "viscous_friction.drag", {"inertia", "viscous_friction"}, 0.99, "A sum is known."};
  d.told.confused = {pair};
  const std::string text = next_scenario(d);
  EXPECT_NE(text.find("# A sum is known."), std::string::npos);
  EXPECT_NE(text.find("speed_ladder"), std::string::npos);  // for drag
  EXPECT_NE(text.find("multisine"), std::string::npos);     // for inertia
  EXPECT_EQ(text.find("reversal_staircase"), std::string::npos);
  EXPECT_GT(run(text).time().size(), 1000);
}

}  // namespace
}  // namespace capstan::tools
