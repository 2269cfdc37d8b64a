// SPDX-License-Identifier: Apache-2.0
// `commission`: from a bare motor to a tuned joint, on a board or on a simulated one.
#include <filesystem>
#include <iostream>
#include <memory>
#include <numbers>

#include "capstan/tools/capstan/attended_board.hpp"
#include "capstan/tools/capstan/commands.hpp"
#include "capstan/tools/commission/commission.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/first_repeat.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

struct CommissionCommand {
  std::vector<int> axes = {0};
  double corridor_rad = 0.0;
  std::vector<double> inertia_gm2;
  std::string port, key, state = "commission.txt", report, machine = "machine.toml";
  std::uint64_t seed = 1;
  double turn_motor_deg = 0.0, turn_joint_deg = 0.0, weight_g = 0.0, arm_mm = 0.0;
  bool find_ends = false;
  bool yes = false, again = false, restarted = false, without_inertia = false;
  bool state_given = false, machine_given = false;
};

/// One file a joint.
auto state_of(const CommissionCommand& options, int axis) -> std::string {
  return !options.state_given       ? with_joint(options.state, axis)
         : options.axes.size() == 1 ? options.state
                                    : options.state + ".joint" + std::to_string(axis);
}

auto machine_of(const CommissionCommand& options) -> std::string {
  return options.machine_given || options.axes.size() > 1 ? options.machine
                                                          : with_joint(options.machine, options.axes[0]);
}

auto progress_of(const CommissionCommand& options, int axis) -> Progress {
  const std::string state = state_of(options, axis);
  if (!std::filesystem::exists(state)) {
    return {};
  }
  if (!options.again) {
    return Progress::parse(read_text_file(state), state);
  }
  Progress anew;
  try {
    Progress kept = Progress::parse(read_text_file(state), state);
    if (!kept.before.empty()) {  // that joint of that board still waits for it
      anew.axis = kept.axis;
      anew.before = std::move(kept.before);
    }
  } catch (const BadInput&) {
    // Anew, whatever the file says.
  }
  return anew;
}

auto turn_of(const CommissionCommand& options) -> std::optional<HandTurn> {
  if (options.turn_motor_deg == 0.0 && options.turn_joint_deg == 0.0) {
    return {};
  }
  if (options.turn_motor_deg != 0.0 && options.turn_joint_deg != 0.0) {
    throw BadInput("--turn-motor and --turn-joint are two ways to the same; give one");
  }
  const bool of_joint = options.turn_joint_deg != 0.0;
  return HandTurn{.angle_rad = std::numbers::pi / 180.0 * (of_joint ? options.turn_joint_deg : options.turn_motor_deg),
                  .of_joint = of_joint};
}

auto weight_of(const CommissionCommand& options) -> std::optional<double> {
  constexpr double kGravity = 9.81;  // m/s2
  if (options.weight_g == 0.0 && options.arm_mm == 0.0) {
    return {};
  }
  if (options.weight_g == 0.0 || options.arm_mm == 0.0) {
    throw BadInput("--weight and --arm go together; give the mass in g and its distance from the joint's axis in mm");
  }
  return 1e-6 * options.weight_g * options.arm_mm * kGravity;
}

auto joints_of(const CommissionCommand& options) -> std::vector<CommissionOptions> {
  if (first_repeat(options.axes) != options.axes.end()) {
    throw BadInput("--axis names a joint twice; give each once, for instance 0,1,2");
  }
  const std::size_t inertias = options.inertia_gm2.size();
  if (inertias > 1 && inertias != options.axes.size()) {
    throw BadInput("--inertia has " + std::to_string(inertias) + " values for " + std::to_string(options.axes.size()) +
                   " joints; give one for each, or one for all");
  }
  std::vector<CommissionOptions> joints;
  for (std::size_t i = 0; i < options.axes.size(); ++i) {
    joints.push_back({.axis = options.axes[i],
                      .corridor_rad = options.corridor_rad,
                      .inertia_kgm2 = {},
                      .key = options.key,
                      .saves = options.axes.size() == 1,
                      .turn = turn_of(options),
                      .weight_nm = weight_of(options),
                      .finds_ends = options.find_ends});
    if (inertias > 0) {
      joints.back().inertia_kgm2 = 1e-3 * options.inertia_gm2[inertias == 1 ? 0 : i];
    }
  }
  return joints;
}

/// @param progress  of each joint before
void commission_joints(BoardShell& line, const CommissionCommand& options, const std::vector<CommissionOptions>& joints,
                       std::vector<Progress> progress) {
  const Operator person{
      .tell = [](const std::string& text) { std::cerr << text << "\n"; },
      .agrees = [&options](const std::string& question) { return agrees(options.yes, question); },
      .assures =
          [&options](const std::string& question) {
            return options.restarted || (!options.yes && agrees(false, question));
          },
      .keep = [&options](int axis, const Progress& now) { write_text_file(state_of(options, axis), now.text()); }};
  for (std::size_t i = 0; i < joints.size(); ++i) {
    give_back(line, person, joints[i], progress[i]);
  }
  const std::vector<std::string> before = joints.size() > 1 ? line.ask("dump") : std::vector<std::string>{};
  std::vector<Commissioned> commissioned;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    commissioned.push_back(commission(line, person, joints[i], std::move(progress[i])));
    progress[i] = commissioned.back().progress;
  }
  if (joints.size() > 1) {
    commission_together(line, person, joints, progress, before);
  }
  for (std::size_t i = 0; i < joints.size(); ++i) {
    commissioned[i].progress = progress[i];
    if (!options.report.empty()) {
      const std::string folder = options.report + (joints.size() == 1 ? "" : "/joint" + std::to_string(joints[i].axis));
      const std::string page = write_commission_report(folder, commissioned[i]);
      std::cerr << "wrote " << page << "\n";
    }
  }
  write_text_file(machine_of(options), machine_file(joints, progress));
  std::cerr << "wrote " << machine_of(options) << "\n";
}

