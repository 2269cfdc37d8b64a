// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/joint_file/width_limit.hpp"

namespace capstan::tools {

auto is_at_limit(const ShapeInfo& info, double value) -> bool {
  constexpr double kNext = 1.3;  // a search of plays goes up in steps of 1.27
  const bool is_width = info.of == ShapeOf::kMotorRange || info.of == ShapeOf::kOtherRange;
  return is_width && kNext * value > info.maximum;
}

auto widths_at_limit(const JointFile& law) -> std::vector<std::string> {
  std::vector<std::string> names;
  for (const auto& term : *law.catalogue) {
    for (std::size_t i = 0; law.has(term.name) && i < term.shapes.size(); ++i) {
      if (is_at_limit(term.shapes[i], law.parameters.shapes[term.first_shape + i])) {
        names.push_back(term.name + "." + term.shapes[i].name);
      }
    }
  }
  return names;
}

}  // namespace capstan::tools
