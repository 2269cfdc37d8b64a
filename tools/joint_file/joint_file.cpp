// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/joint_file/joint_file.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/joint_file/table_section.hpp"
#include "capstan/tools/joint_file/width_limit.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"
#include "capstan/tools/support/toml_text.hpp"

namespace capstan::tools {
namespace {

auto quantity(double value, const std::string& unit, const std::optional<Interval>& ci95) -> std::string {
  std::string text = "{ value = " + exact(value) + ", unit = \"" + unit + "\"";
  if (ci95) {
    text += ", ci95 = [" + exact((*ci95)[0]) + ", " + exact((*ci95)[1]) + "]";
  }
  return text + " }\n";
}

auto term_text(const JointFile& joint, const CatalogueTerm& term) -> std::string {
  std::string text = "\n# " + term.equation + "   " + term.source + "\n[terms." + term.name + "]\n";
  if (term.name == kTableTerm) {
    return text + table_text(joint, term);
  }
  for (std::size_t i = 0; i < term.coefficients.size(); ++i) {
    const std::size_t at = term.first_coefficient + i;
    text += std::string(term.coefficients[i].name) + " = " +
            quantity(joint.parameters.coefficients[at], term.coefficients[i].unit, joint.coefficient_ci95[at]);
  }
  for (std::size_t i = 0; i < term.shapes.size(); ++i) {
    const std::size_t at = term.first_shape + i;
    const int switched = term.shapes[i].idle_without;
    if (switched >= 0 && joint.parameters.shapes[term.first_shape + static_cast<std::size_t>(switched)] == 0.0) {
      continue;
    }
    text += is_at_limit(term.shapes[i], joint.parameters.shapes[at])
                ? "# at the limit of a board's numbers, wider ones were not searched:\n"
                : "";
    text += std::string(term.shapes[i].name) + " = " +
            quantity(joint.parameters.shapes[at], term.shapes[i].unit, joint.shape_ci95[at]);
  }
  return text;
}

auto coupling_text(const std::vector<int>& joints) -> std::string {
  if (joints.empty()) {
    return {};
  }
  if (joints.size() == 1) {
    return "\n# The axis whose motor pulls at this one.\n[coupling]\njoint = " + std::to_string(joints[0]) + "\n";
  }
  std::string text = "\n# The axes whose motors pull at this one.\n[coupling]\njoints = [";
  for (std::size_t i = 0; i < joints.size(); ++i) {
    text += (i > 0 ? ", " : "") + std::to_string(joints[i]);
  }
  return text + "]\n";
}

/// A line for each of a list of numbers that know their names and units.
template <typename Numbers>
auto numbers_text(const Numbers& numbers) -> std::string {
  std::string text;
  for (std::size_t i = 0; i < Numbers::kCount; ++i) {
    text += std::string(Numbers::kNames[i]) + " = " + quantity(numbers.values[i], Numbers::kUnits[i], {});
  }
  return text;
}

/// A law that says the same throughout has no goodness of fit.
auto gof_line(double percent) -> std::string {
  return std::isfinite(percent) ? "gof_percent = " + exact(percent) + "\n" : "";
}

auto fit_text(const FitSummary& fit, const std::string& unit) -> std::string {
  std::string text = "\n[fit]\nrmse = " + quantity(fit.rmse, unit, {}) + gof_line(fit.gof_percent) +
                     "samples = " + std::to_string(fit.samples) + "\n";
  if (fit.motor_range) {
    text += "motor_range = [" + exact((*fit.motor_range)[0]) + ", " + exact((*fit.motor_range)[1]) + "]\n" +
            "joint_range = " + exact(fit.joint_range) + "\n";
  }
  if (fit.loop_half_width) {
    text += "loop_half_width = " + quantity(*fit.loop_half_width, "rad", {});
  }
  if (fit.loop_torque) {
    text += "loop_torque = " + quantity(*fit.loop_torque, "Nm", {});
  }
  if (fit.late) {
    text += "late = " + quantity(*fit.late, "s", {});
  }
  if (fit.friction_rms) {
    text += "friction_rms = " + quantity(*fit.friction_rms, "Nm", {});
  }
  text += "logs = [";
  for (std::size_t i = 0; i < fit.logs.size(); ++i) {
    text += (i > 0 ? ", " : "") + quoted(fit.logs[i]);
  }
  text += "]\n";
  if (fit.error_bar) {
    text +=
        "\n# 95 of 100 times the joint was no further from the law than steady, or turning up to turn of the motor\n"
        "# behind a reversal, with motor angles and torques as given.\n[fit.error_bar]\n" +
        numbers_text(*fit.error_bar);
  }
  if (fit.pretension) {
    text +=
        "\n# Of the tendons, each with half its 95 % interval, 0 where it is not known: friction = eta I r1 with a "
        "free\n"
        "# tip, torque = I r1, r1 the motor pulley's radius, force = I, both tendons' mean tensions together.\n"
        "[fit.pretension]\n" +
        numbers_text(*fit.pretension);
  }
  if (fit.torque) {
    text +=
        "\n# Motor torque while the joint follows: friction s + offset + viscous q1' + inertia q1''\n"
        "# + (sine + odd_sine s) sin q2 + (cosine + odd_cosine s) (1 - cos q2), s the direction.\n[fit.torque]\n" +
        numbers_text(*fit.torque);
  }
  return text;
}

}  // namespace

JointFile::JointFile(const Catalogue& of)
    : catalogue(&of),
      parameters{std::vector<double>(of.coefficient_count(), 0.0), of.initial_shapes()},
      coefficient_ci95(parameters.coefficients.size()),
      shape_ci95(parameters.shapes.size()) {
  if (of.target() == TargetKind::kAngle) {
    parameters.coefficients[of.term("motor_angle").first_coefficient] = 1.0;
  }
}

auto word_of(LawStatus status) -> const char* {
  constexpr std::array<const char*, 3> kWords = {"confirmed", "provisional", "base"};
  return kWords[static_cast<std::size_t>(status)];
}

auto beta_of(const JointFile& joint) -> double {
  return joint.parameters.coefficients[joint.catalogue->term("motor_angle").first_coefficient];
}

auto slots_used(const JointFile& joint) -> std::size_t {
  std::size_t slots = 0;
  for (const auto& term : *joint.catalogue) {
    if (joint.has(term.name)) {
      slots = std::max({slots, term.slots, term.name == kTableTerm ? slots_of_table(joint) : 0});
    }
  }
  return slots;
}

auto JointFile::has(const std::string& term) const -> bool {
  return std::find(terms.begin(), terms.end(), term) != terms.end();
}

auto JointFile::left_out(const CatalogueTerm& term, std::size_t i) const -> bool {
  const std::size_t at = term.first_coefficient + i;
  return parameters.coefficients[at] == 0.0 && !coefficient_ci95[at] && term.coefficients[i].sign == Sign::kAny;
}

auto rigid_law() -> LawParameters<double> {
  return motion_parameters(JointFile());
}

auto motion_parameters(const JointFile& joint) -> LawParameters<double> {
  if (joint.catalogue->target() != TargetKind::kAngle) {
    throw Refusal("this is a law of an effort, and the firmware runs laws of the joint angle; fit one with " +
                  std::string("--model pseudo_kinematic"));
  }
  LawParameters<double> law;
  std::copy(joint.parameters.coefficients.begin(), joint.parameters.coefficients.end(), law.coefficients.begin());
  std::copy(joint.parameters.shapes.begin(), joint.parameters.shapes.end(), law.shapes.begin());
  law.conditioner = joint.parameters.conditioner;
  return law;
}

auto to_fixed(const LawParameters<double>& parameters) -> LawParameters<Q24> {
  const auto rounded = [](double value) { return Q24::from_double(value); };
  LawParameters<Q24> fixed;
  std::transform(parameters.coefficients.begin(), parameters.coefficients.end(), fixed.coefficients.begin(), rounded);
  std::transform(parameters.shapes.begin(), parameters.shapes.end(), fixed.shapes.begin(), rounded);
  fixed.conditioner.direction_threshold_rad = Q24::from_double(parameters.conditioner.direction_threshold_rad);
  fixed.conditioner.rate_time_constant_s = Q24::from_double(parameters.conditioner.rate_time_constant_s);
  return fixed;
}

auto schema_of(std::string_view text) -> std::string_view {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  text.remove_prefix(text.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0);
  while (!text.empty()) {
    std::string_view line = trimmed(text.substr(0, text.find('\n')));
    text.remove_prefix(
        std::min(text.size(), text.find('\n') == std::string_view::npos ? text.size() : text.find('\n') + 1));
    if (line.starts_with('[')) {
      return {};
    }
    if (const auto equals = line.find('='); trimmed(line.substr(0, equals)) == "schema" && equals != line.npos) {
      line = trimmed(line.substr(equals + 1));
      const std::string_view value = line.substr(std::min<std::size_t>(1, line.size()));
      return value.substr(0, value.find(line.empty() ? '"' : line.front()));
    }
  }
  return {};
}

auto joint_file_text(const JointFile& joint) -> std::string {
  const bool angle = joint.catalogue->target() == TargetKind::kAngle;
  std::string text = std::string("# A law of ") + (angle ? "a joint" : "an effort") +
                     ": y = sum of terms, each coefficient times its regressor. Terms that are absent are off.\n" +
                     "schema = \"" + (angle ? kJointSchema : kEffortSchema) + "\"\n" + "status = \"" +
                     word_of(joint.status) + "\"\n\n[conditioner]\n";
  const auto& conditioner = joint.parameters.conditioner;
  text += "direction_threshold = " + quantity(conditioner.direction_threshold_rad, joint.catalogue->motion_unit(), {});
  if (angle) {  // an effort's rates come from a given motion and do not lag
    text += "rate_time_constant = " + quantity(conditioner.rate_time_constant_s, "s", {});
  }
  for (const auto& term : *joint.catalogue) {
    text += joint.has(term.name) ? term_text(joint, term) : "";
  }
  if (joint.steady_torque) {
    text += "\n# Motor torque while the motor moves steadily.\n[feedforward]\n";
    text += "torque_forward = " + quantity(joint.steady_torque->forward_nm, "Nm", {});
    text += "torque_backward = " + quantity(joint.steady_torque->backward_nm, "Nm", {});
  }
  text += coupling_text(joint.coupled_to);
  return text + (joint.fit ? fit_text(*joint.fit, joint.catalogue->target_unit()) : "");
}

void write_joint_file(const std::string& path, const JointFile& joint) {
  write_text_file(path, joint_file_text(joint));
}

}  // namespace capstan::tools
