// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/mjcf/mjcf.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/identify/tendon_fit.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

// A play whose gain is the ratio moves the joint from one side of its gap to the other; with another gain the joint
// would also move within the gap, which MuJoCo's tendons can not. The gap of examples/python is found with a gain of
// 0.9003 at a ratio of 0.9000 (2026-11-22); a tenth is far above that and far below a joint that follows half-way.
constexpr double kGainOfAGap = 0.1;

// MuJoCo's constraints are soft, and with its defaults a joint of 0.1 g m2 gives by a centiradian at 50 mN m, and
// friction is all there at 1 rad/s only. Twice the time constant of the stiffest that is stable at MuJoCo's usual 2 ms,
// and a hundredth of the softness: 0.1 mrad there, all friction from 0.02 rad/s on (2026-11-22, by its documented
// formula and mjcf_test).
constexpr const char* kStiff = "0.004 1";
constexpr const char* kHard = "0.99 0.99 0.001";

auto coefficient(const JointFile& joint, const std::string& term, std::size_t number) -> double {
  return joint.has(term) ? joint.parameters.coefficients[joint.catalogue->term(term).first_coefficient + number] : 0.0;
}
auto shape(const JointFile& joint, const std::string& term, std::size_t number) -> double {
  return joint.has(term) ? joint.parameters.shapes[joint.catalogue->term(term).first_shape + number] : 0.0;
}

auto xml_text(const std::string& name) -> std::string {
  std::string text;
  for (const char c : name) {
    text += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '"' ? "&quot;" : std::string(1, c);
  }
  return text;
}

/// ` name="value"`.
auto attribute(const std::string& name, const std::string& value) -> std::string {
  return " " + name + "=\"" + xml_text(value) + "\"";
}
auto attribute(const std::string& name, double value) -> std::string {
  return attribute(name, rounded(value, 9));
}
/// Of a constraint, as hard as it may be.
auto firm(const std::string& kind) -> std::string {
  return attribute("solref" + kind, kStiff) + attribute("solimp" + kind, kHard);
}
/// A joint's part in a tendon.
auto part(const std::string& hinge, double coefficient) -> std::string {
  return "      <joint" + attribute("joint", hinge) + attribute("coef", coefficient) + "/>\n";
}

/// What stands in the way of the motion, N m at the joint.
auto friction_of(const JointFile& joint, double ratio) -> double {
  return joint.steady_torque
             ? std::abs((joint.steady_torque->forward_nm - joint.steady_torque->backward_nm) / (2.0 * ratio))
             : 0.0;
}

/// The gap between the hinges, rad at the joint to either side; 0: there is none.
auto gap_of(const JointFile& joint, double ratio) -> double {
  const double gain = coefficient(joint, "play", 0);
  return std::abs(gain / ratio - 1.0) <= kGainOfAGap ? std::abs(gain) * shape(joint, "play", 0) : 0.0;
}

/// By which the joint lags per torque of the motor, rad/Nm, where its tendons have friction of their own: as far as in
/// steady motion, for a spring has no friction along it, and the torque of steady motion is what the simulated joint
/// has as friction.
auto lag_of_tendons(const JointFile& joint, double ratio) -> double {
  if (coefficient(joint, kTendonModel, 0) == 0.0) {
    return 0.0;
  }
  if (friction_of(joint, ratio) == 0.0) {
    throw Refusal(
        "the file does not say the torque of steady motion ([feedforward]), by which the law's tendons "
        "stretch; identify it again with 'capstan identify LOG --model pseudo_kinematic -o joint.toml'");
  }
  LawParameters<double> alone = rigid_law();
  const auto take = [](auto& into, const auto& from, std::size_t first, std::size_t count) {
    const auto begin = static_cast<std::ptrdiff_t>(first);
    std::copy_n(from.begin() + begin, count, into.begin() + begin);
  };
  const CatalogueTerm& term = joint.catalogue->term(kTendonModel);
  take(alone.coefficients, joint.parameters.coefficients, joint.catalogue->term("motor_angle").first_coefficient, 1);
  take(alone.coefficients, joint.parameters.coefficients, term.first_coefficient, 1);
  take(alone.shapes, joint.parameters.shapes, term.first_shape, TendonShape::kCount);
  const MotionLaw<double> law(SamplePeriod<double>(1e-3), alone);
  const SteadyTorque& torque = *joint.steady_torque;
  return ratio * law.lost_motion(torque.backward_nm, torque.forward_nm) / (torque.forward_nm - torque.backward_nm);
}

