// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "capstan/tests/tools/play_operator.hpp"
#include "capstan/tools/diagnose/diagnosis.hpp"
#include "capstan/tools/diagnose/free_run.hpp"
#include "capstan/tools/select/choice.hpp"
#include "capstan/tools/select/vocabulary.hpp"
#include "capstan/tools/support/random.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

using test::play_of;

struct Made {
  Eigen::Index rows = 1600;
  double period_s = 0.02;
  double noise = 0.002;
  double angle_unit = 1.0, joint_unit = 1.0, time_unit = 1.0;
  double fast = 0.4;   ///< size of the motion's faster sine, rad
  bool sheath = true;  ///< two plays and a curve behind them; else the ratio alone
};

/// A sheath by hand: h = 0.5 q + 0.3 play_of(q, 0.1) + 0.2 play_of(q, 0.4), q2 = 0.8 h + 0.1 h^2, and white noise.
auto made_log(const Made& made) -> AxisLog {
  AxisLog log;
  log.name = "made.csv";
  log.target = "axis0/q2_rad";
  log.period_s = made.period_s * made.time_unit;
  log.time_s.resize(made.rows);
  Eigen::VectorXd q(made.rows);
  for (Eigen::Index i = 0; i < made.rows; ++i) {
    const double t = made.period_s * static_cast<double>(i);
    log.time_s[i] = t * made.time_unit;
    q[i] = 0.7 * std::sin(1.3 * t) + made.fast * std::sin(3.1 * t);
  }
  const Eigen::VectorXd h = made.sheath ? Eigen::VectorXd(0.5 * q + 0.3 * play_of(q, 0.1) + 0.2 * play_of(q, 0.4)) : q;
  Random random(11);
  log.q2_rad.resize(made.rows);
  for (Eigen::Index i = 0; i < made.rows; ++i) {
    const double curve = made.sheath ? 0.1 * h[i] * h[i] : 0.0;
    log.q2_rad[i] = made.joint_unit * (0.8 * h[i] + curve + made.noise * random.normal());
  }
  log.q1_rad = made.angle_unit * q;
  log.tau_nm = Eigen::VectorXd::Zero(made.rows);
  return log;
}

struct Chosen {
  explicit Chosen(const AxisLog& log)
      : p(prepare({log}, form_of_model("kinematic", {log}))),
        base(causal_law(p, form_of_model("kinematic", {log}))),
        choice(choose_law(p, base, std::nullopt)) {}
  Preparation p;
  JointFile base;
  LawChoice choice;
};

/// Logs as the selection of a law sees them.
struct Opened {
  explicit Opened(std::vector<AxisLog> of) : logs(std::move(of)) {}
  /// The law that made_log() has.
  [[nodiscard]] auto truth() const -> LawCandidate {
    return with_term(*form.catalogue, with_play(with_play(candidate_of(form), 0.1), 0.4), {"curved_ratio", {0.0, 1.0}});
  }
  std::vector<AxisLog> logs;
  LawForm form = form_of_model("kinematic", logs);
  Preparation p = prepare(logs, form);
  SelectionData data{p, *form.catalogue};
  ForwardScore forward{data, data.logs()};
};

TEST(Select, ASheathWithACurveBehindItIsLearnedDownToItsNoise) {
  const Made made;
  const Chosen chosen(made_log(made));
  EXPECT_EQ(chosen.choice.status, LawStatus::kProvisional);
  const double left = report_error(chosen.p, estimates(chosen.p.logs, chosen.p.causal, chosen.choice.learned)).rmse;
  const double before = report_error(chosen.p, estimates(chosen.p.logs, chosen.p.causal, chosen.base)).rmse;
  EXPECT_LT(left, 2.0 * made.noise);
  EXPECT_GT(before, 20.0 * made.noise);
  EXPECT_EQ(chosen.choice.halves_agree, 2);
}

TEST(Select, WhereTheBaseLawIsTheTruthItIsDelivered) {
  Made made;
  made.sheath = false;
  const Chosen chosen(made_log(made));
  EXPECT_EQ(chosen.choice.status, LawStatus::kBase)
      << described(chosen.choice.selection.laws[chosen.choice.selection.best].law);
}

TEST(Select, AScaleOfAngleJointOrTimeChangesTheLawByThatScaleAlone) {
  const Chosen plain{made_log({})};
  const auto error_of = [](const Chosen& chosen) {
    return rms(chosen.p.target - estimates(chosen.p.logs, chosen.p.causal, chosen.choice.law));
  };
  for (const double scale : {0.05, 20.0}) {
    Made angle;
    angle.angle_unit = scale;
    Made joint;
    joint.joint_unit = scale;
    Made time;
    time.time_unit = scale;
    for (const auto& [made, unit] : {std::pair(angle, 1.0), std::pair(joint, scale), std::pair(time, 1.0)}) {
      const Chosen scaled(made_log(made));
      EXPECT_EQ(scaled.choice.status, plain.choice.status) << scale;
      EXPECT_NEAR(error_of(scaled) / unit, error_of(plain), 0.2 * error_of(plain)) << scale;
    }
  }
}

TEST(Select, RowsBeforeTheMotorHasCoveredItsRangeTakeNoPart) {
  const Opened made({made_log({})});
  const SelectionData& data = made.data;
  const RowRange settled = data.settled().front();
  const auto seen = data.q1().head(settled.begin);
  const double range = data.q1().maxCoeff() - data.q1().minCoeff();
  EXPECT_GE(seen.maxCoeff() - seen.minCoeff(), 0.9 * range);
  EXPECT_LE(settled.begin, data.rows() / 4);
  EXPECT_EQ(settled.end, data.rows());
}

