// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/capstan/identify_force.hpp"

#include <filesystem>
#include <iomanip>
#include <iostream>

#include "capstan/tools/identify/force_section.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

auto read_logs(const LogOptions& options) -> std::vector<ForceLog> {
  const auto mappings = parse_mappings(options.maps);
  std::vector<ForceLog> logs;
  for (const auto& file : options.files) {
    const CsvLog log = CsvLog::read(file, mappings);
    for (const auto& warning : log.warnings()) {
      std::cerr << "warning: " << warning << "\n";
    }
    logs.push_back(read_force_log(log, options.axis));
  }
  return logs;
}

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

/// All of a few names, the first of many.
auto short_list(const std::vector<std::string>& names) -> std::string {
  constexpr std::size_t kShown = 8;
  if (names.size() <= kShown) {
    return joined(names);
  }
  const std::vector<std::string> shown(names.begin(), names.begin() + kShown);
  return joined(shown) + " and " + std::to_string(names.size() - kShown) + " more";
}

template <typename Fit>
auto deliver(const Fit& fit, const std::string& model, const std::string& output) -> int {
  print(fit, model);
  if (!fit.undetermined.empty()) {
    throw Refusal("the log can not determine " + short_list(fit.undetermined) + "; " + fit.cure +
                  (output.empty() ? "" : " (" + output + " was not written)"));
  }
  if (!output.empty()) {
    const std::string before = std::filesystem::exists(output) ? read_text_file(output) : "";
    write_text_file(output, with_force_section(before, force_section(fit)));
    std::cerr << "wrote " << output << "\n";
  }
  return kExitDone;
}

}  // namespace

auto identify_force(const LogOptions& options, const std::string& model, const std::string& output) -> int {
  const auto logs = read_logs(options);
  return model == "preisach" ? deliver(fit_preisach(logs), model, output) : deliver(fit_pull_push(logs), model, output);
}

}  // namespace capstan::tools
