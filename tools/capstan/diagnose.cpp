// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>

#include "capstan/tools/capstan/commands.hpp"
#include "capstan/tools/capstan/options.hpp"
#include "capstan/tools/diagnose/next_experiment.hpp"
#include "capstan/tools/jobs/diagnose_job.hpp"
#include "capstan/tools/report/report.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

struct DiagnoseCommand {
  LogOptions logs;
  std::string base, target, json, report, next, output;
  std::vector<std::string> tests;
  TendonDrawing drawing;
  bool alone = false;
};

/// An effort's error is read beside the effort.
auto reported(const ErrorSummary& error, const std::string& unit) -> std::string {
  return error_text(error.rmse, unit) +
         (unit == "rad" ? "" : ", " + rounded(error.relative_percent, 3) + " % of the effort");
}

/// What each of the likeliest effects would take away by itself; they overlap, so the shares need not add up.
auto candidates_line(const std::vector<CandidateShare>& candidates) -> std::string {
  constexpr std::size_t kMost = 3;
  std::vector<std::string> shares;
  for (const auto& candidate : candidates) {
    if (shares.size() < kMost) {
      shares.push_back(candidate.name + " " + std::to_string(std::lround(100.0 * candidate.share)) + " %");
    }
  }
  return shares.empty()
             ? ""
             : "  candidates, with the share of the error's energy that each explains alone: " + joined(shares, ", ") +
                   "\n";
}

/// @param said  warnings that were said while the logs were read
void print_diagnosis(const Diagnosis& d, const std::vector<std::string>& said) {
  std::cout << "verdict: " << verdict_word(d.verdict) << "\n  " << d.reason << "\n";
  if (d.traces.measured.size() == 0) {
    return;
  }
  for (const auto& size : d.sizes) {
    std::cout << "  " << size << "\n";
  }
  if (d.unnamed) {
    std::cout << "  " << d.unnamed->sentence << "\n";
  }
  std::cout << candidates_line(d.candidates);
  std::cout << "  law: " << word_of(d.law.status) << "\n  error on rows set aside (RMSE): before "
            << reported(d.before, d.unit);
  std::cout << "; after " << reported(d.after, d.unit) << "; ratio 95 % [" << rounded(d.ratio_ci95[0], 3) << ", "
            << rounded(d.ratio_ci95[1], 3) << "]; noise floor " << rounded(d.noise_floor) << " " << d.unit << "\n"
            << (repeats_what_was_fitted(d) ? "  " + std::string(kSameMotion) + "\n" : "")
            << law_table(d.law, d.undetermined);
  for (const auto& log : d.tested) {
    std::cout << "  error on " << log.name << " (RMSE): before " << reported(log.before, d.unit) << "; after "
              << reported(log.after, d.unit) << "\n";
  }
  for (const auto& warning : d.warnings) {
    if (std::find(said.begin(), said.end(), warning) == said.end()) {
      std::cout << "  note: " << warning << "\n";
    }
  }
  if (d.next_experiment) {
    std::cout << "  next: " << *d.next_experiment << "\n";
  }
}

/// A log that is fitted is not unseen.
auto tests_of(const DiagnoseCommand& options) -> std::vector<CsvLog> {
  for (const std::string& test : options.tests) {
    const auto& fitted = options.logs.files;
    if (std::any_of(fitted.begin(), fitted.end(), [&](const auto& file) { return same_file(file, test); })) {
      throw BadInput("--test " + test + " is among the logs that are fitted; give one that is not");
    }
  }
  return read_logs(options.tests, options.logs.maps);
}

void say_not_written(const std::string& path, const std::string& why) {
  std::cerr << path << " was not written: " << why
            << (std::filesystem::exists(path) ? "; the older file is left as it was" : "") << "\n";
}

auto run_diagnose(const DiagnoseCommand& options) -> int {
  DiagnoseJob job{.logs = options.logs.job_logs(),
                  .tests = tests_of(options),
                  .base = options.base,
                  .target = options.target,
                  .drawing = options.drawing,
                  .alone = options.alone};
  if (isatty(STDERR_FILENO) != 0) {
    job.progress = [](const std::string& what) { std::cerr << "... " << what << "\n"; };
  }
  std::vector<std::string> said;
  Diagnosis diagnosis = diagnose(job, [&said](const std::string& warning) {
    said.push_back(warning);
    warn(warning);
  });
  print_diagnosis(diagnosis, said);
  if (!options.output.empty()) {
    if (const std::string status = write_law(diagnosis, options.output); !status.empty()) {
      std::cerr << "wrote " << options.output << " (" << status << " law)\n";
    } else {
      say_not_written(options.output,
                      diagnosis.law.terms.empty() ? "these logs give no law" : "no file holds this law");
    }
  }
  if (!options.json.empty()) {
    write_text_file(options.json, diagnosis_json(diagnosis));
  }
  if (!options.report.empty()) {
    const std::string page = write_report(options.report, diagnosis);
    std::cerr << "wrote " << page << "\n";
  }
  if (!options.next.empty()) {
    if (const std::string next = next_scenario(diagnosis); !next.empty()) {
      write_text_file(options.next, next);
      std::cerr << "wrote " << options.next << "; capstan run --scenario " << options.next << "\n";
    } else {
      say_not_written(options.next, "this diagnosis needs no further motion");
    }
  }
  return is_refusal(diagnosis.verdict) ? kExitRefused : kExitDone;
}

}  // namespace

void add_diagnose(CLI::App& app, int& exit_status) {
  auto options = std::make_shared<DiagnoseCommand>();
  CLI::App* command =
      app.add_subcommand("diagnose", "find the effect that a law lacks, name it or report it as unknown, and add it");
  options->logs.add_to(*command, true);
  command->add_option(
      "--base", options->base,
      "law to start from: kinematic, pseudo_kinematic (default where torque is logged), tendon (two tendons with "
      "friction and pretension; takes the default's place where only it leaves no more than noise), "
      "rigid_dynamics (default where the target is an effort) or inertia, pull_push or preisach (joint torque from "
      "motor torque); or the joint.toml of a joint-angle law, which is fitted again");
  command->add_option("--target", options->target,
                      "column to explain: the measured joint angle (default axis<N>/q2_rad), or an effort such as "
                      "axis0/tau_Nm or, with axis0/q1_m, axis0/tau_N; of a force law axis<N>/tau_out_Nm");
  command
      ->add_option("--test", options->tests,
                   "log that takes no part in fit or choice and on which the law is tested too; repeatable")
      ->allow_extra_args(false);
  command
      ->add_flag("--alone", options->alone,
                 "leave the channels of other joints out: a law of an effort with them runs on no board")
      ->excludes("--coupled-to");
  add_drawing(*command, options->drawing);
  command->add_option("--json", options->json, "write the diagnosis as JSON");
  command->add_option("--report", options->report, "folder for the HTML page and its pictures");
  command->add_option(
      "--next", options->next,
      "write the motion that would decide what remains open, as a scenario; the report contains it too");
  command->add_option("-o,--output", options->output, "write the law with the effects added, for instance joint.toml");
  command->callback([options, &exit_status] { exit_status = run_diagnose(*options); });
}

}  // namespace capstan::tools
