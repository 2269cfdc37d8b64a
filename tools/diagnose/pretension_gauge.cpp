// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/pretension_gauge.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/diagnose/loop_change.hpp"
#include "capstan/tools/identify/tendon_fit.hpp"
#include "capstan/tools/identify/torque_balance.hpp"
#include "capstan/tools/select/deciding_numbers.hpp"

namespace capstan::tools {
namespace {

/// Another pretension among the effects, with a size; null where there is none.
auto named_pretension(Diagnosis& d) -> AddedEffect* {
  const auto found = std::find_if(d.effects.begin(), d.effects.end(), [](const auto& effect) {
    return effect.name == kPretensionTerm && effect.size && effect.size->ci95;
  });
  return found != d.effects.end() ? &*found : nullptr;
}

auto has_changed(const Loop& before, const Loop& now) -> bool {
  return std::abs(now.half_width_rad / before.half_width_rad - 1.0) > kLoopTold ||
         std::abs(now.torque_nm / before.torque_nm - 1.0) > kLoopTold;
}

/// What tells no drift of the pretension, in words.
auto sentence_without_drift(const JointFile& healthy, const Loop& now, const AddedEffect* named) -> std::string {
  if (const auto eta = friction_number_drift(healthy, now)) {
    return friction_number_sentence(*healthy.fit->pretension, *eta);
  }
  if (named != nullptr) {
    return change_sentence(named->name, *named->size);
  }
  const auto before = loop_of(healthy);
  return before && has_changed(*before, now)
             ? "torque and width of the loop have not changed alike, as they do with the pretension alone, so the "
               "pretension is not reported"
             : "neither torque nor width of the loop has changed, so the pretension is what it was";
}

void gauge_drift(const Preparation& p, const JointFile& healthy, const Loop& now, Diagnosis& d) {
  AddedEffect* named = named_pretension(d);
  const auto before = loop_of(healthy);
  const double reach = std::max(now.half_width_rad, before ? before->half_width_rad : 0.0);
  d.pretension = pretension_drift(healthy, now, torque_parts({p.logs, p.causal.samples(), reach}));
  if (!d.pretension) {
    d.sizes.push_back(sentence_without_drift(healthy, now, named));
    return;
  }
  d.sizes.push_back(drift_sentence(*d.pretension));
  const Gauged& times = d.pretension->times;
  if (named != nullptr) {
    named->size = EffectSize{times.value, "1", Interval{times.value - times.half, times.value + times.half}};
  }
  if (d.law.fit && d.law.has(kTendonModel)) {
    d.law.fit->pretension = d.pretension->now;
  }
}

}  // namespace

void gauge_pretension(const Preparation& p, const DiagnoseOptions& options, const std::optional<Loop>& now,
                      Diagnosis& d) {
  JointFile healthy = options.base_law.value_or(d.law);
  if (!healthy.fit || !healthy.fit->pretension) {
    if (const AddedEffect* named = named_pretension(d)) {
      d.sizes.push_back(change_sentence(named->name, *named->size));
    }
    return;
  }
  if (healthy.fit->pretension->radius_m() == 0.0) {
    put_into_newtons(options.drawing, healthy);
  }
  if (!options.base_law) {
    d.law.fit->pretension = healthy.fit->pretension;
    d.sizes.push_back(pretension_sentence(*healthy.fit->pretension));
  } else if (now) {
    gauge_drift(p, healthy, *now, d);
  }
}

}  // namespace capstan::tools
