// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/held_terms.hpp"

#include <algorithm>
#include <utility>

#include "capstan/tools/diagnose/verdict.hpp"
#include "capstan/tools/select/effort_catalogue.hpp"

namespace capstan::tools {
namespace {

/// Probes of the search, and the terms of grown laws that say the same.
constexpr std::pair<const char*, const char*> kTermsOfProbes[] = {
    {"shear_thinning", "power_law_friction"},     {"curved_drag", "power_law_friction"},
    {"load_dependent_friction", "load_friction"}, {"angle_dependent_friction", "load_friction"},
    {"coulomb_friction", "coulomb_friction"},     {"stribeck_friction", "stribeck_friction"}};

/// The law's term that says what a probe does; empty where there is none.
auto term_that_holds(const JointFile& law, const std::string& probe) -> std::string {
  const auto axis = axis_of_probe(probe);
  for (const std::string& term : law.terms) {
    const bool of_probe = std::any_of(std::begin(kTermsOfProbes), std::end(kTermsOfProbes), [&](const auto& pair) {
      return probe == pair.first && effect_name(term) == pair.second;
    });
    if (of_probe || (axis && law.catalogue->term(term).of_axis == axis)) {
      return effect_name(term);
    }
  }
  return "";
}

}  // namespace

void say_what_is_held(Diagnosis& d) {
  if (!d.effort_law || d.unlisted.empty() || d.reason != reason_without_name(d.unlisted)) {
    return;
  }
  const std::string term = term_that_holds(d.effort_law->joint, d.unlisted);
  if (term.empty()) {
    return;
  }
  d.reason = reason_without_name(d.unlisted, term);
  if (axis_of_probe(d.unlisted)) {
    d.next_experiment = kEverything;  // that axis is asked already
  }
}

}  // namespace capstan::tools
