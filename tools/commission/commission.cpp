// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/commission/commission.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "capstan/tools/commission/steps.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

auto always(const CommissionOptions& /*options*/) -> bool {
  return true;
}

struct Step {
  const char* name;
  bool moves;
  const char* explains;
  void (*run)(CommissionSteps& steps);
  bool (*wanted)(const CommissionOptions& options) = always;
};

constexpr std::array<Step, 11> kSteps = {{
    {"look", false, "reads encoder and current sensor for a second, without torque", &CommissionSteps::look},
    {"turn", false,
     "you turn it by hand and back, without torque; compares what the encoder counts with motor.encoder_counts and its "
     "sign",
     &CommissionSteps::turn, [](const CommissionOptions& options) { return options.turn.has_value(); }},
    {"shake", true,
     "shakes the motor by less than 5 deg in open loop and checks that the encoder counts, in which direction, and "
     "that the current sensor measures the torque",
     &CommissionSteps::shake},
    {"press", true, "presses the motor slowly both ways by less than 5 deg and checks that both tendons pull",
     &CommissionSteps::press},
    {"ends", true,
     "moves the joint to both ends of the corridor in small steps, with little more torque than its friction takes, "
     "and looks for end stops on the way",
     &CommissionSteps::ends, [](const CommissionOptions& options) { return options.finds_ends; }},
    {"travel", true,
     "moves the joint slowly within the corridor, measures friction both ways and checks that it moves freely",
     &CommissionSteps::travel},
    {"weigh", true,
     "moves the joint slowly with your weight on it; what that changes of the torque both ways tells the torque per "
     "current",
     &CommissionSteps::weigh, [](const CommissionOptions& options) { return options.weight_nm.has_value(); }},
    {"motor", true, "runs the board's own commissioning, which finds the motor observer's values",
     &CommissionSteps::motor},
    {"tune", true,
     "shakes the joint while it travels, for about two minutes, and computes gains with margins from the response",
     &CommissionSteps::tune_gains},
    {"check", true, "compares the new gains with the old ones by a step and a sine", &CommissionSteps::check},
    {"save", false, "saves the values found", &CommissionSteps::save,
     [](const CommissionOptions& options) { return options.saves; }},
}};

constexpr const char* kAnew = "start again with --again, or give this joint a --state of its own";

/// Of another joint nothing may be taken for this one's.
void require_own(JointConsole& joint, const Progress& progress) {
  if (progress.axis && *progress.axis != joint.axis()) {
    throw Refusal("the recorded progress is of joint" + std::to_string(*progress.axis) + ", and this is " +
                  joint.name() + "; give each joint a --state of its own");
  }
  if (const std::string mark = joint.mark(progress.set); !progress.board.empty() && progress.board != mark) {
    throw Refusal("the recorded progress is of another joint or another scale (" + progress.board +
                  "), and this is one of " + mark + "; " + kAnew);
  }
}

/// What a run before this one had found; a board that was restarted does not have it, nor has another one.
void put_back(JointConsole& joint, const Operator& person, const Progress& progress) {
  std::vector<std::pair<std::string, std::string>> known = progress.set;
  if (!progress.is_done("check")) {
    // Nobody has seen yet whether these gains are any good.
    std::erase_if(known, [](const auto& one) { return one.first.starts_with("control."); });
  }
  const std::string other = joint.first_other(known);
  if (other.empty()) {
    return;
  }
  const std::string differs = joint.name() + "." + other + " is " + joint.text(other) +
                              ", which is not what was found in the steps that are done";
  if (progress.is_done("save")) {
    throw Refusal(differs + " and saved: it is another board, or was changed since; " + kAnew);
  }
  if (!person.assures(differs + ": was the board restarted since, and is it the same joint?")) {
    throw Refusal(differs +
                  ": it is another board, or was restarted or changed since; if it was restarted and is the "
                  "same say so (--restarted), otherwise " +
                  kAnew);
  }
  joint.set_together(known);
}

/// What is kept of one joint: the steps that are over, and what parameters were before the one under way.
class Kept {
 public:
  Kept(const Operator& person, int axis, Progress progress)
      : person_(person), axis_(axis), progress_(std::move(progress)) {}

  auto before() -> std::function<void(const JointConsole::Parameters&)> {
    return [this](const JointConsole::Parameters& before) {
      if (before != progress_.before) {
        progress_.before = before;
        person_.keep(axis_, progress_);
      }
    };
  }
  void keep(const Progress& progress) {
    progress_ = progress;
    person_.keep(axis_, progress_);
  }

 private:
  const Operator& person_;
  int axis_;
  Progress progress_;
};

