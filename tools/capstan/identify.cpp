// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <iostream>
#include <memory>

#include "capstan/tools/capstan/commands.hpp"
#include "capstan/tools/capstan/identify_force.hpp"
#include "capstan/tools/capstan/identify_wrist.hpp"
#include "capstan/tools/capstan/options.hpp"
#include "capstan/tools/identify/force_catalogue.hpp"
#include "capstan/tools/jobs/identify_job.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

struct IdentifyOptions {
  LogOptions logs;
  std::string model = kDefaultModel;
  std::string target, output;
  PreisachGrid grid;
  std::vector<int> wrist = {0, 1, 2};
  TendonDrawing drawing;
};

/// A law that says the same throughout has none.
auto gof_text(double percent) -> std::string {
  return std::isfinite(percent) ? rounded(percent) + " %" : "none";
}

auto run_identify(const IdentifyOptions& options) -> int {
  if (options.model != "preisach" && (options.grid.levels != kPreisachLevels || options.grid.adaptive)) {
    throw BadInput("--levels and --adaptive-levels are of --model preisach; leave them out for " + options.model);
  }
  if (options.model == kWristModel) {
    return identify_wrist(options.logs, options.wrist, options.output);
  }
  if (is_force_law(options.model)) {
    return identify_force(options.logs, options.model, options.grid, options.output);
  }
  const Identified done = identify({options.logs.job_logs(), options.model, options.target, options.drawing}, warn);
  const Identification& result = done.result;
  for (const auto& note : result.notes) {
    std::cerr << "note: " << note << "\n";
  }
  std::cout << "model " << options.model << ", " << result.joint.fit->samples << " samples\n"
            << "  parameter                                 value  95 % interval              unit\n"
            << law_table(result.joint, result.undetermined);
  std::cout << "  error (RMSE) " << error_text(result.joint.fit->rmse, done.form.catalogue->target_unit())
            << ", goodness of fit " << gof_text(result.joint.fit->gof_percent) << "\n";
  if (result.joint.fit->pretension) {
    std::cout << "  " << pretension_sentence(*result.joint.fit->pretension) << "\n";
  }
  if (!result.undetermined.empty()) {
    throw Refusal(undetermined_sentence(result.undetermined) +
                  (options.output.empty() ? "" : " (" + options.output + " was not written)"));
  }
  if (!options.output.empty()) {
    write_text_file(options.output, law_text(done));
    std::cerr << "wrote " << options.output << "\n";
  }
  return kExitDone;
}

}  // namespace

void add_identify(CLI::App& app, int& exit_status) {
  auto options = std::make_shared<IdentifyOptions>();
  CLI::App* command = app.add_subcommand("identify", "fit a law to logs of one joint");
  options->logs.add_to(*command, true);
  command
      ->add_option("--model", options->model,
                   "law to fit: kinematic, pseudo_kinematic, pretensioned, dynamic, multi_dof, tendon; wrist: pitch "
                   "and both jaws at once; of the joint torque: "
                   "pull_push, blend (of pull and pull-push law), preisach; of an effort: "
                   "rigid_dynamics, inertia; or the joint.toml of a joint-angle law, which is fitted again")
      ->capture_default_str();
  command->add_option("--target", options->target,
                      "column to explain (default axis<N>/q2_rad; rigid_dynamics: axis<N>/tau_Nm, or tau_N with q1_m)");
  command
      ->add_option("--levels", options->grid.levels,
                   "of --model preisach: levels of its grid; a board holds 11 unless it was built for more")
      ->capture_default_str()
      ->check(CLI::Range(kFewestPreisachLevels, kMostPreisachLevels));
  command->add_flag("--adaptive-levels", options->grid.adaptive,
                    "of --model preisach: place the levels where the log needs them, tested on rows set aside");
  command
      ->add_option("--wrist-axes", options->wrist,
                   "of --model wrist: numbers of pitch, right and left jaw; the files are called FILE_axis<N>.toml")
      ->expected(3)
      ->delimiter(',')
      ->check(CLI::Range(0, kMostAxes - 1))
      ->capture_default_str();
  add_drawing(*command, options->drawing);
  command->add_option("-o,--output", options->output, "where to write the law, for instance joint.toml");
  command->callback([options, &exit_status] { exit_status = run_identify(*options); });
}

}  // namespace capstan::tools
