// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <iostream>
#include <memory>

#include "capstan/tools/capstan/commands.hpp"
#include "capstan/tools/capstan/options.hpp"
#include "capstan/tools/diagnose/diagnosis.hpp"
#include "capstan/tools/diagnose/next_experiment.hpp"
#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/joint_file/effort_file.hpp"
#include "capstan/tools/report/report.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

struct CommandOptions {
  LogOptions logs;
  std::string base, target, json, report, next, output;
  std::vector<std::string> tests;
};

/// An effort's error is read beside the effort.
auto reported(const ErrorSummary& error, const std::string& unit) -> std::string {
  return error_text(error.rmse, unit) +
         (unit == "rad" ? "" : ", " + rounded(error.relative_percent, 3) + " % of the effort");
}

void print_diagnosis(const Diagnosis& d) {
  std::cout << "verdict: " << verdict_word(d.verdict) << "\n  " << d.reason << "\n";
  if (d.traces.measured.size() == 0) {
    return;
  }
  if (d.unnamed) {
    std::cout << "  " << d.unnamed->sentence << "\n";
  }
  std::cout << "  law: " << word_of(d.law.status) << "\n  error on rows set aside (RMSE): before "
            << reported(d.before, d.unit);
  std::cout << "; after " << reported(d.after, d.unit) << "; ratio 95 % [" << rounded(d.ratio_ci95[0], 3) << ", "
            << rounded(d.ratio_ci95[1], 3) << "]; noise floor " << rounded(d.noise_floor) << " " << d.unit << "\n"
            << law_table(d.law, d.undetermined);
  for (const auto& log : d.tested) {
    std::cout << "  error on " << log.name << " (RMSE): before " << reported(log.before, d.unit) << "; after "
              << reported(log.after, d.unit) << "\n";
  }
  if (d.next_experiment) {
    std::cout << "  next: " << *d.next_experiment << "\n";
  }
}

/// A law's coefficients belong to the joints that it names, in its order.
void couple_as(const JointFile& base, const std::string& file, LogOptions& logs) {
  if (base.coupled_to.empty()) {
    return;
  }
  if (!logs.coupled_to.empty() && logs.coupled_to != base.coupled_to) {
    std::vector<std::string> axes;
    for (const int axis : base.coupled_to) {
      axes.push_back(std::to_string(axis));
    }
    throw BadInput("the law of " + file + " is coupled to axis " + joined(axes) + "; leave --coupled-to out");
  }
  logs.coupled_to = base.coupled_to;
}

auto run_diagnose(const CommandOptions& options) -> int {
  AxisRequest request;
  request_target(options.target, options.base, request);
  DiagnoseOptions wanted;
  LogOptions logs_read = options.logs;
  if (options.base.ends_with(".toml")) {
    const JointFile base = read_joint_file(options.base);
    wanted.base_law = form_of(base);
    couple_as(base, options.base, logs_read);
    if (request.effort || request.force) {
      throw BadInput("the law of " + options.base + " explains a joint angle, and " + options.target +
                     " is an effort; leave --target out, or choose --base rigid_dynamics, pull_push or preisach");
    }
  }
  request.needs_torque = wanted.base_law ? wanted.base_law->has("tendon_elongation") : options.base == kDefaultModel;
  const auto logs = logs_read.read(request);
  wanted.base_model = options.base;
  if (!options.tests.empty()) {
    LogOptions tests = logs_read;
    tests.files = options.tests;
    wanted.test_logs = tests.read(request);
  }
  if (isatty(STDERR_FILENO) != 0) {
    wanted.progress = [](const std::string& what) { std::cerr << "... " << what << "\n"; };
  }
  Diagnosis diagnosis = diagnose(logs, wanted);
  print_diagnosis(diagnosis);
  if (!options.output.empty() && diagnosis.effort_law) {
    write_effort_file(options.output, *diagnosis.effort_law);
    std::cerr << "wrote " << options.output << " (" << diagnosis.effort_law->status << " law)\n";
    diagnosis.law_file = options.output;
  } else if (!options.output.empty() && !diagnosis.law.terms.empty()) {
    write_joint_file(options.output, diagnosis.law);
    std::cerr << "wrote " << options.output << " (" << word_of(diagnosis.law.status) << " law)\n";
    diagnosis.law_file = options.output;
  }
  if (!options.json.empty()) {
    write_text_file(options.json, diagnosis_json(diagnosis));
  }
  if (!options.report.empty()) {
    std::cerr << "wrote " << write_report(options.report, diagnosis) << "\n";
  }
  if (const std::string next = next_scenario(diagnosis); !options.next.empty() && !next.empty()) {
    write_text_file(options.next, next);
    std::cerr << "wrote " << options.next << "; capstan run --scenario " << options.next << "\n";
  }
  return is_refusal(diagnosis.verdict) ? kExitRefused : kExitDone;
}

}  // namespace

void add_diagnose(CLI::App& app, int& exit_status) {
  auto options = std::make_shared<CommandOptions>();
  CLI::App* command =
      app.add_subcommand("diagnose", "find what a law lacks, name it or say that it is unknown, add it");
  options->logs.add_to(*command, true);
  command->add_option(
      "--base", options->base,
      "law to start from: kinematic, pseudo_kinematic (default where torque is logged), tendon (two tendons with "
      "friction and pretension; takes the default's place where only it leaves no more than noise), "
      "rigid_dynamics (default where the target is an effort) or inertia, pull_push or preisach (joint torque "
      "from motor torque); or a joint file, whose law is fitted anew");
  command->add_option("--target", options->target,
                      "column to explain: the measured joint angle (default axis<N>/q2_rad), or an effort such as "
                      "axis0/tau_Nm or, with axis0/q1_m, axis0/tau_N; of a force law axis<N>/tau_out_Nm");
  command->add_option("--test", options->tests, "log that takes no part in fit or choice and is judged too; repeatable")
      ->allow_extra_args(false);
  command->add_option("--json", options->json, "write the diagnosis as JSON");
  command->add_option("--report", options->report, "folder for the HTML page and its pictures");
  command->add_option("--next", options->next,
                      "write the motion that would settle what stays open, as a scenario; the report has it too");
  command->add_option("-o,--output", options->output, "write the law with the effects added, for instance joint.toml");
  command->callback([options, &exit_status] { exit_status = run_diagnose(*options); });
}

}  // namespace capstan::tools
