// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <iostream>
#include <memory>
#include <numbers>

#include "tools/capstan/commands.hpp"
#include "tools/capstan/options.hpp"
#include "tools/diagnose/diagnosis.hpp"
#include "tools/identify/identify.hpp"
#include "tools/report/report.hpp"
#include "tools/support/errors.hpp"
#include "tools/support/text.hpp"

namespace capstan::tools {
namespace {

struct CommandOptions {
  LogOptions logs;
  std::string base, target, json, report, output;
};

auto degrees(double rad) -> std::string {
  return rounded(rad * 180.0 / std::numbers::pi, 3);
}

void print_diagnosis(const Diagnosis& d) {
  std::cout << "verdict: " << verdict_word(d.verdict) << "\n  " << d.reason << "\n";
  if (d.traces.measured.size() == 0) {
    return;
  }
  std::cout << "  error on rows set aside (RMSE): before " << rounded(d.before.rmse) << " rad ("
            << degrees(d.before.rmse) << " deg)";
  if (!d.effects.empty()) {
    std::cout << ", after " << rounded(d.after.rmse) << " rad (" << degrees(d.after.rmse) << " deg), ratio 95 % ["
              << rounded(d.ratio_ci95[0], 3) << ", " << rounded(d.ratio_ci95[1], 3) << "]";
  }
  std::cout << "; noise floor " << rounded(d.noise_floor) << " rad\n" << law_table(d.law, {});
  if (d.next_experiment) {
    std::cout << "  next: " << *d.next_experiment << "\n";
  }
}

void check_target(const std::string& target) {
  for (const char* unit : {"_Nm", "_N", "_A", "_V"}) {
    if (target.ends_with(unit)) {
      throw Refusal("the target " + target +
                    " is an effort; this version diagnoses joint angles, such as axis0/q2_rad");
    }
  }
}

auto run_diagnose(const CommandOptions& options) -> int {
  check_target(options.target);
  AxisRequest request;
  request.target = options.target;
  request.needs_torque = options.base == kDefaultModel;
  const auto logs = options.logs.read(request);
  DiagnoseOptions wanted;
  wanted.base_model = options.base;
  if (isatty(STDERR_FILENO) != 0) {
    wanted.progress = [](const std::string& what) { std::cerr << "... " << what << "\n"; };
  }
  const Diagnosis diagnosis = diagnose(logs, wanted);
  print_diagnosis(diagnosis);
  if (!options.json.empty()) {
    write_text_file(options.json, diagnosis_json(diagnosis));
  }
  if (!options.report.empty()) {
    std::cerr << "wrote " << write_report(options.report, diagnosis) << "\n";
  }
  if (!options.output.empty() && !diagnosis.law.terms.empty()) {
    write_joint_file(options.output, diagnosis.law);
    std::cerr << "wrote " << options.output << (diagnosis.effects.empty() ? " (the base law: no effect was added)" : "")
              << "\n";
  }
  return is_refusal(diagnosis.verdict) ? kExitRefused : kExitDone;
}

}  // namespace

void add_diagnose(CLI::App& app, int& exit_status) {
  auto options = std::make_shared<CommandOptions>();
  CLI::App* command =
      app.add_subcommand("diagnose", "find what a law lacks, name it or say that it is unknown, add it");
  options->logs.add_to(*command, true);
  command->add_option("--base", options->base,
                      "law to start from: kinematic or pseudo_kinematic (default where torque is logged)");
  command->add_option("--target", options->target, "column with the measured joint angle (default axis<N>/q2_rad)");
  command->add_option("--json", options->json, "write the diagnosis as JSON");
  command->add_option("--report", options->report, "folder for the HTML page and its pictures");
  command->add_option("-o,--output", options->output, "write the law with the effects added, for instance joint.toml");
  command->callback([options, &exit_status] { exit_status = run_diagnose(*options); });
}

}  // namespace capstan::tools
