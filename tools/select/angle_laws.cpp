// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/angle_laws.hpp"

#include <algorithm>

namespace capstan::tools {
namespace {

class AngleLaws final : public LawFamily<LawCandidate> {
 public:
  AngleLaws(ForwardScore& forward, const Vocabulary& vocabulary) : forward_(forward), vocabulary_(vocabulary) {}

  auto score(const LawCandidate& law) -> double override { return forward_.score(law); }

  [[nodiscard]] auto additions(const LawCandidate& law) const -> std::vector<LawCandidate> override {
    std::vector<LawCandidate> laws;
    for (std::size_t i = 0; may_have_plays(law) && i < vocabulary_.plays.size(); ++i) {
      if (std::find(law.plays.begin(), law.plays.end(), vocabulary_.plays[i]) == law.plays.end()) {
        laws.push_back(with_play(law, vocabulary_.plays[i]));
      }
    }
    for (const auto& grid : vocabulary_.terms) {
      if (!law.has(grid.term) && may_have(law, catalogue().term(grid.term))) {
        for (const auto& shapes : grid.settings) {
          laws.push_back(with_term(catalogue(), law, {grid.term, shapes, grid.by_direction}));
        }
      }
    }
    return laws;
  }

  [[nodiscard]] auto reductions(const LawCandidate& law) const -> std::vector<LawCandidate> override {
    std::vector<LawCandidate> laws;
    for (std::size_t i = 0; i < law.plays.size(); ++i) {
      laws.push_back(without_play(law, i));
    }
    for (const auto& choice : law.terms) {
      if (!vocabulary_.start.has(choice.term)) {
        LawCandidate less = without_term(law, choice.term);
        const bool stands = std::all_of(less.terms.begin(), less.terms.end(),
                                        [&](const auto& one) { return may_have(less, catalogue().term(one.term)); });
        if (stands) {
          laws.push_back(std::move(less));
        }
      }
    }
    return laws;
  }

  [[nodiscard]] auto variations(const LawCandidate& law) const -> std::vector<LawCandidate> override {
    std::vector<LawCandidate> laws;
    for (std::size_t i = 0; i < law.plays.size(); ++i) {
      const auto at = std::find(vocabulary_.plays.begin(), vocabulary_.plays.end(), law.plays[i]);
      for (const std::ptrdiff_t step : {-1, 1}) {
        const std::ptrdiff_t place = at - vocabulary_.plays.begin() + step;
        if (at != vocabulary_.plays.end() && place >= 0 && place < std::ssize(vocabulary_.plays)) {
          const double half_width = vocabulary_.plays[static_cast<std::size_t>(place)];
          if (std::find(law.plays.begin(), law.plays.end(), half_width) == law.plays.end()) {
            laws.push_back(with_play(without_play(law, i), half_width));
          }
        }
      }
    }
    for (const auto& grid : vocabulary_.terms) {
      const TermChoice* choice = law.find(grid.term);
      const auto at = choice == nullptr || choice->by_direction != grid.by_direction
                          ? grid.settings.end()
                          : std::find(grid.settings.begin(), grid.settings.end(), choice->shapes);
      for (const std::ptrdiff_t step : {-1, 1}) {
        const std::ptrdiff_t place = at - grid.settings.begin() + step;
        if (at != grid.settings.end() && place >= 0 && place < std::ssize(grid.settings)) {
          laws.push_back(with_term(catalogue(), law,
                                   {grid.term, grid.settings[static_cast<std::size_t>(place)], grid.by_direction}));
        }
      }
    }
    return laws;
  }

 private:
  auto numbers() const -> const DecidingNumbers& { return forward_.numbers(); }
  auto catalogue() const -> const Catalogue& { return forward_.data().catalogue(); }

  /// A term that sees the rate behind the plays is not judged beside plays: its columns would change with their
  /// weights.
  auto sees_plays(const CatalogueTerm& term) const -> bool {
    return term.reads_input && !term.placed && !vocabulary_.start.has(term.name);
  }

  auto may_have(const LawCandidate& law, const CatalogueTerm& term) const -> bool {
    const bool based = term.builds_on.empty() || std::any_of(term.builds_on.begin(), term.builds_on.end(),
                                                             [&](const auto& name) { return law.has(name); });
    return based && (law.plays.empty() || !sees_plays(term));
  }

  auto may_have_plays(const LawCandidate& law) const -> bool {
    return law.plays.size() < numbers().most_plays &&
           std::none_of(law.terms.begin(), law.terms.end(),
                        [&](const auto& choice) { return sees_plays(catalogue().term(choice.term)); });
  }

  ForwardScore& forward_;
  const Vocabulary& vocabulary_;
};

}  // namespace

auto grown_angle_laws(ForwardScore& forward, const Vocabulary& vocabulary) -> std::vector<ScoredLaw<LawCandidate>> {
  AngleLaws laws(forward, vocabulary);
  Grower grower(laws, forward.numbers().growth);
  std::vector<ScoredLaw<LawCandidate>> grown;
  for (const auto& start : vocabulary.starts) {
    const auto path = grower.run(start);
    grown.insert(grown.end(), path.begin(), path.end());
  }
  return grown;
}

}  // namespace capstan::tools
