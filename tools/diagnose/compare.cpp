// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/compare.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/identify/log_zeros.hpp"
#include "capstan/tools/identify/pretension.hpp"
#include "capstan/tools/identify/tendon_fit.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

using Json = nlohmann::ordered_json;

/// How often a healthy joint may be told that anything has moved: it is asked from day to day, about every parameter of
/// its law. Intervals that do not meet were found in 6 of 480 pairs of a drawn healthy joint's logs (100 and 200 Hz, 40
/// to 80 s, 28 Nov 2026). The largest difference there was 3.0 standard deviations; six parameters are asked for 3.8.
constexpr double kFalseMoves = 0.001;

/// How well a ratio comes again beside another effect, as a share, two spreads: 0.02 % off at most by what tendons
/// carry and by what changes the loop (joints of a plant by itself, 29 November 2026).
constexpr double kRatioBeside = 5e-4;

auto half_of(const Interval& ci95) -> double {
  return 0.5 * (ci95[1] - ci95[0]);
}

/// How far two values are apart, in half widths of the difference's interval.
auto distance(const MovedParameter& one) -> double {
  const double half = std::hypot(half_of(one.healthy_ci95), half_of(one.now_ci95));
  const double apart = std::abs(one.now - one.healthy);
  return half > 0.0 ? apart / half : apart > 0.0 ? std::numeric_limits<double>::infinity() : 0.0;
}

/// Every parameter that has an interval at both times.
auto known_at_both(const JointFile& healthy, const JointFile& now) -> std::vector<MovedParameter> {
  std::vector<MovedParameter> known;
  for (const auto& term : *healthy.catalogue) {
    if (!healthy.has(term.name)) {
      continue;
    }
    for (std::size_t i = 0; i < term.coefficients.size(); ++i) {
      const std::size_t at = term.first_coefficient + i;
      if (healthy.coefficient_ci95[at] && now.coefficient_ci95[at]) {
        known.push_back({term.name + "." + term.coefficients[i].name, term.coefficients[i].unit,
                         healthy.parameters.coefficients[at], now.parameters.coefficients[at],
                         *healthy.coefficient_ci95[at], *now.coefficient_ci95[at]});
      }
    }
    for (std::size_t i = 0; i < term.shapes.size(); ++i) {
      const std::size_t at = term.first_shape + i;
      if (healthy.shape_ci95[at] && now.shape_ci95[at]) {
        known.push_back({term.name + "." + term.shapes[i].name, term.shapes[i].unit, healthy.parameters.shapes[at],
                         now.parameters.shapes[at], *healthy.shape_ci95[at], *now.shape_ci95[at]});
      }
    }
  }
  return known;
}

/// The law that now's logs are measured by. Under a free tip tendons' numbers trade against each other, so none of them
/// moves by itself: they stay the healthy joint's, and what has changed there is asked of the loop.
auto law_of_now(const JointFile& healthy, const std::vector<AxisLog>& now) -> LawForm {
  const auto held = [&healthy](const AxisLog& log) { return is_held(log, beta_of(healthy)); };
  const auto told = [&healthy] { return healthy.fit->pretension && healthy.fit->pretension->eta() > 0.0; };
  if (!healthy.has(kTendonModel) || (told() && std::any_of(now.begin(), now.end(), held))) {
    return form_of(healthy);
  }
  LawForm form = base_of(healthy);
  form.held.emplace_back(kTendonModel);
  return form;
}

/// What the pretension has changed by: from the healthy time's to now's, both beside the law that both are measured by.
auto pretension_between(const Comparison& comparison) -> std::optional<PretensionDrift> {
  if (!comparison.healthy.pretension || !comparison.now.pretension) {
    return comparison.now.pretension;
  }
  const PretensionDrift& before = *comparison.healthy.pretension;
  PretensionDrift drift = *comparison.now.pretension;
  const double times = drift.times.value / before.times.value;
  const double of_law = drift.pretension.value / drift.times.value;  // the pretension at the law's own time
  // How well that is known counts for the difference alone; how well a loop's torque is, twice.
  const double of_times = std::hypot(drift.times.half, before.times.half);
  const double known = drift.pretension.half / drift.pretension.value;
  drift.change.value = drift.pretension.value - before.pretension.value;
  drift.change.half = std::hypot(of_law * of_times, known * drift.change.value);
  drift.times = {times, of_times / before.times.value};
  return drift;
}

/// A law fitted to logs of one joint, each of which may be counted from another zero.
auto fitted_to(std::vector<AxisLog> logs, const LawForm& form) -> JointFile {
  count_from_one_zero(logs, form);
  return identify(logs, form).joint;
}

