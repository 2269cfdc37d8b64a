// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "capstan/tests/tools/run/drawn_joint.hpp"
#include "capstan/tools/commission/board_shell.hpp"

namespace capstan::tools {

/// A simulated board with its data sheet's values, on which something happens ahead of the first line that has
/// `ahead_of` in it.
class Happening final : public BoardShell {
 public:
  explicit Happening(const sim::Scenario& scenario, std::string event = "", std::string ahead_of = "")
      : line_(scenario), event_(std::move(event)), ahead_of_(std::move(ahead_of)) {
    const auto axes = sim::axes_of(scenario);
    for (std::size_t i = 0; i < axes.size(); ++i) {
      for (const std::string& one : data_sheet(axes[i].plant, i)) {
        line_.ask(one);
      }
    }
  }
  [[nodiscard]] auto board() -> SimShell& { return line_; }
  [[nodiscard]] auto asked() const -> const std::vector<std::string>& { return asked_; }
  [[nodiscard]] auto armed_since() const -> int { return armed_since_; }
  /// The last line that began like this, or nothing.
  [[nodiscard]] auto last(const std::string& begin) const -> std::string {
    const auto found =
        std::find_if(asked_.rbegin(), asked_.rend(), [&](const std::string& line) { return line.starts_with(begin); });
    return found == asked_.rend() ? "" : *found;
  }

 private:
  auto do_ask(const std::string& line) -> std::vector<std::string> override {
    if (!event_.empty() && line.find(ahead_of_) != std::string::npos) {
      happened_ = true;
      static_cast<void>(line_.take_way());
      line_.ask(std::exchange(event_, ""));
    }
    armed_since_ += happened_ && line == "arm" ? 1 : 0;
    asked_.push_back(line);
    return line_.ask(line);
  }
  SimShell line_;
  std::string event_, ahead_of_;
  std::vector<std::string> asked_;
  bool happened_ = false;
  int armed_since_ = 0;
};

}  // namespace capstan::tools
