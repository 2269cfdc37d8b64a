// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/jobs/identify_job.hpp"

#include <cmath>

#include "capstan/tools/identify/force_section.hpp"
#include "capstan/tools/identify/log_zeros.hpp"
#include "capstan/tools/jobs/law_request.hpp"
#include "capstan/tools/joint_file/effort_file.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

/// All of a few names, the first of many.
auto short_list(const std::vector<std::string>& names) -> std::string {
  constexpr std::size_t kShown = 8;
  if (names.size() <= kShown) {
    return joined(names);
  }
  const std::vector<std::string> shown(names.begin(), names.begin() + kShown);
  return joined(shown) + " and " + std::to_string(names.size() - kShown) + " more";
}

/// Why a law that was fitted is not sure to be one of the joint; empty: nothing speaks against it.
auto doubt_of(const JointFile& law) -> std::string {
  const double gof = law.fit->gof_percent;
  if (law.has("motor_angle")) {
    const auto& beta = law.coefficient_ci95[law.catalogue->term("motor_angle").first_coefficient];
    if (beta && (*beta)[0] <= 0.0 && (*beta)[1] >= 0.0) {
      return "the log does not show that the joint follows its motor (the interval of motor_angle.beta holds 0), so "
             "the law is provisional; check the joint's sensor and the column that it is read from";
    }
  }
  if (!(gof > 0.0)) {  // what is left is larger than all that the law says
    return "the law leaves more than it explains" +
           (std::isfinite(gof) ? " (goodness of fit " + rounded(gof, 3) + " %)" : std::string()) +
           ", so it is provisional; choose another --model, or check the columns (--map, --target)";
  }
  return "";
}

template <typename Fit>
auto identified(const Fit& fit) -> IdentifiedForce {
  return {fit, fit.undetermined.empty() ? force_section(fit) : ""};
}

}  // namespace

auto identify(const IdentifyJob& job, const Say& warn) -> Identified {
  LawRequest asked = request_for(job.model, job.target, job.logs);
  add_moving_axes(job.logs.files, asked.columns);
  Identified done;
  done.logs = read_recordings(job.logs.files, asked.columns, warn);
  done.form = asked.law ? form_of(*asked.law) : form_of_model(job.model, done.logs);
  for (const auto& zero : count_from_one_zero(done.logs, done.form)) {
    warn(zero);
  }
  done.result = identify(done.logs, done.form);
  put_into_newtons(job.drawing, done.result.joint);
  if (const std::string doubt = doubt_of(done.result.joint); !doubt.empty()) {
    done.result.joint.status = LawStatus::kProvisional;
    warn(doubt);
  }
  return done;
}

auto undetermined_sentence(const std::vector<std::string>& undetermined) -> std::string {
  return "the log can not determine " + joined(undetermined) +
         "; record a motion with reversals at several amplitudes and loads";
}

auto law_text(const Identified& identified) -> std::string {
  return identified.logs.front().motion_alone()
             ? effort_file_text(runnable_law(identified.result.joint, identified.logs))
             : joint_file_text(identified.result.joint);
}

auto identify_force(const JobLogs& logs, const std::string& model, const Say& warn, const PreisachGrid& grid)
    -> IdentifiedForce {
  std::vector<AxisLog> read;
  for (const auto& file : logs.files) {
    read.push_back(read_force_log(file, logs.axis));
    for (const auto& warning : read.back().warnings) {
      warn(warning);
    }
  }
  if (model == "preisach") {
    return identified(fit_preisach(read, grid));
  }
  return identified(model == "blend" ? fit_blend(read) : fit_pull_push(read));
}

auto undetermined_sentence(const ForceFit& fit) -> std::string {
  return "the log can not determine " + short_list(fit.undetermined) + "; " + fit.cure;
}

}  // namespace capstan::tools
