// SPDX-License-Identifier: Apache-2.0
// Safety limits change only while maintenance is open, and the key that opens it is never shown.
#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>

#include "capstan/firmware/console/shell_input.hpp"
#include "capstan/tests/firmware/support.hpp"

namespace capstan {
namespace {

using Bench = test::Bench<2>;
using test::has_line;
using test::lines_of;
using test::verdict;

constexpr const char* kKey = "tendon-27";

auto refused(const std::string& answer, const std::string& name) -> bool {
  return verdict(answer).rfind("error " + name + ": ", 0) == 0;
}
auto in_force(const Bench& bench) -> const AxisConfig& {
  return bench.application.config()[0];
}
void set_key(Bench& bench) {
  ASSERT_EQ(verdict(bench.say("maintenance open")), "ok");
  ASSERT_EQ(verdict(bench.say(std::string("maintenance key ") + kKey)), "ok");
  ASSERT_EQ(verdict(bench.say("maintenance close")), "ok");
}

TEST(ShellMaintenance, EveryLimitIsRefusedWhileClosedAndNothingElseIs) {
  Bench bench;
  for (const ParameterInfo& parameter : parameters()) {
    const std::string name = std::string(parameter.group) + "." + parameter.name;
    const bool limit = std::string(parameter.group) == "limits" || std::string(parameter.group) == "observer" ||
                       name == "motor.speed_limit" || name == "motor.fitted";
    AxisConfig changed;
    const std::int32_t raw = raw_value(changed, parameter);
    set_raw_value(changed, parameter, raw < parameter.maximum ? raw + 1 : raw - 1);
    EXPECT_EQ(changed_safety_limit(AxisConfig{}, changed) != nullptr, limit) << name;
  }
  EXPECT_TRUE(refused(bench.say("set joint0.limits.current 2"), "maintenance"));
  EXPECT_TRUE(refused(bench.say("set joint0.motor.speed_limit 50"), "maintenance"));
  EXPECT_TRUE(test::same(in_force(bench), AxisConfig{}));
  EXPECT_EQ(verdict(bench.say("set joint0.motor.torque_per_current 0.2")), "ok");
  EXPECT_EQ(verdict(bench.say("set joint0.motor_angle.beta 1.1")), "ok");
}

/// "limits.*", and names of groups that are not safety limits as a whole.
auto safety_limits() -> std::set<std::string> {
  std::set<std::string> wholes;
  std::set<std::string> names;
  for (const ParameterInfo& parameter : parameters()) {
    wholes.insert(parameter.group);
  }
  for (const ParameterInfo& parameter : parameters()) {
    if (parameter.change != ParameterChange::kMaintenance) {
      wholes.erase(parameter.group);
    }
  }
  for (const ParameterInfo& parameter : parameters()) {
    if (parameter.change == ParameterChange::kMaintenance) {
      names.insert(std::string(parameter.group) + "." + (wholes.count(parameter.group) > 0 ? "*" : parameter.name));
    }
  }
  return names;
}

/// What stands between the first pair of brackets behind `words`, without quotes.
auto listed_behind(const std::string& text, const std::string& words) -> std::set<std::string> {
  const std::size_t begin = text.find('(', text.find(words)) + 1;
  std::istringstream list(text.substr(begin, text.find(')', begin) - begin));
  std::set<std::string> names;
  for (std::string name; list >> name;) {
    std::erase_if(name, [](char c) { return c == '`' || c == ','; });
    names.insert(name);
  }
  return names;
}

TEST(ShellMaintenance, HelpAndTheManualListWhatItOpens) {
  Bench bench;
  EXPECT_EQ(listed_behind(bench.say("help maintenance"), "opens the safety limits"), safety_limits());
  std::ifstream page(CAPSTAN_FIRMWARE_PAGE);
  std::stringstream text;
  text << page.rdbuf();
  EXPECT_EQ(listed_behind(text.str(), "\nSafety limits"), safety_limits());
}

TEST(ShellMaintenance, TheRefusalNamesTheLimitAndATransactionIsRefusedWhole) {
  Bench bench;
  bench.say("begin");
  bench.say("set joint0.control.kp 1.5");
  bench.say("set joint0.limits.current 2");
  const std::string answer = bench.say("commit");
  EXPECT_TRUE(refused(answer, "maintenance"));
  EXPECT_NE(answer.find("limits.current"), std::string::npos) << answer;
  EXPECT_TRUE(test::same(in_force(bench), AxisConfig{}));
  EXPECT_EQ(verdict(bench.say("maintenance open")), "ok");
  EXPECT_EQ(verdict(bench.say("commit")), "ok") << "what was staged is still there";
  EXPECT_EQ(in_force(bench).limits.current_a, Q24::from_int(2));
}

TEST(ShellMaintenance, TheScaleOfACommissionedJointIsASafetyLimit) {
  Bench bench;
  const std::array<const char*, 3> scale = {"set joint0.motor.encoder_counts 409600",
                                            "set joint0.motor.encoder_sign -1",
                                            "set joint0.motor.torque_per_current 0.001 Nm/A"};
  for (const char* line : scale) {
    EXPECT_EQ(verdict(bench.say(line)), "ok") << line << ", while the joint is set up";
  }
  bench.say("maintenance open");
  for (const char* line : {"begin", "set joint0.motor.encoder_counts 40960", "set joint0.motor.encoder_sign 1",
                           "set joint0.motor.torque_per_current 0.1", "set joint0.observer.inertia 0.02",
                           "set joint0.observer.coulomb 0.003", "set joint0.observer.against 0.01",
                           "set joint0.observer.noise 0.003", "commit", "maintenance close"}) {
    EXPECT_EQ(verdict(bench.say(line)), "ok") << line;
  }
  for (const char* line : scale) {
    const std::string answer = bench.say(line);
    EXPECT_TRUE(refused(answer, "maintenance")) << line;
    EXPECT_NE(answer.find("motor."), std::string::npos) << answer;
  }
  EXPECT_EQ(in_force(bench).motor.encoder_counts_per_turn, 40960);
  EXPECT_EQ(verdict(bench.say("set joint0.motor_angle.beta 1.1")), "ok") << "a law is applied without maintenance";
  EXPECT_EQ(verdict(bench.say("set joint1.motor.encoder_counts 8192")), "ok") << "the other joint is not commissioned";
  bench.say("maintenance open");
  EXPECT_EQ(verdict(bench.say(scale[0])), "ok");
}

TEST(ShellMaintenance, ADumpGoesBackWithoutMaintenanceWhereItsLimitsAreInForce) {
  Bench bench;
  bench.say("set joint0.control.kp 1.5");
  const auto dump = lines_of(bench.say("dump"));
  bench.say("set joint0.control.kp 0.5");
  for (std::size_t i = 0; i + 1 < dump.size(); ++i) {
    ASSERT_EQ(verdict(bench.say(dump[i])), "ok") << dump[i];
  }
  EXPECT_EQ(in_force(bench).control.kp, Q24::from_double(1.5));
}

TEST(ShellMaintenance, TheKeyOpensAWrongOneDoesNotAndTheNextHasToWait) {
  Bench bench;
  set_key(bench);
  EXPECT_TRUE(refused(bench.say("maintenance open"), "wrong_key"));
  EXPECT_TRUE(refused(bench.say(std::string("maintenance open ") + kKey), "too_soon"));
  EXPECT_TRUE(refused(bench.say("set joint0.limits.current 2"), "maintenance"));
  bench.ticks(3'000);
  EXPECT_EQ(verdict(bench.say(std::string("maintenance open ") + kKey)), "ok");
  EXPECT_EQ(verdict(bench.say("set joint0.limits.current 2")), "ok");
  EXPECT_TRUE(has_line(bench.say("maintenance"), "maintenance open, closes 10 minutes after it was opened, a key is"));
}

TEST(ShellMaintenance, AKeyIsNotTakenWhereNoneIsSet) {
  Bench bench;
  EXPECT_TRUE(refused(bench.say(std::string("maintenance open ") + kKey), "usage"));
  EXPECT_TRUE(refused(bench.say("set joint0.limits.current 2"), "maintenance"));
  EXPECT_EQ(verdict(bench.say("maintenance open")), "ok");
}

TEST(ShellMaintenance, TheKeyChangesOnlyWhileOpenAndCanBeTakenAway) {
  Bench bench;
  EXPECT_TRUE(refused(bench.say("maintenance key secret-enough"), "maintenance"));
  bench.say("maintenance open");
  EXPECT_TRUE(refused(bench.say("maintenance key short"), "short_key"));
  EXPECT_TRUE(has_line(bench.say("maintenance"), "maintenance open, closes 10 minutes after it was opened, no key"));
  set_key(bench);
  EXPECT_TRUE(refused(bench.say("maintenance key none"), "maintenance"));
  bench.say(std::string("maintenance open ") + kKey);
  EXPECT_EQ(verdict(bench.say("maintenance key none")), "ok");
  bench.say("maintenance close");
  EXPECT_EQ(verdict(bench.say("maintenance open")), "ok");
}

TEST(ShellMaintenance, TheKeyIsKeptOverARestartBySaveAndByNothingElse) {
  const auto after_restart = [](const Bench& bench) {
    test::FlashBanks banks = bench.banks;
    test::FakeIo<2> io;
    return Application<test::FakeIo<2>>(io, banks).maintenance_key();
  };
  Bench bench;
  bench.say("save");
  set_key(bench);
  EXPECT_FALSE(after_restart(bench).is_set());
  EXPECT_EQ(verdict(bench.say("save")), "ok");
  EXPECT_EQ(after_restart(bench), digest_of(kKey));
  bench.say("defaults");
  EXPECT_EQ(verdict(bench.say("commit")), "ok");
  EXPECT_TRUE(bench.application.maintenance_key().is_set()) << "defaults are of parameters";
  bench.say(std::string("maintenance open ") + kKey);
  bench.say("maintenance key none");
  EXPECT_EQ(verdict(bench.say("load")), "ok");
  EXPECT_EQ(bench.application.maintenance_key(), digest_of(kKey)) << "load brings back what was saved";
}

TEST(ShellMaintenance, ItClosesWhenThePeerLeavesAndAfterTenMinutes) {
  Bench bench;
  ShellInput input(bench.shell);
  bench.say("maintenance open");
  input.peer_left();
  bench.sink.take();
  EXPECT_TRUE(refused(bench.say("set joint0.limits.current 2"), "maintenance"));
  bench.say("maintenance open");
  bench.ticks(600'000);
  EXPECT_TRUE(refused(bench.say("set joint0.limits.current 2"), "maintenance"));
}

TEST(ShellMaintenance, NoKeyIsEverPrintedWhateverIsSaidWithIt) {
  Bench bench(true);
  std::string all;
  for (const std::string& line : std::vector<std::string>{
           "maintenance open", std::string("maintenance key ") + kKey, std::string("maintenance open ") + kKey,
           std::string(" \tmaintenance  open\t") + kKey, std::string("maintenance ") + kKey,
           std::string("maintenance close ") + kKey, std::string("maintenance open x\b") + kKey + " too many",
           "maintenance", "save", "dump", "diff", "list", "status", "help", "version"}) {
    all += bench.say(line);
  }
  EXPECT_EQ(all.find(kKey), std::string::npos) << all.substr(all.find(kKey) - 80, 200);
  EXPECT_EQ(all.find("tendon-2"), std::string::npos);
  EXPECT_NE(all.find("maintenance *************"), std::string::npos) << "stars instead: " << all.substr(0, 200);
  for (const auto& bank : bench.banks.memory) {
    const std::string bytes(bank.begin(), bank.end());
    EXPECT_EQ(bytes.find("tendon"), std::string::npos);
  }
}

TEST(ShellMaintenance, AJointThatIsNotFittedIsSaidToBeMissingAndMovesNothing) {
  Bench bench;
  EXPECT_TRUE(refused(bench.say("set joint1.motor.fitted 0"), "maintenance"));
  ASSERT_EQ(verdict(bench.say("maintenance open")), "ok");
  ASSERT_EQ(verdict(bench.say("set joint1.motor.fitted 0")), "ok");
  ASSERT_EQ(verdict(bench.say("arm")), "ok");
  EXPECT_TRUE(has_line(bench.say("status"), "joint1 not fitted"));
  EXPECT_TRUE(refused(bench.say("move joint1 0.2 rad"), "not_fitted"));
  EXPECT_TRUE(refused(bench.say("hold joint1"), "not_fitted"));
  EXPECT_TRUE(refused(bench.say("experiment joint1 triangle"), "range"));
  ASSERT_EQ(verdict(bench.say("move joint0 0.2 rad")), "ok");
  bench.ticks(1000);
  EXPECT_NEAR(bench.joint(0).q2_rad.to_double(), 0.2, 0.02);
  EXPECT_FALSE(bench.io.drive.axis[1].enabled);
  EXPECT_TRUE(bench.io.drive.axis[0].enabled);
}

}  // namespace
}  // namespace capstan
