// SPDX-License-Identifier: Apache-2.0
// What a commissioning found sets up the next board alike.
#include <gtest/gtest.h>

#include <algorithm>

#include "capstan/tools/apply/machine_lines.hpp"
#include "capstan/tools/commission/commission.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

const std::string kHead = "schema = \"capstan.machine/1\"\n";

TEST(MachineFile, SetsUpAnotherBoardAlike) {
  Progress found;
  found.set = {{"observer.inertia", "0.0224368 gm2"}, {"observer.coulomb", "0.0059872 Nm"},
               {"observer.against", "0.0167118 Nm"},  {"observer.noise", "0.004 A"},
               {"control.stiffness", "2.125 Nm/rad"}, {"control.rate_time_constant", "0.0005 s"}};
  const std::string text = machine_file({{.axis = 0, .corridor_rad = 1.0, .inertia_kgm2 = {}, .key = {}}}, {found});
  SimShell board{sim::Scenario{}};
  for (const std::string& line : machine_lines(text, "machine.toml")) {
    board.ask(line);
  }
  const std::vector<std::string> dump = board.ask("dump");
  for (const auto& [name, value] : found.set) {
    const std::string start = "set joint0." + name + " " + value.substr(0, value.find(' '));
    EXPECT_TRUE(std::any_of(dump.begin(), dump.end(), [&](const auto& line) { return line.starts_with(start); }))
        << start;
  }
}

TEST(MachineFile, WhatTheBoardConvertedIsReadBackAsItWasSet) {
  SimShell board{sim::Scenario{}};
  board.ask("maintenance open");
  for (const char* value : {"0.037 deg", "1 mrad", "0.002 rad", "0.0019"}) {
    const std::string line = std::string("set joint0.control.reversal_angle ") + value;
    board.ask(line);
    const std::string answer = board.ask("get joint0.control.reversal_angle").front();
    EXPECT_TRUE(reports(answer, line)) << answer << " for " << value;
    EXPECT_FALSE(reports(answer, "set joint0.control.reversal_angle 3 mrad")) << answer;
    EXPECT_FALSE(reports(answer, "set joint0.control.kp " + std::string(value))) << answer;
  }
  board.ask("set joint0.motor.encoder_counts 40000");
  EXPECT_TRUE(reports(board.ask("get joint0.motor.encoder_counts").front(), "set joint0.motor.encoder_counts 40000"));
}

TEST(MachineFile, AnotherVersionsFileIsSaidToBeOne) {
  try {
    machine_lines("schema = \"capstan.machine/9\"\n[joint0]\n\"control.kp\" = \"0.5\"\n", "machine.toml");
    ADD_FAILURE();
  } catch (const BadInput& bad) {
    EXPECT_NE(std::string(bad.what()).find("the schema is not capstan.machine/1"), std::string::npos) << bad.what();
  }
}

TEST(MachineFile, WhatIsNoParameterIsRefusedWithItsLine) {
  for (const auto& [body, sentence] : std::vector<std::pair<std::string, std::string>>{
           {"[joint0]\n\"control.kp\" = 0.5\n", ":3: 'control.kp' is no parameter with its value in quotes"},
           {"[joint0]\n\"control.kp\" = \"1\\nsave\"\n", ":3: 'control.kp' is no parameter"},
           {"[joint0]\n\"control.kp 1\\narm\" = \"1\"\n", ":3: "},
           {"[joint7]\n\"control.kp\" = \"1\"\n", ":2: 'joint7' is none of [joint0] to [joint3]"},
           {"[joint0]\ncontrol\n", ":3: "},
           {"", "sets nothing"},
           {"# \xC3\xBC\n", "sets nothing"},
           {"[joint0]\n\"control.k\xC3\xBC\" = \"1\"\n", ":3: 'control.k\xC3\xBC' is no parameter"}}) {
    try {
      machine_lines(kHead + body, "machine.toml");
      ADD_FAILURE() << body;
    } catch (const BadInput& bad) {
      EXPECT_NE(std::string(bad.what()).find("machine.toml" + (sentence[0] == ':' ? sentence : "")), std::string::npos)
          << bad.what();
      EXPECT_NE(std::string(bad.what()).find(sentence), std::string::npos) << bad.what();
    }
  }
}

}  // namespace
}  // namespace capstan::tools
