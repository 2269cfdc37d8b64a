// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/thesis/page.hpp"

namespace capstan::tools {

auto thesis_figures() -> std::vector<ThesisFigure> {
  return {};
}

}  // namespace capstan::tools
