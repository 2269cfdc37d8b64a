// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <sstream>

#include "capstan/tools/identify/term_catalogue.hpp"
#include "capstan/tools/joint_file/section_reader.hpp"
#include "capstan/tools/joint_file/table_section.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

void read_conditioner(const SectionReader& reader, const toml::table& root, JointFile& joint) {
  const toml::table* table = reader.table(root, "conditioner");
  if (table == nullptr && root.contains("force") && !root.contains("terms")) {
    reader.fail(
        root,
        "the file has [force] alone, a law of the joint's torque, and one of the joint's angle is wanted; write "
        "it into a board with 'capstan apply', or run it over a log with 'capstan replay'");
  }
  if (table == nullptr) {
    reader.fail(root, "[conditioner] is missing; write it with direction_threshold and rate_time_constant");
  }
  reader.only(*table, {"direction_threshold", "rate_time_constant"}, "[conditioner]");
  auto& conditioner = joint.parameters.conditioner;
  conditioner.direction_threshold_rad = reader.quantity(*table, "direction_threshold", "rad", {0.0, 1.0});
  conditioner.rate_time_constant_s = reader.quantity(*table, "rate_time_constant", "s", {0.0, 1.0});
}

void read_terms(const SectionReader& reader, const toml::table& root, JointFile& joint) {
  const toml::table* all = reader.table(root, "terms");
  if (all == nullptr || !all->contains("motor_angle")) {
    reader.fail(all == nullptr ? root : *all,
                "the law has no ratio; write [terms.motor_angle] with beta = { value = ..., unit = \"1\" }");
  }
  reader.terms(*all, joint);
  if (const double beta = beta_of(joint); std::abs(beta) < kSmallestBeta) {
    reader.fail(*all->get("motor_angle"), "beta = " + rounded(beta) + " is too near zero for the law to be inverted; " +
                                              "check the fit, the joint hardly moved");
  }
}

void read_steady_torque(const SectionReader& reader, const toml::table& root, JointFile& joint) {
  if (const toml::table* table = reader.table(root, "feedforward")) {
    reader.only(*table, {"torque_forward", "torque_backward"}, "[feedforward]");
    joint.steady_torque = SteadyTorque{reader.quantity(*table, "torque_forward", "Nm", {}),
                                       reader.quantity(*table, "torque_backward", "Nm", {})};
  }
}

void read_coupling(const SectionReader& reader, const toml::table& root, JointFile& joint) {
  const toml::table* table = reader.table(root, "coupling");
  if (table == nullptr) {
    return;
  }
  reader.only(*table, {"joint", "joints"}, "[coupling]");
  std::vector<const toml::node*> nodes;
  if (const toml::array* several = (*table)["joints"].as_array()) {
    for (const auto& node : *several) {
      nodes.push_back(&node);
    }
  } else {
    nodes.push_back(table->get("joint"));
  }
  constexpr double kLastAxis = 15.0;
  for (const toml::node* node : nodes) {
    const double number = node != nullptr ? reader.number(*node, "the axis in [coupling]") : -1.0;
    const bool twice = std::find(joint.coupled_to.begin(), joint.coupled_to.end(), number) != joint.coupled_to.end();
    if (number < 0.0 || number > kLastAxis || number != std::floor(number) || twice ||
        joint.coupled_to.size() == kMostOthers) {
      reader.fail(*table,
                  "[coupling] does not name axes; write joint = N, or joints = [N, M] for up to three different ones, "
                  "those whose motors pull");
    }
    joint.coupled_to.push_back(static_cast<int>(number));
  }
}

/// Every slot that a term reads has its axis.
void check_coupling(const SectionReader& reader, const toml::table& root, const JointFile& joint) {
  const std::size_t used = slots_used(joint);
  if (used > joint.coupled_to.size() && used > 1) {
    reader.fail(root, "the law reads " + std::to_string(used) + " coupled axes and [coupling] names " +
                          std::to_string(joint.coupled_to.size()) + "; write joints = [...] with all of them");
  }
}

void read_status(const SectionReader& reader, const toml::table& root, JointFile& joint) {
  const toml::node* node = root.get("status");
  if (node == nullptr) {
    return;  // written before there was one, by a fit of a model that was asked for
  }
  for (const auto status : {LawStatus::kConfirmed, LawStatus::kProvisional, LawStatus::kBase}) {
    if (node->value<std::string>() == word_of(status)) {
      joint.status = status;
      return;
    }
  }
  reader.fail(*node, "unknown status; write \"confirmed\", \"provisional\" or \"base\"");
}

