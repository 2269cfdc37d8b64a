// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "capstan/tools/diagnose/identifiability.hpp"
#include "capstan/tools/diagnose/residual_map.hpp"
#include "capstan/tools/identify/force_fit.hpp"
#include "capstan/tools/identify/law_fit.hpp"
#include "capstan/tools/identify/pretension.hpp"
#include "capstan/tools/joint_file/joint_file.hpp"
#include "capstan/tools/log/axis_log.hpp"
#include "capstan/tools/select/effort_law.hpp"

namespace capstan::tools {

enum class Verdict {
  kNothingMissing,
  kEffect,
  kAmbiguous,
  kEffectPlusUnlisted,
  kUnknown,
  kNotIdentifiable,
  kDataUnfit
};
/// The contract's word.
auto verdict_word(Verdict verdict) -> const char*;
/// Whether the answer is a refusal (exit status 1): unknown, not_identifiable, data_unfit.
auto is_refusal(Verdict verdict) -> bool;

/// One line of the ranking: how a possible effect fared.
struct RankedEffect {
  std::string name;
  bool in_catalogue = false;
  double p_value = 1.0;
  double log_e_value = 0.0;     ///< nats on unseen rows
  double explained = 0.0;       ///< share of the residual's energy that it takes away, out of fold
  double log_likelihood = 0.0;  ///< above the law alone, nats
  std::string outcome;          ///< why it was taken or ruled out
};

/// One round of the search: what the law of that round left, and who could explain it.
struct RoundSummary {
  bool lacks_something = false;
  double reducible_share = 0.0;  ///< share of the residual's energy that is no noise
  double lack_of_fit_p = 1.0;    ///< against repeated cycles
  double flexible_p = 1.0;       ///< against a flexible model
  std::vector<RankedEffect> ranking;
};

/// How large an effect is, where no coefficient of the law says it.
struct EffectSize {
  double value = 0.0;
  std::string unit;
  std::optional<Interval> ci95 = {};
};

/// An effect that was added to the law.
struct AddedEffect {
  std::string name;
  std::vector<std::string> alternatives;
  double p_value = 1.0, log_e_value = 0.0, log_e_value_needed = 0.0, log_likelihood = 0.0, explained = 0.0,
         explained_t = 0.0, absorbed = 0.0;
  std::optional<EffectSize> size = {};
};

/// Free-running error on the rows that took no part in choice or fit.
struct ErrorSummary {
  double rmse = 0.0;
  double relative_percent = 0.0;  ///< of the target's own rms
  double gof_percent = 0.0;
};

/// An effect and the share of the base law's residual energy that it takes away, out of fold.
struct CandidateShare {
  std::string name;
  double share = 0.0;
};

/// What the delivered law corrects without a name.
struct UnnamedPart {
  std::vector<std::string> signals;  ///< that the residual depends on
  std::string form;                  ///< "hysteresis + curve"
  double share = 0.0;                ///< of the base law's error energy on rows set aside that it takes away
  double rmse = 0.0;                 ///< of that part, in the target's unit
  std::string sentence;
};

/// The smallest contribution of an effect that the log would have shown: its rms in the target's unit.
struct DetectableEffect {
  std::string name;
  double rmse = 0.0;
};

/// A log that took no part, judged by the laws before and after; its zero offset is its own.
struct TestedLog {
  std::string name;
  ErrorSummary before, after;
};

/// Everything the report draws. Rows of all logs, one below the other.
struct Traces {
  Eigen::VectorXd time_s, q1, measured, before, after;
  Eigen::VectorXd load;  ///< the motor's torque, where it is an input of the law
};

struct Diagnosis {
  Verdict verdict = Verdict::kDataUnfit;
  std::string reason;  ///< one sentence
  std::optional<std::string> next_experiment;
  std::string target, base_model;
  std::string unit = "rad", motion_unit = "rad";  ///< of the target, of q1
  long samples = 0;
  double rate_hz = 0.0;
  long repeats = 0;
  std::vector<std::string> warnings;
  std::vector<std::string> notes;  ///< how the logs were looked at; JSON and report have them behind the warnings
  std::vector<std::string> sizes;  ///< how large what came is, as far as the effects' coefficients do not say it
  std::optional<PretensionDrift> pretension = {};  ///< beside that of the healthy joint, where one was given
  JointFile base, law;                             ///< the law before, and with the effects; equal if none was added
  std::optional<EffortLaw> effort_law;             ///< of an effort: `law` with what it takes to run it
  std::optional<PullPushFit> pull_push;  ///< base law of a joint torque, as a file holds it; delivered without another
  std::optional<JointFile> found;        ///< the law with the effects that were found; it need not be the one delivered
  std::vector<AddedEffect> effects;      ///< in the order added
  std::string unlisted;                  ///< that the search could not add and what is missing is most like; or empty
  std::vector<std::string> undetermined;  ///< parameters of `law` that these logs can not determine
  std::vector<RoundSummary> rounds;
  ErrorSummary before, after;
  Interval ratio_ci95 = {1.0, 1.0};
  double noise_floor = 0.0;
  /// "repeats", "flexible model", "law": what the delivered law leaves, if that is less, or "laws of the parts" of a
  /// log that no one law holds over.
  std::string floor_from;
  std::vector<CandidateShare> candidates;
  std::optional<UnnamedPart> unnamed;
  int halves_agree = 0;  ///< of two halves of the log: the delivered law does best there
  std::vector<DetectableEffect> detectable;
  std::vector<TestedLog> tested;
  std::optional<std::string> law_file;  ///< that the law was written to
  double explained_share = 0.0, explained_share_lower = 0.0;
  std::optional<Eigen::Index> changed_at;  ///< of all rows, the one from which the joint is another one
  Traces traces;
  ResidualMap map_before, map_after;  ///< where base law and delivered law leave something
  Identifiability told;               ///< what the logs can tell of the delivered law's parameters
};

struct DiagnoseOptions {
  std::string
      base_model;  ///< empty: rigid_dynamics for an effort, pseudo_kinematic where torque is logged, else kinematic
  std::vector<AxisLog> test_logs = {};     ///< take no part in fit or choice
  std::optional<JointFile> base_law = {};  ///< a joint angle's law to start from instead, called base_model
  TendonDrawing drawing = {};              ///< of a joint with tendons
  std::function<void(const std::string&)> progress = [](const std::string&) {};
};

/// Finds what the base law lacks on these logs. @pre every log has the target
/// Throws Refusal and BadInput for base models as form_of_model() does.
auto diagnose(const std::vector<AxisLog>& logs, const DiagnoseOptions& options) -> Diagnosis;

/// Whether the rows set aside are other cycles of the motion that the law was fitted to, and no other log was asked.
inline auto repeats_what_was_fitted(const Diagnosis& diagnosis) -> bool {
  return diagnosis.repeats > 1 && diagnosis.tested.empty();
}
inline constexpr const char* kSameMotion =
    "the rows set aside repeat the motion that the law was fitted to; use --test LOG to see its error on another "
    "motion";

/// What a person should know of log and law: warnings, then how the logs were looked at.
auto all_notes(const Diagnosis& diagnosis) -> std::vector<std::string>;

/// The contract's JSON, schema capstan.diagnosis/2.
auto diagnosis_json(const Diagnosis& diagnosis) -> std::string;

}  // namespace capstan::tools
