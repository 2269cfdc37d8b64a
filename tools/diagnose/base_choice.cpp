// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/base_choice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "capstan/model/terms/tendon.hpp"
#include "capstan/tools/diagnose/left_to_choose.hpp"
#include "capstan/tools/identify/loop.hpp"
#include "capstan/tools/identify/noncausal_samples.hpp"
#include "capstan/tools/identify/tendon_fit.hpp"
#include "capstan/tools/select/deciding_numbers.hpp"

namespace capstan::tools {
namespace {

/// The loop that tendons draw by their law; nothing where the motor's torque is not steady.
auto loop_by_law(const Preparation& p, const LawForm& tendons, const Blocks& rows) -> std::optional<Loop> {
  JointFile joint = law_with_intervals(p.causal, p.target, rows, tendons, p.conditioner);
  joint.steady_torque = steady_torque(p.logs, p.causal);
  return loop_of(joint);
}

/// What the joint's sensor would have shown without its lateness.
auto brought_ahead(const LawDesign& design, const Eigen::VectorXd& target, double late_s) -> Eigen::VectorXd {
  Eigen::VectorXd ahead(target.size());
  Eigen::Index begin = 0;
  for (std::size_t log = 0; log < design.log_rows().size(); ++log) {
    const Eigen::Index rows = design.log_rows()[log];
    ahead.segment(begin, rows) = ahead_by(late_s / design.period_s(log), target.segment(begin, rows));
    begin += rows;
  }
  return ahead;
}

/// The loop that the joint draws, and how late it is.
auto late_loop(const Preparation& p, const Blocks& rows) -> LawForm {
  const auto [least, most] = std::minmax_element(p.logs.front().q1_rad.begin(), p.logs.front().q1_rad.end());
  std::pair<double, LawForm> best = {std::numeric_limits<double>::infinity(), {}};
  for (const double share : {0.01, 0.03, 0.1}) {  // of the motor's range, where its width is looked for from
    const Loop start{share * (*most - *least), 0.0};
    LawForm loop = with_lateness(p.causal, p.target, rows, fit_loop(p.causal, p.target, rows, start));
    const double left = left_to_choose(p, loop);
    if (left < best.first) {
      best = {left, std::move(loop)};
    }
  }
  return best.second;
}

/// Tendons of a joint that is late, if its loop and they leave less for that. They are looked for as if it were not:
/// several of them fit poorly while the lateness is a part of the law.
auto late_tendons(const Preparation& p, const LawForm& start, const Blocks& rows) -> std::optional<LawForm> {
  const LawForm gauge = late_loop(p, rows);
  const LawForm prompt_gauge = fit_loop(p.causal, p.target, rows, {half_width_of(gauge), 0.0});
  if (left_to_choose(p, gauge) >= kWorthLateness * left_to_choose(p, prompt_gauge)) {
    return std::nullopt;
  }
  const LawForm prompt = fit_tendon(p.causal, brought_ahead(p.causal, p.target, lateness_of(gauge)), rows, start);
  LawForm late = prompt;
  late.terms.emplace_back(kDelayTerm);
  late.set_shapes(late.catalogue->term(kDelayTerm), {lateness_of(gauge)});
  late.held = {kTendonModel};
  late = refine_shapes(p.causal, p.target, rows, std::move(late));
  late.held = start.held;
  const double left_by_prompt = left_to_choose(p, refine_tendon(p.causal, p.target, rows, prompt));
  const bool is_found = lateness_of(late) < late.catalogue->term(kDelayTerm).shapes.front().maximum;
  return is_found && left_to_choose(p, late) < kWorthLateness * left_by_prompt ? std::optional(late) : std::nullopt;
}

/// Without a lateness that is to be named: more than what the torque that grows with the motor's speed makes by
/// stretching the tendons, and than a sample, by which two clocks may differ.
auto without_foreign_lateness(const Preparation& p, LawForm tendons, const Blocks& rows) -> LawForm {
  if (!tendons.has(kDelayTerm)) {
    return tendons;
  }
  const auto loop = loop_by_law(p, tendons, rows);
  const double drag = tendons.shapes_of(tendons.catalogue->term(kTendonModel))[TendonShape::kViscous];
  const double own_s = loop ? drag / (kTorqueOfStretch * loop->torque_stretching(1.0)) : 0.0;
  if (lateness_of(tendons) > std::max(own_s, p.causal.period_s(0))) {
    const std::size_t shape = tendons.catalogue->term(kDelayTerm).first_shape;
    tendons.shapes[shape] = tendons.catalogue->initial_shapes()[shape];
    std::erase(tendons.terms, kDelayTerm);
  }
  return tendons;
}

/// Tendons that are not known yet, and how late their joint is, fitted to the rows to learn from, with the rate's
/// filter that serves them; their compliance is tied to what it is there.
auto fitted_tendons(Preparation& p, const LawForm& start) -> LawForm {
  const Blocks learned = refined(p.split, p.factor).learned();
  const auto late = late_tendons(p, start, learned);
  LawForm law = late ? *late : fit_tendon(p.causal, p.target, learned, start);
  const auto conditioner = choose_tendon_filter(p.logs, p.target, learned, law, p.conditioner);
  if (conditioner.rate_time_constant_s != p.conditioner.rate_time_constant_s) {
    p = with_rate_filter(std::move(p), conditioner.rate_time_constant_s);
    law = refine_tendon(p.causal, p.target, learned, std::move(law));
  }
  law = base_of(law_with_intervals(p.causal, p.target, learned, law, p.conditioner));
  law.held.emplace_back(kTendonModel);
  return law;
}

/// Half the width at the joint of the loop that a search called a gap; 0 where it found none.
auto loop_size(const Preparation& p, const LawForm& law) -> double {
  if (!law.has(kPlayTerm)) {
    return 0.0;
  }
  Eigen::Index gain = 0;
  for (const CatalogueTerm* term : ordered_terms(law)) {
    if (term->name == kPlayTerm) {
      break;
    }
    gain += static_cast<Eigen::Index>(term->coefficients.size());
  }
  const LinearFit fit = fit_law(p.causal, p.target, p.certain(), law);
  return std::abs(fit.theta[gain]) * law.shapes_of(law.catalogue->term(kPlayTerm)).front();
}

auto with_effects(const LawForm& base, const LawForm& all, const std::vector<AddedEffect>& effects, std::size_t count)
    -> LawForm {
  LawForm law = all;
  law.terms = base.terms;
  for (std::size_t i = 0; i < count; ++i) {
    law.terms.push_back(effects[i].name);
  }
  return law;
}

}  // namespace

auto may_be_tendons(const Search& search) -> bool {
  const CatalogueTerm& tendon = catalogue_term(kTendonModel);
  return std::any_of(search.effects.begin(), search.effects.end(), [&](const AddedEffect& effect) {
    const auto is_it = [&](const std::string& name) { return name == effect.name; };
    return std::any_of(tendon.doubles.begin(), tendon.doubles.end(), is_it) ||
           std::any_of(tendon.special_cases.begin(), tendon.special_cases.end(), is_it);
  });
}

auto settled_base(Preparation& p, LawForm base) -> LawForm {
  if (!base.has(kTendonModel)) {
    return base;
  }
  if (base.shapes == base.catalogue->initial_shapes()) {
    base = fitted_tendons(p, base);
    return without_foreign_lateness(p, std::move(base), refined(p.split, p.factor).learned());
  }
  base.held.emplace_back(kTendonModel);
  return base;
}

auto better_base(const Preparation& p, const LawForm& usual, const Search& search) -> std::optional<BaseChoice> {
  const bool torque = std::all_of(p.logs.begin(), p.logs.end(), [](const auto& log) { return log.has_torque; });
  const double found = left_to_choose(p, search.law);
  const double noise = noise_of(p, search, found);
  const bool tendons_likely = may_be_tendons(search);
  // A law with effects of another kind that leaves no more than noise needs no tendons.
  if (!torque || (!tendons_likely && found <= kAboveFloor * noise)) {
    return std::nullopt;
  }
  LawForm tendons;
  tendons.terms = terms_of_model(kTendonModel);
  Preparation theirs = with_rate_filter(p, kTendonRateFilterS);
  tendons = fitted_tendons(theirs, tendons);
  const double left = left_to_choose(theirs, tendons);
  tendons = without_foreign_lateness(theirs, std::move(tendons), refined(p.split, p.factor).learned());
  const bool complete = left_to_choose(p, usual) > kMuchIsMissing * noise && left <= kAboveFloor * noise;
  const double form_error = tendons_likely ? kTendonForm * loop_size(p, search.law) : 0.0;
  const bool as_good = tendons_likely && left <= std::hypot(kAsGoodABase * found, form_error);
  return complete || as_good || left <= kWorthABase * found
             ? std::optional(BaseChoice{tendons, form_error, theirs.conditioner.rate_time_constant_s})
             : std::nullopt;
}

auto without_form_error(const Preparation& p, const BaseChoice& base, Search search) -> Search {
  const LawForm& tendons = base.law;
  const double enough = std::hypot(kAboveFloor * noise_of(p, search, left_to_choose(p, search.law)), base.form_error);
  const double left = left_to_choose(p, tendons);
  const auto answer = [&](const LawForm& law, double left_by_it, std::vector<AddedEffect> effects) {
    search.law = law;
    search.effects = std::move(effects);
    search.unlisted.clear();
    search.lacks_something = false;
    const double share = 1.0 - left_by_it * left_by_it / (left * left);
    search.share = {share, share};
    return search;
  };
  if (left <= enough) {
    return answer(tendons, left, {});
  }
  const LawForm moved = with_other_pretension(p.causal, p.target, refined(p.split, p.factor).learned(), tendons);
  const double left_by_moved = left_to_choose(p, moved);
  if (left_by_moved <= enough) {
    AddedEffect pretension;
    pretension.name = kPretensionTerm;
    pretension.explained = 1.0 - left_by_moved * left_by_moved / (left * left);
    return answer(moved, left_by_moved, {pretension});
  }
  for (std::size_t count = 1; count < search.effects.size(); ++count) {
    const LawForm law = with_effects(tendons, search.law, search.effects, count);
    const double left_by_law = left_to_choose(p, law);
    if (left_by_law <= enough) {
      return answer(law, left_by_law, {search.effects.begin(), search.effects.begin() + static_cast<long>(count)});
    }
  }
  return search;
}

}  // namespace capstan::tools
