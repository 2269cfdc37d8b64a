// SPDX-License-Identifier: Apache-2.0
// The estimator against a loop whose response is known in closed form.
#include "capstan/tools/response/response.hpp"

#include <gtest/gtest.h>

#include <iterator>
#include <sstream>

#include "capstan/firmware/control/excitation.hpp"
#include "capstan/tests/tools/response/known_loop.hpp"
#include "capstan/tools/response/response_report.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

using test::KnownLoop;
using test::random_multisine;
constexpr long kRows = 20 * 2048 + 1;

static_assert(kMultisinePeriodMs == ExcitationSetup::kPeriodMs);

auto refusal_of(const Response& response) -> std::string {
  try {
    require_usable(response);
  } catch (const Refusal& refusal) {
    return refusal.what();
  }
  return "";
}

TEST(Response, WithoutNoiseItIsThePlantTheJointAndTheLoop) {
  const KnownLoop known;
  const Response response = estimate_response(known.run(random_multisine(1, 0.01, kRows), kRows, 1));
  EXPECT_TRUE(response.multisine);
  EXPECT_TRUE(response.on_torque);
  ASSERT_EQ(response.points.size(), 15U);
  EXPECT_EQ(response.windows, 18U) << "less the one that settles and the one that fades";
  for (const ResponsePoint& point : response.points) {
    EXPECT_LT(std::abs(point.motor.value / known.plant(point.hz) - 1.0), 1e-4) << point.hz;
    EXPECT_LT(std::abs(point.loop.value / known.loop(point.hz) - 1.0), 1e-4) << point.hz;
    EXPECT_LT(std::abs(point.joint.value - 1.1), 1e-9) << point.hz;
    EXPECT_GT(point.coherence, 0.9999) << point.hz;
  }
  EXPECT_LT(response.distortion.odd, 1e-3);
  EXPECT_LT(response.distortion.even, 1e-3);
}

/// A joint that goes to and fro by legs of 3.2 s, and is one loop forward and another backward.
auto travelling(const KnownLoop& backward, const KnownLoop& forward) -> ResponseLog {
  constexpr long kLeg = 3200;
  constexpr long kLong = 24 * kLeg;
  constexpr double kSpeed = 0.5e-3;  // rad a row
  const auto shaken = random_multisine(3, 0.01, kLong);
  ResponseLog log = forward.run(shaken, kLong, 1);
  const ResponseLog other = backward.run(shaken, kLong, 2);
  for (long i = 0; i < kLong; ++i) {
    if (i / kLeg % 2 == 1) {
      log.q1_rad[i] = other.q1_rad[i];
      log.q2_rad[i] = other.q2_rad[i];
      log.torque_nm[i] = other.torque_nm[i];
    }
    const long back = i / kLeg % 2 == 1 ? kLeg - i % kLeg : i % kLeg;
    log.reference_rad[i] = kSpeed * static_cast<double>(back);
    log.q1_rad[i] += log.reference_rad[i];
    log.q2_rad[i] += log.reference_rad[i];
  }
  return log;
}

// Of both ways together a good part of the power repeats with nothing, however loud the shake is.
TEST(Response, OfAJointThatDiffersBackwardAndForwardItIsEachWaysPlant) {
  KnownLoop backward;
  backward.noise_nm = 2e-4;
  backward.pole2 = 0.95;  // of another phase, too
  backward.gain = 1e-3;
  KnownLoop forward;
  forward.noise_nm = backward.noise_nm;
  const Response response = estimate_response(travelling(backward, forward));
  const std::vector<const Response*> views = views_of(response);
  ASSERT_EQ(views.size(), 2U);
  for (std::size_t i = 0; i < response.points.size(); ++i) {
    const double hz = response.points[i].hz;
    const Estimate& back = views[0]->points[i].motor;
    const Estimate& on = views[1]->points[i].motor;
    EXPECT_LT(std::abs(back.value - backward.plant(hz)), 2.0 * back.radius95 + 1e-3 * std::abs(back.value)) << hz;
    EXPECT_LT(std::abs(on.value - forward.plant(hz)), 2.0 * on.radius95 + 1e-3 * std::abs(on.value)) << hz;
  }
  const auto least_coherence = [](const Response& some) {
    double least = 1.0;
    for (const ResponsePoint& point : some.points) {
      least = std::min(least, point.hz < 60.0 ? point.coherence : 1.0);  // above, noise is what is left
    }
    return least;
  };
  EXPECT_LT(least_coherence(response), kLeastCoherence) << "as one it is of no use";
  EXPECT_GT(least_coherence(*views[0]), 0.99);
  EXPECT_GT(least_coherence(*views[1]), 0.99);
  EXPECT_EQ(refusal_of(response), "");
}

