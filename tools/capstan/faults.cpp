// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "capstan/tools/campaign/campaign_report.hpp"
#include "capstan/tools/campaign/false_alarms.hpp"
#include "capstan/tools/capstan/commands.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

struct FaultOptions {
  bool all = false;
  bool fmea = false;
  bool tuned = false;
  std::optional<double> hours;
  std::uint64_t seed = 1;
  Drawn drawn = Drawn::kForcepsAndFinger;
};

auto run_faults(const FaultOptions& options) -> int {
  if (options.hours) {
    const FalseAlarms alarms =
        run_false_alarms(*options.hours, options.seed, 2, options.tuned ? Gains::kTuned : Gains::kDrawn, options.drawn);
    print_false_alarms(std::cout, alarms);
    return alarms.false_stops() == 0 ? kExitDone : kExitRefused;
  }
  const Campaign campaign = run_fault_campaign(options.all ? Extent::kLong : Extent::kShort);
  if (options.fmea) {
    std::vector<CampaignRow> rows = campaign.single;
    rows.insert(rows.end(), campaign.pairs.begin(), campaign.pairs.end());
    print_fmea(std::cout, rows);
  } else {
    print_campaign(std::cout, campaign);
  }
  const bool unsafe = std::any_of(campaign.single.begin(), campaign.single.end(),
                                  [](const CampaignRow& row) { return row.outcome == Outcome::kUnsafe; });
  return unsafe ? kExitRefused : kExitDone;
}

}  // namespace

void add_faults(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand(
      "faults", "inject every fault into every input of the firmware, and print how far the simulated joint moves");
  command->footer(
      "Exit status: 1 where a single fault is unsafe, as some are (docs/safety_concept.md lists them), or a "
      "healthy joint was stopped; else 0.");
  auto options = std::make_shared<FaultOptions>();
  CLI::Option* all =
      command->add_flag("--all", options->all, "every joint in every phase; takes an hour instead of minutes");
  CLI::Option* fmea = command->add_flag("--fmea", options->fmea, "the table of docs/safety_concept.md");
  CLI::Option* hours = command
                           ->add_option("--hours", options->hours,
                                        "instead: simulate healthy random joints for this many hours, and count false "
                                        "stops; five minutes for each joint, at least one")
                           ->check(CLI::Range(0.001, 1e5))
                           ->excludes(all)
                           ->excludes(fmea);
  command->add_option("--seed", options->seed, "with --hours: seed of the first random joint")->needs(hours);
  command
      ->add_flag("--tuned", options->tuned, "with --hours: gains as 'capstan tune' finds them instead of random ones")
      ->needs(hours);
  command
      ->add_option("--joints", options->drawn,
                   "with --hours: what they are drawn about: small (forceps and finger, the default), elbow or wrist")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, Drawn>{
              {"small", Drawn::kForcepsAndFinger}, {"elbow", Drawn::kElbow}, {"wrist", Drawn::kWrist}},
          CLI::ignore_case))
      ->needs(hours);
  command->callback([options, &exit_status] { exit_status = run_faults(*options); });
}

}  // namespace capstan::tools
