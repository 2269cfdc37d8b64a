// SPDX-License-Identifier: Apache-2.0
#include "capstan/boards/linux_rt/options.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace capstan {
namespace {

auto parse(std::vector<std::string> words) -> BoardOptions {
  words.insert(words.begin(), "capstan_linux_rt");
  std::vector<char*> arguments;
  for (std::string& word : words) {
    arguments.push_back(word.data());
  }
  return parse_options(arguments);
}

auto refusal(const std::vector<std::string>& words) -> std::string {
  try {
    parse(words);
    return "";
  } catch (const std::runtime_error& problem) {
    return problem.what();
  }
}

TEST(BoardOptions, WithoutArgumentsTheShellIsOnStandardStreamsAndRunsUntilToldToStop) {
  const BoardOptions options = parse({});
  EXPECT_EQ(options.action, BoardOptions::Action::kRun);
  EXPECT_EQ(options.console, "stdio");
  EXPECT_TRUE(options.storage.empty());
  EXPECT_FALSE(options.seconds.has_value());
  EXPECT_EQ(options.rt.cpu, -1);
  EXPECT_FALSE(options.rt.insist);
}

TEST(BoardOptions, EveryOptionReachesItsField) {
  const BoardOptions options = parse({"--console", "tcp:4000", "--storage=banks.bin", "--cpu", "1", "--priority", "42",
                                      "--for", "2.5", "--insist", "--selftest"});
  EXPECT_EQ(options.action, BoardOptions::Action::kSelftest);
  EXPECT_EQ(options.console, "tcp:4000");
  EXPECT_EQ(options.storage, "banks.bin");
  EXPECT_EQ(options.seconds, 2.5);
  EXPECT_EQ(options.rt.cpu, 1);
  EXPECT_EQ(options.rt.priority, 42);
  EXPECT_TRUE(options.rt.insist);
}

TEST(BoardOptions, DriveProfilesAreReadInTheirOrderAndAWatchdogLineIsKnownToTheSetUp) {
  const std::string file = testing::TempDir() + "mine.profile";
  std::ofstream(file) << "name = mine\nnode = 3\nrated_current_ma = 1200\n";
  const BoardOptions options = parse({"--can", "can0:3", "--profile", file, "--gpio", "/dev/gpiochip2:watchdog=4"});
  ASSERT_EQ(options.can.profiles.size(), 1U);
  EXPECT_EQ(options.can.profiles[0].rated_current_ma, 1200U);
  EXPECT_TRUE(options.can.watchdog);
  EXPECT_FALSE(parse({"--can", "can0:3", "--gpio", "/dev/gpiochip2:enable=4"}).can.watchdog);
  EXPECT_NE(refusal({"--profile", "/nowhere/x.profile"}).find("can not be read; "), std::string::npos);
  std::ofstream(file) << "colour = green\n";
  EXPECT_NE(refusal({"--profile", file}).find("line 1 has the key 'colour'"), std::string::npos);
}

TEST(BoardOptions, HardwareIsReadAsItIsWritten) {
  const BoardOptions options = parse({"--can", "can0:1,2", "--can", "unix:/tmp/bus:3", "--pdo", "packed", "--fd",
                                      "--gpio", "/dev/gpiochip2:estop=!3,watchdog=0,enable=12"});
  ASSERT_EQ(options.can.buses.size(), 2U);
  EXPECT_EQ(options.can.buses[0].name, "can0");
  EXPECT_EQ(options.can.buses[0].nodes, (std::vector<std::uint8_t>{1, 2}));
  EXPECT_EQ(options.can.buses[1].name, "unix:/tmp/bus");
  EXPECT_EQ(options.can.buses[1].nodes, (std::vector<std::uint8_t>{3}));
  EXPECT_EQ(options.can.layout, cia402::PdoLayout::kPacked);
  EXPECT_TRUE(options.can.fd);
  EXPECT_EQ(options.gpio.chip, "/dev/gpiochip2");
  ASSERT_TRUE(options.gpio.estop && options.gpio.enable && options.gpio.watchdog);
  EXPECT_EQ(options.gpio.estop->offset, 3U);
  EXPECT_TRUE(options.gpio.estop->inverted);
  EXPECT_EQ(options.gpio.enable->offset, 12U);
  EXPECT_FALSE(options.gpio.enable->inverted);
  EXPECT_FALSE(options.gpio.brake);
}

TEST(BoardOptions, AnEmergencyStopMayStopASimulatedJoint) {
  EXPECT_TRUE(parse({"--gpio", "/dev/gpiochip2:estop=3"}).gpio.estop);
}

TEST(BoardOptions, ParsingTwiceGivesTheSame) {
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(parse({"--cpu", "3"}).rt.cpu, 3);
  }
}

