// SPDX-License-Identifier: Apache-2.0
#include "boards/linux_rt/options.hpp"

#include <gtest/gtest.h>

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

TEST(BoardOptions, ParsingTwiceGivesTheSame) {
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(parse({"--cpu", "3"}).rt.cpu, 3);
  }
}

TEST(BoardOptions, WhatIsWrongIsNamedAndTheCureToo) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"--cpu", "x"}, "'x'"},           {{"--cpu", "-1"}, "'-1'"},
      {{"--priority", "0"}, "'0'"},      {{"--priority", "100"}, "'100'"},
      {{"--for", "nan"}, "'nan'"},       {{"--for", "-3"}, "'-3'"},
      {{"--for", "2s"}, "'2s'"},         {{"--storage"}, "--storage"},
      {{"--nonsense"}, "--nonsense"},    {{"-x"}, "-x"},
      {{"file.toml"}, "'file.toml'"},    {{"--help=yes"}, "--help=yes"},
      {{"--cpu", "1", "--for"}, "--for"}};
  for (const auto& [words, named] : cases) {
    const std::string sentence = refusal(words);
    EXPECT_NE(sentence.find(named), std::string::npos) << words.front() << " gives: " << sentence;
    EXPECT_NE(sentence.find("; "), std::string::npos) << sentence;
  }
}

TEST(BoardOptions, HelpNamesEveryOptionThatIsAccepted) {
  const std::string help = help_text();
  for (const char* name :
       {"--console", "--storage", "--for", "--cpu", "--priority", "--insist", "--selftest", "--version", "--help"}) {
    EXPECT_NE(help.find(std::string("\n  ") + name), std::string::npos) << name;
  }
}

}  // namespace
}  // namespace capstan
