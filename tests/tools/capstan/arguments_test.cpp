// SPDX-License-Identifier: Apache-2.0
// What is refused before a command begins: exit status 2, one sentence, nothing written.
#include "capstan/tests/tools/capstan/command_fixture.hpp"

namespace capstan::tools {
namespace {

using Arguments = Command;

void expect_refused(const Outcome& outcome, const std::string& sentence) {
  EXPECT_EQ(outcome.status, 2) << outcome.output;
  EXPECT_NE(outcome.output.find(sentence), std::string::npos) << outcome.output;
}

TEST_F(Arguments, NumbersAreFinite) {
  for (const char* command :
       {"run --for", "tune log.csv --bandwidth", "identify log.csv --radius", "commission --corridor",
        "commission --corridor 0.8 --yes --inertia", "tip log.csv --jaw 0.01 --pitch-to-jaw", "faults --hours",
        "record tcp:1 joint0.q2 -o log.csv --for"}) {
    expect_refused(run(std::string(command) + " nan"), ": nan is no finite number; give one");
  }
}

TEST_F(Arguments, RangesArePrintedAsPeopleReadThem) {
  expect_refused(run("identify log.csv --radius 0"), "--radius: Value 0 not in range 0.000010 to 10.000000");
  expect_refused(run("identify log.csv --stiffness inf"), "not in range 0.001000 to");
  for (const char* hours : {"-1", "0", "1e308"}) {
    expect_refused(run(std::string("faults --hours ") + hours), "not in range 0.001000 to 100000.000000");
  }
}

TEST_F(Arguments, SeedsAreCounts) {
  for (const char* seed : {"-1", "99999999999999999999"}) {
    expect_refused(run(std::string("run --for 0.01 --seed ") + seed),
                   std::string("--seed: ") + seed + " is out of range; give a whole number from 0 to");
  }
  EXPECT_EQ(run("run --for 0.01 --seed 18446744073709551615").status, 0);
}

TEST_F(Arguments, AnOptionThatWouldHaveNoEffectIsRefused) {
  expect_refused(run("run --shell stdio --fast --model law.toml < /dev/null"), "capstan apply");
  expect_refused(run("run --shell stdio --fast --log log.csv < /dev/null"), "capstan record");
  EXPECT_FALSE(exists("log.csv"));
  expect_refused(run("faults --seed 5"), "--seed requires --hours");
  expect_refused(run("faults --tuned"), "--tuned requires --hours");
  expect_refused(run("faults --hours 0.001 --fmea"), "--fmea excludes --hours");
  expect_refused(run("faults --hours 0.001 --all"), "--all excludes --hours");
  const Outcome shortest = run("faults --hours 0.001");
  EXPECT_NE(shortest.output.find("of 1 drawn joint, five minutes each at most"), std::string::npos) << shortest.output;
}

TEST_F(Arguments, NoOutputReplacesAnInput) {
  const std::string log = write_log(short_log(100.0));
  const std::string text = read_text_file(path("log.csv"));
  std::filesystem::create_symlink("log.csv", path("link.csv"));
  std::filesystem::create_hard_link(path("log.csv"), path("hard.csv"));
  for (const char* name : {"log.csv", "link.csv", "hard.csv", "./log.csv"}) {
    expect_refused(run("identify " + log + " -o \"" + path(name) + "\""),
                   "which LOG reads; give --output another name");
    EXPECT_EQ(read_text_file(path(name)), text);
  }
  write_text_file(path("law.toml"), "law");
  expect_refused(run("replay " + log + " --model \"" + path("law.toml") + "\" -o \"" + path("law.toml") + "\""),
                 "which --model reads");
  expect_refused(run("compare other.csv --now " + log + " --json " + log), "which --now reads");
  expect_refused(run("routing \"" + path("law.toml") + "\" --svg \"" + path("law.toml") + "\""), "which FILE reads");
  EXPECT_EQ(read_text_file(path("law.toml")), "law");
}

TEST_F(Arguments, WhatIsNoMcapIsNotNamedSo) {
  const std::string log = write_log(short_log(100.0));
  const std::string named = "\"" + path("x.mcap") + "\"";
  expect_refused(run("run --for 0.01 --log " + named), "give it another ending, for a log .csv");
  expect_refused(run("replay " + log + " --model law.toml -o " + named), "'capstan replay' does not write");
  EXPECT_FALSE(exists("x.mcap"));
}

TEST_F(Arguments, NoFileIsWrittenTwice) {
  const std::string log = write_log(short_log(100.0));
  const std::string one = "\"" + path("one") + "\"";
  expect_refused(run("diagnose " + log + " --json " + one + " --next \"" + path("./one") + "\""),
                 "--json and --next would write the same file");
  expect_refused(run("diagnose " + log + " -o " + one + " --json " + one), "give each its own name");
  expect_refused(run("diagnose " + log + " --report " + one + " --json " + one), "would write the same file");
  expect_refused(run("commission --corridor 0.5 --yes --machine commission.txt"), "--state and --machine would write");
  expect_refused(run("commission --corridor 0.5 --yes --inertia 0.02 --machine commission.joint0.txt"),
                 "--state and --machine would write");
  EXPECT_FALSE(exists("one"));
}

TEST_F(Arguments, AnOutputsFolderIsThereBeforeTheWorkBegins) {
  expect_refused(run("commission --corridor 0.8 --yes --machine /nonexistent/machine.toml"),
                 "--machine /nonexistent/machine.toml: there is no folder /nonexistent; make it");
  EXPECT_FALSE(exists("commission.txt"));
}

TEST_F(Arguments, APortIsANumberThatPortsHave) {
  for (const char* port : {"99999", "80x", "-1"}) {
    expect_refused(run(std::string("console --listen ") + port),
                   "--listen: Value " + std::string(port) + " not in range 0 to 65535");
  }
}

TEST_F(Arguments, StandardOutputThatTakesNoMoreIsSaid) {
  for (const char* command : {"dbc", "tune --help"}) {
    const Outcome outcome = run(std::string(command) + " 2> \"" + path("said") + "\" > /dev/full; echo status $?");
    EXPECT_EQ(outcome.output, "status 2\n") << command;
    EXPECT_NE(read_text_file(path("said")).find("the result could not be written completely to standard output"),
              std::string::npos);
  }
}

TEST_F(Arguments, AReportGoesIntoAFolder) {
  const std::string log = write_log(short_log(100.0));
  const Outcome outcome = run("diagnose " + log + " --report " + log);
  expect_refused(outcome, "is a file; name a folder");
  EXPECT_EQ(outcome.output.find("wrote"), std::string::npos) << outcome.output;
  write_text_file(path("file"), "");
  const Outcome within =
      run("diagnose " + log + " --report \"" + path("file/new/report") + "\" -o \"" + path("o") + "\"");
  expect_refused(within, "file is a file; name a folder");
  EXPECT_FALSE(exists("o"));
  expect_refused(run("diagnose " + log + " -o \"" + path(".") + "\""), "is a folder; name a file in it");
}

TEST_F(Arguments, AMapOfAColumnThatNothingReadsIsRefused) {
  const std::string log = write_log(short_log(100.0));
  expect_refused(run("identify " + log + " --map \"axis0/tau_nm=axis0/tau_Nm\""), "did you mean axis0/tau_Nm?");
  expect_refused(run("tip " + log + " --pitch-to-jaw 0.01 --jaw 0.01 --map foo=axis0/tau_Nm"),
                 "nothing reads a column foo");
  const Outcome target = run("identify " + log + " --model kinematic --map camera=axis0/q2_rad --target camera");
  EXPECT_EQ(target.status, 0) << target.output;
}

}  // namespace
}  // namespace capstan::tools
