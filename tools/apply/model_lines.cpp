// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/apply/model_lines.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "capstan/firmware/estimate/law_monitor.hpp"
#include "capstan/tools/apply/board_number.hpp"
#include "capstan/tools/identify/friction_spread.hpp"
#include "capstan/tools/select/deciding_numbers.hpp"

namespace capstan::tools {
namespace {

/// Writes one 'set' line per parameter, in the order of the catalogue.
class LawLines {
 public:
  LawLines(std::vector<std::string>& lines, const LawParameters<double>& law, int axis)
      : lines_(lines), law_(law), prefix_("set joint" + std::to_string(axis) + ".") {}

  void set(const std::string& group, const std::string& name, double value, const char* unit) {
    std::string line = prefix_ + group + "." + name + " " + board_number(value);
    if (std::string_view(unit) != "1") {
      line.append(" ").append(unit);
    }
    lines_.push_back(std::move(line));
  }
  template <typename Term>
  void operator()() {
    for (const CoefficientInfo& info : Term::kInfo.coefficients) {
      set(Term::kInfo.name, info.name, law_.coefficients[coefficient_++], info.unit);
    }
    for (const ShapeInfo& info : Term::kInfo.shapes) {
      set(Term::kInfo.name, info.name, law_.shapes[shape_++], info.unit);
    }
  }

 private:
  std::vector<std::string>& lines_;
  const LawParameters<double>& law_;
  std::string prefix_;
  std::size_t coefficient_ = 0;
  std::size_t shape_ = 0;
};

/// A joint sensor is expected to differ from the law as the logs did, and in other motions by what a loop's width is
/// known to (kLoopTold); without a fit nobody knows, and nothing is watched.
auto expected_error_rad(const JointFile& joint) -> double {
  constexpr double kMostRad = 1.0;
  if (!joint.fit) {
    return 0.0;
  }
  double width_rad = 0.0;
  if (joint.fit->loop_half_width) {
    width_rad = kLoopTold * std::abs(beta_of(joint)) * *joint.fit->loop_half_width;
  }
  return std::min(std::hypot(joint.fit->rmse, width_rad), kMostRad);
}

static_assert(MonitorStretch::kSamples == LawMonitor::kSteadyStretch);
static_assert(MonitorStretch::kUnsettled == LawMonitor::kUnsettled);
static_assert(MonitorStretch::kStrideRad == LawMonitor::kStride.to_double());
static_assert(Q24::from_double(MonitorStretch::kSettleRad) == MonitorConfig{}.settle_rad);

/// Friction is expected to change from stretch to stretch as it did in the logs, and by some from one motion to
/// another; without enough of them nobody knows.
auto expected_friction_nm(const JointFile& joint) -> double {
  constexpr double kMostNm = 10.0;
  // Of the steady friction; the logs' own change is 0.7 to 2.2 % on drawn joints 701 to 705. Set on 23 November 2026
  // before a board had watched by it.
  constexpr double kAnotherMotion = 0.01;
  if (!joint.fit || !joint.steady_torque || !joint.fit->friction_rms) {
    return 0.0;
  }
  const double friction = 0.5 * std::abs(joint.steady_torque->forward_nm - joint.steady_torque->backward_nm);
  return std::min(std::hypot(*joint.fit->friction_rms, kAnotherMotion * friction), kMostNm);
}

/// All 0 where the file has none: the board then says that nobody knows.
void write_error_bar(const JointFile& joint, LawLines& write) {
  constexpr double kWidestRad = 7.0;  // ends of the parameters
  const bool told = joint.fit && joint.fit->error_bar && joint.fit->error_bar->steady_rad() <= kWidestRad &&
                    joint.fit->error_bar->turning_rad() <= kWidestRad;
  const ErrorBarNumbers bar = told ? *joint.fit->error_bar : ErrorBarNumbers{};
  for (std::size_t i = 0; i < ErrorBarNumbers::kCount; ++i) {
    write.set("error_bar", ErrorBarNumbers::kNames[i], bar.values[i], ErrorBarNumbers::kUnits[i]);
  }
}

/// What the board's gauge of pretension begins from; 0 where the file has none, or more than a board's numbers hold.
void write_pretension(const JointFile& joint, LawLines& write) {
  constexpr double kMost = 127.0;  // ends of the parameters
  constexpr double kTwoSpreads = 1.96;
  const PretensionNumbers numbers = joint.fit && joint.fit->pretension ? *joint.fit->pretension : PretensionNumbers{};
  const double friction = numbers.friction_nm();
  double half = 0.0;
  if (numbers.force_n() > 0.0) {
    // Of the newtons, of the friction per newton while half of it changes, and of a stretch of motion.
    const double share = std::hypot(numbers.force_95_n() / numbers.force_n(), 0.5 * numbers.friction_95_nm() / friction,
                                    kTwoSpreads * expected_friction_nm(joint) / friction);
    half = share * numbers.force_n();
  }
  const bool fits = numbers.force_n() <= kMost && half <= kMost;
  // A free tip alone does not know it better than the motor's own, which the board has from commissioning.
  write.set("monitor", "tendon_friction", numbers.torque_nm() > 0.0 ? std::min(friction, 100.0) : 0.0, "Nm");
  write.set("monitor", "pretension", fits ? numbers.force_n() : 0.0, "N");
  write.set("monitor", "pretension_error", fits ? half : 0.0, "N");
}

}  // namespace

auto model_lines(const JointFile& joint, int axis) -> std::vector<std::string> {
  std::vector<std::string> lines = {"begin"};
  const LawParameters<double> law = motion_parameters(joint);
  LawLines write(lines, law, axis);
  for_each_term<double>(write);
  const ConditionerShape<double>& conditioner = joint.parameters.conditioner;
  write.set("conditioner", "direction_threshold", conditioner.direction_threshold_rad, "rad");
  write.set("conditioner", "rate_time_constant", conditioner.rate_time_constant_s, "s");
  constexpr std::array<const char*, kMostOthers> kSlots = {"joint", "joint_2", "joint_3"};
  const std::string stem = "set joint" + std::to_string(axis) + ".";
  for (std::size_t slot = 0; slot < kSlots.size(); ++slot) {
    const int coupled = slot < joint.coupled_to.size() ? joint.coupled_to[slot] : -1;
    lines.push_back(stem + "axis_coupling." + kSlots[slot] + " " + std::to_string(coupled));
  }
  lines.push_back(stem + "law.status " + std::to_string(static_cast<int>(joint.status)));
  if (joint.steady_torque) {
    write.set("control", "torque_forward", joint.steady_torque->forward_nm, "Nm");
    write.set("control", "torque_backward", joint.steady_torque->backward_nm, "Nm");
  }
  write.set("monitor", "joint_rms", expected_error_rad(joint), "rad");
  write.set("monitor", "torque_rms", expected_friction_nm(joint), "Nm");
  write_pretension(joint, write);
  write_error_bar(joint, write);
  lines.emplace_back("commit");
  return lines;
}

}  // namespace capstan::tools
