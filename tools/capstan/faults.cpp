// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iostream>

#include "tools/campaign/fault_campaign.hpp"
#include "tools/capstan/commands.hpp"
#include "tools/support/errors.hpp"

namespace capstan::tools {
namespace {

auto run_faults() -> int {
  const auto rows = run_fault_campaign();
  print_campaign(std::cout, rows);
  const bool unsafe = std::any_of(rows.begin(), rows.end(), [](const CampaignRow& row) {
    return row.impossible == nullptr && row.outcome == Outcome::kUnsafe;
  });
  return unsafe ? kExitRefused : kExitDone;
}

}  // namespace

void add_faults(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand(
      "faults", "break every input of the firmware in every way and state, and print where that ends");
  command->callback([&exit_status] { exit_status = run_faults(); });
}

}  // namespace capstan::tools
