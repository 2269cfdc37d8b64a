// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iostream>
#include <memory>

#include "capstan/tools/capstan/commands.hpp"
#include "capstan/tools/capstan/options.hpp"
#include "capstan/tools/identify/force_section.hpp"
#include "capstan/tools/jobs/replay_job.hpp"
#include "capstan/tools/joint_file/effort_file.hpp"
#include "capstan/tools/replay/effort_replay.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

struct ReplayOptions {
  LogOptions logs;
  std::string model;
  std::string arithmetic = "fixed";
  std::string output;
  bool axis_given = false;
};

/// A law of an effort as a board runs it: causal, in fixed point.
auto run_board_replay(const ReplayOptions& options, const CsvLog& csv, const EffortLaw& law) -> int {
  const BoardEffortReplay replayed = replay_board_effort(csv, options.logs.axis, law, options.model);
  std::for_each(replayed.log.warnings.begin(), replayed.log.warnings.end(), warn);
  write_text_file(options.output, replayed.text);
  const Eigen::Index inner = replayed.log.samples() - 2 * replayed.effort.delay;
  std::cout << "replayed " << replayed.log.samples() << " samples in fixed arithmetic, wrote " << options.output
            << "\n  error (RMSE) against " << replayed.log.target << " "
            << rounded(rms((replayed.log.effort - replayed.effort.law).segment(replayed.effort.delay, inner)))
            << " Nm, sample by sample; disturbance (RMS) " << rounded(rms(replayed.effort.disturbance)) << " Nm, "
            << replayed.effort.delay << " ms late\n";
  refuse_saturated(replayed.effort.saturated, options.model);
  return kExitDone;
}

/// A law of an effort explains one column by the motion: in double by that of the whole log. Its axis is the law's own
/// unless another is asked for.
auto run_effort_replay(ReplayOptions options) -> int {
  const EffortLaw law = read_effort_file(options.model);
  if (!options.axis_given) {
    options.logs.axis = axis_of_column(law.target);
  }
  const CsvLog csv = CsvLog::read(options.logs.files.front(), parse_mappings(options.logs.maps));
  if (options.arithmetic == "fixed") {
    return run_board_replay(options, csv, law);
  }
  const EffortReplay replayed = replay_effort(csv, options.logs.axis, law);
  std::for_each(replayed.log.warnings.begin(), replayed.log.warnings.end(), warn);
  write_text_file(options.output, replayed.text);
  std::cout << "replayed " << replayed.log.samples() << " samples in double arithmetic, wrote " << options.output
            << "\n";
  return kExitDone;
}

/// Torque of the joint by the file's force law, if it has one.
auto run_force_replay(const ReplayOptions& options, const CsvLog& csv, Arithmetic arithmetic, LogColumns& columns)
    -> std::string {
  const BoardForceLaw law = read_board_force_law(read_text_file(options.model), options.model);
  if (law.parameters.kind == ForceLawKind::kNone) {
    return "";
  }
  const Eigen::VectorXd torque = replay_torque(csv, options.logs.axis, law, arithmetic, warn);
  columns.add(axis_column(options.logs.axis, "tau_out_est_Nm"), torque);
  const std::string measured = axis_column(options.logs.axis, "tau_out_Nm");
  return csv.has(measured)
             ? "  error (RMSE) against " + measured + " " + rounded(rms(csv.column(measured) - torque)) + " Nm\n"
             : "";
}

auto run_angle_replay(const ReplayOptions& options, const CsvLog& csv, Arithmetic arithmetic) -> int {
  const JointFile joint = read_joint_file(options.model);
  const auto [rows, log, replayed] = replay_angle(csv, options.logs.axis, joint, arithmetic, warn);
  LogColumns columns = columns_of(options.logs.axis, replayed);
  const std::string force = run_force_replay(options, rows, arithmetic, columns);
  write_text_file(options.output, rows.text_with(columns.names, columns.values));
  std::cout << "replayed " << log.samples() << " samples in " << options.arithmetic << " arithmetic, wrote "
            << options.output << "\n";
  if (log.q2_rad.size() > 0) {
    std::cout << "  error (RMSE) against " << log.target << " " << rounded(rms(log.q2_rad - replayed.reported))
              << " rad\n";
  }
  std::cout << force;
  refuse_saturated(replayed.saturated, options.model);
  return kExitDone;
}

auto run_replay(const ReplayOptions& options) -> int {
  if (is_effort_file(options.model)) {
    return run_effort_replay(options);
  }
  const CsvLog csv = CsvLog::read(options.logs.files.front(), parse_mappings(options.logs.maps));
  const auto arithmetic = options.arithmetic == "fixed" ? Arithmetic::kFixed : Arithmetic::kDouble;
  if (!is_force_alone(read_text_file(options.model), options.model)) {
    return run_angle_replay(options, csv, arithmetic);
  }
  LogColumns columns;
  std::vector<std::string> notes;
  const CsvLog rows = force_rows(csv, options.logs.axis, notes);
  std::for_each(notes.begin(), notes.end(), warn);
  const std::string force = run_force_replay(options, rows, arithmetic, columns);
  write_text_file(options.output, rows.text_with(columns.names, columns.values));
  std::cout << "replayed " << rows.rows() << " samples in " << options.arithmetic << " arithmetic, wrote "
            << options.output << "\n"
            << force;
  return kExitDone;
}

}  // namespace

void add_replay(CLI::App& app, int& exit_status) {
  auto options = std::make_shared<ReplayOptions>();
  CLI::App* command = app.add_subcommand("replay", "run a law over a log and append its estimates as columns");
  options->logs.add_to(*command, false);
  command->add_option("--model", options->model, "the law, a joint.toml")->required();
  command->add_option("--arithmetic", options->arithmetic, "fixed: the firmware's, at 1 kHz; double: any rate")
      ->capture_default_str()
      ->check(CLI::IsMember({"fixed", "double"}));
  command->add_option("-o,--output", options->output, "log to write")->required();
  command->callback([options, command, &exit_status] {
    options->axis_given = command->count("--axis") > 0;
    exit_status = run_replay(*options);
  });
}

}  // namespace capstan::tools
