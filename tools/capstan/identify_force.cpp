// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/capstan/identify_force.hpp"

#include <algorithm>
#include <filesystem>
#include <iomanip>
#include <iostream>

#include "capstan/tools/identify/force_section.hpp"
#include "capstan/tools/jobs/identify_job.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

void print(const ForceFit& fit, const std::string& model) {
  for (const auto& note : fit.notes) {
    std::cerr << "note: " << note << "\n";
  }
  std::cout << "model " << model << ", " << fit.samples << " samples\n"
            << "  parameter                                 value  95 % interval              unit\n";
  for (const auto& p : fit.parameters) {
    const bool known = std::find(fit.undetermined.begin(), fit.undetermined.end(), p.name) == fit.undetermined.end();
    const std::string interval = p.half_interval > 0.0 && known ? "[" + rounded(p.value - p.half_interval) + ", " +
                                                                      rounded(p.value + p.half_interval) + "]"
                                                                : "";
    std::cout << "  " << std::left << std::setw(34) << p.name << std::right << std::setw(13)
              << (known ? rounded(p.value, 5) : "?") << "  " << std::left << std::setw(25) << interval << " " << p.unit
              << "\n";
  }
  std::cout << "  error (RMSE) " << rounded(fit.rmse_nm) << " Nm, "
            << rounded(100.0 * fit.rmse_nm / fit.full_scale_nm, 3) << " % of " << rounded(fit.full_scale_nm) << " Nm\n";
}

}  // namespace

auto identify_force(const LogOptions& options, const std::string& model, const PreisachGrid& grid,
                    const std::string& output) -> int {
  const IdentifiedForce done = identify_force(options.job_logs(), model, warn, grid);
  print(done.fit, model);
  if (!done.fit.undetermined.empty()) {
    throw Refusal(undetermined_sentence(done.fit) + (output.empty() ? "" : " (" + output + " was not written)"));
  }
  if (!output.empty()) {
    const std::string before = std::filesystem::exists(output) ? read_text_file(output) : "";
    write_text_file(output, with_force_section(before, done.section));
    std::cerr << "wrote " << output << "\n";
  }
  return kExitDone;
}

}  // namespace capstan::tools
