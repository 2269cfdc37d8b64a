// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/apply/law_lines.hpp"

#include <charconv>

#include "capstan/tools/apply/effort_lines.hpp"
#include "capstan/tools/apply/force_lines.hpp"
#include "capstan/tools/apply/machine_lines.hpp"
#include "capstan/tools/apply/model_lines.hpp"
#include "capstan/tools/apply/plausible_law.hpp"
#include "capstan/tools/joint_file/effort_file.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

/// A law that this board can run. Throws BadInput or Refusal with the cure.
auto checked(const JointFile& joint, const std::string& file, int axis, bool force) -> const JointFile& {
  constexpr int kLastAxis = 3;
  for (const int other : joint.coupled_to) {
    if (other > kLastAxis || other == axis) {
      throw BadInput(file + ": the law is coupled to axis " + std::to_string(other) + ", and joint " +
                     std::to_string(axis) + " of a board can be coupled to its others of 0 to 3; write the " +
                     "board's number of that joint into [coupling]");
    }
  }
  if (const std::string reason = implausible(joint); !reason.empty() && !force) {
    throw Refusal(file + " is " + word_of(joint.status) + " and implausible: " + reason +
                  "; nothing was written. Fit it to a longer log, or write it all the same with --force");
  }
  return joint;
}

/// The whole number behind some words of a line; negative where they are not there.
auto number_behind(const std::string& line, const std::string& words) -> int {
  int number = -1;
  if (const auto at = line.find(words); at != std::string::npos) {
    std::from_chars(line.data() + at + words.size(), line.data() + line.size(), number);
  }
  return number;
}

}  // namespace

auto law_lines(const std::string& file, int axis, bool force) -> std::vector<std::string> {
  const std::string text = read_text_file(file);
  const std::string_view schema = schema_of(text);
  if (schema.starts_with(kEffortSchemas)) {
    return effort_lines(parse_effort_file(text, file), file, axis);
  }
  if (schema.starts_with(kMachineFamily)) {
    return machine_lines(text, file);
  }
  std::vector<std::string> force_law = force_lines(text, file, axis);
  const bool only_force = !force_law.empty() && text.find("[terms") == std::string::npos;
  std::vector<std::string> lines = only_force
                                       ? std::vector<std::string>{"begin", "commit"}
                                       : model_lines(checked(parse_joint_file(text, file), file, axis, force), axis);
  lines.insert(lines.end() - 1, force_law.begin(), force_law.end());
  return lines;
}

void expect_axis(const std::vector<std::string>& lines, int axis, const std::string& file) {
  for (const std::string& line : lines) {
    if (const int joint = number_behind(line, "set joint"); joint >= 0 && joint != axis) {
      throw BadInput(file + " sets up joint " + std::to_string(joint) + ", and --axis names joint " +
                     std::to_string(axis) + "; leave --axis out, or write the other joint's number into the file");
    }
  }
}

void expect_joints(const std::vector<std::string>& lines, const std::vector<std::string>& version) {
  const int joints = version.empty() ? -1 : number_behind(version.front(), "joints ");
  for (const std::string& line : lines) {
    const int joint = number_behind(line, "set joint");
    if (joints > 0 && joint >= joints) {
      throw BadInput("the board has " + std::to_string(joints) + (joints == 1 ? " joint" : " joints") +
                     ", numbered from 0, and joint " + std::to_string(joint) +
                     " was asked for; give an --axis that it has, or the file of this board");
    }
  }
}

}  // namespace capstan::tools