/// Steps that belong together.
struct Sequence {
  std::span<const Step> steps;
  const char* when_stopped;  ///< what is to be said of that
};
constexpr Sequence kAll{kSteps, "; the same command continues from here"};
constexpr Sequence kGains{std::span(kSteps).last<3>(), "; the gains are those of before"};

/// What follows from a step must not be older than it.
void require_in_order(const Step& step, std::span<const Step> later, const Progress& progress) {
  for (const Step& one : later) {
    if (progress.is_done(one.name)) {
      throw Refusal(std::string(step.name) + ": comes ahead of '" + one.name +
                    "', which is done already; start again with --again");
    }
  }
}

/// Those that are wanted and not done yet. Throws Refusal with the step's name.
void run_steps(const Sequence& sequence, const Operator& person, JointConsole& joint, CommissionSteps& steps,
               const Progress& progress, const std::function<void(const Step&)>& is_over) {
  for (std::size_t i = 0; i < sequence.steps.size(); ++i) {
    const Step& step = sequence.steps[i];
    if (!step.wanted(steps.options())) {
      continue;
    }
    if (progress.is_done(step.name)) {
      person.tell(std::string(step.name) + ": done before");
      continue;
    }
    require_in_order(step, sequence.steps.subspan(i + 1), progress);
    person.tell(std::string(step.name) + ": " + step.explains);
    const auto end = [&step](const std::string& why) { throw Refusal(std::string(step.name) + ": " + why); };
    if (step.moves && !person.agrees("may the joint move?")) {
      end(std::string(Stopped().what()) + sequence.when_stopped);
    }
    try {
      step.run(steps);
      joint.restore();
    } catch (const Refusal& refusal) {
      joint.restore();
      end(refusal.what());
    } catch (const Stopped& stopped) {
      joint.restore();
      end(std::string(stopped.what()) + sequence.when_stopped);
    }
    is_over(step);
  }
}

/// What the board of a commissioned joint knows of it. Throws Refusal where it does not.
auto known_of(const JointConsole& joint, const CommissionOptions& options) -> Progress {
  constexpr double kPerGm2 = 1e-3;
  Progress known;
  known.inertia_kgm2 = options.inertia_kgm2.value_or(kPerGm2 * joint.value("observer.inertia"));
  known.backward_nm = joint.value("control.torque_backward");
  known.forward_nm = joint.value("control.torque_forward");
  known.reversal_rad = joint.value("control.reversal_angle");
  const bool knows_friction = known.forward_nm > known.backward_nm;
  if (known.inertia_kgm2 <= 0.0 || !knows_friction) {
    throw Refusal(joint.name() + " is not commissioned (" +
                  (knows_friction ? "observer.inertia is 0" : "control.torque_forward and torque_backward are 0") +
                  "): nobody has checked its wiring, and how hard it may be shaken is not known; run 'capstan "
                  "commission' first" +
                  (knows_friction ? ", or give --inertia if its board cannot find that value" : ""));
  }
  return known;
}

}  // namespace

auto Progress::parse(const std::string& text, const std::string& name) -> Progress {
  Progress progress;
  std::size_t begin = 0;
  int number = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    begin = end + 1;
    const std::size_t blank = std::min(line.find(' '), line.size());
    const std::string word = line.substr(0, blank);
    const std::string rest = blank < line.size() ? line.substr(blank + 1) : "";
    const std::size_t equals = rest.find('=');
    ++number;
    if (number == 1 && line == "capstan.commission/2") {
      continue;
    }
    if (number > 1 && word == "axis" && parse_number(rest)) {
      progress.axis = static_cast<int>(*parse_number(rest));
    } else if (number > 1 && word == "board") {
      progress.board = rest;
    } else if (number > 1 && word == "home" && parse_number(rest)) {
      progress.home_rad = *parse_number(rest);
    } else if (number > 1 && word == "done") {
      progress.done.push_back(rest);
    } else if (number > 1 && word == "found") {
      progress.found.push_back(rest);
    } else if (number > 1 && word == "inertia" && parse_number(rest)) {
      progress.inertia_kgm2 = *parse_number(rest);
    } else if (number > 1 && word == "backward" && parse_number(rest)) {
      progress.backward_nm = *parse_number(rest);
    } else if (number > 1 && word == "forward" && parse_number(rest)) {
      progress.forward_nm = *parse_number(rest);
    } else if (number > 1 && word == "reversal" && parse_number(rest)) {
      progress.reversal_rad = *parse_number(rest);
    } else if (number > 1 && (word == "set" || word == "before") && equals != std::string::npos) {
      (word == "set" ? progress.set : progress.before).emplace_back(rest.substr(0, equals), rest.substr(equals + 1));
    } else {
      throw BadInput(
          name + ":" + std::to_string(number) +
          ": is not a progress file of 'capstan commission'; give another --state, or delete the file to start again");
    }
  }
  return progress;
}