// The plots pooled both, and so showed a coherence and a response that no margin was taken of.
TEST(Response, ThePageShowsBothWaysByThemselvesWhereTheyDifferAndOneWhereNot) {
  KnownLoop backward;
  backward.noise_nm = 2e-4;
  backward.gain = 1e-3;
  KnownLoop forward;
  forward.noise_nm = backward.noise_nm;
  const auto page_of = [](const Response& response) {
    return read_text_file(write_response_report(testing::TempDir() + "ways_report", response, {}, 0));
  };
  const auto count = [](const std::string& text, const std::string& part) {
    int found = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
      ++found;
    }
    return found;
  };
  const Response unlike = estimate_response(travelling(backward, forward));
  ASSERT_EQ(views_of(unlike).size(), 2U);
  const std::string both = page_of(unlike);
  for (const char* label : {">backward<", ">forward<"}) {
    EXPECT_EQ(count(both, label), 6) << label << ": plant and loop, gain and phase each, coherence and Nyquist";
  }
  EXPECT_EQ(count(both, ">measured<"), 0);
  EXPECT_EQ(count(both, "\nbackward:\n"), 1) << "a table each";
  const std::string one = page_of(estimate_response(travelling(forward, forward)));
  EXPECT_EQ(count(one, ">measured<"), 6);
  EXPECT_EQ(count(one, ">backward<"), 0);
}

TEST(Response, OfAJointThatIsTheSameBothWaysItIsOne) {
  KnownLoop known;
  known.noise_nm = 2e-4;
  const Response response = estimate_response(travelling(known, known));
  ASSERT_EQ(response.ways.size(), 2U);
  const std::vector<const Response*> views = views_of(response);
  ASSERT_EQ(views.size(), 1U);
  EXPECT_EQ(views.front(), &response) << "of all periods, so with the smaller circles";
}

// Feedback carries the load's noise into the torque, which biases a plain H1; what shakes as the instrument does not.
TEST(Response, InClosedLoopWithNoiseTheTruthLiesInTheCircleInNinetyFiveOfAHundred) {
  KnownLoop known;
  known.noise_nm = 0.002;
  known.sensor_rad = 1e-4;
  int held = 0;
  int loops = 0;
  int asked = 0;
  for (unsigned seed = 100; seed < 140; ++seed) {
    const Response response = estimate_response(known.run(random_multisine(seed, 0.01, kRows), kRows, seed));
    for (const ResponsePoint& point : response.points) {
      held += std::abs(point.motor.value - known.plant(point.hz)) <= point.motor.radius95 ? 1 : 0;
      loops += std::abs(point.loop.value - known.loop(point.hz)) <= point.loop.radius95 ? 1 : 0;
      ++asked;
    }
  }
  // 600 draws of 0.95 have a standard deviation of 0.9 %; neighbours share noise, so three of them are allowed.
  EXPECT_NEAR(static_cast<double>(held) / asked, 0.95, 0.027);
  EXPECT_NEAR(static_cast<double>(loops) / asked, 0.95, 0.027);
  std::printf("truth in the 95 %% circle: plant %d, loop %d of %d\n", held, loops, asked);
}

TEST(Response, ACircleShrinksAsTheRootOfTheTime) {
  KnownLoop known;
  known.noise_nm = 0.002;
  const auto radius = [&known](long rows) {
    double sum = 0.0;
    for (unsigned seed = 1; seed <= 5; ++seed) {
      for (const ResponsePoint& point :
           estimate_response(known.run(random_multisine(seed, 0.01, rows), rows, seed)).points) {
        sum += point.loop.radius95 / std::abs(point.loop.value);
      }
    }
    return sum;
  };
  EXPECT_NEAR(radius(18 * 2048 + 1) / radius(66 * 2048 + 1), 2.0 * 1.055, 0.25) << "16 and 64 windows";
}

