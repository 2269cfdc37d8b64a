// SPDX-License-Identifier: Apache-2.0
// `capstan tune PORT`: other gains for a joint that is commissioned.
#include <gtest/gtest.h>

#include "capstan/tests/tools/run/happening.hpp"
#include "capstan/tests/tools/run/number_from.hpp"
#include "capstan/tools/commission/commission.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

constexpr double kCorridor = 0.8;

auto scenario() -> const sim::Scenario& {
  static const sim::Scenario one = draw(4471);
  return one;
}

auto options_with(std::optional<double> bandwidth_hz = {}) -> CommissionOptions {
  CommissionOptions options{.axis = 0, .corridor_rad = kCorridor, .inertia_kgm2 = {}, .key = {}};
  options.wanted.bandwidth_hz = bandwidth_hz;
  return options;
}

auto yes() -> Operator {
  return {.tell = [](const std::string&) {},
          .agrees = [](const std::string&) { return true; },
          .keep = [](int, const Progress&) {}};
}

/// What sets up that joint's board as commissioning left it.
auto set_up() -> const std::vector<std::string>& {
  static const std::vector<std::string> lines = [] {
    SimShell first(scenario());
    for (const std::string& one : data_sheet(scenario().plant)) {
      first.ask(one);
    }
    commission(first, yes(), options_with(), {});
    std::vector<std::string> all = {"maintenance open", "begin"};
    for (const std::string& line : first.ask("dump")) {
      if (line.starts_with("set ")) {
        all.push_back(line);
      }
    }
    all.emplace_back("commit");
    return all;
  }();
  return lines;
}

/// A commissioned board on which something happens.
struct Rig {
  explicit Rig(const std::string& event = "", const std::string& ahead_of = "") : line(scenario(), event, ahead_of) {
    for (const std::string& one : set_up()) {
      line.board().ask(one);
    }
    line.board().ask("save");
    before = line.board().ask("dump");
    static_cast<void>(line.board().take_way());
  }
  /// The sentence of a refusal, or nothing.
  auto refusal_of(const Operator& person, const CommissionOptions& options) -> std::string {
    try {
      tuned = retune(line, person, options);
    } catch (const Refusal& refusal) {
      return refusal.what();
    }
    return "";
  }
  [[nodiscard]] auto count(const std::string& part) const -> long {
    return std::count_if(line.asked().begin(), line.asked().end(),
                         [&](const std::string& one) { return one.find(part) != std::string::npos; });
  }
  [[nodiscard]] auto energised_now() -> bool { return energised(line.board().board().machine().telemetry().state); }
  /// As the board has them once its power was off.
  auto saved() -> std::vector<std::string> {
    line.board().ask("load");
    return line.board().ask("dump");
  }
  Happening line;
  std::vector<std::string> before;
  Commissioned tuned;
};

auto place_of(const std::vector<std::string>& asked, const std::string& part) -> std::ptrdiff_t {
  return std::find_if(asked.begin(), asked.end(),
                      [&](const std::string& one) { return one.find(part) != std::string::npos; }) -
         asked.begin();
}

TEST(Retune, GainsAreStagedTriedAndSavedBehindTheCheckAlone) {
  Rig rig;
  ASSERT_EQ(rig.refusal_of(yes(), options_with(30.0)), "");
  const double wanted = rig.tuned.tuning->gains.stiffness;
  const auto& control = rig.line.board().board().machine().config()[0].control;
  EXPECT_NEAR(control.stiffness_nm_per_rad.to_double(), wanted, 1e-4);
  EXPECT_NEAR(rig.tuned.tuning->servo.crossover_hz, 32.0, 3.0) << "30 to 34.5 Hz are the promise";
  const auto& asked = rig.line.asked();
  const std::ptrdiff_t staged = place_of(asked, "set joint0.control.stiffness " + rounded(wanted));
  ASSERT_LT(staged, std::ssize(asked));
  const auto upwards = std::find(asked.rbegin() + (std::ssize(asked) - staged), asked.rend(), "begin");
  const auto ends_before = std::find(asked.rbegin() + (std::ssize(asked) - staged), asked.rend(), "commit");
  EXPECT_LT(upwards, ends_before) << "by begin ... commit";
  EXPECT_LT(staged, place_of(asked, "frequencies=0.1Hz"));
  EXPECT_LT(place_of(asked, "frequencies=0.1Hz"), place_of(asked, "save"));
  EXPECT_EQ(rig.saved(), rig.line.board().ask("dump"));
  EXPECT_NEAR(control.stiffness_nm_per_rad.to_double(), wanted, 1e-4) << "outlives the power";
  EXPECT_FALSE(rig.energised_now());
  EXPECT_LT(rig.line.board().take_way().joint_rad, kCorridor + 0.02);
  EXPECT_EQ(rig.tuned.progress.found.back(), "saved");
}

TEST(Retune, ACheckThatFailsTakesTheGainsBackAndSavesNothing) {
  Rig rig("fail tendon_bottom snap", "frequencies=0.1Hz");
  const std::string refusal = rig.refusal_of(yes(), options_with(30.0));
  EXPECT_EQ(refusal.find("check: "), 0U) << refusal;
  EXPECT_EQ(rig.count("save"), 0);
  EXPECT_EQ(rig.line.board().ask("dump"), rig.before);
  EXPECT_EQ(rig.saved(), rig.before);
  EXPECT_FALSE(rig.energised_now());
}

