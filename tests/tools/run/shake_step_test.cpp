// SPDX-License-Identifier: Apache-2.0
// How hard and how fast `capstan commission` shakes a motor whose encoder is coarse.
#include <gtest/gtest.h>

#include "capstan/tests/tools/run/happening.hpp"
#include "capstan/tools/commission/commission.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

constexpr double kFiveDegrees = 5.0 / 57.29577951308232;

auto shake_of(Happening& line, const sim::Scenario& scenario) -> std::string {
  Progress known;
  const Operator person{.tell = [](const std::string&) {},
                        .agrees = [&](const std::string&) { return !known.is_done("shake"); },
                        .keep = [&](int, const Progress& now) { known = now; }};
  try {
    commission(line, person,
               {.axis = 0, .corridor_rad = 1.0, .inertia_kgm2 = scenario.plant.motor_inertia_kgm2, .key = {}}, {});
  } catch (const Refusal& refusal) {
    return refusal.what();
  }
  return "";
}

auto shaken_from(const Happening& line, const char* from) -> long {
  return std::count_if(line.asked().begin(), line.asked().end(),
                       [&](const std::string& one) { return one.find(from) != std::string::npos; });
}

// RAVEN's shoulder: 4,000 counts and much friction. At 50 to 150 Hz it never showed three counts rms, so it was told
// that its encoder does not count.
TEST(Shake, AShouldersCoarseEncoderThatCountsGetsTheFasterShake) {
  for (const std::uint64_t seed : {4462U, 4464U}) {
    const sim::Scenario scenario = draw(seed, joint_of("raven2:0"));
    Happening line(scenario);
    static_cast<void>(line.board().take_way());
    const std::string refusal = shake_of(line, scenario);
    EXPECT_EQ(refusal.find("press: stopped on request"), 0U) << seed << ": " << refusal;
    EXPECT_GT(shaken_from(line, "from=80Hz") + shaken_from(line, "from=120Hz"), 0) << seed;
    EXPECT_LT(line.board().take_way().motor_rad, kFiveDegrees) << seed;
  }
}

// A motor that can not be seen must not be shaken harder.
TEST(Shake, AShoulderWhoseEncoderIsDeadDoesNot) {
  for (const std::uint64_t seed : {4462U, 4464U}) {
    const sim::Scenario scenario = draw(seed, joint_of("raven2:0"));
    Happening line(scenario);
    line.ask("fail encoder stuck");
    static_cast<void>(line.board().take_way());
    const std::string refusal = shake_of(line, scenario);
    EXPECT_NE(refusal.find("the motor has its current and the encoder does not count"), std::string::npos)
        << seed << ": " << refusal;
    EXPECT_EQ(shaken_from(line, "from=80Hz") + shaken_from(line, "from=120Hz"), 0) << seed;
    EXPECT_LT(line.board().take_way().motor_rad, kFiveDegrees) << seed;
  }
}

}  // namespace
}  // namespace capstan::tools
