// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <nlohmann/json.hpp>

#include "capstan/tools/diagnose/diagnosis.hpp"
#include "capstan/tools/identify/term_catalogue.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

using Json = nlohmann::ordered_json;

auto parameter_json(const Json& value, const char* unit, const std::optional<Interval>& ci95) -> Json {
  Json json = {{"value", value}, {"unit", unit}};
  json["ci95"] = ci95 ? Json(*ci95) : Json(nullptr);
  return json;
}

/// Parameters of the named terms. Names are those of the coefficients and shapes; the catalogue keeps them distinct
/// enough by prefixing the term where two terms share one.
auto parameters_json(const JointFile& joint, const std::vector<std::string>& terms,
                     const std::vector<std::string>& undetermined = {}) -> Json {
  Json json = Json::object();
  for (const auto& name : terms) {
    const CatalogueTerm& term = joint.catalogue->term(name);
    auto key = [&](const char* parameter) {
      return json.contains(parameter) ? name + "." + parameter : std::string(parameter);
    };
    for (std::size_t i = 0; i < term.coefficients.size(); ++i) {
      const std::size_t at = term.first_coefficient + i;
      const bool known = std::find(undetermined.begin(), undetermined.end(), name + "." + term.coefficients[i].name) ==
                         undetermined.end();
      json[key(term.coefficients[i].name)] =
          parameter_json(known ? Json(joint.parameters.coefficients[at]) : Json(nullptr), term.coefficients[i].unit,
                         known ? joint.coefficient_ci95[at] : std::nullopt);
    }
    for (std::size_t i = 0; i < term.shapes.size(); ++i) {
      const std::size_t at = term.first_shape + i;
      json[key(term.shapes[i].name)] =
          parameter_json(joint.parameters.shapes[at], term.shapes[i].unit, joint.shape_ci95[at]);
    }
  }
  return json;
}

auto size_json(const std::optional<EffectSize>& size) -> Json {
  if (!size) {
    return nullptr;
  }
  return {{"value", size->value}, {"unit", size->unit}, {"ci95", size->ci95 ? Json(*size->ci95) : Json(nullptr)}};
}

auto effect_json(const Diagnosis& d, const AddedEffect& effect) -> Json {
  const bool grown = d.effort_law && d.law.has(effect.name);  // the law that is delivered says how large it is
  const JointFile& law = d.found && !grown ? *d.found : d.law;
  // Another pretension of the law's own tendons is no term of its own.
  const std::string term = law.has("tendon") && !law.has(effect.name) ? "tendon" : effect.name;
  return {{"name", effect.name},
          {"alternatives", effect.alternatives},
          {"parameters", parameters_json(law, {term}, d.undetermined)},
          {"size", size_json(effect.size)},
          {"evidence",
           {{"p_value", effect.p_value},
            {"log_evidence_nats", effect.log_e_value},
            {"log_evidence_needed_nats", effect.log_e_value_needed},
            {"log_likelihood_gain", effect.log_likelihood},
            {"explained_share", effect.explained},
            {"explained_t", effect.explained_t},
            {"absorbed_by_base", effect.absorbed},
            {"share_of_explainable", d.explained_share},
            {"grade", d.repeats > 1 ? "confirmed" : "indicated"}}}};
}

auto unnamed_json(const UnnamedPart& part) -> Json {
  return {{"signals", part.signals},
          {"form", part.form},
          {"share", part.share},
          {"rmse", part.rmse},
          {"sentence", part.sentence}};
}

auto map_json(const ResidualMap& map) -> Json {
  Json cells = Json::array();
  for (const auto& cell : map.cells) {
    cells.push_back({{"signal", cell.signal},
                     {"forward", cell.forward},
                     {"from", cell.from},
                     {"to", cell.to},
                     {"mean", cell.mean},
                     {"visits", cell.visits},
                     {"p_value", cell.p_value},
                     {"found", cell.found}});
  }
  return {{"sentence", map.sentence}, {"cells", cells}};
}

/// What the logs can tell of the delivered law's parameters.
auto told_json(const Identifiability& told) -> Json {
  Json parameters = Json::array();
  for (const auto& one : told.parameters) {
    parameters.push_back({{"name", one.name},
                          {"share", one.share},
                          {"own", one.own},
                          {"most_alike", one.most_alike.empty() ? Json(nullptr) : Json(one.most_alike)},
                          {"correlation", one.correlation},
                          {"holds_zero", one.holds_zero()}});
  }
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < told.correlation.rows(); ++i) {
    const Eigen::VectorXd row = told.correlation.row(i);
    rows.push_back(std::vector<double>(row.begin(), row.end()));
  }
  Json confused = Json::array();
  for (const auto& pair : told.confused) {
    confused.push_back(
        {{"parameters", {pair.first, pair.second}}, {"correlation", pair.correlation}, {"sentence", pair.sentence}});
  }
  return {{"parameters", parameters}, {"correlation", rows}, {"confused", confused}};
}