TEST(Retune, NothingMovesAndNothingIsChangedWhereThePersonSaysNo) {
  Rig rig;
  Operator person = yes();
  person.agrees = [](const std::string&) { return false; };
  const std::string refusal = rig.refusal_of(person, options_with());
  EXPECT_EQ(refusal, "tune: stopped on request, torque is off; the gains are those of before");
  EXPECT_EQ(rig.count("arm") - rig.count("disarm"), 0) << "torque was never given";
  EXPECT_EQ(rig.count("set "), 0);
  EXPECT_LT(rig.line.board().take_way().motor_rad, 1e-3);
  EXPECT_EQ(rig.line.board().ask("dump"), rig.before);
}

TEST(Retune, GainsThatWereFoundAreNotTriedWhereThePersonSaysNo) {
  Rig rig;
  int questions = 0;
  Operator person = yes();
  person.agrees = [&](const std::string&) { return ++questions == 1; };
  const std::string refusal = rig.refusal_of(person, options_with());
  EXPECT_EQ(refusal, "check: stopped on request, torque is off; the gains are those of before");
  EXPECT_EQ(rig.line.board().ask("dump"), rig.before);
  EXPECT_EQ(rig.count("save"), 0);
}

TEST(Retune, AJointThatNobodyCommissionedIsToldSoBeforeItMoves) {
  const std::vector<std::vector<std::string>> unknown = {
      {"set joint0.observer.inertia 0"},
      {"set joint0.control.torque_forward 0", "set joint0.control.torque_backward 0"}};
  for (const std::vector<std::string>& lines : unknown) {
    Rig rig;
    for (const std::string& line : lines) {
      rig.line.board().ask(line);
    }
    const std::string refusal = rig.refusal_of(yes(), options_with());
    EXPECT_NE(refusal.find("joint0 is not commissioned"), std::string::npos) << refusal;
    EXPECT_NE(refusal.find("run 'capstan commission' first"), std::string::npos) << refusal;
    EXPECT_EQ(rig.count("arm") - rig.count("disarm"), 0);
  }
}

// Shaken louder four times it would have cost eight minutes and said the same.
TEST(Retune, ABandwidthThatNoGainsReachIsRefusedAfterOneShake) {
  Rig rig;
  const std::string refusal = rig.refusal_of(yes(), options_with(200.0));
  EXPECT_NE(refusal.find("at 200 Hz"), std::string::npos) << refusal;
  EXPECT_EQ(rig.count("multisine"), 2) << "slow and fast";
  EXPECT_EQ(rig.line.board().ask("dump"), rig.before);
}

// Its gains were refused for following a sine worse than stiffer ones.
TEST(Retune, SofterGainsThatWereAskedForAreTaken) {
  Rig rig;
  EXPECT_EQ(rig.refusal_of(yes(), options_with(12.0)), "");
  EXPECT_EQ(rig.tuned.progress.found.back(), "saved");
}

// As CAPSTAN_INSTRUMENT=raven2:1 CAPSTAN_SEED=4580 CAPSTAN_PLANTS=3.
TEST(Retune, ADrawnJointGetsAboutTheGainsThatCommissioningGaveIt) {
  const std::uint64_t first = number_from("CAPSTAN_SEED", 4472);
  for (std::uint64_t seed = first; seed < first + number_from("CAPSTAN_PLANTS", 1); ++seed) {
    const sim::Scenario drawn = draw(seed);
    Happening line(drawn);
    CommissionOptions options = options_with();
    options.inertia_kgm2 = drawn.plant.motor_inertia_kgm2;
    try {
      commission(line, yes(), options, {});
    } catch (const Refusal& refusal) {
      std::printf("%llu | not commissioned: %s\n", static_cast<unsigned long long>(seed), refusal.what());
      continue;
    }
    const auto& control = line.board().board().machine().config()[0].control;
    const double before = control.stiffness_nm_per_rad.to_double();
    static_cast<void>(line.board().take_way());
    std::string refusal;
    Commissioned tuned;
    try {
      tuned = retune(line, yes(), options_with());
    } catch (const Refusal& why) {
      refusal = why.what();
    }
    EXPECT_EQ(refusal, "") << seed;
    const SimShell::Way way = line.board().take_way();
    std::printf("%llu | stiffness %.3f -> %.3f Nm/rad, crossover %.1f Hz | joint %.2f rad, %.0f s\n",
                static_cast<unsigned long long>(seed), before, control.stiffness_nm_per_rad.to_double(),
                tuned.tuning ? tuned.tuning->whole_nominal.crossover_hz : 0.0, way.joint_rad, way.seconds);
    // Two logs of one joint: its margins scatter by 1 dB (docs/tuning.md), which is 12 % of gain either way.
    EXPECT_NEAR(control.stiffness_nm_per_rad.to_double() / before, 1.0, 0.25) << seed;
    EXPECT_LT(way.joint_rad, kCorridor + 0.02) << seed;
  }
}

TEST(Retune, WhatARunThatWasKilledHadChangedIsKeptToBeGivenBack) {
  Rig rig;
  Progress kept;
  Operator person = yes();
  person.keep = [&](int, const Progress& now) { kept = Progress::parse(now.text(), "state"); };
  bool lost = false;
  person.tell = [&](const std::string& text) { lost = lost || text.starts_with("  gains: "); };
  struct Killed {};
  person.agrees = [&](const std::string&) {
    if (lost) {
      throw Killed{};
    }
    return true;
  };
  EXPECT_THROW(static_cast<void>(rig.refusal_of(person, options_with())), Killed);
  EXPECT_TRUE(kept.before.empty()) << "between steps nothing waits";
  EXPECT_EQ(kept.axis, 0);
  EXPECT_NE(kept.board.find("40960 counts"), std::string::npos) << kept.board;
  EXPECT_EQ(rig.line.board().ask("dump"), rig.before);
}

}  // namespace
}  // namespace capstan::tools