/// Nothing else tells counts and torque per current that are wrong by a factor of 2.
void require_inertia(const CommissionCommand& options) {
  if (!options.inertia_gm2.empty() || options.without_inertia) {
    return;
  }
  const std::string warning =
      "WARNING: without --inertia nothing compares motor.encoder_counts and motor.torque_per_current with the motor: "
      "if "
      "one is wrong by a factor, gains, speed, torque and the corridor will be wrong by it, and nobody will notice";
  if (options.yes) {
    throw BadInput(warning + "; give the data sheet's --inertia, or say --without-inertia");
  }
  std::cerr << warning << "\n";
  if (!agrees(options.yes, "are both right for certain?")) {
    throw Refusal("nothing was begun; give the data sheet's --inertia");
  }
}

auto run_commission(const CommissionCommand& options) -> int {
  const std::vector<CommissionOptions> joints = joints_of(options);
  require_inertia(options);
  std::vector<Progress> progress;
  for (const CommissionOptions& joint : joints) {
    if (same_file(state_of(options, joint.axis), machine_of(options))) {
      throw BadInput("--state and --machine would write the same file " + machine_of(options) +
                     "; give each its own name");
    }
    progress.push_back(progress_of(options, joint.axis));
  }
  std::unique_ptr<BoardShell> line;
  if (options.port.empty()) {
    std::cerr << "no port: this is the simulated forceps\n";
    sim::Scenario scenario;
    scenario.seed = options.seed;
    line = std::make_unique<SimShell>(scenario);
  } else {
    line = open_board(options.port);
  }
  try {
    commission_joints(*line, options, joints, std::move(progress));
  } catch (const Stopped& stopped) {
    throw Refusal(std::string(stopped.what()) + "; the same command continues from here");
  }
  return kExitDone;
}

}  // namespace

void add_commission(CLI::App& app, int& exit_status) {
  auto options = std::make_shared<CommissionCommand>();
  CLI::App* command =
      app.add_subcommand("commission", "commission a joint from a bare motor to tuned gains, step by step");
  command->add_option("port", options->port,
                      "the board's shell: tcp:PORT, or its serial device; without it the simulated forceps");
  command
      ->add_option("--axis", options->axes,
                   "joint of the board, or several (0,1,2): one after the other, then all together, then saved")
      ->delimiter(',')
      ->check(CLI::Range(0, 3));
  command
      ->add_option("--corridor", options->corridor_rad,
                   "rad: how far the joint may move either way from its position at the start")
      ->required()
      ->check(CLI::Range(0.1, 3.0));
  command
      ->add_option("--inertia", options->inertia_gm2,
                   "g m2 of motor and gear at the input pulley by the data sheet, of each joint or one for all; "
                   "without it a wrong encoder resolution is not detected")
      ->delimiter(',')
      ->check(CLI::Range(1e-6, 1e6));
  command->add_flag("--without-inertia", options->without_inertia,
                    "the inertia is not known, and counts and torque per current are certain");
  command
      ->add_option("--turn-motor", options->turn_motor_deg,
                   "deg by which you turn the motor's pulley by hand when asked, and back: tells encoder counts per "
                   "turn and their sign; 360 is good")
      ->check(CLI::Range(30.0, 36000.0));
  command
      ->add_option("--turn-joint", options->turn_joint_deg,
                   "deg by which you turn the joint instead: tells the sign and counts that are wrong by a factor")
      ->check(CLI::Range(20.0, 360.0));
  command
      ->add_option("--weight", options->weight_g,
                   "g that you hang on the joint when asked: tells the torque per current; with --arm")
      ->check(CLI::Range(0.1, 1e5));
  command
      ->add_option("--arm", options->arm_mm,
                   "mm from the joint's axis to the weight: of an arm that is level in the middle of the corridor, or "
                   "the radius of a drum with a thread")
      ->check(CLI::Range(0.1, 1e4));
  command->add_flag("--find-ends", options->find_ends,
                    "look for end stops in the corridor, with little more torque than friction takes, and set the "
                    "limits of joint and motor there");
  command->add_option("--key", options->key, "maintenance key, if one is set on the board");
  const CLI::Option* state =
      command
          ->add_option("--state", options->state,
                       "file that records the steps done; without it the joint's name is put into the name")
          ->capture_default_str();
  command->add_flag("--again", options->again, "start again, whatever the file says");
  command->add_flag("--restarted", options->restarted,
                    "the board lost its power meanwhile, and is the one that was commissioned");
  command->add_option("--report", options->report, "folder for the report page");
  const CLI::Option* machine =
      command
          ->add_option(
              "--machine", options->machine,
              "file with the settings found, to set up another board; without it the name of a single joint is "
              "put into the name")
          ->capture_default_str();
  command->add_option("--seed", options->seed, "seed of the simulated forceps");
  command->add_flag("--yes", options->yes, "for scripts: answer yes to every question");
  command->callback([options, state, machine, &exit_status] {
    options->state_given = state->count() > 0;
    options->machine_given = machine->count() > 0;
    exit_status = run_commission(*options);
  });
}

}  // namespace capstan::tools
