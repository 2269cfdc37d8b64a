// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "capstan/model/terms/table.hpp"
#include "capstan/tools/diagnose/diagnosis.hpp"
#include "capstan/tools/diagnose/free_run.hpp"
#include "capstan/tools/select/choice.hpp"
#include "capstan/tools/select/vocabulary.hpp"
#include "capstan/tools/support/random.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

constexpr double kNoise = 0.001;
constexpr double kPeriod = 0.005;
constexpr std::size_t kKnots = Table<double>::kKnots;

/// Strokes of many lengths and speeds under a torque of its own course: q2 = 1.1 q1 - (0.9 | 0.6) tau + an effect.
struct Joint {
  Eigen::VectorXd q, rate, torque, sign;
  AxisLog log;

  template <typename Effect>
  explicit Joint(Effect&& effect, Eigen::Index rows = 16000) {
    q.resize(rows);
    rate.resize(rows);
    torque.resize(rows);
    sign.resize(rows);
    Random random(7);
    log.name = "made.csv";
    log.target = "axis0/q2_rad";
    log.period_s = kPeriod;
    log.has_torque = true;
    log.time_s.resize(rows);
    log.q2_rad.resize(rows);
    for (Eigen::Index i = 0; i < rows; ++i) {
      const double t = kPeriod * static_cast<double>(i);
      log.time_s[i] = t;
      q[i] = 0.7 * std::sin(1.3 * t) + 0.5 * std::sin(2.9 * t);
      rate[i] = 0.7 * 1.3 * std::cos(1.3 * t) + 0.5 * 2.9 * std::cos(2.9 * t);
      sign[i] = rate[i] < 0.0 ? -1.0 : 1.0;
      torque[i] = 0.04 * q[i] + 0.02 * sign[i] + 0.03 * std::sin(0.77 * t);
      log.q2_rad[i] = 1.1 * q[i] - (sign[i] > 0.0 ? 0.9 : 0.6) * torque[i] + kNoise * random.normal();
    }
    for (Eigen::Index i = 0; i < rows; ++i) {
      log.q2_rad[i] += effect(*this, i);
    }
    log.q1_rad = q;
    log.tau_nm = torque;
  }
};

auto no_effect(const Joint& /*joint*/, Eigen::Index /*row*/) -> double {
  return 0.0;
}

/// A log as the selection of a law sees it.
struct Opened {
  explicit Opened(const AxisLog& log) : logs{log} {}
  std::vector<AxisLog> logs;
  LawForm form = form_of_model("pseudo_kinematic", logs);
  Preparation p = prepare(logs, form);
  SelectionData data{p, *form.catalogue};
  ForwardScore forward{data, data.logs()};
  LawCandidate base = candidate_of(form);
};

auto over(TableSignal signal, double knots, double low, double high, TableFactor factor) -> Shapes {
  return {static_cast<double>(signal), knots, low, high, static_cast<double>(factor)};
}

TEST(WiderVocabulary, HasTablesByDirectionAndWithEveryFactorThatTheLogShows) {
  const Opened opened(Joint(no_effect).log);
  const Vocabulary wide = wider_vocabulary(opened.data, {opened.base});
  ASSERT_EQ(wide.starts.size(), 1U);
  EXPECT_EQ(wide.starts.front(), opened.base);
  const auto has = [&](TableSignal signal, TableFactor factor, bool by_direction) {
    return std::any_of(wide.terms.begin(), wide.terms.end(), [&](const TermGrid& grid) {
      return grid.term == "table" && grid.by_direction == by_direction &&
             std::any_of(grid.settings.begin(), grid.settings.end(), [&](const Shapes& shapes) {
               return shapes[0] == static_cast<double>(signal) && shapes[4] == static_cast<double>(factor);
             });
    });
  };
  EXPECT_TRUE(has(TableSignal::kMotorAngle, TableFactor::kOne, true));
  EXPECT_TRUE(has(TableSignal::kRate, TableFactor::kTorque, false));
  EXPECT_TRUE(has(TableSignal::kSinceReversal, TableFactor::kMotorAngle, true));
  EXPECT_FALSE(has(TableSignal::kOtherAngle, TableFactor::kOne, true)) << "no other joint moves";
  EXPECT_FALSE(has(TableSignal::kWarmth, TableFactor::kTorque, true)) << "nor does it get warm";
}

// By direction: a curve of its own for each, which one curve of both can not follow.
TEST(WiderVocabulary, ATableByDirectionFollowsACurveOfEachDirection) {
  const Joint joint([](const Joint& made, Eigen::Index i) {
    return 0.01 * (made.sign[i] > 0.0 ? std::sin(3.0 * made.q[i]) : std::cos(2.0 * made.q[i]));
  });
  Opened opened(joint.log);
  const Shapes shapes = over(TableSignal::kMotorAngle, 17.0, -1.2, 1.2, TableFactor::kOne);
  const auto left = [&](bool by_direction) {
    return std::sqrt(
        opened.forward.score(with_term(*opened.form.catalogue, opened.base, {"table", shapes, by_direction})));
  };
  EXPECT_GT(left(false), 4.0 * kNoise);
  EXPECT_LT(left(true), 1.3 * kNoise);
}

