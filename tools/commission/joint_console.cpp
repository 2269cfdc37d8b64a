// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/commission/joint_console.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <utility>

#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

constexpr int kMostLooks = 60;  // of half a second, until a motor has come to rest
constexpr int kMostDisarms = 3;
constexpr double kStillCounts = 2.5;
/// A board rounds what it is told: to a thousandth, or to a millionth of the unit.
constexpr double kRoundedShare = 1e-3, kRounded = 1e-6;

auto number_of(const std::string& value) -> double {
  return parse_number(value.substr(0, value.find(' '))).value_or(0.0);
}

}  // namespace

JointConsole::JointConsole(BoardShell& board, int axis, std::string key,
                           std::function<void(const Parameters&)> keep_before)
    : board_(board), axis_(axis), key_(std::move(key)), keep_before_(std::move(keep_before)) {
  board_.ask("disarm");
  read_parameters();
}

JointConsole::~JointConsole() {
  bool stopped = true;
  while (std::exchange(stopped, false)) {
    try {
      restore();
    } catch (const Stopped&) {
      stopped = true;  // said once, and no reason to leave anything as it is
    } catch (const std::exception&) {
      // The line is gone; without it a board takes torque away by itself.
    }
  }
}

void JointConsole::read_parameters() {
  values_.clear();
  const std::string prefix = name() + ".";
  for (const std::string& line : board_.ask("dump")) {
    std::istringstream words(line);
    std::string set;
    std::string parameter;
    words >> set >> parameter;
    if (set == "set" && parameter.starts_with(prefix)) {
      std::string value;
      std::getline(words >> std::ws, value);
      values_[parameter.substr(prefix.size())] = value;
    }
  }
  if (values_.empty()) {
    throw BadInput("the board has no " + name() + "; give --axis of one that it has");
  }
}

void JointConsole::set(const std::string& parameter, const std::string& value) {
  if (before_.try_emplace(parameter, text(parameter)).second) {
    tell_before();
  }
  board_.ask("maintenance open" + (key_.empty() ? "" : " " + key_));
  board_.ask("set " + name() + "." + parameter + " " + value);
  values_[parameter] = value;
}

void JointConsole::stage(const Parameters& parameters) {
  board_.ask("maintenance open" + (key_.empty() ? "" : " " + key_));
  board_.ask("begin");
  try {
    for (const auto& [parameter, value] : parameters) {
      board_.ask("set " + name() + "." + parameter + " " + value);
    }
    board_.ask("commit");
  } catch (const std::exception&) {
    board_.ask("abandon");
    throw;
  }
  for (const auto& [parameter, value] : parameters) {
    values_[parameter] = value;
  }
}

void JointConsole::set_together(const Parameters& parameters) {
  stage(parameters);
  for (const auto& [parameter, value] : parameters) {
    before_.erase(parameter);
  }
}

void JointConsole::try_together(const Parameters& parameters) {
  for (const auto& [parameter, value] : parameters) {
    before_.try_emplace(parameter, text(parameter));
  }
  tell_before();
  stage(parameters);
}

void JointConsole::restore() {
  disarm();
  if (!before_.empty()) {
    set_together({before_.begin(), before_.end()});
  }
  tell_before();
}

auto JointConsole::text(const std::string& parameter) const -> const std::string& {
  const auto found = values_.find(parameter);
  if (found == values_.end()) {
    throw BadInput("the board has no parameter " + name() + "." + parameter + "; it runs another version");
  }
  return found->second;
}

auto JointConsole::value(const std::string& parameter) const -> double {
  return number_of(text(parameter));
}

auto JointConsole::gains_dump() -> std::string {
  std::string dump;
  for (const auto& [parameter, value] : values_) {
    dump += "set " + name() + "." + parameter + " " + value + "\n";
  }
  return dump;
}

auto JointConsole::mark(const Parameters& found) -> std::string {
  std::string board;
  for (const std::string& line : board_.ask("version")) {
    const std::size_t from = line.find("board ");
    if (from != std::string::npos) {
      board = line.substr(from, line.find(" parameters ") - from) + ", ";
    }
  }
  const auto scale = [&](const std::string& parameter) {
    const auto own = std::find_if(found.begin(), found.end(), [&](const auto& one) { return one.first == parameter; });
    return own == found.end() ? text(parameter) : own->second;
  };
  return board + scale("motor.encoder_counts") + " counts, sign " + scale("motor.encoder_sign") + ", " +
         scale("motor.torque_per_current");
}

auto JointConsole::first_other(const Parameters& parameters) const -> std::string {
  const auto other = std::find_if(parameters.begin(), parameters.end(), [this](const auto& one) {
    const double wanted = number_of(one.second);
    return std::fabs(value(one.first) - wanted) > kRoundedShare * std::fabs(wanted) + kRounded;
  });
  return other == parameters.end() ? "" : other->first;
}

auto JointConsole::count_rad() const -> double {
  return 2.0 * std::numbers::pi / value("motor.encoder_counts");
}

void JointConsole::arm() {
  board_.ask("maintenance open" + (key_.empty() ? "" : " " + key_));
  // A joint that still springs back would be taken for one whose encoder moves by itself.
  for (int look = 0; look < kMostLooks; ++look) {
    const Eigen::VectorXd angle = column(rows("log", "50 10"), "q1_rad");
    if (angle.maxCoeff() - angle.minCoeff() < kStillCounts * count_rad()) {
      try {
        board_.ask("arm");
      } catch (const Refusal& refusal) {
        throw Faulted(refusal.what() + fault());
      }
      return;
    }
  }
  throw Refusal(name() + " does not come to rest without torque; hold it, or remove what drives it");
}

void JointConsole::disarm() {
  for (int attempt = 0;; ++attempt) {
    try {
      board_.ask("disarm");
      return;
    } catch (const Refusal&) {
      if (attempt == kMostDisarms) {
        throw;
      }
      // The end of what was stopped came first.
    }
  }
}

auto JointConsole::fault() -> std::string {
  for (const std::string& line : board_.ask("faults")) {
    if ((line.starts_with("latched ") && !line.starts_with("latched none")) || line.starts_with("present ")) {
      return "; " + line;
    }
  }
  return {};
}

auto JointConsole::order(const std::string& line) -> std::vector<std::string> {
  try {
    return board_.ask(line);
  } catch (const Refusal& refusal) {
    if (const std::string why = fault(); !why.empty()) {
      throw Faulted(refusal.what() + why);
    }
    throw;
  }
}

auto JointConsole::rows(const std::string& command, const std::string& options) -> CsvLog {
  std::string text;
  for (const std::string& line : order(command + " " + name() + " " + options)) {
    const bool row = line.find(',') != std::string::npos;
    text += row ? line + "\n" : "";
  }
  return CsvLog::parse(text, "the board's log");
}

auto JointConsole::column(const CsvLog& log, const std::string& column) const -> Eigen::VectorXd {
  return log.column("axis" + std::to_string(axis_) + "/" + column);
}

}  // namespace capstan::tools
