// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/identify/force_fit.hpp"
#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/identify/pretension.hpp"
#include "capstan/tools/jobs/logs.hpp"

namespace capstan::tools {

struct IdentifyJob {
  JobLogs logs;
  std::string model = kDefaultModel;  ///< a name, or the path of a joint file
  std::string target;                 ///< column to explain; empty: the model's own
  TendonDrawing drawing = {};         ///< of a law with tendons
};

struct Identified {
  Identification result;
  LawForm form;
  std::vector<AxisLog> logs;
};

/// A law of a joint angle or an effort. Throws BadInput and Refusal; what the logs can not determine is for the caller.
/// @pre the model is none of a joint torque (is_force_model)
auto identify(const IdentifyJob& job, const Say& warn) -> Identified;

/// The sentence for what the logs can not determine.
auto undetermined_sentence(const std::vector<std::string>& undetermined) -> std::string;

/// The text of the law's file.
auto law_text(const Identified& identified) -> std::string;

/// The same for a law of the joint's torque: the numbers, and its [force] section.
struct IdentifiedForce {
  ForceFit fit;
  std::string section;
};
/// @param grid  of preisach
auto identify_force(const JobLogs& logs, const std::string& model, const Say& warn, const PreisachGrid& grid = {})
    -> IdentifiedForce;
auto undetermined_sentence(const ForceFit& fit) -> std::string;

}  // namespace capstan::tools