/// "capstan.joint/2" and beyond: what this version can not know.
auto is_newer(const std::optional<std::string>& schema) -> bool {
  const std::string stem = "capstan.joint/";
  return schema && schema->starts_with(stem) && *schema != kJointSchema &&
         schema->find_first_not_of("0123456789", stem.size()) == std::string::npos && schema->size() > stem.size();
}

/// The table within [fit] of a list of numbers that know their names and units, if it is there.
template <typename Numbers>
auto numbers_of(const SectionReader& reader, const toml::table& fit, const char* key, double most = kLargestNumber)
    -> std::optional<Numbers> {
  const toml::table* table = reader.table(fit, key, "fit.");
  if (table == nullptr) {
    return std::nullopt;
  }
  reader.only(*table, {Numbers::kNames.begin(), Numbers::kNames.end()}, "[fit." + std::string(key) + "]");
  Numbers numbers;
  for (std::size_t i = 0; i < Numbers::kCount; ++i) {
    numbers.values[i] = reader.quantity(*table, Numbers::kNames[i], Numbers::kUnits[i], {-most, most});
  }
  return numbers;
}

void read_fit(const SectionReader& reader, const toml::table& root, JointFile& joint) {
  const toml::table* table = reader.table(root, "fit");
  if (table == nullptr) {
    return;
  }
  reader.only(*table,
              {"rmse", "gof_percent", "samples", "motor_range", "joint_range", "loop_half_width", "loop_torque", "late",
               "friction_rms", "logs", "torque", "error_bar", "pretension"},
              "[fit]");
  FitSummary fit;
  fit.rmse = reader.quantity(*table, "rmse", "rad", {0.0, kLargestNumber});
  const auto number = [&](const char* key) {
    return table->contains(key) ? reader.number(*table->get(key), key) : 0.0;
  };
  fit.gof_percent = number("gof_percent");
  fit.samples = std::lround(number("samples"));
  fit.joint_range = number("joint_range");
  if (const auto* range = table->get("motor_range")) {
    fit.motor_range = reader.interval(*range, "motor_range");
  }
  const auto if_there = [&](const char* key, const char* unit) {
    return table->contains(key) ? std::optional(reader.quantity(*table, key, unit, {0.0, kLargestNumber}))
                                : std::nullopt;
  };
  fit.loop_half_width = if_there("loop_half_width", "rad");
  fit.loop_torque = if_there("loop_torque", "Nm");
  fit.late = if_there("late", "s");
  fit.friction_rms = if_there("friction_rms", "Nm");
  fit.torque = numbers_of<TorqueParts>(reader, *table, "torque");
  fit.error_bar = numbers_of<ErrorBarNumbers>(reader, *table, "error_bar");
  fit.pretension = numbers_of<PretensionNumbers>(reader, *table, "pretension", PretensionNumbers::kMost);
  if (const auto* logs = table->get("logs"); logs != nullptr && logs->as_array() != nullptr) {
    for (const auto& log : *logs->as_array()) {
      fit.logs.push_back(as_written(log.value_or(std::string{})));
    }
  }
  joint.fit = fit;
}

auto read_table(const toml::table& root, const std::string& name) -> JointFile {
  const SectionReader reader(name);
  const auto schema = root["schema"].value<std::string>();
  if (schema == kEffortSchema) {
    throw BadInput(place(name, 1) +
                   "this is a law of an effort, and one of the joint angle is wanted here; make it with " +
                   "capstan identify --model pseudo_kinematic");
  }
  if (is_newer(schema)) {
    throw BadInput(place(name, 1) + "the law is of a newer version, " + *schema + ", and this program reads " +
                   kJointSchema + "; update capstan, or write the file again with this version");
  }
  if (schema != kJointSchema) {
    throw BadInput(place(name, 1) +
                   "the schema is not capstan.joint/1; write schema = \"capstan.joint/1\" or make the file " +
                   "with capstan identify");
  }
  reader.only(root, {"schema", "status", "conditioner", "terms", "feedforward", "coupling", "fit", "force"},
              "the file");
  JointFile joint;
  read_conditioner(reader, root, joint);
  read_terms(reader, root, joint);
  read_steady_torque(reader, root, joint);
  read_coupling(reader, root, joint);
  check_coupling(reader, root, joint);
  read_status(reader, root, joint);
  read_fit(reader, root, joint);
  return joint;
}

}  // namespace

auto parse_joint_file(const std::string& text, const std::string& name) -> JointFile {
  return read_toml(text, name, "repair the line or write the file again with capstan identify",
                   [&name](const toml::table& root) { return read_table(root, name); });
}

auto read_joint_file(const std::string& path) -> JointFile {
  return parse_joint_file(read_text_file(path), path);
}

}  // namespace capstan::tools
