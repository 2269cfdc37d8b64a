// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/apply/effort_lines.hpp"

#include <string_view>

#include "capstan/firmware/parameters/effort_rows.hpp"
#include "capstan/tools/apply/board_number.hpp"
#include "capstan/tools/replay/board_effort_law.hpp"

namespace capstan::tools {
namespace {

/// Writes one line per parameter.
class EffortLines {
 public:
  explicit EffortLines(int axis) : prefix_("set joint" + std::to_string(axis) + ".") {}
  void set(const std::string& name, double value, std::string_view unit) {
    lines_.push_back(prefix_ + name + " " + board_number(value) + (unit == "1" ? "" : " " + std::string(unit)));
  }
  void choose(const std::string& name, int value) { lines_.push_back(prefix_ + name + " " + std::to_string(value)); }
  [[nodiscard]] auto take() -> std::vector<std::string> {
    lines_.insert(lines_.begin(), "begin");
    lines_.emplace_back("commit");
    return std::move(lines_);
  }

 private:
  std::string prefix_;
  std::vector<std::string> lines_;
};

auto status_of(const std::string& word) -> int {
  return word == word_of(LawStatus::kConfirmed) ? 0 : (word == word_of(LawStatus::kProvisional) ? 1 : 2);
}

}  // namespace

auto effort_lines(const EffortLaw& law, const std::string& name, int axis) -> std::vector<std::string> {
  const BoardEffortLaw board = board_effort_law(law, name);
  EffortLines lines(axis);
  std::size_t coefficient = 0;
  std::size_t shape = 0;
  TorqueTerms::for_each<double>([&]<typename Term>() {
    const std::string group = std::string(kEffortGroup<Term>.data()) + ".";
    for (const CoefficientInfo& info : Term::kInfo.coefficients) {
      lines.set(group + info.name, board.law.coefficients[coefficient++], of_torque(info).unit);
    }
    for (const ShapeInfo& info : Term::kInfo.shapes) {
      lines.set(group + info.name, board.law.shapes[shape++], info.unit);
    }
  });
  lines.set("effort.window", board.view.window_s, "s");
  lines.set("effort.standstill", board.view.standstill_rad_s, "rad/s");
  lines.set("effort.letting_go", board.view.letting_go_s, "s");
  lines.choose("effort.status", status_of(law.status));
  return lines.take();
}

}  // namespace capstan::tools
