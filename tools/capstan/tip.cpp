// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/tip/tip.hpp"

#include <iostream>
#include <memory>

#include "capstan/tools/capstan/commands.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/first_repeat.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

struct TipOptions {
  std::string log, output;
  std::vector<std::string> maps;
  std::vector<int> axes = {0, 1, 2};
  double pitch_to_jaw_m = 0.0;
  double jaw_m = 0.0;
  double offset_m = 0.0;
};

auto run_tip(const TipOptions& options) -> int {
  if (first_repeat(options.axes) != options.axes.end()) {
    throw BadInput("--wrist-axes names an axis twice; give pitch, right and left jaw, for instance 0 1 2");
  }
  const CsvLog log = CsvLog::read(options.log, parse_mappings(options.maps));
  WristInLog wrist;
  std::copy(options.axes.begin(), options.axes.end(), wrist.axes.begin());
  wrist.links.pitch_to_jaw_m = options.pitch_to_jaw_m;
  wrist.links.jaw_m = options.jaw_m;
  wrist.links.offset_m = options.offset_m;
  const TipTrack track = tips_of(log, wrist);
  constexpr std::array kJaws = {"right", "left"};
  for (std::size_t jaw = 0; jaw < kJaws.size(); ++jaw) {
    if (const auto& error = track.errors[jaw]) {
      std::cout << "tip of the " << kJaws[jaw] << " jaw: off by " << rounded(1e3 * error->rms_m) << " mm (RMSE), "
                << rounded(1e3 * error->largest_m) << " mm at most\n";
    }
  }
  if (options.output.empty() && !track.errors[0] && !track.errors[1]) {
    throw BadInput(options.log +
                   ": no jaw has both estimates (q2_est_rad) and measured angles (q2_rad) to compare; run 'capstan "
                   "replay' for estimates, or write the tips with -o FILE");
  }
  if (!options.output.empty()) {
    write_text_file(options.output, log.text_with(track.names, track.columns));
    std::cerr << "wrote " << options.output << "\n";
  }
  return kExitDone;
}

}  // namespace

void add_tip(CLI::App& app, int& exit_status) {
  auto options = std::make_shared<TipOptions>();
  CLI::App* command =
      app.add_subcommand("tip", "compute the positions of a wrist's jaws from a log's joint angles, and their error");
  command->add_option("LOG", options->log, "log of the wrist's three axes (CSV)")->required();
  command->add_option("--map", options->maps, "WANTED=COLUMN or \"WANTED=COLUMN*FACTOR\"; repeatable")
      ->allow_extra_args(false);
  command->add_option("--pitch-to-jaw", options->pitch_to_jaw_m, "m, from the pitch axis to the jaws' axis")
      ->required()
      ->check(CLI::Range(0.0, 0.5));
  command->add_option("--jaw", options->jaw_m, "m, from the jaws' axis to the tip")
      ->required()
      ->check(CLI::Range(1e-4, 0.5));
  command->add_option("--offset", options->offset_m, "m, of the tip along the jaws' axis")
      ->capture_default_str()
      ->check(CLI::Range(-0.1, 0.1));
  command->add_option("--wrist-axes", options->axes, "numbers of pitch, right and left jaw")
      ->expected(3)
      ->delimiter(',')
      ->check(CLI::Range(0, 999))
      ->capture_default_str();
  command->add_option("-o,--output", options->output, "the log with the tips appended");
  command->footer(
      "(6.12), from the pitch axis in its frame: x along the shaft, z along the pitch axis. Estimates (q2_est_rad) "
      "are\n"
      "compared with measured angles (q2_rad) where the log has both. Where a camera followed the jaws, columns\n"
      "tip_right/qw, qx, qy, qz (and tip_left/...), a jaw's frame in that of the pitch axis, become measured angles,\n"
      "which 'capstan identify --model wrist' takes.\n"
      "  capstan tip wrist.csv --pitch-to-jaw 0.009 --jaw 0.01 -o tips.csv");
  command->callback([options, &exit_status] { exit_status = run_tip(*options); });
}

}  // namespace capstan::tools
