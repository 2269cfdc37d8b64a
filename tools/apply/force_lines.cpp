// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/apply/force_lines.hpp"

#include <cmath>

#include "capstan/firmware/parameters/config.hpp"
#include "capstan/tools/apply/board_number.hpp"
#include "capstan/tools/identify/force_section.hpp"
#include "capstan/tools/replay/force_replay.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

static_assert(ForceConfig::kDepth == kForceDepth, "a replay remembers what a board does");

class ForceLines {
 public:
  explicit ForceLines(int axis) : prefix_("set joint" + std::to_string(axis) + ".") {}
  void set(const std::string& name, double value, const std::string& unit) {
    constexpr double kMost = 127.0;
    if (std::abs(value) > kMost) {
      throw BadInput("[force] " + name + " is beyond what a board takes, 127; give the law in N m");
    }
    lines_.push_back(prefix_ + name + " " + board_number(value) + (unit == "1" ? "" : " " + unit));
  }
  void choose(ForceLawKind kind) { lines_.push_back(prefix_ + "force.law " + std::to_string(static_cast<int>(kind))); }
  void levels(std::size_t count) { lines_.push_back(prefix_ + "preisach.levels " + std::to_string(count)); }
  [[nodiscard]] auto take() -> std::vector<std::string> { return std::move(lines_); }

 private:
  std::string prefix_;
  std::vector<std::string> lines_;
};

void add_preisach(ForceLines& lines, const PreisachTable& table) {
  lines.choose(ForceLawKind::kPreisach);
  lines.set("force.friction", 0.0, "Nm");  // it is in the table
  lines.set("force.offset", 0.0, "Nm");
  lines.levels(table.levels);
  for (std::size_t row = 0; row < table.levels; ++row) {
    lines.set("preisach.input_" + std::to_string(row), table.inputs[row], "Nm");
    for (std::size_t column = 0; column <= row; ++column) {
      lines.set("preisach.force_" + std::to_string(row) + "_" + std::to_string(column), table.force(row, column), "Nm");
    }
  }
}

}  // namespace

auto force_lines(const std::string& joint_file, const std::string& name, int axis) -> std::vector<std::string> {
  ForceLines lines(axis);
  const std::string model = force_model(joint_file, name);
  if (is_of_tendons(model)) {
    const PullPushFit fit = read_pull_push(joint_file, name);
    lines.choose(fit.kind);
    for (const ForceParameter& parameter : fit.parameters) {
      lines.set("force." + parameter.name,
                parameter.name == "friction" ? std::max(parameter.value, 0.0) : parameter.value, parameter.unit);
    }
  } else if (model == "preisach") {
    add_preisach(lines, read_preisach(joint_file, name));
  } else if (!model.empty()) {
    throw BadInput(name + ": [force] has the model \"" + model +
                   "\", which no board runs; pull_push, blend and preisach are");
  }
  if (!model.empty()) {  // all 0 where the file does not say: the board then says that nobody knows
    const ForceErrorNumbers error = read_force_error(joint_file, name).value_or(ForceErrorNumbers{});
    for (std::size_t i = 0; i < ForceErrorNumbers::kCount; ++i) {
      lines.set("force." + std::string(ForceErrorNumbers::kNames[i]), error.values[i], "Nm");
    }
  }
  return lines.take();
}

}  // namespace capstan::tools