/// The same of the whole law, the mean of both tendons.
auto lag_of(const JointFile& joint, double ratio) -> double {
  return lag_of_tendons(joint, ratio) -
         (coefficient(joint, "tendon_elongation", 0) + coefficient(joint, "tendon_elongation", 1)) / 2.0;
}

/// Of the spring between the hinges, N m/rad at the joint; 0: they are stiff. The motor's torque is the ratio times the
/// joint's.
auto stiffness_of(double lag, double ratio) -> double {
  return lag * ratio > 0.0 ? 1.0 / (lag * ratio) : 0.0;
}

/// Whether a term is what the spring is made of.
auto is_elastic(const std::string& term) -> bool {
  return term == "tendon_elongation" || term == kTendonModel;
}

}  // namespace

auto mjcf_of(const JointFile& joint, const MjcfNames& names) -> Mjcf {
  if (names.motor.empty() || names.joint.empty() || names.tendon.empty()) {
    throw BadInput("a hinge or the tendon has no name; give --motor, --joint and --tendon one, or leave them out");
  }
  if (names.motor == names.joint) {
    throw BadInput("motor and joint are both the hinge " + names.motor +
                   ", and a tendon joins two; give --motor and --joint the model's names of each");
  }
  if (joint.catalogue->target() != TargetKind::kAngle) {
    throw Refusal("the law explains a torque, and a tendon is made of a law of the joint angle; identify one");
  }
  const double ratio = coefficient(joint, "motor_angle", 0);
  if (ratio == 0.0) {
    throw Refusal("the law has no ratio between motor and joint, so no tendon can be made of it; identify it with " +
                  std::string("--model pseudo_kinematic"));
  }
  const double gap = gap_of(joint, ratio);
  const double lag = gap > 0.0 ? 0.0 : lag_of(joint, ratio);
  const double stiffness = stiffness_of(lag, ratio);
  const bool pushes = lag * ratio < 0.0 || (gap == 0.0 && lag == 0.0 && coefficient(joint, kTendonModel, 0) != 0.0);
  Mjcf result;
  std::vector<std::string> unknown;
  for (const auto& term : joint.terms) {
    const bool expressed = term == "motor_angle" || term == "joint_offset" || (term == "play" && gap > 0.0) ||
                           (is_elastic(term) && gap == 0.0 && !pushes);
    if (!expressed) {
      result.left_out.push_back(term);
    }
    if (!expressed && !(is_elastic(term) && pushes)) {
      unknown.push_back(term);
    }
  }
  if (!unknown.empty()) {
    result.warnings.push_back("MuJoCo's tendons have no counterpart of " + joined(unknown) +
                              "; the simulated joint goes without");
  }
  if (pushes) {
    result.warnings.push_back("with a ratio of " + rounded(ratio, 3) + " this law's " +
                              (joint.has(kTendonModel) ? kTendonModel : "tendon_elongation") +
                              " is a spring that pushes the joint on, which no tendon is; "
                              "the simulated joint goes without. Count the joint the other way, --map with a minus on "
                              "q2_rad, and identify the law again");
  }
  const double offset = coefficient(joint, "joint_offset", 0);
  std::string tendons;
  std::string equality;
  if (gap > 0.0 || stiffness > 0.0) {
    tendons =
        "    <fixed" + attribute("name", names.tendon) +
        (gap > 0.0 ? attribute("limited", "true") +
                         attribute("range", rounded(offset - gap, 9) + " " + rounded(offset + gap, 9)) + firm("limit")
                   : attribute("stiffness", stiffness) + attribute("springlength", offset)) +
        ">\n" + part(names.joint, 1.0) + part(names.motor, -ratio) + "    </fixed>\n";
  } else {
    equality = "  <equality>\n    <joint" + attribute("name", names.tendon) + attribute("joint1", names.joint) +
               attribute("joint2", names.motor) +
               attribute("polycoef", rounded(offset, 9) + " " + rounded(ratio, 9) + " 0 0 0") + firm("") +
               "/>\n  </equality>\n";
  }
  if (const double friction = friction_of(joint, ratio); friction > 0.0) {
    tendons += "    <fixed" + attribute("name", names.tendon + "_sheath") + attribute("frictionloss", friction) +
               firm("friction") + ">\n" + part(names.joint, 1.0) + "    </fixed>\n";
  }
  result.text = "<mujoco>\n  <!-- A tendon by capstan: " + std::string(word_of(joint.status)) + " law" +
                (result.left_out.empty() ? "" : "; without " + joined(result.left_out)) + " -->\n" +
                (tendons.empty() ? "" : "  <tendon>\n" + tendons + "  </tendon>\n") + equality + "</mujoco>\n";
  return result;
}

}  // namespace capstan::tools
