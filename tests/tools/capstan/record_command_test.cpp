// SPDX-License-Identifier: Apache-2.0
// What a recording does to the file that it is to write, beside a simulated board.
#include "capstan/tests/tools/capstan/command_fixture.hpp"

namespace capstan::tools {
namespace {

TEST_F(Command, ARefusedRecordingLeavesTheOlderLogAlone) {
  for (const char* name : {"keep.csv", "keep.mcap"}) {
    write_text_file(path(name), "older");
    const std::string to = " -o \"" + path(name) + "\" --for 0.3";
    const Outcome unknown = run("record $port joint0.nonsense" + to, beside_a_board(path("board")));
    EXPECT_EQ(unknown.status, 1) << unknown.output;
    EXPECT_NE(unknown.output.find("'frames 10 joint0.nonsense': unknown_signal"), std::string::npos) << unknown.output;
    EXPECT_EQ(unknown.output.find("\n\n"), std::string::npos) << unknown.output;
    EXPECT_EQ(read_text_file(path(name)), "older") << name;
    const Outcome twice = run("record $port joint0.q2 joint0.q2" + to, beside_a_board(path("board")));
    EXPECT_EQ(twice.status, 2) << twice.output;
    EXPECT_NE(twice.output.find("joint0.q2 is given twice"), std::string::npos) << twice.output;
    EXPECT_EQ(read_text_file(path(name)), "older") << name;
    const Outcome nobody = run("shell tcp:1 --record \"" + path(name) + "\"");
    EXPECT_EQ(nobody.status, 2) << nobody.output;
    EXPECT_EQ(read_text_file(path(name)), "older") << name;
    const Outcome recorded = run("record $port joint0.q2" + to, beside_a_board(path("board")));
    EXPECT_EQ(recorded.status, 0) << recorded.output;
    EXPECT_NE(read_text_file(path(name)), "older") << name;
  }
}

TEST_F(Command, ARecordingOfABoardThatSomebodyElseHasLeavesTheOlderLogAlone) {
  write_text_file(path("keep.csv"), "older");
  const std::string other = "sleep 2 | \"" CAPSTAN_PROGRAM "\" shell $port > /dev/null 2>&1 & sleep 0.5; ";
  const Outcome taken =
      run("record $port joint0.q2 -o \"" + path("keep.csv") + "\" --for 0.3", beside_a_board(path("board")) + other);
  EXPECT_NE(taken.status, 0) << taken.output;
  EXPECT_EQ(read_text_file(path("keep.csv")), "older");
}

}  // namespace
}  // namespace capstan::tools
