// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/loop_without_torque.hpp"

#include <algorithm>

#include "capstan/tools/identify/loop.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {

void doubt_loop_without_torque(const Preparation& p, Diagnosis& d) {
  const bool torque = std::any_of(p.logs.begin(), p.logs.end(), [](const auto& log) { return log.has_torque; });
  const bool named =
      std::any_of(d.effects.begin(), d.effects.end(), [](const auto& effect) { return effect.name == kPlayTerm; });
  if (torque || !named || !d.found || !d.found->has(kPlayTerm)) {
    return;
  }
  const double half_width = d.found->parameters.shapes[d.found->catalogue->term(kPlayTerm).first_shape];
  const std::string axis = d.target.substr(0, d.target.find('/'));
  d.warnings.push_back(
      "play may be no gap: no torque is logged, and tendons or sheaths that are healthy draw the same "
      "loop, here " +
      rounded(half_width, 3) + " " + d.motion_unit +
      " to either side at the motor, by stretching under their own friction; the law holds either "
      "way");
  if (!d.next_experiment) {
    d.next_experiment = "Log the motor's torque (" + axis + (p.logs.front().linear ? "/tau_N" : "/tau_Nm") +
                        ") too, in slow motion under several loads: a gap is as wide under each and takes no torque, "
                        "stretched tendons are not.";
  }
}

}  // namespace capstan::tools