/// What logs told of the tendons' pretension; null for what they did not.
auto pretension_json(const Diagnosis& d) -> Json {
  const bool of_law = d.law.fit && d.law.fit->pretension;
  if (!d.pretension && !of_law) {
    return nullptr;
  }
  const PretensionNumbers& n = d.pretension ? d.pretension->now : *d.law.fit->pretension;
  const auto number = [](double value, double half, const std::string& unit) -> Json {
    return value == 0.0 ? Json(nullptr)
                        : Json{{"value", value}, {"unit", unit}, {"ci95", {value - half, value + half}}};
  };
  Json change = nullptr;
  if (d.pretension) {
    change = number(d.pretension->change.value, d.pretension->change.half, d.pretension->unit);
  }
  return {{"force", number(n.force_n(), n.force_95_n(), "N")},
          {"torque", number(n.torque_nm(), n.torque_95_nm(), "Nm")},
          {"friction", number(n.friction_nm(), n.friction_95_nm(), "Nm")},
          {"eta", number(n.eta(), n.eta_95(), "1")},
          {"change", change},
          {"sentence", d.pretension ? drift_sentence(*d.pretension) : pretension_sentence(n)}};
}

auto error_json(const ErrorSummary& error) -> Json {
  return {{"rmse", error.rmse}, {"gof_percent", error.gof_percent}, {"relative_percent", error.relative_percent}};
}

}  // namespace

auto diagnosis_json(const Diagnosis& d) -> std::string {
  Json json;
  json["schema"] = "capstan.diagnosis/2";
  json["log"] = {{"samples", d.samples}, {"rate_hz", d.rate_hz}, {"repeats", d.repeats}, {"warnings", all_notes(d)}};
  json["target"] = d.target;
  json["base"] = {{"model", d.base_model}, {"parameters", parameters_json(d.base, d.base.terms)}};
  json["law"] = {{"status", word_of(d.law.status)},
                 {"terms", d.law.terms},
                 {"file", d.law_file ? Json(*d.law_file) : Json(nullptr)}};
  json["verdict"] = verdict_word(d.verdict);
  json["reason"] = d.reason;
  json["sizes"] = d.sizes;
  json["pretension"] = pretension_json(d);
  json["effects"] = Json::array();
  for (const auto& effect : d.effects) {
    json["effects"].push_back(effect_json(d, effect));
  }
  json["before"] = error_json(d.before);
  json["after"] = error_json(d.after);
  json["ratio_ci95"] = d.ratio_ci95;
  json["noise_floor"] = d.noise_floor;
  json["floor_from"] = d.floor_from;
  json["detectable"] = Json::array();
  const double whole = d.traces.measured.size() > 0 ? rms(d.traces.measured) : 0.0;
  for (const auto& effect : d.detectable) {
    if (effect.rmse <= whole) {  // more than all of the motion is none that this log would show
      json["detectable"].push_back({{"name", effect.name}, {"rmse", effect.rmse}});
    }
  }
  json["unnamed"] = d.unnamed ? unnamed_json(*d.unnamed) : Json(nullptr);
  json["candidates"] = Json::array();
  for (const auto& candidate : d.candidates) {
    json["candidates"].push_back({{"name", candidate.name}, {"share", candidate.share}});
  }
  json["stability"] = {{"halves", 2}, {"agree", d.halves_agree}};
  json["test"] = Json::array();
  for (const auto& log : d.tested) {
    json["test"].push_back({{"log", log.name}, {"before", error_json(log.before)}, {"after", error_json(log.after)}});
  }
  json["residual_map"] = {{"before", map_json(d.map_before)}, {"after", map_json(d.map_after)}};
  json["identifiability"] = told_json(d.told);
  json["next_experiment"] = d.next_experiment ? Json(*d.next_experiment) : Json(nullptr);
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

auto all_notes(const Diagnosis& d) -> std::vector<std::string> {
  std::vector<std::string> all = d.warnings;
  all.insert(all.end(), d.notes.begin(), d.notes.end());
  if (repeats_what_was_fitted(d)) {
    all.emplace_back(kSameMotion);
  }
  return all;
}

auto verdict_word(Verdict verdict) -> const char* {
  switch (verdict) {
    case Verdict::kNothingMissing:
      return "nothing_missing";
    case Verdict::kEffect:
      return "effect";
    case Verdict::kAmbiguous:
      return "ambiguous";
    case Verdict::kEffectPlusUnlisted:
      return "effect_plus_unlisted";
    case Verdict::kUnknown:
      return "unknown";
    case Verdict::kNotIdentifiable:
      return "not_identifiable";
    case Verdict::kDataUnfit:
      break;
  }
  return "data_unfit";
}

auto is_refusal(Verdict verdict) -> bool {
  return verdict == Verdict::kUnknown || verdict == Verdict::kNotIdentifiable || verdict == Verdict::kDataUnfit;
}

}  // namespace capstan::tools