TEST(BoardOptions, WhatIsWrongIsNamedAndTheCureToo) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"--cpu", "x"}, "'x'"},
      {{"--cpu", "-1"}, "'-1'"},
      {{"--priority", "0"}, "'0'"},
      {{"--priority", "100"}, "'100'"},
      {{"--for", "nan"}, "'nan'"},
      {{"--for", "-3"}, "'-3'"},
      {{"--for", "2s"}, "'2s'"},
      {{"--storage"}, "--storage"},
      {{"--nonsense"}, "--nonsense"},
      {{"-x"}, "-x"},
      {{"file.toml"}, "'file.toml'"},
      {{"--help=yes"}, "--help=yes"},
      {{"--cpu", "1", "--for"}, "--for"},
      {{"--can", "can0"}, "'can0'"},
      {{"--can", "can0:"}, "''"},
      {{"--can", ":1"}, "':1'"},
      {{"--can", "can0:0"}, "'0'"},
      {{"--can", "can0:127"}, "'127'"},
      {{"--can", "can0:1,x"}, "'x'"},
      {{"--can", "can0:1,1"}, "twice"},
      {{"--can", "can0:1", "--can", "can0:2"}, "can0 is given twice"},
      {{"--can", "can0:1,2,3,4,5"}, "5 drives"},
      {{"--can", "can0:1", "--can", "can1:2", "--can", "can2:3"}, "3 buses"},
      {{"--can", "can0:1", "--selftest"}, "--selftest"},
      {{"--selftest", "--gpio", "/dev/g:estop=5"}, "--selftest"},
      {{"--selftest", "--gpio", "/dev/g:brake=5"}, "Without --can"},
      {{"--gpio", "/dev/g:estop=1,enable=5"}, "Without --can"},
      {{"--gpio", "/dev/g:watchdog=5"}, "Without --can"},
      {{"--can", "can0:1", "--gpio", "/dev/g:estop=3", "--gpio", "/dev/h:enable=4"}, "--gpio is given twice"},
      {{"--pdo", "many"}, "'many'"},
      {{"--gpio", "/dev/gpiochip0"}, "'/dev/gpiochip0'"},
      {{"--gpio", "/dev/g:stop=3"}, "'stop=3'"},
      {{"--gpio", "/dev/g:estop"}, "'estop'"},
      {{"--gpio", "/dev/g:estop=x"}, "'estop=x'"},
      {{"--gpio", "/dev/g:estop=3,estop=4"}, "'estop=4'"},
      {{"--gpio", "/dev/g:estop=3,brake=3"}, "'brake=3'"}};
  for (const auto& [words, named] : cases) {
    const std::string sentence = refusal(words);
    EXPECT_NE(sentence.find(named), std::string::npos) << words.front() << " gives: " << sentence;
    EXPECT_NE(sentence.find("; "), std::string::npos) << sentence;
  }
}

TEST(BoardOptions, HelpNamesEveryOptionThatIsAccepted) {
  const std::string help = help_text();
  for (const char* name : {"--console", "--storage", "--for", "--cpu", "--priority", "--insist", "--can", "--pdo",
                           "--fd", "--gpio", "--selftest", "--version", "--help"}) {
    EXPECT_NE(help.find(std::string("\n  ") + name), std::string::npos) << name;
  }
}

}  // namespace
}  // namespace capstan
