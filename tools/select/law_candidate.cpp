// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/law_candidate.hpp"

#include <algorithm>
#include <cstdio>

#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

auto place_in(const Catalogue& catalogue, const std::string& term) -> std::ptrdiff_t {
  return std::find_if(catalogue.begin(), catalogue.end(), [&](const auto& one) { return one.name == term; }) -
         catalogue.begin();
}

auto digits(double value) -> std::string {
  char text[32];
  std::snprintf(text, sizeof text, " %.12g", value);
  return text;
}

}  // namespace

auto LawCandidate::find(const std::string& term) const -> const TermChoice* {
  const auto found = std::find_if(terms.begin(), terms.end(), [&](const auto& one) { return one.term == term; });
  return found == terms.end() ? nullptr : &*found;
}

auto LawCandidate::output(const Catalogue& catalogue) const -> const TermChoice* {
  const auto found = std::find_if(terms.begin(), terms.end(),
                                  [&](const auto& one) { return catalogue.term(one.term).acts_on_output; });
  return found == terms.end() ? nullptr : &*found;
}

auto without_term(LawCandidate law, const std::string& term) -> LawCandidate {
  std::erase_if(law.terms, [&](const auto& one) { return one.term == term; });
  return law;
}

auto with_term(const Catalogue& catalogue, LawCandidate law, TermChoice choice) -> LawCandidate {
  law = without_term(std::move(law), choice.term);
  const auto after = std::find_if(law.terms.begin(), law.terms.end(), [&](const auto& one) {
    return place_in(catalogue, one.term) > place_in(catalogue, choice.term);
  });
  law.terms.insert(after, std::move(choice));
  return law;
}

auto with_play(LawCandidate law, double half_width) -> LawCandidate {
  law.plays.insert(std::upper_bound(law.plays.begin(), law.plays.end(), half_width), half_width);
  return law;
}

auto without_play(LawCandidate law, std::size_t place) -> LawCandidate {
  law.plays.erase(law.plays.begin() + static_cast<std::ptrdiff_t>(place));
  return law;
}

auto candidate_of(const LawForm& form) -> LawCandidate {
  LawCandidate law;
  for (const auto* term : ordered_terms(form)) {
    const Shapes shapes = form.shapes_of(*term);
    if (!term->acts_on_input) {
      law.terms.push_back({term->name, shapes, term->form_free});
      continue;
    }
    for (std::size_t i = 0; i + 1 < shapes.size(); i += 2) {  // half width, weight
      if (shapes[i + 1] != 0.0) {
        law = with_play(std::move(law), shapes[i]);
      }
    }
  }
  return law;
}

auto key_of(const TermChoice& choice) -> std::string {
  std::string key = choice.term;
  for (const double shape : choice.shapes) {
    key += digits(shape);
  }
  return choice.by_direction ? key + " by direction" : key;
}

auto key_of(const LawCandidate& law) -> std::string {
  std::string key;
  for (const auto& choice : law.terms) {
    key += key_of(choice) + ";";
  }
  for (const double half_width : law.plays) {
    key += digits(half_width);
  }
  return key;
}

auto described(const LawCandidate& law) -> std::string {
  std::vector<std::string> parts;
  for (const auto& choice : law.terms) {
    parts.push_back(choice.term);
  }
  if (!law.plays.empty()) {
    parts.push_back(std::to_string(law.plays.size()) + (law.plays.size() == 1 ? " play" : " plays"));
  }
  return joined(parts, " + ");
}

}  // namespace capstan::tools
