// SPDX-License-Identifier: Apache-2.0
// Law files of efforts and torques: what writes them, and what reads them again.
#include "capstan/tests/tools/capstan/command_fixture.hpp"
#include "capstan/tests/tools/synthetic_effort.hpp"
#include "capstan/tools/log/csv_log.hpp"

namespace capstan::tools {
namespace {

class LawFileCommand : public Command {
 protected:
  /// An axis with dry friction, its torque in every `every`-th row only or, held, in all.
  auto write_effort(const std::string& name, int cycles, int every = 1, bool held = false) const -> std::string {
    test::EffortRequest request;
    request.truth = test::EffortTruth::kCoulomb;
    request.cycles = cycles;
    const AxisLog made = test::synthetic_effort_log(request);
    std::string text = "time_s,axis0/q1_rad,axis0/tau_Nm\n";
    for (Eigen::Index i = 0; i < made.samples(); ++i) {
      const Eigen::Index measured = i - i % every;
      text += log_number(made.time_s[i]) + "," + log_number(made.q1_rad[held ? measured : i]) + "," +
              (held || measured == i ? log_number(made.effort[measured]) : "") + "\n";
    }
    write_text_file(path(name), text);
    return "\"" + path(name) + "\"";
  }
  /// The log of a recipe's motion, in quotes.
  auto recipe_log(const std::string& model) const -> std::string {
    const std::string log = "\"" + path("log.csv") + "\"";
    const Outcome ran =
        run("run --scenario \"" CAPSTAN_SOURCE_DIR "/tools/scenarios/recipe_" + model + ".toml\" --log " + log);
    EXPECT_EQ(ran.status, 0) << ran.output;
    return log;
  }
  auto replayed(const std::string& log, const std::string& law) const -> Outcome {
    return run("replay " + log + " --model \"" + path(law) + "\" --arithmetic double -o \"" + path("replayed.csv") +
               "\"");
  }
  auto rows_replayed() const -> std::size_t { return CsvLog::read(path("replayed.csv")).rows(); }
};

TEST_F(LawFileCommand, AnEffortsLawRunsOverLogsOfSeveralRatesAndOfASlowRecorder) {
  const std::string log = write_effort("log.csv", 2);
  ASSERT_EQ(run("identify " + log + " --model rigid_dynamics -o \"" + path("law.toml") + "\"").status, 0);
  const Outcome gaps = replayed(write_effort("gaps.csv", 2, 2), "law.toml");
  EXPECT_EQ(gaps.status, 0) << gaps.output;
  EXPECT_NE(gaps.output.find("warning: " + path("gaps.csv") + ": the channels have different rates"), std::string::npos)
      << gaps.output;
  EXPECT_EQ(rows_replayed(), 1200U);
  EXPECT_NE(gaps.output.find("replayed 1200 samples"), std::string::npos) << gaps.output;
  const Outcome repeats = replayed(write_effort("repeats.csv", 2, 5, true), "law.toml");
  EXPECT_EQ(repeats.status, 0) << repeats.output;
  EXPECT_EQ(rows_replayed(), 2400U) << "every row of the log";
}

TEST_F(LawFileCommand, AnEffortsLawIsReplayedOverItsOwnAxisAndSaysIntoWhichJointItGoes) {
  const std::string log = write_effort("log.csv", 2);
  ASSERT_EQ(run("identify " + log + " --model rigid_dynamics -o \"" + path("law.toml") + "\"").status, 0);
  const auto of_axis_2 = [](std::string text) {
    for (std::size_t at = 0; (at = text.find("axis0/", at)) != std::string::npos;) {
      text.replace(at, 5, "axis2");
    }
    return text;
  };
  write_text_file(path("log.csv"), of_axis_2(read_text_file(path("log.csv"))));
  write_text_file(path("law.toml"), of_axis_2(read_text_file(path("law.toml"))));
  const Outcome outcome = replayed(log, "law.toml");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_TRUE(CsvLog::read(path("replayed.csv")).has("axis2/tau_est_Nm"));
  const std::string apply = "apply \"" + path("law.toml") + "\" --port tcp:1";
  EXPECT_NE(run(apply).output.find("the law is of axis2/tau_Nm, and goes into joint 0"), std::string::npos);
  EXPECT_EQ(run(apply + " --axis 1").output.find("the law is of"), std::string::npos) << "who asks for a joint knows";
}

TEST_F(LawFileCommand, AKindIsReadFromTheSchemaAndNotFromWordsInTheFile) {
  const std::string log = write_effort("log.csv", 2);
  ASSERT_EQ(run("identify " + log + " --model rigid_dynamics -o \"" + path("law.toml") + "\"").status, 0);
  const std::string law = read_text_file(path("law.toml"));
  write_text_file(path("law.toml"), "# of capstan.machine/1\n" + law);
  EXPECT_EQ(replayed(log, "law.toml").status, 0);
  EXPECT_NE(run("apply \"" + path("law.toml") + "\" --port tcp:1").output.find("nothing answers"), std::string::npos);
  std::string newer = law;
  newer.replace(newer.find("capstan.effort/1"), 16, "capstan.effort/2");
  write_text_file(path("law.toml"), newer);
  for (const Outcome& outcome : {replayed(log, "law.toml"), run("apply \"" + path("law.toml") + "\" --port tcp:1")}) {
    EXPECT_EQ(outcome.status, 2);
    EXPECT_NE(outcome.output.find("another version, capstan.effort/2, and this program reads capstan.effort/1; update"),
              std::string::npos)
        << outcome.output;
  }
}

TEST_F(LawFileCommand, ATorquesLawRunsOverLogsOfSeveralRates) {
  write_text_file(path("force.toml"),
                  "schema = \"capstan.joint/1\"\n[force]\nmodel = \"preisach\"\ninputs = [-0.1, 0, 0.1]\n"
                  "forces = [[-0.05], [-0.05, 0.01], [-0.05, 0.03, 0.06]]\n");
  write_text_file(path("log.csv"),
                  "time_s,axis0/q1_rad,axis0/tau_Nm,axis0/tau_out_Nm\n"
                  "0,0,-0.1,-0.05\n0.01,0.05,0.1,\n0.02,0.1,0.1,0.06\n0.03,0.07,0.05,\n0.04,0.05,0,0.04\n");
  const Outcome outcome = replayed("\"" + path("log.csv") + "\"", "force.toml");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_EQ(rows_replayed(), 3U);
}

TEST_F(LawFileCommand, TheSimulatorRunsAFileOfAForceLawAloneAndLogsItsTorque) {
  write_text_file(path("force.toml"),
                  "schema = \"capstan.joint/1\"\n[force]\nmodel = \"preisach\"\ninputs = [-0.1, 0, 0.1]\n"
                  "forces = [[-0.05], [-0.05, 0.01], [-0.05, 0.03, 0.06]]\n");
  write_text_file(path("scenario.toml"),
                  "instrument = \"micro_forceps\"\n[environment]\nkind = \"locked\"\n[motion]\n"
                  "[[motion.segments]]\nkind = \"triangle\"\nduration_s = 4.0\namplitude_rad = 0.2\n"
                  "frequency_hz = 0.25\ncorner_s = 0.2\n");
  const auto most = [&](const std::string& options) {
    const Outcome outcome =
        run("run --scenario \"" + path("scenario.toml") + "\" --log \"" + path("log.csv") + "\"" + options);
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    return CsvLog::read(path("log.csv")).column("axis0/tau_out_est_Nm").cwiseAbs().maxCoeff();
  };
  EXPECT_EQ(most(""), 0.0) << "no law, no torque";
  EXPECT_GT(most(" --model \"" + path("force.toml") + "\""), 0.03);
}

TEST_F(LawFileCommand, ATableOfMoreLevelsThanTheBoardHasSaysWhichBuildHasThem) {
  std::vector<std::string> inputs, rows;
  for (int i = 0; i < 21; ++i) {
    inputs.push_back(exact(0.01 * (i - 10)));
    std::vector<std::string> row;
    for (int k = 0; k <= i; ++k) {
      row.push_back(exact(0.005 * (k - 10)));
    }
    rows.push_back("[" + joined(row) + "]");
  }
  write_text_file(path("force.toml"), "schema = \"capstan.joint/1\"\n[force]\nmodel = \"preisach\"\ninputs = [" +
                                          joined(inputs) + "]\nforces = [" + joined(rows) + "]\n");
  const Outcome outcome =
      run("apply \"" + path("force.toml") + "\" --port $port", beside_a_board(path("board"), "--fast"));
  EXPECT_EQ(outcome.status, 1) << outcome.output;
  EXPECT_NE(outcome.output.find("-DCAPSTAN_PREISACH_LEVELS=21"), std::string::npos) << outcome.output;
}

TEST_F(LawFileCommand, AMapWithoutSitesSaysThatItTakesTheLogForOne) {
  const auto quantity = [](const std::string& name, double value, const std::string& unit) {
    return name + " = { value = " + exact(value) + ", unit = \"" + unit + "\" }\n";
  };
  write_text_file(path("force.toml"),
                  "schema = \"capstan.joint/1\"\n[force]\nmodel = \"pull_push\"\n" + quantity("eta_top", 1.14, "1") +
                      quantity("eta_bottom", 1.14, "1") + quantity("pretension", 0.072, "Nm") +
                      quantity("ratio", 0.92, "1") + quantity("friction", 0.003, "Nm") + quantity("offset", 0, "Nm") +
                      quantity("stiffness_top", 0.34, "Nm/rad") + quantity("stiffness_bottom", 0.34, "Nm/rad"));
  const std::string rest = " --model \"" + path("force.toml") + "\"";
  const std::string log = write_log(short_log(200.0));
  const std::string note = "log.csv: without a column 'site' and without --period the whole log is one site";
  const Outcome alone = run("palpate " + log + rest);
  EXPECT_NE(alone.output.find(note), std::string::npos) << alone.output;
  const Outcome told = run("palpate " + log + rest + " --period 3 --factor 1.5");
  EXPECT_EQ(told.output.find(note), std::string::npos) << told.output;
  EXPECT_EQ(run("palpate " + log + rest + " --factor 0.5").status, 2);
}

TEST_F(LawFileCommand, TheLawOfAnEffortsShortLogIsReadAgain) {
  const std::string log = write_effort("log.csv", 1);
  std::string text = read_text_file(path("log.csv"));
  std::size_t end = 0;
  for (int line = 0; line < 201; ++line) {
    end = text.find('\n', end) + 1;
  }
  write_text_file(path("short.csv"), text.substr(0, end));
  const Outcome diagnosed =
      run("diagnose \"" + path("short.csv") + "\" --target axis0/tau_Nm -o \"" + path("law.toml") + "\"");
  ASSERT_TRUE(exists("law.toml")) << diagnosed.output;
  const Outcome outcome = replayed(log, "law.toml");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
}

TEST_F(LawFileCommand, AReversalTableThatWasDiagnosedIsReadAgain) {
  const std::string log = recipe_log("preisach");
  const Outcome diagnosed = run("diagnose " + log + " --base preisach -o \"" + path("law.toml") + "\"");
  ASSERT_TRUE(exists("law.toml")) << diagnosed.output;
  const Outcome outcome = replayed(log, "law.toml");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  const auto rms = outcome.output.find("against axis0/tau_out_Nm 0.00");
  EXPECT_NE(rms, std::string::npos) << outcome.output;
}

TEST_F(LawFileCommand, APullPushLawThatWasDiagnosedIsTheOneThatIdentifyWrites) {
  const std::string log = recipe_log("pull_push");
  ASSERT_EQ(run("identify " + log + " --model pull_push -o \"" + path("identified.toml") + "\"").status, 0);
  const Outcome diagnosed = run("diagnose " + log + " --base pull_push -o \"" + path("law.toml") + "\"");
  ASSERT_TRUE(exists("law.toml")) << diagnosed.output;
  EXPECT_EQ(read_text_file(path("law.toml")), read_text_file(path("identified.toml"))) << diagnosed.output;
}

TEST_F(LawFileCommand, TheAxisOfAMachineFileIsItsOwn) {
  write_text_file(path("machine.toml"), "schema = \"capstan.machine/1\"\n[joint0]\n\"control.kp\" = \"0.5\"\n");
  const Outcome other = run("apply \"" + path("machine.toml") + "\" --port tcp:1 --axis 1");
  EXPECT_EQ(other.status, 2);
  EXPECT_NE(other.output.find("sets up joint 0, and --axis names joint 1"), std::string::npos) << other.output;
  const Outcome same = run("apply \"" + path("machine.toml") + "\" --port tcp:1 --axis 0");
  EXPECT_NE(same.output.find("nothing answers"), std::string::npos) << same.output;
}

}  // namespace
}  // namespace capstan::tools
