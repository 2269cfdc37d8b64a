// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/loop_change.hpp"

#include <cmath>

#include "capstan/model/terms/tendon.hpp"
#include "capstan/tools/identify/loop.hpp"
#include "capstan/tools/identify/tendon_fit.hpp"
#include "capstan/tools/select/deciding_numbers.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {

auto name_of_change(double width, double torque) -> std::string {
  const bool wider = width > 1.0 + kLoopTold;
  const bool narrower = width < 1.0 - kLoopTold;
  const bool same_torque = std::abs(torque - 1.0) <= kLoopTold;
  if (!wider && !narrower) {
    return {};
  }
  const double together = std::log(torque) / std::log(width);
  if (together > kLeastTogether && together < 1.0 / kLeastTogether) {
    return kPretensionTerm;
  }
  if (narrower) {
    return torque >= 1.0 - kLoopTold ? kHardeningTerm : "";
  }
  return same_torque ? kPlayTerm : "";
}

auto change_sentence(const std::string& name, const EffectSize& size) -> std::string {
  const auto range = [&size](double unit) {
    return with_interval(unit * size.value, unit * (*size.ci95)[0], unit * (*size.ci95)[1]);
  };
  if (name == kPlayTerm) {
    return "the gap is " + range(1.0) + " rad to either side, at the joint";
  }
  if (name == kDelayTerm) {
    return "the joint is seen " + range(1e3) + " ms later than at the healthy joint";
  }
  // A free tip tells the product of pretension and friction number.
  return (name == kPretensionTerm ? "pretension, if the tendons' friction number is unchanged, is "
                                  : "the tendons' stiffness is ") +
         range(100.0) + " % of the healthy joint's";
}

auto changed_tendons(LawForm tendons, const std::string& name, double width) -> LawForm {
  if (name == kPretensionTerm) {
    tendons.shapes[tendons.catalogue->term(kTendonModel).first_shape + TendonShape::kPretension] *= width;
  } else if (name == kHardeningTerm) {
    *tendons.tied_compliance *= width;
  }
  return tendons;
}

}  // namespace capstan::tools
