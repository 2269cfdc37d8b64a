// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "capstan/model/terms/table.hpp"
#include "capstan/tests/tools/select/small_selection.hpp"
#include "capstan/tools/select/vocabulary.hpp"

namespace capstan::tools {
namespace {

using test::SmallSelection;

constexpr Eigen::Index kRows = 400;

/// Which signals of a log change beside the motor's angle.
struct Signals {
  bool torque = true, others = true, warmth = true;
  double angle_unit = 1.0;
};

auto samples_with(const Signals& signals) -> Samples {
  Samples samples = test::samples_of(signals.angle_unit * test::two_sines(kRows));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto t = static_cast<double>(i);
    samples[i].tau = signals.torque ? 0.2 * std::sin(0.37 * t) : 0.0;
    samples[i].warmth = signals.warmth ? 0.01 * t : 0.0;
    samples[i].others[0].q1 = signals.others ? std::sin(0.05 * t) : 0.0;
    samples[i].others[2].q1 = signals.others ? 2.0 * std::sin(0.07 * t) : 0.0;
  }
  return samples;
}

auto grids_of(const Vocabulary& vocabulary, const std::string& term) -> std::vector<TermGrid> {
  std::vector<TermGrid> grids;
  for (const auto& grid : vocabulary.terms) {
    if (grid.term == term) {
      grids.push_back(grid);
    }
  }
  return grids;
}

/// {signal, factor} of every table of some grids.
auto tables_of(const std::vector<TermGrid>& grids) -> std::multiset<std::pair<TableSignal, TableFactor>> {
  std::multiset<std::pair<TableSignal, TableFactor>> tables;
  for (const auto& grid : grids) {
    for (const auto& shapes : grid.settings) {
      tables.emplace(static_cast<TableSignal>(shapes[0]), static_cast<TableFactor>(shapes[4]));
    }
  }
  return tables;
}

TEST(AngleVocabulary, BeginsWithRatioAndOffset) {
  const SmallSelection small(samples_with({}), Eigen::VectorXd::Zero(kRows));
  const Vocabulary vocabulary = angle_vocabulary(small.data);
  EXPECT_EQ(described(vocabulary.start), "motor_angle + joint_offset");
  ASSERT_EQ(vocabulary.starts.size(), 1u);
  EXPECT_EQ(vocabulary.starts.front(), vocabulary.start);
  EXPECT_EQ(vocabulary.plays, small.data.play_widths());
  for (const char* apart : {"play", "gravity", "motor_angle", "joint_offset", "hysteresis"}) {
    EXPECT_TRUE(grids_of(vocabulary, apart).empty() || grids_of(vocabulary, apart).front().settings.empty()) << apart;
  }
}

TEST(AngleVocabulary, HasTablesOverEverySignalThatTheLogHas) {
  const SmallSelection all(samples_with({}), Eigen::VectorXd::Zero(kRows));
  EXPECT_EQ(tables_of(grids_of(angle_vocabulary(all.data), "table")),
            (std::multiset<std::pair<TableSignal, TableFactor>>{{TableSignal::kMotorAngle, TableFactor::kOne},
                                                                {TableSignal::kTorque, TableFactor::kOne},
                                                                {TableSignal::kOtherAngle, TableFactor::kOne},
                                                                {TableSignal::kThirdOtherAngle, TableFactor::kOne}}));
  const SmallSelection alone(samples_with({.torque = false, .others = false}), Eigen::VectorXd::Zero(kRows));
  EXPECT_EQ(tables_of(grids_of(angle_vocabulary(alone.data), "table")),
            (std::multiset<std::pair<TableSignal, TableFactor>>{{TableSignal::kMotorAngle, TableFactor::kOne}}));
}

TEST(AngleVocabulary, OtherJointsPullThroughPlaysOfTheirOwnWidths) {
  const SmallSelection small(samples_with({}), Eigen::VectorXd::Zero(kRows));
  const Vocabulary vocabulary = angle_vocabulary(small.data);
  const auto first = grids_of(vocabulary, "coupled_hysteresis");
  ASSERT_EQ(first.size(), 1u);
  EXPECT_NEAR(first[0].settings.front()[0], small.data.ranges().others[0] / 100.0, 1e-9);
  EXPECT_TRUE(grids_of(vocabulary, "coupled_hysteresis_2").empty() ||
              grids_of(vocabulary, "coupled_hysteresis_2").front().settings.empty());  // that slot is at rest
  ASSERT_EQ(grids_of(vocabulary, "coupled_hysteresis_3").size(), 1u);
}

TEST(AngleVocabulary, ShapesAreSharesOfTheSignalThatTheyBelongTo) {
  const SmallSelection small(samples_with({}), Eigen::VectorXd::Zero(kRows));
  const Vocabulary vocabulary = angle_vocabulary(small.data);
  bool of_torque = false;
  for (const auto& grid : vocabulary.terms) {
    const auto& infos = term_catalogue().term(grid.term).shapes;
    for (std::size_t i = 0; i < infos.size(); ++i) {
      if (infos[i].of == ShapeOf::kTorqueRange) {
        of_torque = true;
        for (const auto& shapes : grid.settings) {
          EXPECT_LE(shapes[i], small.data.ranges().tau * (1.0 + 1e-12)) << grid.term;
          EXPECT_GE(shapes[i], small.data.ranges().tau / 25.0 * (1.0 - 1e-12)) << grid.term;
        }
      }
    }
  }
  EXPECT_TRUE(of_torque);
}

TEST(AngleVocabulary, WithoutTorqueThereIsNothingThatIsAShareOfIt) {
  const SmallSelection small(samples_with({.torque = false}), Eigen::VectorXd::Zero(kRows));
  for (const auto& grid : angle_vocabulary(small.data).terms) {
    for (const auto& info : term_catalogue().term(grid.term).shapes) {
      EXPECT_TRUE(info.of != ShapeOf::kTorqueRange || grid.settings.empty()) << grid.term;
    }
  }
}

TEST(AngleVocabulary, NoShapeIsBeyondWhatAJointFileTakes) {
  for (const double unit : {1e-5, 1.0, 1e3}) {
    const SmallSelection small(samples_with({.angle_unit = unit}), Eigen::VectorXd::Zero(kRows));
    const Vocabulary vocabulary = wider_vocabulary(small.data, {});
    const ShapeInfo& half_width = term_catalogue().term("hysteresis").shapes.front();
    for (const double width : vocabulary.plays) {
      EXPECT_GE(width, half_width.minimum);
      EXPECT_LE(width, half_width.maximum);
    }
    EXPECT_LE(vocabulary.plays.size(), small.data.play_widths().size());
    for (const auto& grid : vocabulary.terms) {
      const auto& infos = term_catalogue().term(grid.term).shapes;
      for (const auto& shapes : grid.settings) {
        ASSERT_EQ(shapes.size(), infos.size()) << grid.term;
        for (std::size_t i = 0; i < infos.size(); ++i) {
          EXPECT_GE(shapes[i], infos[i].minimum) << grid.term;
          EXPECT_LE(shapes[i], infos[i].maximum) << grid.term;
        }
      }
    }
  }
}

TEST(AngleVocabulary, WiderGrowsFromTheLawsAskedForAndMultipliesNoSignalByItself) {
  const SmallSelection small(samples_with({}), Eigen::VectorXd::Zero(kRows));
  const LawCandidate other = test::law_of({{"motor_angle", {}}}, {0.3});
  const Vocabulary vocabulary = wider_vocabulary(small.data, {other});
  ASSERT_EQ(vocabulary.starts.size(), 1u);
  EXPECT_EQ(vocabulary.starts.front(), other);
  const auto grids = grids_of(vocabulary, "table");
  ASSERT_EQ(grids.size(), 3u);
  const auto together = tables_of({grids[1]});
  EXPECT_EQ(together.count({TableSignal::kTorque, TableFactor::kTorque}), 0u);
  EXPECT_EQ(together.count({TableSignal::kTorque, TableFactor::kRate}), 1u);
  EXPECT_EQ(together.count({TableSignal::kMotorAngle, TableFactor::kMotorAngle}), 0u);
  EXPECT_EQ(together.count({TableSignal::kRate, TableFactor::kRate}), 0u);
  EXPECT_EQ(together.count({TableSignal::kWarmth, TableFactor::kOne}), 1u);
  EXPECT_EQ(together.count({TableSignal::kSecondOtherAngle, TableFactor::kOne}), 0u);  // at rest
  EXPECT_TRUE(grids[2].by_direction);
  EXPECT_EQ(tables_of({grids[2]}).count({TableSignal::kRate, TableFactor::kOne}), 0u);  // its sign is the direction
  const SmallSelection no_torque(samples_with({.torque = false}), Eigen::VectorXd::Zero(kRows));
  for (const auto& [signal, factor] : tables_of(grids_of(wider_vocabulary(no_torque.data, {}), "table"))) {
    EXPECT_NE(factor, TableFactor::kTorque);
  }
}

}  // namespace
}  // namespace capstan::tools
