// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/python/law.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/identify/force_section.hpp"
#include "capstan/tools/jobs/replay_job.hpp"
#include "capstan/tools/joint_file/effort_file.hpp"
#include "capstan/tools/python/words.hpp"
#include "capstan/tools/replay/effort_replay.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::python {
namespace {

using namespace tools;

void check_size(const Eigen::VectorXd& values, Eigen::Index samples, const std::string& name) {
  if (values.size() != samples) {
    throw BadInput(name + " has " + std::to_string(values.size()) + " values and q1 has " + std::to_string(samples) +
                   "; give one for each sample");
  }
  for (Eigen::Index i = 0; i < samples; ++i) {
    if (!std::isfinite(values[i])) {
      throw BadInput(name + "[" + std::to_string(i) + "] is not a finite number; leave such samples out or fill them");
    }
  }
}

/// A file's text without the line of its schema.
auto without_schema(std::string text) -> std::string {
  const std::size_t at = std::min(text.find("schema"), text.size());
  return text.erase(at, text.find('\n', at) + 1 - at);
}

auto log_of(const Inputs& inputs, const JointFile& law) -> AxisLog {
  const Eigen::Index samples = inputs.q1.size();
  if (!(inputs.rate_hz > 0.0)) {
    throw BadInput("rate_hz is " + rounded(inputs.rate_hz) + "; give the samples per second, for instance 1000");
  }
  if (law.has("tendon_elongation") && !inputs.tau) {
    throw BadInput("the law has tendon_elongation and there is no tau; give the motor's torque in N m");
  }
  if (law.coupled_to.size() != inputs.others.size()) {
    throw BadInput("the law is coupled to " + std::to_string(law.coupled_to.size()) + " other axes and others has " +
                   std::to_string(inputs.others.size()) + "; give q1 and tau of each");
  }
  AxisLog log;
  log.name = kArrays;
  log.period_s = 1.0 / inputs.rate_hz;
  log.q1_rad = inputs.q1;
  log.time_s = Eigen::VectorXd::LinSpaced(samples, 0.0, static_cast<double>(samples - 1) * log.period_s);
  log.tau_nm = inputs.tau.value_or(Eigen::VectorXd::Zero(samples));
  check_size(log.q1_rad, samples, "q1");
  check_size(log.tau_nm, samples, "tau");
  if (inputs.temperature) {
    log.temperature_c = *inputs.temperature;
    check_size(log.temperature_c, samples, "temperature");
  }
  for (const auto& [q1, tau] : inputs.others) {
    check_size(q1, samples, "q1 of another axis");
    check_size(tau, samples, "tau of another axis");
    log.others.push_back({.q1_rad = q1, .tau_nm = tau});
  }
  return log;
}

}  // namespace

auto Law::read(const std::string& path) -> Law {
  Law law;
  law.name_ = path;
  law.text_ = read_text_file(path);
  if (is_effort_file(path)) {
    law.law_ = parse_effort_file(law.text_, path);
  } else if (is_force_alone(law.text_, path)) {
    law.law_ = Force{force_model(law.text_, path), read_force_fit(law.text_, path)};
  } else {
    law.law_ = parse_joint_file(law.text_, path);
  }
  return law;
}

auto Law::from(const Identified& identified) -> Law {
  Law law;
  law.name_ = "the law";
  law.text_ = law_text(identified);
  if (identified.logs.front().motion_alone()) {
    law.law_ = runnable_law(identified.result.joint, identified.logs);
  } else {
    law.law_ = identified.result.joint;
  }
  law.notes_ = identified.result.notes;
  return law;
}

auto Law::from(const IdentifiedForce& identified, const std::string& model) -> Law {
  Law law;
  law.name_ = "the law";
  law.law_ = Force{model, identified.fit};
  law.text_ = with_force_section("", identified.section);
  law.notes_ = identified.fit.notes;
  return law;
}

auto Law::joint() const -> const JointFile& {
  const auto* effort = std::get_if<EffortLaw>(&law_);
  return effort != nullptr ? effort->joint : std::get<JointFile>(law_);
}

auto Law::kind() const -> std::string {
  return law_.index() == 0 ? "angle" : law_.index() == 1 ? "effort" : "force";
}