// Torque grows with the angle here, so a table over a range twice as wide has cells where no row has been, and in one
// direction more of them than in the other.
TEST(WiderVocabulary, KnotsWhereNoRowHasBeenTakeTheirNeighboursValues) {
  const Joint joint([](const Joint& made, Eigen::Index i) { return 0.05 * made.torque[i] * made.rate[i]; });
  Opened opened(joint.log);
  const double least = joint.torque.minCoeff();
  const double most = joint.torque.maxCoeff();
  const double range = most - least;
  const Shapes shapes = over(TableSignal::kTorque, 17.0, least - range, most + range, TableFactor::kRate);
  const FittedCandidate fit =
      opened.forward.fitted(with_term(*opened.form.catalogue, opened.base, {"table", shapes, true}));
  ASSERT_TRUE(fit.valid);
  std::size_t first = 0;
  for (const auto& choice : fit.law.terms) {
    if (choice.term == "table") {
      break;
    }
    first += opened.form.catalogue->term(choice.term).coefficients.size();
  }
  const Eigen::VectorXd values = fit.theta.segment(static_cast<Eigen::Index>(first), 2 * kKnots);
  // The largest value that the effect has where the motor has been.
  const double largest = 0.05 * joint.torque.cwiseAbs().maxCoeff();
  EXPECT_LT(values.cwiseAbs().maxCoeff(), 1.5 * largest);
  for (const Eigen::Index direction : {0, 1}) {
    const auto own = values.segment(direction * static_cast<Eigen::Index>(kKnots), kKnots);
    EXPECT_NEAR(own[0], own[3], 0.05 * largest) << "below every row";
    EXPECT_NEAR(own[16], own[13], 0.05 * largest) << "above every row";
    EXPECT_GT(own.maxCoeff() - own.minCoeff(), 0.5 * largest);
  }
}

TEST(WiderVocabulary, LawsGrowFromTheBaseLawToo) {
  const Joint joint([](const Joint& made, Eigen::Index i) { return 0.05 * made.torque[i] * made.rate[i]; });
  Opened opened(joint.log);
  Vocabulary vocabulary = wider_vocabulary(opened.data, {opened.base});
  const auto grown = [&] { return grown_angle_laws(opened.forward, vocabulary); };
  const auto all = grown();
  const auto keeps_base = [&](const ScoredLaw<LawCandidate>& one) {
    return std::all_of(opened.base.terms.begin(), opened.base.terms.end(),
                       [&](const TermChoice& choice) { return one.law.find(choice.term) != nullptr; });
  };
  const auto best = std::min_element(all.begin(), all.end(), [](auto& a, auto& b) { return a.score < b.score; });
  EXPECT_TRUE(keeps_base(*best)) << described(best->law);
  EXPECT_LT(std::sqrt(best->score), 1.2 * kNoise);
  EXPECT_EQ(all.front().law.terms.size(), opened.base.terms.size()) << "a path begins with its start";
}

// Two stages: what the base law or a name says well is not asked again.
TEST(WiderVocabulary, IsNotAskedWhereTheBaseLawIsTheTruth) {
  const Opened opened(Joint(no_effect).log);
  const JointFile base = causal_law(opened.p, opened.form);
  const LawChoice choice = choose_law(opened.p, base, std::nullopt);
  EXPECT_EQ(choice.status, LawStatus::kBase);
  for (const auto& judged : choice.selection.laws) {
    const TermChoice* table = judged.law.find("table");
    EXPECT_TRUE(table == nullptr || (!table->by_direction && table->shapes[4] == 0.0)) << described(judged.law);
  }
}

TEST(WiderVocabulary, FrictionByRateTimesTorqueIsCorrectedOnUnseenRows) {
  const Joint joint(
      [](const Joint& made, Eigen::Index i) { return 0.06 * made.torque[i] * std::abs(made.rate[i]) * made.rate[i]; });
  const Diagnosis d = diagnose({joint.log}, {});
  EXPECT_EQ(d.law.status, LawStatus::kProvisional) << d.reason;
  EXPECT_GT(d.before.rmse, 2.5 * kNoise);
  EXPECT_LT(d.after.rmse, 1.3 * kNoise) << d.unnamed.value_or(UnnamedPart{}).sentence;
  ASSERT_TRUE(d.unnamed.has_value());
  EXPECT_FALSE(d.unnamed->signals.empty());
}

// An effect that is the other way round in the rows that are set aside: over all rows a law with it is still
// the better one, but what was learned without them errs there more than a law without it.
TEST(DeliveredLaw, ThatErrsMoreThanTheBaseLawOnUnseenRowsIsTheBaseLaw) {
  const auto effect = [](const Joint& made, Eigen::Index i) {
    return 0.06 * made.torque[i] * std::abs(made.rate[i]) * made.rate[i];
  };
  const Opened opened(Joint(effect).log);
  Eigen::VectorXd side = Eigen::VectorXd::Ones(16000);
  for (const auto& rows : refined(opened.p.split, opened.p.factor).of(Role::kReport)) {
    side.segment(rows.begin, rows.size()).setConstant(-1.0);
  }
  const Joint joint([&](const Joint& made, Eigen::Index i) { return side[i] * effect(made, i); });
  const Diagnosis d = diagnose({joint.log}, {});
  EXPECT_TRUE(d.effects.empty()) << d.reason;
  EXPECT_EQ(d.law.status, LawStatus::kBase);
  EXPECT_LE(d.after.rmse, d.before.rmse);
  EXPECT_TRUE(std::any_of(d.warnings.begin(), d.warnings.end(), [](const std::string& warning) {
    return warning.find("had larger errors than the base law") != std::string::npos;
  }));
}

}  // namespace
}  // namespace capstan::tools