auto Progress::text() const -> std::string {
  std::string text = "capstan.commission/2\n";
  text += axis ? "axis " + std::to_string(*axis) + "\n" : "";
  text += board.empty() ? "" : "board " + board + "\n";
  text += home_rad ? "home " + exact(*home_rad) + "\n" : "";
  for (const std::string& step : done) {
    text += "done " + step + "\n";
  }
  text += "inertia " + exact(inertia_kgm2) + "\nbackward " + exact(backward_nm) + "\nforward " + exact(forward_nm) +
          "\nreversal " + exact(reversal_rad) + "\n";
  for (const auto& [name, value] : set) {
    text += "set " + name + "=" + value + "\n";
  }
  for (const auto& [name, value] : before) {
    text += "before " + name + "=" + value + "\n";
  }
  for (const std::string& sentence : found) {
    text += "found " + sentence + "\n";
  }
  return text;
}

auto Progress::is_done(const std::string& step) const -> bool {
  return std::find(done.begin(), done.end(), step) != done.end();
}

auto commission(BoardShell& board, const Operator& person, const CommissionOptions& options, Progress progress)
    -> Commissioned {
  give_back(board, person, options, progress);
  progress.axis = options.axis;
  Commissioned all{.progress = std::move(progress), .response = {}, .tuning = {}};
  Kept kept(person, options.axis, all.progress);
  JointConsole joint(board, options.axis, options.key, kept.before());
  CommissionSteps steps(joint, person, options, all);
  put_back(joint, person, all.progress);
  const std::size_t steps_here = options.saves ? kSteps.size() : kSteps.size() - 1;
  run_steps({kAll.steps.first(steps_here), kAll.when_stopped}, person, joint, steps, all.progress,
            [&](const Step& step) {
              if (step.moves) {
                all.progress.board = joint.mark({});
              }
              all.progress.done.emplace_back(step.name);
              kept.keep(all.progress);
            });
  return all;
}

auto retune(BoardShell& board, const Operator& person, const CommissionOptions& options) -> Commissioned {
  Commissioned all{.progress = {}, .response = {}, .tuning = {}};
  Kept kept(person, options.axis, {});
  JointConsole joint(board, options.axis, options.key, kept.before());
  all.progress = known_of(joint, options);
  all.progress.axis = options.axis;
  all.progress.board = joint.mark({});
  kept.keep(all.progress);
  CommissionSteps steps(joint, person, options, all);
  run_steps(kGains, person, joint, steps, all.progress, [](const Step&) {});
  return all;
}

void give_back(BoardShell& board, const Operator& person, const CommissionOptions& options, Progress& progress) {
  JointConsole joint(board, options.axis, options.key, [](const auto&) {});
  require_own(joint, progress);
  if (progress.before.empty()) {
    return;
  }
  person.tell("restores the settings that an interrupted run had changed temporarily");
  joint.set_together(progress.before);
  progress.before.clear();
  person.keep(options.axis, progress);
}

void commission_together(BoardShell& board, const Operator& person, const std::vector<CommissionOptions>& joints,
                         std::vector<Progress>& progress, const std::vector<std::string>& before) {
  std::string why;
  try {
    for (std::size_t i = 0; i < joints.size(); ++i) {
      Commissioned all{.progress = progress[i], .response = {}, .tuning = {}};
      Kept kept(person, joints[i].axis, all.progress);
      JointConsole joint(board, joints[i].axis, joints[i].key, kept.before());
      CommissionSteps steps(joint, person, joints[i], all);
      person.tell("together: shakes " + joint.name() + " while it travels and the others hold, for about two minutes");
      if (!person.agrees("may the joint move?")) {
        throw Refusal("stopped on request, torque is off");
      }
      CommissionSteps::together(steps);
      joint.restore();
      if (i + 1 == joints.size()) {
        CommissionSteps::save(steps);
      }
      progress[i] = all.progress;
    }
    return;
  } catch (const Refusal& refusal) {
    why = refusal.what();
  } catch (const Stopped& stopped) {
    why = stopped.what();
  }
  board.ask("begin");
  for (const CommissionOptions& one : joints) {
    for (const std::string& line : before) {
      if (line.starts_with("set joint" + std::to_string(one.axis) + ".control.")) {
        board.ask(line);
      }
    }
  }
  board.ask("commit");
  throw Refusal("together: " + why + "; the previous gains were restored, nothing was saved");
}

}  // namespace capstan::tools
