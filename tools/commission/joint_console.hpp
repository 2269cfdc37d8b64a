// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "capstan/tools/commission/board_shell.hpp"
#include "capstan/tools/log/csv_log.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {

/// The board latched a fault or gives no torque. To try again would acknowledge it and forget its cause.
class Faulted : public Refusal {
 public:
  using Refusal::Refusal;
};

/// One joint of a board, as commissioning uses it. Remembers what parameters were before they were changed.
class JointConsole {
 public:
  /// Names without the joint's, and values.
  using Parameters = std::vector<std::pair<std::string, std::string>>;
  /// @param keep_before  is told what parameters were before, ahead of each change for a while and when all is back
  JointConsole(BoardShell& board, int axis, std::string key, std::function<void(const Parameters&)> keep_before);
  JointConsole(const JointConsole&) = delete;
  auto operator=(const JointConsole&) -> JointConsole& = delete;
  /// Torque off, and everything back that was set and not kept. Whatever the board says to that.
  ~JointConsole();

  auto ask(const std::string& line) -> std::vector<std::string> { return board_.ask(line); }
  /// A parameter of the joint, "control.kp"; it counts as changed for a while.
  void set(const std::string& name, const std::string& value);
  /// Parameters that make sense only together, and count from now on: all of them or none.
  void set_together(const Parameters& parameters);
  /// The same for a while.
  void try_together(const Parameters& parameters);
  /// What was set counts from now on.
  void keep(const std::string& name) { before_.erase(name); }
  /// What was set for a while is as it was before. Torque is off then.
  void restore();
  [[nodiscard]] auto value(const std::string& name) const -> double;
  /// "0.5 Nm/rad"
  [[nodiscard]] auto text(const std::string& name) const -> const std::string&;
  [[nodiscard]] auto gains_dump() -> std::string;

  /// What tells this board's joint from others, as far as it can be told: kind and joints of the board, scale of the
  /// motor.
  /// @param found  what commissioning has found of them counts, whatever the board has
  auto mark(const Parameters& found) -> std::string;
  /// Of parameters that it should have the first that it has otherwise; nothing: none.
  [[nodiscard]] auto first_other(const Parameters& parameters) const -> std::string;

  /// Waits until the motor stands, then arms. Throws Faulted where the board does not.
  void arm();
  void disarm();
  /// What may move the joint. Throws Faulted where a fault ended it.
  auto order(const std::string& line) -> std::vector<std::string>;
  /// `log` or `experiment` with the joint's name behind the first word; an order().
  auto rows(const std::string& command, const std::string& options) -> CsvLog;
  auto column(const CsvLog& log, const std::string& name) const -> Eigen::VectorXd;
  [[nodiscard]] auto count_rad() const -> double;
  [[nodiscard]] auto name() const -> std::string { return "joint" + std::to_string(axis_); }
  [[nodiscard]] auto axis() const -> int { return axis_; }

 private:
  void read_parameters();
  /// By begin and commit.
  void stage(const Parameters& parameters);
  void tell_before() { keep_before_({before_.begin(), before_.end()}); }
  /// "; latched encoder_motion: ...", or what would block arming; nothing: there is no fault.
  auto fault() -> std::string;

  BoardShell& board_;
  int axis_;
  std::string key_;
  std::function<void(const Parameters&)> keep_before_;
  std::map<std::string, std::string> values_, before_;
};

}  // namespace capstan::tools