/// What now's logs have beyond the healthy joint's. Laws of efforts and of a torque behind a gear are asked from their
/// base law again, so friction that the joint always had is found again.
auto effects_that_came(const HealthyJoint& healthy, const std::vector<AddedEffect>& now) -> std::vector<AddedEffect> {
  std::vector<AddedEffect> came;
  const auto was_there = [&healthy](const AddedEffect& effect) {
    const auto& found = healthy.diagnosis.effects;
    return healthy.law.has(effect.name) ||
           std::any_of(found.begin(), found.end(), [&](const auto& one) { return one.name == effect.name; });
  };
  std::remove_copy_if(now.begin(), now.end(), std::back_inserter(came), was_there);
  return came;
}

/// The form with effects that have come, from the shapes that they were found with. Without them the healthy law's own
/// numbers would make up for them: where a gap had come the ratio had "moved" from 1.083 to 1.022.
auto with_effects(LawForm form, const std::vector<AddedEffect>& came, const JointFile& found) -> LawForm {
  for (const auto& effect : came) {
    if (!form.has(effect.name) && found.has(effect.name)) {
      form.terms.push_back(effect.name);
      const CatalogueTerm& term = form.catalogue->term(effect.name);
      form.set_shapes(term, form_of(found).shapes_of(term));
    }
  }
  return form;
}

auto loop_law(double half_width_rad) -> LawForm {
  LawForm law;
  law.terms = {"motor_angle", "joint_offset", kPlayTerm};
  law.set_shapes(law.catalogue->term(kPlayTerm), {half_width_rad});
  return law;
}

/// Widens the interval of a coefficient, where it has one.
void widen(JointFile& law, const char* term, double by) {
  if (auto& ci95 = law.coefficient_ci95[law.catalogue->term(term).first_coefficient]) {
    (*ci95)[0] -= by;
    (*ci95)[1] += by;
  }
}

/// What tendons carry leaves them as they were; a pretension or stiffness of their own does not.
auto tendons_carry_it(const Comparison& comparison) -> bool {
  const auto& found = comparison.now.found;
  return found && found->has(kTendonModel) &&
         std::none_of(comparison.came.begin(), comparison.came.end(), [](const auto& effect) {
           return effect.name == kPretensionTerm || effect.name == kHardeningTerm;
         });
}

auto loop_of_healthy(const std::vector<AxisLog>& logs, const JointFile& healthy) -> std::optional<JointFile> {
  const auto loop = loop_of(healthy);
  const auto held = [&healthy](const AxisLog& log) { return is_held(log, beta_of(healthy)); };
  return loop && std::none_of(logs.begin(), logs.end(), held)
             ? std::optional(fitted_to(logs, loop_law(loop->half_width_rad)))
             : std::nullopt;
}

/// Ratio and zero alone: how wide the loop is the diagnosis says.
auto without_loop(JointFile law) -> JointFile {
  std::erase(law.terms, kPlayTerm);
  return law;
}

/// Ratio and zero, which have moved beside something else that changed: by the law that was found for it.
auto moved_beside(const HealthyJoint& healthy, const std::vector<AxisLog>& now, const Comparison& comparison)
    -> std::vector<MovedParameter> {
  const JointFile& found = comparison.now.found ? *comparison.now.found : comparison.now.law;
  const double ratio_known = kRatioBeside * std::abs(beta_of(healthy.fitted));
  if (tendons_carry_it(comparison)) {
    LawForm form = base_of(found);
    form.held.emplace_back(kTendonModel);
    JointFile law = fitted_to(now, with_effects(std::move(form), comparison.came, found));
    widen(law, "motor_angle", ratio_known);
    return moved_between(healthy.fitted, law);
  }
  const JointFile& before = *healthy.by_loop;
  const std::size_t width = before.catalogue->term(kPlayTerm).first_shape;
  const double start = (found.has(kPlayTerm) ? found : before).parameters.shapes[width];
  JointFile law = fitted_to(now, with_effects(loop_law(start), comparison.came, found));
  widen(law, "motor_angle", ratio_known);
  // Where the loop grows or shrinks, its middle goes with either side.
  const double wider = law.parameters.shapes[width] - before.parameters.shapes[width];
  widen(law, "joint_offset", 0.5 * std::abs(beta_of(healthy.fitted) * wider));
  return moved_between(without_loop(before), law);
}

}  // namespace

auto moved_between(const JointFile& healthy, const JointFile& now) -> std::vector<MovedParameter> {
  std::vector<MovedParameter> moved = known_at_both(healthy, now);
  // Either sign of any of them may be chance.
  const double asked =
      normal_quantile_upper(kFalseMoves / (2.0 * static_cast<double>(std::max<std::size_t>(1, moved.size()))));
  const double of_interval = normal_quantile_upper(0.025);
  std::erase_if(moved, [&](const auto& one) { return distance(one) <= asked / of_interval; });
  std::stable_sort(moved.begin(), moved.end(), [](const auto& a, const auto& b) { return distance(a) > distance(b); });
  return moved;
}