TEST(Select, OnlyPlaysThatTheMotionTurnsRoundAreTried) {
  const Opened made({made_log({})});
  const Eigen::VectorXd& q1 = made.logs.front().q1_rad;
  ASSERT_FALSE(made.data.play_widths().empty());
  EXPECT_LE(made.data.play_widths().back(), 0.5 * (q1.maxCoeff() - q1.minCoeff()));
}

TEST(Select, TimesThatAreTriedAreShareOfTheLogInTheUnitOfTheShape) {
  const Opened made({made_log({.rows = 16000})});  // 320 s
  const Vocabulary vocabulary = angle_vocabulary(made.data);
  const auto longest = [&](const std::string& term) {
    const auto grid = std::find_if(vocabulary.terms.begin(), vocabulary.terms.end(),
                                   [&](const auto& one) { return one.term == term && !one.settings.empty(); });
    return grid == vocabulary.terms.end() ? 0.0 : grid->settings.back().front();
  };
  EXPECT_NEAR(longest("thermal_drift"), 80.0 / 60.0, 0.01);  // minutes: a quarter of the log
  EXPECT_NEAR(longest("viscoelastic_creep"), 80.0, 0.5);     // seconds
}

// Where the motion is slow, its acceleration in krad/s2 is next to nothing, and what a fit makes of it beyond 128.
TEST(Select, ALawBeyondTheRangeOfNumbersIsNoneUnlessTheBaseLawIsBeyondItToo) {
  for (const double angle_unit : {1.0, 1e-4}) {
    Made made;
    made.time_unit = 100.0;
    made.angle_unit = angle_unit;
    Opened opened({made_log(made)});
    ForwardScore& forward = opened.forward;
    const LawCandidate base = candidate_of(opened.form);
    const LawCandidate beyond = with_term(*opened.form.catalogue, base, {"load_inertia", {}});
    EXPECT_TRUE(std::isfinite(forward.score(beyond)));
    forward.limit_as(base);
    EXPECT_TRUE(std::isfinite(forward.score(base)));
    EXPECT_EQ(std::isfinite(forward.score(beyond)), angle_unit < 1.0);
  }
}

TEST(Select, TheScoreOfTheTrueLawIsTheNoiseAndThatOfTheRatioAloneIsNot) {
  const Made made;
  Opened opened({made_log(made)});
  ForwardScore& forward = opened.forward;
  const LawCandidate ratio = candidate_of(opened.form);
  const LawCandidate truth = opened.truth();
  EXPECT_NEAR(std::sqrt(forward.score(truth)), made.noise, 0.1 * made.noise);
  EXPECT_GT(std::sqrt(forward.score(ratio)), 20.0 * made.noise);
  const Eigen::VectorXd losses = forward.losses(truth);
  EXPECT_NEAR(losses.mean(), forward.score(truth), 0.05 * forward.score(truth));
}

TEST(Select, AFittedCandidateHasTheWeightsOfItsPlays) {
  Opened made({made_log({})});
  const JointFile joint = joint_of(made.data, made.data.logs(), made.truth(), made.p.conditioner);
  const std::size_t first = made.form.catalogue->term("hysteresis").first_shape;
  EXPECT_DOUBLE_EQ(joint.parameters.shapes[first], 0.1);
  EXPECT_NEAR(joint.parameters.shapes[first + 1], 0.3, 0.02);
  EXPECT_DOUBLE_EQ(joint.parameters.shapes[first + 2], 0.4);
  EXPECT_NEAR(joint.parameters.shapes[first + 3], 0.2, 0.02);
  EXPECT_TRUE(joint.has("hysteresis"));
}

TEST(Select, TwoLogsWithZerosOfTheirOwnGiveOneLaw) {
  AxisLog second = made_log({});
  second.q2_rad.array() += 0.3;
  Opened both({made_log({}), second});
  EXPECT_LT(std::sqrt(both.forward.score(both.truth())), 1.2 * Made{}.noise);
}

// Too little to name anything, and enough to learn from.
TEST(Select, ALogOfTwoStrokesGetsItsLawAndNoName) {
  Made made;
  made.rows = 160;
  made.period_s = 0.024;
  made.fast = 0.0;
  const Diagnosis d = diagnose({made_log(made)}, {});
  EXPECT_EQ(d.verdict, Verdict::kDataUnfit) << d.reason;
  EXPECT_NE(d.reason.find("forth, back and forth again"), std::string::npos) << d.reason;
  EXPECT_TRUE(d.effects.empty());
  EXPECT_EQ(d.law.status, LawStatus::kProvisional);
  EXPECT_LT(d.after.rmse, 0.5 * d.before.rmse);
  Made longer = made;
  longer.rows = 310;
  const AxisLog unseen = made_log(longer);
  const Eigen::VectorXd estimate = estimates({unseen}, LawDesign({unseen}, d.law.parameters.conditioner), d.law);
  const Eigen::VectorXd base = estimates({unseen}, LawDesign({unseen}, d.base.parameters.conditioner), d.base);
  const auto later = [&](const Eigen::VectorXd& of) { return rms((unseen.q2_rad - of).tail(longer.rows - made.rows)); };
  EXPECT_LT(later(estimate), 0.7 * later(base)) << "on the next strokes";
}

TEST(Select, AShortLogWithTwoLoopsIsDiagnosed) {
  Made made;
  made.rows = 310;
  made.period_s = 0.04;
  const Diagnosis d = diagnose({made_log(made)}, {});
  EXPECT_NE(d.verdict, Verdict::kDataUnfit) << d.reason;
  EXPECT_LT(d.after.rmse, 0.5 * d.before.rmse);
}

}  // namespace
}  // namespace capstan::tools