auto Law::status() const -> std::string {
  if (const auto* effort = std::get_if<EffortLaw>(&law_)) {
    return effort->status;
  }
  return kind() == "force" ? word_of(LawStatus::kConfirmed) : word_of(joint().status);
}

auto Law::terms() const -> std::vector<std::string> {
  if (const auto* force = std::get_if<Force>(&law_)) {
    return {force->model};
  }
  return joint().terms;
}

auto Law::parameters() const -> std::vector<Parameter> {
  std::vector<Parameter> list;
  if (const auto* force = std::get_if<Force>(&law_)) {
    for (const auto& p : force->fit.parameters) {
      const Interval around = {p.value - p.half_interval, p.value + p.half_interval};
      list.push_back({p.name, p.value, p.unit, p.half_interval > 0.0 ? std::optional(around) : std::nullopt});
    }
    return list;
  }
  for (const auto& term : *joint().catalogue) {
    if (!joint().has(term.name)) {
      continue;
    }
    for (std::size_t i = 0; i < term.coefficients.size(); ++i) {
      const std::size_t at = term.first_coefficient + i;
      list.push_back({term.name + "." + term.coefficients[i].name, joint().parameters.coefficients[at],
                      term.coefficients[i].unit, joint().coefficient_ci95[at]});
    }
    for (std::size_t i = 0; i < term.shapes.size(); ++i) {
      const std::size_t at = term.first_shape + i;
      list.push_back({term.name + "." + term.shapes[i].name, joint().parameters.shapes[at], term.shapes[i].unit,
                      joint().shape_ci95[at]});
    }
  }
  return list;
}

auto Law::fit() const -> std::optional<FitSummary> {
  if (const auto* force = std::get_if<Force>(&law_)) {
    return FitSummary{.rmse = force->fit.rmse_nm, .samples = force->fit.samples, .logs = {}};
  }
  return joint().fit;
}

auto Law::run(const Inputs& inputs, Arithmetic arithmetic) const -> Replayed {
  if (kind() != "angle") {
    throw BadInput(
        "the law explains a torque or a force and arrays are run through laws of joint angles only; use "
        "replay() with a log");
  }
  Replayed replayed = tools::replay(log_of(inputs, joint()), motion_parameters(joint()), arithmetic);
  refuse_saturated(replayed.saturated, name_);
  return replayed;
}

auto Law::replay(const CsvLog& log, int axis, Arithmetic arithmetic, const Say& warn) const -> CsvLog {
  std::string text;
  long saturated = 0;
  if (const auto* effort = std::get_if<EffortLaw>(&law_)) {
    if (arithmetic == Arithmetic::kFixed) {
      const BoardEffortReplay replayed = replay_board_effort(log, axis, *effort, name_);
      std::for_each(replayed.log.warnings.begin(), replayed.log.warnings.end(), warn);
      text = replayed.text;
      saturated = replayed.effort.saturated;
    } else {
      const EffortReplay replayed = replay_effort(log, axis, *effort);
      std::for_each(replayed.log.warnings.begin(), replayed.log.warnings.end(), warn);
      text = replayed.text;
    }
  } else {
    LogColumns columns;
    CsvLog rows = log;
    if (kind() == "angle") {
      AngleReplay replayed = replay_angle(log, axis, joint(), arithmetic, warn);
      columns = columns_of(axis, replayed.estimates);
      saturated = replayed.estimates.saturated;
      rows = std::move(replayed.csv);
    } else {
      std::vector<std::string> notes;
      rows = force_rows(log, axis, notes);
      std::for_each(notes.begin(), notes.end(), warn);
    }
    if (const BoardForceLaw law = read_board_force_law(text_, name_); law.parameters.kind != ForceLawKind::kNone) {
      columns.add(axis_column(axis, "tau_out_est_Nm"), replay_torque(rows, axis, law, arithmetic, warn));
    }
    text = rows.text_with(columns.names, columns.values);
  }
  refuse_saturated(saturated, name_);
  return CsvLog::parse(std::move(text), log.name());
}

void Law::save(const std::filesystem::path& path) const {
  const bool beside = kind() == "force" && std::filesystem::exists(path);
  write_text_file(path.string(),
                  beside ? with_force_section(read_text_file(path.string()), without_schema(text_)) : text_);
}

}  // namespace capstan::python
