// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "capstan/tools/commission/board_shell.hpp"
#include "capstan/tools/response/tuning.hpp"

namespace capstan::tools {

/// A person turns the motor, or the joint, by this angle and back, rad.
struct HandTurn {
  double angle_rad = 0.0;
  bool of_joint = false;
};

struct CommissionOptions {
  int axis = 0;
  double corridor_rad = 0.0;             ///< of the joint, either way from where it stands
  std::optional<double> inertia_kgm2;    ///< of motor and input pulley by the data sheet: tells wrong counts
  std::string key;                       ///< of maintenance, where the board has one
  bool saves = true;                     ///< at the end; with several joints commission_together does
  Wanted wanted = {};                    ///< of the gains
  std::optional<HandTurn> turn = {};     ///< tells counts per turn and their sign
  std::optional<double> weight_nm = {};  ///< torque of a known weight about the joint: tells the torque per current
  bool finds_ends = false;               ///< looks for end stops in the corridor
};

/// What was found, and which steps are over. Kept in a file, so that commissioning can be stopped and goes on.
struct Progress {
  std::optional<int> axis;         ///< whose it is ...
  std::string board;               ///< ... on what board, since the motor was shaken: JointConsole::mark
  std::optional<double> home_rad;  ///< where the joint stood then: the middle of the corridor
  std::vector<std::string> done;
  std::vector<std::pair<std::string, std::string>> set;     ///< parameters without the joint's name, and their values
  std::vector<std::pair<std::string, std::string>> before;  ///< the same of what is set for a while just now
  std::vector<std::string> found;                           ///< sentences for the report
  double inertia_kgm2 = 0.0;                                ///< of the motor as it was shaken
  double backward_nm = 0.0, forward_nm = 0.0;               ///< torque of a slow motion
  double reversal_rad = 0.0;  ///< of the motor, after a turn, until friction has gone over to the other way
  /// Throws BadInput: no such form.
  static auto parse(const std::string& text, const std::string& name) -> Progress;
  [[nodiscard]] auto text() const -> std::string;
  [[nodiscard]] auto is_done(const std::string& step) const -> bool;
};

/// Who is asked. All of it may be called before anything moves.
struct Operator {
  std::function<void(const std::string& text)> tell;
  std::function<bool(const std::string& question)> agrees;
  /// Whether the board was restarted since, and is the one that was commissioned: a person can know that, a script that
  /// asks nothing has to be told.
  std::function<bool(const std::string& question)> assures = [](const std::string&) { return false; };
  std::function<void(int axis, const Progress& progress)>
      keep;  ///< after every step, and ahead of a change for a while
};

/// What the report shows beside the sentences.
struct Commissioned {
  Progress progress;
  std::optional<Response> response;
  std::optional<Tuning> tuning;
};

/// Torque off, and parameters as they were before a run that was ended in the midst of a step. Throws Refusal where the
/// progress is another joint's, and nothing was changed.
void give_back(BoardShell& board, const Operator& person, const CommissionOptions& options, Progress& progress);

/// From a bare motor to a tuned joint, step by step: look (without torque), shake (encoder, current sensor, inertia),
/// press (tendons), travel (friction, a blocked joint), motor (the board's own `commission`), tune, check, save; where
/// they are asked for also turn (counts per turn, by hand), ends (end stops) and weigh (torque per current). Before
/// `ends` and `travel` the motor moves by less than 5 deg. Steps that are done are not done again, on the joint they
/// were done on. Throws Refusal with the step and a sentence with its cure; Stopped where no step had begun. However it
/// ends, torque is off; unless it ended well, gains and limits are those of before. Where it can not end itself, as
/// this program was killed or the board lost, the progress that was kept has them, and the next run gives them back.
auto commission(BoardShell& board, const Operator& person, const CommissionOptions& options, Progress progress)
    -> Commissioned;

/// Other gains for a joint that is commissioned, by the same steps: tune, check and `save`, which is asked for only
/// after the check. Ends as commission() does; there is no going on from the midst. Throws Refusal with a sentence,
/// too, where its board does not know what commissioning finds.
/// @pre nothing waits to be given back
auto retune(BoardShell& board, const Operator& person, const CommissionOptions& options) -> Commissioned;

/// Of joints that are commissioned and not saved: margins of each, all being under control, then `save`.
/// Throws Refusal with its sentence where a margin is lost; the gains of all are those of `before` then, and nothing is
/// saved.
/// @param before  lines of the board's `dump` before the first was commissioned
void commission_together(BoardShell& board, const Operator& person, const std::vector<CommissionOptions>& joints,
                         std::vector<Progress>& progress, const std::vector<std::string>& before);

/// machine.toml: what sets up the next board alike.
auto machine_file(const std::vector<CommissionOptions>& joints, const std::vector<Progress>& progress) -> std::string;
/// The page. Throws BadInput if the folder can not be written.
auto write_commission_report(const std::string& folder, const Commissioned& commissioned) -> std::string;

}  // namespace capstan::tools
