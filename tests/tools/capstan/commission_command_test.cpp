// SPDX-License-Identifier: Apache-2.0
// How `capstan commission` and `capstan tune PORT` end when they are ended from outside, and what they are asked
// wrongly.
#include "capstan/tests/tools/capstan/command_fixture.hpp"

namespace capstan::tools {
namespace {

class CommissionCommand : public Command {
 protected:
  /// The program by itself, and what ends it as soon as it is in that step.
  auto ended(const std::string& step, const std::string& signal, const std::string& more = "",
             const std::string& whom = "$program") const -> std::string {
    return ": > \"" + path("said") +
           "\"; \"" CAPSTAN_PROGRAM "\" commission $port --corridor 0.8 --inertia 0.02 --yes --state \"" +
           path("state") + "\" --machine \"" + path("machine") + "\" " + more + " >> \"" + path("said") +
           "\" 2>&1 & program=$!; for i in $(seq 400); do grep -q '^" + step + ":' \"" + path("said") +
           "\" && break; sleep 0.02; done; sleep 0.2; kill -" + signal + " " + whom +
           "; wait $program; echo status $? >> \"" + path("said") + "\"; ";
  }
  /// Keeps the board's parameters in a file.
  auto dump(const std::string& name) const -> std::string {
    return "echo dump | \"" CAPSTAN_PROGRAM "\" shell $port | grep '^set ' > \"" + path(name) + "\"; ";
  }
  auto board() const -> std::string { return beside_a_board(path("board"), "--fast"); }
};

TEST_F(CommissionCommand, ItIsStoppedByAClosedTerminalAsByCtrlC) {
  for (const char* signal : {"INT", "HUP", "TERM"}) {
    const Outcome status =
        run("shell $port", board() + dump("before") + ended("shake", signal) + dump("after") + "echo status | ");
    const std::string said = read_text_file(path("said"));
    EXPECT_NE(said.find("shake: stopped on request, torque is off; the same command continues from here\nstatus 1\n"),
              std::string::npos)
        << signal << ": " << said;
    EXPECT_NE(status.output.find("state disarmed"), std::string::npos) << signal << ": " << status.output;
    EXPECT_EQ(read_text_file(path("after")), read_text_file(path("before"))) << signal;
    std::filesystem::remove(path("state"));
  }
}

TEST_F(CommissionCommand, AfterItWasKilledTheNextRunGivesBackWhatItHadSetForAWhile) {
  for (const char* again : {"", "--again"}) {
    const Outcome status = run("shell $port", board() + dump("before") + ended("shake", "KILL") + dump("killed") +
                                                  ended("shake", "INT", again) + dump("after") + "echo status | ");
    EXPECT_TRUE(read_text_file(path("killed")) != read_text_file(path("before"))) << again;
    EXPECT_NE(read_text_file(path("said")).find(": stopped on request, torque is off"), std::string::npos) << again;
    EXPECT_EQ(read_text_file(path("after")), read_text_file(path("before"))) << again;
    EXPECT_NE(status.output.find("state disarmed"), std::string::npos) << again << status.output;
    std::filesystem::remove(path("state"));
  }
}

TEST_F(CommissionCommand, ABoardThatIsGoneIsSaid) {
  static_cast<void>(run("--version", board() + ended("shake", "KILL", "", "$board")));
  const std::string said = read_text_file(path("said"));
  EXPECT_NE(said.find("status 1\n"), std::string::npos) << said;
  EXPECT_TRUE(said.find("the board closed the line") != std::string::npos ||
              said.find("the line broke while sending") != std::string::npos)
      << said;
}

TEST_F(CommissionCommand, WithoutTheInertiaAScriptHasToSaySoAndAPersonIsAsked) {
  const Outcome script = run("commission --corridor 0.8 --yes");
  EXPECT_EQ(script.status, 2);
  EXPECT_NE(script.output.find("or say --without-inertia"), std::string::npos) << script.output;
  const Outcome person = run("commission --corridor 0.8", "cd \"" + path("") + "\"; echo n | ");
  EXPECT_EQ(person.status, 1);
  EXPECT_NE(person.output.find("WARNING: without --inertia"), std::string::npos) << person.output;
  EXPECT_FALSE(exists("commission.joint0.txt"));
}

TEST_F(CommissionCommand, EachJointHasAFileOfItsOwnAndOnlyItGoesOnFromThere) {
  const std::string here = "cd \"" + path("") + "\"; echo n | ";
  const std::string command = "commission --corridor 0.8 --inertia 0.02";
  EXPECT_NE(run(command, here).output.find("shake: stopped on request"), std::string::npos);
  ASSERT_TRUE(exists("commission.joint0.txt"));
  EXPECT_NE(read_text_file(path("commission.joint0.txt")).find("\naxis 0\n"), std::string::npos);
  EXPECT_NE(run(command, here).output.find("look: done before"), std::string::npos);
  std::string text = read_text_file(path("commission.joint0.txt"));
  text.replace(text.find("axis 0"), 6, "axis 1");
  write_text_file(path("other.txt"), text);
  const Outcome other = run(command + " --state other.txt", here);
  EXPECT_EQ(other.status, 1);
  EXPECT_NE(other.output.find("is of joint1, and this is joint0"), std::string::npos) << other.output;
}

TEST_F(CommissionCommand, HalfOfAHandsMeasureIsAnsweredWithTheOtherHalf) {
  const std::string command = "commission --corridor 0.8 --inertia 0.02 --yes ";
  const std::string here = "cd \"" + path("") + "\"; ";
  const Outcome twice = run(command + "--turn-motor 360 --turn-joint 45", here);
  EXPECT_EQ(twice.status, 2);
  EXPECT_NE(twice.output.find("two ways to the same; give one"), std::string::npos) << twice.output;
  for (const char* half : {"--weight 300", "--arm 12"}) {
    const Outcome outcome = run(command + half, here);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_NE(outcome.output.find("--weight and --arm go together"), std::string::npos) << outcome.output;
  }
  // A script turns nothing.
  const Outcome idle = run(command + "--turn-motor 360", here);
  EXPECT_EQ(idle.status, 1);
  EXPECT_NE(idle.output.find("turn: the encoder gave 0 counts"), std::string::npos) << idle.output;
}

/// `capstan tune` of a board, which is commissioned by hand: inertia and friction are what it has to know.
class TuneBoardCommand : public CommissionCommand {
 protected:
  auto commissioned_board() const -> std::string {
    return board() +
           "printf 'maintenance open\\nbegin\\nset joint0.observer.inertia 0.02 gm2\\nset joint0.observer.coulomb "
           "0.02\\n"
           "set joint0.observer.against 0.02\\nset joint0.observer.noise 0.003\\nset joint0.control.torque_forward "
           "0.08 "
           "Nm\\nset joint0.control.torque_backward -0.08 Nm\\ncommit\\n' | \"" CAPSTAN_PROGRAM "\" shell $port > \"" +
           path("set up") + "\"; ";
  }
};

TEST_F(TuneBoardCommand, AfterItWasKilledTheNextRunGivesBackWhatItHadSetForAWhile) {
  const std::string here = "cd \"" + path("") + "\"; ";
  const std::string killed =
      ": > said; \"" CAPSTAN_PROGRAM
      "\" tune $port --corridor 0.8 --yes >> said 2>&1 & program=$!; for i in $(seq 400); do [ -e "
      "tune.joint0.txt ] && break; sleep 0.02; done; sleep 0.3; kill -KILL $program; wait "
      "$program; ";
  const Outcome next = run("tune $port --corridor 0.8", here + commissioned_board() + dump("before") + killed +
                                                            dump("killed") + "cp tune.joint0.txt kept.txt; echo n | ");
  EXPECT_TRUE(read_text_file(path("killed")) != read_text_file(path("before")));
  EXPECT_NE(read_text_file(path("kept.txt")).find("\nbefore limits.joint_max="), std::string::npos);
  EXPECT_EQ(next.status, 1);
  EXPECT_NE(next.output.find("restores the settings that an interrupted run had changed"), std::string::npos)
      << next.output;
  EXPECT_NE(next.output.find("tune: stopped on request, torque is off; the gains are those of before"),
            std::string::npos)
      << next.output;
  EXPECT_FALSE(exists("tune.joint0.txt"));
}

TEST_F(TuneBoardCommand, ItIsStoppedByCtrlCAndTheBoardIsAsBefore) {
  const std::string here = "cd \"" + path("") + "\"; ";
  const std::string stopped = ": > said; \"" CAPSTAN_PROGRAM
                              "\" tune $port --corridor 0.8 --yes >> said 2>&1 & program=$!; for i in $(seq 400); do [ "
                              "-e tune.joint0.txt ] && break; sleep 0.02; done; sleep 0.3; kill -INT $program; wait "
                              "$program; echo status $? >> said; ";
  const Outcome status =
      run("shell $port", here + commissioned_board() + dump("before") + stopped + dump("after") + "echo status | ");
  const std::string said = read_text_file(path("said"));
  EXPECT_NE(said.find("tune: stopped on request, torque is off; the gains are those of before\nstatus 1\n"),
            std::string::npos)
      << said;
  EXPECT_EQ(read_text_file(path("after")), read_text_file(path("before")));
  EXPECT_NE(status.output.find("state disarmed"), std::string::npos) << status.output;
  EXPECT_FALSE(exists("tune.joint0.txt"));
}

TEST_F(TuneBoardCommand, WhatIsAskedWronglyIsAnsweredWithTheCure) {
  struct Wrong {
    const char* arguments;
    int status;
    const char* sentence;
  };
  for (const Wrong& wrong : {Wrong{"tune $port --yes", 2, "a board needs --corridor"},
                             Wrong{"tune $port --corridor 0.8 --dump dump.txt", 2, "--dump is for a log"},
                             Wrong{"tune $port --corridor 0.8 --map axis0/q1_rad=a", 2, "--map is for a log"},
                             Wrong{"tune log.csv --corridor 0.8", 2, "--corridor is for a board, and log.csv is a log"},
                             Wrong{"tune log.csv --yes", 2, "--yes is for a board"},
                             Wrong{"tune /dev/ttyNone --corridor 0.8", 2, "the port does not open"},
                             Wrong{"tune $port --corridor 0.8 --axis 2", 2, "the board has no joint2"},
                             Wrong{"tune $port --corridor 0.8 --yes", 1, "joint0 is not commissioned"},
                             Wrong{"tune $port --corridor 0.8 --state set.txt", 2, "is not a progress file"}}) {
    write_text_file(path("set.joint0.txt"), "time_s,axis0/q1_rad\n");
    const Outcome outcome = run(wrong.arguments, "cd \"" + path("") + "\"; " + board());
    EXPECT_EQ(outcome.status, wrong.status) << wrong.arguments << ": " << outcome.output;
    EXPECT_NE(outcome.output.find(wrong.sentence), std::string::npos) << wrong.arguments << ": " << outcome.output;
  }
}

}  // namespace
}  // namespace capstan::tools