auto moved_sentence(const MovedParameter& one) -> std::string {
  const std::vector<double> values = {one.healthy, one.healthy_ci95[0], one.healthy_ci95[1],
                                      one.now,     one.now_ci95[0],     one.now_ci95[1]};
  const std::size_t different = std::set<double>(values.begin(), values.end()).size();
  std::vector<std::string> texts(values.size());
  constexpr int kMostDigits = 17;  // tell any two numbers apart
  for (int digits = 4; digits <= kMostDigits; ++digits) {
    std::transform(values.begin(), values.end(), texts.begin(),
                   [digits](double value) { return rounded(value, digits); });
    if (std::set<std::string>(texts.begin(), texts.end()).size() == different) {
      break;
    }
  }
  return one.name + " moved from " + texts[0] + " [" + texts[1] + ", " + texts[2] + "] to " + texts[3] + " [" +
         texts[4] + ", " + texts[5] + "] " + one.unit;
}

auto healthy_joint(const std::vector<AxisLog>& logs, const DiagnoseOptions& options) -> HealthyJoint {
  HealthyJoint healthy{diagnose(logs, options), {}, {}};
  if (healthy.diagnosis.law.terms.empty()) {
    throw Refusal("the healthy logs give no law to compare by: " + healthy.diagnosis.reason);
  }
  if (options.base_law) {
    healthy.law = *options.base_law;
    healthy.fitted = fitted_to(logs, form_of(healthy.law));
    healthy.by_loop = loop_of_healthy(logs, healthy.fitted);
    return healthy;
  }
  // A law that was grown has no intervals; what has names has.
  const bool named = healthy.diagnosis.law.status == LawStatus::kConfirmed;
  healthy.law = named ? healthy.diagnosis.law : healthy.diagnosis.base;
  healthy.fitted = fitted_to(logs, form_of(healthy.law));
  if (healthy.law.fit) {
    healthy.law.fit->pretension = healthy.fitted.fit->pretension;
  }
  healthy.by_loop = loop_of_healthy(logs, healthy.fitted);
  return healthy;
}

auto compare(const HealthyJoint& healthy, const std::vector<AxisLog>& now, const DiagnoseOptions& options)
    -> Comparison {
  Comparison result;
  result.healthy = healthy.diagnosis;
  result.terms = healthy.law.terms;
  DiagnoseOptions from_healthy = options;
  if (healthy.law.catalogue->target() == TargetKind::kAngle) {
    from_healthy.base_law = healthy.law;
    from_healthy.base_model = "the healthy joint's law";
  }
  result.now = diagnose(now, from_healthy);
  result.came = effects_that_came(healthy, result.now.effects);
  if (healthy.by_loop && result.now.verdict != Verdict::kNothingMissing) {
    result.moved = moved_beside(healthy, now, result);
  } else {
    LawForm form = law_of_now(healthy.fitted, now);
    if (result.now.found) {
      form = with_effects(std::move(form), result.came, *result.now.found);
    }
    result.moved = moved_between(healthy.fitted, fitted_to(now, form));
  }
  result.pretension = pretension_between(result);
  return result;
}

auto compare(const std::vector<AxisLog>& healthy, const std::vector<AxisLog>& now, const DiagnoseOptions& options)
    -> Comparison {
  return compare(healthy_joint(healthy, options), now, options);
}

auto comparison_json(const Comparison& comparison) -> std::string {
  Json json;
  json["schema"] = "capstan.comparison/1";
  json["law"] = comparison.terms;
  json["moved"] = Json::array();
  for (const auto& one : comparison.moved) {
    json["moved"].push_back({{"name", one.name},
                             {"unit", one.unit},
                             {"healthy", {{"value", one.healthy}, {"ci95", one.healthy_ci95}}},
                             {"now", {{"value", one.now}, {"ci95", one.now_ci95}}}});
  }
  json["came"] = Json::array();
  for (const auto& effect : comparison.came) {
    json["came"].push_back({{"name", effect.name}, {"alternatives", effect.alternatives}});
  }
  json["pretension"] = nullptr;
  if (comparison.pretension) {
    const auto number = [](const Gauged& one) -> Json {
      return {{"value", one.value}, {"ci95", {one.value - one.half, one.value + one.half}}};
    };
    const PretensionDrift& drift = *comparison.pretension;
    json["pretension"] = {{"unit", drift.unit}, {"now", number(drift.pretension)}, {"change", number(drift.change)}};
  }
  json["verdict"] = verdict_word(comparison.now.verdict);
  json["healthy"] = Json::parse(diagnosis_json(comparison.healthy));
  json["now"] = Json::parse(diagnosis_json(comparison.now));
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace capstan::tools
