// SPDX-License-Identifier: Apache-2.0
// The host program as a user calls it: exit statuses and messages of the contract.
#include "capstan/tests/tools/capstan/command_fixture.hpp"
#include "capstan/tests/tools/synthetic_effort.hpp"

namespace capstan::tools {
namespace {

TEST_F(Command, IdentifyThenReplayInTheFirmwaresArithmetic) {
  const std::string log = write_log(short_log(1000.0));
  const Outcome identified = run("identify " + log + " --model pseudo_kinematic -o \"" + path("joint.toml") + "\"");
  EXPECT_EQ(identified.status, 0) << identified.output;
  EXPECT_NE(identified.output.find("motor_angle.beta"), std::string::npos);
  const Outcome replayed =
      run("replay " + log + " --model \"" + path("joint.toml") + "\" -o \"" + path("out.csv") + "\"");
  EXPECT_EQ(replayed.status, 0) << replayed.output;
  EXPECT_NE(read_text_file(path("out.csv")).substr(0, 100).find("axis0/q2_est_rad"), std::string::npos);
}

TEST_F(Command, DiagnoseWritesJsonReportAndLaw) {
  test::SyntheticRequest request = short_log(100.0);
  request.truth = test::Truth::kPlay;
  request.cycles = 4;
  request.cycle_s = 25.0;
  const Outcome outcome = run("diagnose " + write_log(request) + " --json \"" + path("d.json") + "\" --report \"" +
                              path("report") + "\" -o \"" + path("law.toml") + "\"");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_NE(outcome.output.find("verdict: effect"), std::string::npos) << outcome.output;
  EXPECT_TRUE(exists("d.json") && exists("report/index.html") && exists("law.toml"));
  EXPECT_NE(read_text_file(path("law.toml")).find("[terms.play]"), std::string::npos);
  request.seed = 2;
  const Outcome again = run("identify " + write_log(request) + " --model \"" + path("law.toml") + "\"");
  EXPECT_EQ(again.status, 0) << again.output;
  EXPECT_NE(again.output.find("play.half_width"), std::string::npos) << again.output;
  request.strength = 2.0;  // the same joint with a wider gap
  const Outcome worn = run("diagnose " + write_log(request) + " --base \"" + path("law.toml") + "\"");
  EXPECT_EQ(worn.status, 0) << worn.output;
  EXPECT_NE(worn.output.find("verdict: nothing_missing"), std::string::npos) << worn.output;
  EXPECT_NE(worn.output.find("play.half_width moved from "), std::string::npos) << worn.output;
}

TEST_F(Command, WhatALogCanNotDetermineIsNamedAndNotPrinted) {
  AxisLog log = test::synthetic_log(short_log(200.0));
  log.tau_nm.setZero();
  write_text_file(path("log.csv"), test::log_text(log));
  const std::string name = "\"" + path("log.csv") + "\"";
  const Outcome identified = run("identify " + name + " -o \"" + path("joint.toml") + "\"");
  EXPECT_EQ(identified.status, 1);
  EXPECT_NE(identified.output.find("can not determine tendon_elongation.top, tendon_elongation.bottom;"),
            std::string::npos)
      << identified.output;
  EXPECT_EQ(identified.output.find("tendon_elongation.top   "), std::string::npos) << identified.output;
  EXPECT_FALSE(exists("joint.toml"));
  const Outcome diagnosed = run("diagnose " + name + " --base pseudo_kinematic --json \"" + path("d.json") + "\"");
  EXPECT_EQ(diagnosed.status, 1);
  EXPECT_NE(read_text_file(path("d.json")).find("\"verdict\": \"not_identifiable\""), std::string::npos);
  EXPECT_NE(diagnosed.output.find("tendon_elongation.top"), std::string::npos) << diagnosed.output;
}

TEST_F(Command, ALogWithTooLittleMotionIsUnfitAndSaysWhatToRecord) {
  const AxisLog made = test::synthetic_log(short_log(200.0));
  AxisLog small = made;  // hardly more than the counts of its encoder
  small.q1_rad = (4.0 * made.q1_rad.array()).round() * 1e-3;
  AxisLog one_way = made;
  one_way.q1_rad = 0.1 * made.time_s;
  one_way.q2_rad = 0.1 * made.time_s;
  for (const AxisLog& log : {small, one_way}) {
    write_text_file(path("log.csv"), test::log_text(log));
    const Outcome outcome = run("diagnose \"" + path("log.csv") + "\" --json \"" + path("d.json") + "\"");
    EXPECT_EQ(outcome.status, 1) << outcome.output;
    EXPECT_NE(outcome.output.find("; record a "), std::string::npos) << outcome.output;
    EXPECT_NE(read_text_file(path("d.json")).find("\"verdict\": \"data_unfit\""), std::string::npos);
  }
}

TEST_F(Command, AnUnknownEffectIsARefusal) {
  test::SyntheticRequest request = short_log(100.0);
  request.truth = test::Truth::kStickySpot;
  request.cycles = 4;
  request.cycle_s = 25.0;
  const Outcome outcome = run("diagnose " + write_log(request));
  EXPECT_EQ(outcome.status, 1) << outcome.output;
  EXPECT_NE(outcome.output.find("verdict: unknown"), std::string::npos) << outcome.output;
}

TEST_F(Command, AWordThatIsNoCommandIsToldWhatWasMeant) {
  const Outcome slip = run("diagnos log.csv");
  EXPECT_EQ(slip.status, 2);
  EXPECT_NE(slip.output.find("did you mean 'diagnose'?"), std::string::npos) << slip.output;
  const Outcome stranger = run("banana");
  EXPECT_EQ(stranger.status, 2);
  EXPECT_NE(stranger.output.find("there is no command 'banana'; `capstan --help`"), std::string::npos)
      << stranger.output;
  const Outcome nothing = run("");
  EXPECT_EQ(nothing.status, 2);
  EXPECT_NE(nothing.output.find("`capstan --help` lists the commands"), std::string::npos) << nothing.output;
  EXPECT_EQ(run("--help").status, 0);
}

TEST_F(Command, BadLogsEndWithStatusTwoAndOneSentence) {
  const std::string good = "time_s,axis0/q1_rad,axis0/tau_Nm,axis0/q2_rad\n";
  const std::string cases[][2] = {
      {"time_s,axis0/q1_rad,axis0/q2_rad\n0,0,0\n0.1,1,1\n0.2,0,0\n", "there is no column axis0/tau_Nm"},
      {good + "0,0,0,0\n0.1,1,nan,1\n0.2,2,0,2\n", ":3: column axis0/tau_Nm holds 'nan'"},
      {good + "0,0,0,0\n0.1,1,1,1\n0.1,2,0,2\n", ":4: time_s repeats 0.1"},
      {good + "0,0,0,0\n0.1,1,1,1\n0.05,2,0,2\n", ":4: time_s runs backward"},
      {good + "0,0,0,0\n0.1,0,1,1\n0.2,0,0,2\n", "axis0/q1_rad stands at 0"},
  };
  for (const auto& [text, expected] : cases) {
    write_text_file(path("bad.csv"), text);
    for (const char* command : {"identify", "diagnose --base pseudo_kinematic"}) {
      const Outcome outcome = run(std::string(command) + " \"" + path("bad.csv") + "\"");
      EXPECT_EQ(outcome.status, 2) << outcome.output;
      EXPECT_NE(outcome.output.find(expected), std::string::npos) << outcome.output;
      EXPECT_NE(outcome.output.find(";"), std::string::npos) << "no cure: " << outcome.output;
    }
  }
}

TEST_F(Command, ATruncatedLogIsUsedWithAWarning) {
  std::string text = test::log_text(test::synthetic_log(short_log(200.0)));
  write_text_file(path("cut.csv"), text.substr(0, text.size() - 20));
  const Outcome outcome = run("identify \"" + path("cut.csv") + "\"");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_NE(outcome.output.find("the last line is cut off"), std::string::npos) << outcome.output;
}

TEST_F(Command, ForceLawOfALogWithoutJointTorqueIsBadInput) {
  const std::string log = write_log(short_log(200.0));
  for (const std::string model : {"pull_push", "preisach"}) {
    for (const std::string& command :
         {"identify " + log + " --model " + model, "diagnose " + log + " --base " + model}) {
      const Outcome outcome = run(command);
      EXPECT_EQ(outcome.status, 2) << outcome.output;
      EXPECT_NE(outcome.output.find("axis0/tau_out_Nm"), std::string::npos) << outcome.output;
    }
  }
  const Outcome motor = run("diagnose " + log + " --base preisach --target axis0/tau_Nm");
  EXPECT_EQ(motor.status, 2) << motor.output;
  EXPECT_NE(motor.output.find("name the joint's"), std::string::npos) << motor.output;
}

TEST_F(Command, EveryLawOfTheJointAngleIsFittedByItsName) {
  const std::string log = write_log(short_log(200.0));
  const std::pair<const char*, const char*> models[] = {{"pretensioned", "pretension_offset.contrast"},
                                                        {"dynamic", "transmission_viscous.top"},
                                                        {"multi_dof", "axis_coupling.angle"}};
  for (const auto& [model, parameter] : models) {
    const Outcome outcome = run("identify " + log + " --model " + model);
    EXPECT_NE(outcome.output.find(parameter), std::string::npos) << model << ": " << outcome.output;
  }
}

TEST_F(Command, ABaseLawIsCoupledToTheJointsThatItNames) {
  const std::string log = write_log(short_log(200.0));
  const std::string law = "\"" + path("joint.toml") + "\"";
  ASSERT_EQ(run("identify " + log + " --model pseudo_kinematic -o " + law).status, 0);
  const std::string text = read_text_file(path("joint.toml"));
  write_text_file(path("joint.toml"), text + "\n[coupling]\njoint = 1\n");
  const Outcome two = run("diagnose " + log + " --base " + law + " --coupled-to 2");
  EXPECT_EQ(two.status, 2) << two.output;
  EXPECT_NE(two.output.find("is coupled to axis 1; leave --coupled-to out"), std::string::npos) << two.output;
  write_text_file(path("joint.toml"), text + "\n[coupling]\njoint = 7\n");
  const Outcome absent = run("diagnose " + log + " --base " + law);
  EXPECT_EQ(absent.status, 2) << absent.output;
  EXPECT_NE(absent.output.find("axis7/q1_rad"), std::string::npos) << absent.output;
}

TEST_F(Command, RefusalsEndWithStatusOne) {
  const std::string log = write_log(short_log(200.0));
  run("identify " + log + " -o \"" + path("joint.toml") + "\"");
  const Outcome rate = run("replay " + log + " --model \"" + path("joint.toml") + "\" -o \"" + path("out.csv") + "\"");
  EXPECT_EQ(rate.status, 1);
  EXPECT_NE(rate.output.find("--arithmetic double"), std::string::npos) << rate.output;
  EXPECT_FALSE(exists("out.csv"));
}

TEST_F(Command, AFullDiskIsSaidAndLeavesNoPieces) {
  const std::string full = "trap '' XFSZ; ulimit -f ";  // blocks of a file, and what is more is an error, not the end
  const Outcome cut = run("run --for 12 --fast --log \"" + path("log.csv") + "\"", full + "1024; ");
  EXPECT_EQ(cut.status, 2) << cut.output;
  EXPECT_NE(cut.output.find("log.csv: the log is cut off, as the disk took no more; free some space"),
            std::string::npos)
      << cut.output;
  EXPECT_EQ(cut.output.find("log written"), std::string::npos) << cut.output;
  const Outcome piece = run("dbc --output \"" + path("node.dbc") + "\"", full + "1; ");
  EXPECT_EQ(piece.status, 2) << piece.output;
  EXPECT_NE(piece.output.find("has room"), std::string::npos) << piece.output;
  std::filesystem::create_directories(path("taken"));
  EXPECT_EQ(run("dbc --output \"" + path("taken") + "\"").status, 2);
  EXPECT_FALSE(exists("node.dbc") || exists("node.dbc.part") || exists("taken.part"));
}

TEST_F(Command, WhatIsRefusedLeavesTheOldLogAlone) {
  write_text_file(path("log.csv"), "old");
  EXPECT_EQ(run("run --for 0.1 --model no_such_law.toml --log \"" + path("log.csv") + "\"").status, 2);
  write_text_file(path("refused.toml"), "shell = [\"set joint0.control.stiffness 1e9\"]\n");
  EXPECT_NE(run("run --for 0.1 --scenario \"" + path("refused.toml") + "\" --log \"" + path("log.csv") + "\"").status,
            0);
  EXPECT_NE(run("record no_such_port joint0.q2 -o \"" + path("log.csv") + "\"").status, 0);
  EXPECT_EQ(read_text_file(path("log.csv")), "old");
}

TEST_F(Command, UnknownWordsAndMissingFilesAreBadInput) {
  EXPECT_EQ(run("").status, 2);
  EXPECT_EQ(run("frobnicate").status, 2);
  EXPECT_EQ(run("identify").status, 2);
  EXPECT_EQ(run("identify no_such_file.csv").status, 2);
  EXPECT_EQ(run("identify no_such_file.csv --model nonsense").status, 2);
  EXPECT_EQ(run("--help").status, 0);
  EXPECT_EQ(run("diagnose --help").status, 0);
}

TEST_F(Command, AForceIsIdentifiedAndDiagnosedFromTheMotionOfALinearAxis) {
  test::EffortRequest request;
  request.truth = test::EffortTruth::kCoulomb;
  const AxisLog made = test::synthetic_effort_log(request);
  std::string text = "t,position_m,push_N\n";
  for (Eigen::Index i = 0; i < made.samples(); ++i) {
    text += log_number(made.time_s[i]) + "," + log_number(made.q1_rad[i]) + "," + log_number(made.effort[i]) + "\n";
  }
  write_text_file(path("axis.csv"), text);
  const std::string log = "\"" + path("axis.csv") + "\" --map time_s=t --map axis0/q1_rad=position_m ";
  const Outcome identified =
      run("identify " + log + "--map axis0/tau_Nm=push_N --model rigid_dynamics -o \"" + path("axis.toml") + "\"");
  EXPECT_EQ(identified.status, 0) << identified.output;
  EXPECT_NE(identified.output.find("kg"), std::string::npos) << identified.output;
  EXPECT_NE(read_text_file(path("axis.toml")).find("capstan.effort/1"), std::string::npos);
  const Outcome diagnosed = run("diagnose " + log + "--target push_N --json \"" + path("d.json") + "\" --report \"" +
                                path("report") + "\" -o \"" + path("push.toml") + "\"");
  EXPECT_EQ(diagnosed.status, 0) << diagnosed.output;
  EXPECT_NE(diagnosed.output.find("The law lacks coulomb_friction;"), std::string::npos) << diagnosed.output;
  EXPECT_NE(read_text_file(path("d.json")).find("\"unit\": \"Ns/m\""), std::string::npos);
  EXPECT_TRUE(exists("report/index.html"));
  const Outcome replayed = run("replay " + log + "--model \"" + path("axis.toml") + "\" -o \"" + path("o.csv") + "\"");
  EXPECT_EQ(replayed.status, 1);
  EXPECT_NE(replayed.output.find("linear axis"), std::string::npos) << replayed.output;
  EXPECT_NE(replayed.output.find("add --arithmetic double"), std::string::npos) << replayed.output;
  const Outcome in_double = run("replay " + log + "--map axis0/tau_Nm=push_N --arithmetic double --model \"" +
                                path("axis.toml") + "\" -o \"" + path("o.csv") + "\"");
  EXPECT_EQ(in_double.status, 0) << in_double.output;
  const Outcome own_column = run("replay " + log + "--map axis0/push_N=push_N --arithmetic double --model \"" +
                                 path("push.toml") + "\" -o \"" + path("o.csv") + "\"");
  EXPECT_EQ(own_column.status, 0) << own_column.output;
  const Outcome current = run("diagnose " + log + "--target axis0/current_A");
  EXPECT_EQ(current.status, 1);
  EXPECT_NE(current.output.find("*FACTOR"), std::string::npos) << current.output;
}

TEST_F(Command, ForeignColumnsAreReadThroughMaps) {
  std::string text = test::log_text(test::synthetic_log(short_log(200.0)));
  text.replace(0, text.find('\n'), "t,motor,milli_nm,joint");
  write_text_file(path("foreign.csv"), text);
  const Outcome outcome =
      run("identify \"" + path("foreign.csv") +
          "\" --map time_s=t --map axis0/q1_rad=motor --map \"axis0/tau_Nm=milli_nm*1.0\" --map axis0/q2_rad=joint");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
}

TEST_F(Command, RoutingCostsItsOwnExampleAndRefusesAnotherWithTheRange) {
  const Outcome help = run("routing --help");
  const auto start = help.output.find("  input_radius_m");
  ASSERT_NE(start, std::string::npos);
  write_text_file(path("way.toml"), help.output.substr(start, help.output.find("[bottom] is like") - start));
  const Outcome done =
      run("routing \"" + path("way.toml") + "\" --json \"" + path("way.json") + "\" --svg \"" + path("way.svg") + "\"");
  EXPECT_EQ(done.status, 0) << done.output;
  EXPECT_NE(done.output.find("elbow"), std::string::npos) << done.output;
  EXPECT_NE(read_text_file(path("way.json")).find("capstan.routing/1"), std::string::npos);
  EXPECT_NE(read_text_file(path("way.svg")).find("<svg"), std::string::npos);
  write_text_file(path("way.toml"), "input_radius_m = 5\n");
  const Outcome refused = run("routing \"" + path("way.toml") + "\"");
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.output.find("way.toml:1: input_radius_m = 5 is out of range; it must be from 0.0001 to 1"),
            std::string::npos)
      << refused.output;
}

TEST_F(Command, IdentifyRefusesLevelsThatMakeNoSense) {
  const std::string log = write_log(short_log(200.0));
  const Outcome few = run("identify " + log + " --model preisach --levels 3");
  EXPECT_EQ(few.status, 2);
  EXPECT_NE(few.output.find("5 to 41"), std::string::npos) << few.output;
  const Outcome other = run("identify " + log + " --model kinematic --levels 21");
  EXPECT_EQ(other.status, 2);
  EXPECT_NE(other.output.find("--levels"), std::string::npos) << other.output;
}

TEST_F(Command, ReplayOfAForceLawAppendsTheJointsTorque) {
  write_text_file(path("joint.toml"),
                  "schema = \"capstan.joint/1\"\n[force]\nmodel = \"preisach\"\ninputs = [-0.1, 0, 0.1]\n"
                  "forces = [[-0.05], [-0.05, 0.01], [-0.05, 0.03, 0.06]]\n");
  write_text_file(path("log.csv"),
                  "time_s,axis0/q1_rad,axis0/tau_Nm,axis0/tau_out_Nm\n"
                  "0,0,-0.1,-0.05\n0.01,0.1,0.1,0.06\n0.02,0.05,0,0.04\n");
  const Outcome done =
      run("replay \"" + path("log.csv") + "\" --model \"" + path("joint.toml") + "\" -o \"" + path("out.csv") + "\"");
  EXPECT_EQ(done.status, 0) << done.output;
  // Off by 0.01 in one row of three.
  EXPECT_NE(done.output.find("against axis0/tau_out_Nm 0.005774 Nm"), std::string::npos) << done.output;
  EXPECT_NE(read_text_file(path("out.csv")).find("axis0/tau_out_est_Nm"), std::string::npos);
}

TEST_F(Command, ALogIsEvidenceOnce) {
  const std::string log = write_log(short_log(200.0));
  std::filesystem::create_symlink("log.csv", path("link.csv"));
  std::filesystem::copy_file(path("log.csv"), path("healthy.csv"));
  for (const std::string& command :
       {std::string("identify "), std::string("diagnose "), "compare \"" + path("healthy.csv") + "\" --now "}) {
    const Outcome twice = run(command + log + " \"" + path("link.csv") + "\"");
    EXPECT_EQ(twice.status, 2);
    EXPECT_NE(twice.output.find("link.csv is given twice"), std::string::npos) << twice.output;
  }
  const Outcome seen = run("diagnose " + log + " --test \"" + path("./link.csv") + "\"");
  EXPECT_EQ(seen.status, 2);
  EXPECT_NE(seen.output.find("link.csv is among the logs that are fitted"), std::string::npos) << seen.output;
}

TEST_F(Command, ASiteIsPalpatedOnceByEachLog) {
  write_text_file(path("force.toml"), "");
  const std::string log = write_log(short_log(200.0));
  const Outcome twice = run("palpate " + log + " " + log + " --model \"" + path("force.toml") + "\"");
  EXPECT_EQ(twice.status, 2);
  EXPECT_NE(twice.output.find("log.csv is given twice"), std::string::npos) << twice.output;
}

TEST_F(Command, AFileOfAnEffortsLawIsNoStartOfAFit) {
  write_text_file(path("law.toml"), "schema = \"capstan.effort/1\"\n");
  const std::string log = write_log(short_log(200.0)) + " --target axis0/tau_Nm ";
  std::filesystem::copy_file(path("log.csv"), path("other.csv"));
  for (const std::string& command : {"diagnose " + log + "--base", "identify " + log + "--model",
                                     "compare " + log + " --now \"" + path("other.csv") + "\" --base"}) {
    const Outcome outcome = run(command + " \"" + path("law.toml") + "\"");
    EXPECT_EQ(outcome.status, 2);
    EXPECT_NE(outcome.output.find("give the name of one instead, rigid_dynamics or inertia"), std::string::npos)
        << outcome.output;
  }
}

TEST_F(Command, TheTorquesSignIsTurnedOnItsOwnAxis) {
  AxisLog log = test::synthetic_log(short_log(200.0));
  log.tau_nm = -log.tau_nm;
  std::string text = test::log_text(log);
  for (auto at = text.find("axis0/"); at != std::string::npos; at = text.find("axis0/", at)) {
    text.replace(at, 6, "axis7/");
  }
  write_text_file(path("log.csv"), text);
  const Outcome outcome = run("identify \"" + path("log.csv") + "\" --axis 7");
  EXPECT_NE(outcome.output.find("--map \"axis7/tau_Nm=COLUMN*-1\" turns it"), std::string::npos) << outcome.output;
}

TEST_F(Command, WristNamesThreeAxesThatTheLogHas) {
  const std::string log = write_log(short_log(200.0));
  const Outcome twice = run("identify " + log + " --model wrist --wrist-axes 0 1 1");
  EXPECT_EQ(twice.status, 2);
  EXPECT_NE(twice.output.find("names an axis twice"), std::string::npos) << twice.output;
  const Outcome commas = run("identify " + log + " --model wrist --wrist-axes 0,1,1");
  EXPECT_NE(commas.output.find("names an axis twice"), std::string::npos) << commas.output;
  const Outcome absent = run("identify " + log + " --model wrist");
  EXPECT_EQ(absent.status, 2);
  EXPECT_NE(absent.output.find("axis1/"), std::string::npos) << absent.output;
}

TEST_F(Command, TipAppendsItsColumnsAndRefusesLengthsOfNoWrist) {
  write_text_file(path("wrist.csv"), "time_s,axis0/q2_rad,axis1/q2_rad,axis2/q2_rad\n0,0,0,0\n1,0.1,0.1,0.1\n");
  const std::string log = "tip \"" + path("wrist.csv") + "\" ";
  EXPECT_EQ(run(log + "--pitch-to-jaw 0.009 --jaw 0.01 -o \"" + path("tips.csv") + "\"").status, 0);
  EXPECT_NE(read_text_file(path("tips.csv")).find("tip_left/z_m"), std::string::npos);
  const Outcome turned =
      run(log + "--pitch-to-jaw 0.009 --jaw 0.01 --wrist-axes 0,2,1 -o \"" + path("tips.csv") + "\"");
  EXPECT_EQ(turned.status, 0) << turned.output;
  const Outcome nothing = run(log + "--pitch-to-jaw 0.009 --jaw 0.01");
  EXPECT_EQ(nothing.status, 2);
  EXPECT_NE(nothing.output.find("write the tips with -o"), std::string::npos) << nothing.output;
  for (const char* axes : {"0,0,1", "0 0 1"}) {
    const Outcome twice = run(log + "--pitch-to-jaw 0.009 --jaw 0.01 --wrist-axes " + axes);
    EXPECT_EQ(twice.status, 2);
    EXPECT_NE(twice.output.find("names an axis twice"), std::string::npos) << twice.output;
  }
  const Outcome commission = run("commission --corridor 0.8 --yes --axis 0,0");
  EXPECT_EQ(commission.status, 2);
  EXPECT_NE(commission.output.find("--axis names a joint twice"), std::string::npos) << commission.output;
  const Outcome long_jaw = run(log + "--pitch-to-jaw 0.009 --jaw 10");
  EXPECT_EQ(long_jaw.status, 2);
  EXPECT_NE(long_jaw.output.find("not in range"), std::string::npos) << long_jaw.output;
}

}  // namespace
}  // namespace capstan::tools
