// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <iostream>
#include <memory>

#include "capstan/tools/capstan/commands.hpp"
#include "capstan/tools/capstan/options.hpp"
#include "capstan/tools/jobs/compare_job.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

struct CompareCommand {
  LogOptions healthy;
  std::vector<std::string> now;
  std::string base, target, json;
  TendonDrawing drawing;
};

void print_comparison(const Comparison& comparison) {
  std::cout << "compared by: " << joined(comparison.terms, " + ") << "\n";
  for (const auto& one : comparison.moved) {
    std::cout << "  " << moved_sentence(one) << "\n";
  }
  if (comparison.moved.empty()) {
    std::cout << (comparison.now.changed_at
                      ? "  the joint changed within the logs of now, so no one set of parameters is theirs\n"
                      : "  it is not certain that any parameter has moved\n");
  }
  if (comparison.pretension && comparison.healthy.pretension) {  // else it is among the sizes below
    std::cout << "  " << drift_sentence(*comparison.pretension) << "\n";
  }
  for (const auto& effect : comparison.came) {
    std::cout << "  " << effect.name << " has come\n";
  }
  for (const auto& size : comparison.now.sizes) {
    std::cout << "    " << size << "\n";
  }
  std::cout << comparison.now.base_model << " on the logs of now: " << verdict_word(comparison.now.verdict) << ". "
            << comparison.now.reason << "\n";
}

auto run_compare(const CompareCommand& options) -> int {
  if (options.now.empty()) {
    throw BadInput("the later logs are missing; write them after --: capstan compare HEALTHY... -- NOW...");
  }
  std::vector<std::string> all = options.healthy.files;
  all.insert(all.end(), options.now.begin(), options.now.end());
  refuse_repeats(all);
  CompareJob job{.healthy = options.healthy.job_logs(),
                 .now = read_logs(options.now, options.healthy.maps),
                 .base = options.base,
                 .target = options.target,
                 .drawing = options.drawing};
  if (isatty(STDERR_FILENO) != 0) {
    job.progress = [](const std::string& what) { std::cerr << "... " << what << "\n"; };
  }
  const Comparison comparison = compare(job, warn);
  print_comparison(comparison);
  if (!options.json.empty()) {
    write_text_file(options.json, comparison_json(comparison));
  }
  return kExitDone;
}

}  // namespace

void add_compare(CLI::App& app, int& exit_status) {
  auto options = std::make_shared<CompareCommand>();
  CLI::App* command = app.add_subcommand(
      "compare", "find what changed between earlier and later logs of a joint: capstan compare HEALTHY... -- NOW...");
  options->healthy.add_to(*command, true);
  command->add_option("--now", options->now, "later logs, as after --");
  command->add_option("--base", options->base,
                      "law to start from, as for diagnose, or the joint.toml of the joint's own angle law");
  add_drawing(*command, options->drawing);
  command->add_option("--target", options->target, "column to explain, as for diagnose");
  command->add_option("--json", options->json, "write the comparison as JSON");
  command->callback([options, &exit_status] { exit_status = run_compare(*options); });
}

}  // namespace capstan::tools