TEST(Response, ATravellingJointsRampIsNoResponseAndItsTurnsAreLeftOut) {
  const KnownLoop known;
  const long rows = 40 * 2048 + 1;
  ResponseLog log = known.run(random_multisine(3, 0.01, rows), rows, 3);
  for (long i = 0; i < rows; ++i) {
    const double place = std::fmod(static_cast<double>(i), 12'000.0);  // 0.2 rad/s to and fro
    const double way = 2e-4 * (place < 6000.0 ? place : 12'000.0 - place);
    log.reference_rad[i] += way;
    log.q1_rad[i] += way + (place > 6000.0 ? 0.01 * std::exp(-(place - 6000.0) / 50.0) : 0.0);
    log.q2_rad[i] += 1.1 * way;
  }
  const Response response = estimate_response(log);
  EXPECT_TRUE(response.travels);
  EXPECT_GE(response.windows, 20U);
  for (const ResponsePoint& point : response.points) {
    EXPECT_LT(std::abs(point.motor.value / known.plant(point.hz) - 1.0), 1e-3) << point.hz;
  }
}

// A tail of 60 mrad and 0.8 s behind each turn, as soft tendons leave it, is a step from window's end to window's end.
TEST(Response, WhatATurnLeavesForALegDoesNotLeakIntoTheLines) {
  const KnownLoop known;
  const long rows = 50 * 2048 + 1;
  ResponseLog log = known.run(random_multisine(4, 0.01, rows), rows, 4);
  for (long i = 0; i < rows; ++i) {
    const double leg = std::fmod(static_cast<double>(i), 3200.0);
    const bool forward = std::fmod(static_cast<double>(i), 6400.0) < 3200.0;
    const double way = 2e-4 * (forward ? leg : 3200.0 - leg);
    log.reference_rad[i] += way;
    log.q1_rad[i] += way + (forward ? 0.06 : -0.06) * std::exp(-leg / 800.0);
  }
  const Response response = estimate_response(log);
  EXPECT_EQ(refusal_of(response), "");
  for (const ResponsePoint& point : response.points) {
    if (point.hz > 10.0) {
      EXPECT_LT(std::abs(point.motor.value / known.plant(point.hz) - 1.0), 0.02) << point.hz;
    }
  }
}

/// From 1 to 200 Hz within 30 s, N m.
auto chirp(long i) -> double {
  const double t = 1e-3 * static_cast<double>(i);
  const double ramp = std::min({1.0, t / 0.256, (30.0 - t) / 0.256});
  const double rate = std::log(200.0) / 30.0;
  return t > 30.0 ? 0.0 : 0.01 * ramp * std::sin(2.0 * std::numbers::pi * (std::exp(rate * t) - 1.0) / rate);
}

TEST(Response, AChirpShowsTheSamePlant) {
  KnownLoop known;
  known.noise_nm = 2e-4;
  const Response response = estimate_response(known.run(chirp, 30'001, 9));
  EXPECT_FALSE(response.multisine);
  ASSERT_GE(response.points.size(), 20U);
  int good = 0;
  for (const ResponsePoint& point : response.points) {
    good += std::abs(point.loop.value / known.loop(point.hz) - 1.0) < 0.1 ? 1 : 0;
    EXPECT_LT(std::abs(point.loop.value / known.loop(point.hz) - 1.0), 0.3) << point.hz;
  }
  EXPECT_GE(good, static_cast<int>(0.9 * static_cast<double>(response.points.size())));
}

// What leaks beyond 1 and 200 Hz is noise's, and no amplitude would mend it.
TEST(Response, AChirpIsJudgedWhereItShakesAndItsCureIsOneThatTheBoardTakes) {
  KnownLoop known;
  known.noise_nm = 5e-3;
  const Response response = estimate_response(known.run(chirp, 30'001, 9));
  ASSERT_FALSE(response.points.empty());
  EXPECT_GT(response.points.front().hz, 0.7);
  EXPECT_LT(response.points.back().hz, 200.0);
  known.noise_nm = 0.5;
  const std::string refusal = refusal_of(estimate_response(known.run(chirp, 30'001, 9)));
  EXPECT_NE(refusal.find("multisine on=torque travel"), std::string::npos) << refusal;
  EXPECT_EQ(refusal.find("period"), std::string::npos) << refusal;
}

// A board whose law holds its estimate, and a shake of a joint that is not armed.
TEST(Response, AnEstimateThatStandsAndATorqueWithoutControlAreRefusedWithTheirCause) {
  const KnownLoop known;
  const ResponseLog good = known.run(random_multisine(6, 0.01, kRows), kRows, 6);
  const auto told = [](const ResponseLog& log) -> std::string {
    try {
      static_cast<void>(estimate_response(log));
    } catch (const Refusal& refusal) {
      return refusal.what();
    }
    return "";
  };
  EXPECT_EQ(told(good), "");
  ResponseLog held = good;
  held.q2_rad.setZero();
  EXPECT_NE(told(held).find("joint's estimate stands still"), std::string::npos) << told(held);
  ResponseLog open = good;
  open.torque_nm = open.excitation_nm;
  EXPECT_NE(told(open).find("no loop was closed"), std::string::npos) << told(open);
  ResponseLog dead = good;
  dead.q1_rad.setConstant(0.3);
  EXPECT_NE(told(dead).find("check the encoder"), std::string::npos) << told(dead);
}

// Of lines that noise buries the circle is larger than the value.
TEST(Response, ColumnsOfTheTableStayApart) {
  const KnownLoop known;
  Response response = estimate_response(known.run(random_multisine(6, 0.01, kRows), kRows, 6));
  response.points.front().motor.radius95 = 1.6 * std::abs(response.points.front().motor.value);
  std::istringstream rows(response_text(response));
  for (std::string line; std::getline(rows, line);) {
    if (line.find('|') != std::string::npos && line.find("Hz") == std::string::npos) {
      std::istringstream words(line);
      EXPECT_EQ(std::distance(std::istream_iterator<std::string>(words), {}), 10) << line;
    }
  }
  EXPECT_NE(rows.str().find(" >100% "), std::string::npos) << rows.str();
}

TEST(Response, RowsElevenMillisecondsApartShowWhatEveryRowShows) {
  const KnownLoop known;
  const long rows = 11 * 7 * 2048 + 1;
  const ResponseLog dense = known.run(random_multisine(4, 0.01, rows), rows, 4);
  ResponseLog log{.name = "sparse"};
  const Eigen::Index count = (rows + 10) / 11;
  const auto thin = [count](const Eigen::VectorXd& all) {
    Eigen::VectorXd some(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      some[i] = all[11 * i];
    }
    return some;
  };
  log.time_s = thin(dense.time_s);
  log.q1_rad = thin(dense.q1_rad);
  log.torque_nm = thin(dense.torque_nm);
  log.q2_rad = thin(dense.q2_rad);
  log.reference_rad = thin(dense.reference_rad);
  log.excitation_nm = thin(dense.excitation_nm);
  const Response response = estimate_response(log);
  ASSERT_EQ(response.points.size(), 15U);
  for (const ResponsePoint& point : response.points) {
    EXPECT_LT(std::abs(point.loop.value / known.loop(point.hz) - 1.0), 1e-3) << point.hz;
  }
}

TEST(Response, EvenAndOddNonlinearityShowOnTheirOwnLines) {
  for (const bool odd : {true, false}) {
    KnownLoop known;
    (odd ? known.cubic : known.square) = 0.3;
    known.sensor_rad = 1e-6;
    const Response response = estimate_response(known.run(random_multisine(5, 0.01, kRows), kRows, 5));
    const Distortion& seen = response.distortion;
    ASSERT_TRUE(seen.known);
    EXPECT_GT(odd ? seen.odd : seen.even, 0.01);
    EXPECT_LT(odd ? seen.even : seen.odd, 0.2 * (odd ? seen.odd : seen.even));
  }
}

TEST(Response, WhatNoiseBuriesWhereMarginsAreDecidedIsRefusedWithACureThatCures) {
  KnownLoop known;
  const auto shaken_with = [&known](double amplitude_nm) {
    return refusal_of(estimate_response(known.run(random_multisine(6, amplitude_nm, kRows), kRows, 6)));
  };
  EXPECT_EQ(shaken_with(0.01), "");
  known.noise_nm = 0.1;
  const std::string refusal = shaken_with(0.01);
  EXPECT_NE(refusal.find("80 %"), std::string::npos) << refusal;
  const std::size_t times = refusal.find(" times the amplitude");
  ASSERT_NE(times, std::string::npos) << refusal;
  const double louder = std::stod(refusal.substr(refusal.rfind(' ', times - 1)));
  EXPECT_EQ(shaken_with(1.4 * louder * 0.01), "") << "eighteen periods tell the coherence to a few per cent";
  EXPECT_NE(shaken_with(0.5 * louder * 0.01), "");
}

TEST(Response, TooFewPeriodsOrNothingThatShakesIsRefused) {
  const KnownLoop known;
  EXPECT_THROW(
      static_cast<void>(estimate_response(known.run(random_multisine(7, 0.01, 5 * 2048 + 1), 5 * 2048 + 1, 7))),
      Refusal);
  EXPECT_THROW(static_cast<void>(estimate_response(known.run([](long) { return 0.0; }, kRows, 7))), Refusal);
}

TEST(Response, ALogWithALostRowNamesTheLine) {
  std::string text = "time_s,axis0/q1_rad,axis0/tau_cmd_Nm,axis0/q2_est_rad,axis0/q2_ref_rad,axis0/tau_exc_Nm\n";
  for (int i = 0; i < 9000; ++i) {
    text += i == 5000 ? "" : std::to_string(0.001 * i) + ",0,0,0,0,0.01\n";
  }
  try {
    static_cast<void>(read_response(CsvLog::parse(text, "run.csv"), 0));
    FAIL();
  } catch (const BadInput& bad) {
    EXPECT_NE(std::string(bad.what()).find("run.csv:5002: a row is missing"), std::string::npos) << bad.what();
  }
  EXPECT_THROW(static_cast<void>(read_response(CsvLog::parse(text, "run.csv"), 1)), BadInput);
}

}  // namespace
}  // namespace capstan::tools
