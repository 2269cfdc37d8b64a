// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/loop_gauge.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "capstan/tools/diagnose/base_choice.hpp"
#include "capstan/tools/diagnose/left_to_choose.hpp"
#include "capstan/tools/diagnose/loop_change.hpp"
#include "capstan/tools/diagnose/loop_course.hpp"
#include "capstan/tools/diagnose/loop_size.hpp"
#include "capstan/tools/diagnose/torque_gauge.hpp"
#include "capstan/tools/identify/loop.hpp"
#include "capstan/tools/identify/tendon_fit.hpp"
#include "capstan/tools/select/deciding_numbers.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

constexpr const char* kPeriodic = "angle_periodic";
constexpr std::array kLateTerms = {kDelayTerm, kDragTerm};

auto is_late_term(const std::string& name) -> bool {
  return std::any_of(kLateTerms.begin(), kLateTerms.end(), [&](const char* term) { return name == term; });
}

/// How the motor's torque differs from the healthy joint's, beyond its loop.
auto change_of_torque(const Preparation& p, const JointFile& healthy, const Loop& before)
    -> std::optional<TorqueChange> {
  if (!healthy.fit || !healthy.fit->torque) {
    return std::nullopt;
  }
  return torque_change(torque_logs(p, healthy, before), *healthy.fit->torque);
}

/// A loop of any width; as late as the healthy joint was, where another lateness leaves nothing less.
auto loop_now(const Preparation& p, const Loop& before) -> LawForm {
  LawForm loop = fit_loop(p.noncausal, p.target, p.certain(), before);
  if (!before.late_s) {
    return loop;
  }
  LawForm late = with_lateness(p.causal, p.target, p.certain(), loop);
  LawForm as_before = late;
  as_before.set_shapes(as_before.catalogue->term(kDelayTerm), {*before.late_s});
  const bool is_as_late = left_to_choose(p, as_before) <= kAboveFloor * left_to_choose(p, late);
  return is_as_late ? late : loop;
}

/// A search from a loop of any width, and what its end says.
class LoopSearch {
 public:
  LoopSearch(const Preparation& p, const JointFile& healthy, const Loop& before, const SteadyTorque& torque,
             const LawForm& tendons, const std::function<void(const std::string&)>& progress)
      : p_(p),
        healthy_(healthy),
        before_(before),
        tendons_(tendons),
        loop_(loop_now(p, before)),
        search_(search_effects(p, loop_, progress)),
        left_(left_to_choose(p, tendons)),
        left_by_loop_(left_to_choose(p, loop_)),
        left_by_found_(left_to_choose(p, search_.law)),
        enough_(kAboveFloor * std::min(noise_of(p, search_, left_by_found_), noise_known(p, healthy))) {
    size_.emplace(p, healthy, before_, search_.law);
    const double width_rad = size_->half_width_rad();
    const auto sliding =
        healthy.fit && healthy.fit->loop_torque ? loop_torque(p.noncausal, p.certain(), width_rad) : std::nullopt;
    const Loop now{width_rad, sliding.value_or(friction_of(torque))};
    force_ = now.torque_nm / before.torque_nm;
    search_.loop = now;
    change_ = change_of_torque(p, healthy, before);
    if (change_ && !torque_has_changed(*change_, friction_nm())) {
      force_ = 1.0;  // row by row it is the healthy joint's; its mean over the loop hangs on where the motion turned
    }
    by_torque_ = change_ ? found_in_torque(*change_, friction_nm(), beta_of(healthy)) : std::nullopt;
    if (by_torque_) {
      search_.sizes.push_back("the motor's torque shows " + by_torque_->sentence);
    }
  }

  auto answer() -> std::optional<Search> {
    std::optional<Search> told = by_torque_ ? of_the_torque() : by_angle();
    const auto is_contradicted = [&](const AddedEffect& effect) {
      return change_ && (contradicted_by_torque(effect.name, *change_, friction_nm()) ||
                         (effect.name == kPeriodic && size_->is_torque_periodic()));
    };
    if (told && !by_torque_ && std::any_of(told->effects.begin(), told->effects.end(), is_contradicted)) {
      told = nameless("");
    }
    if (told) {
      told->sizes.insert(told->sizes.begin(), loop_sentence(*told->loop));
    }
    return told;
  }

 private:
  /// Of the healthy joint.
  [[nodiscard]] auto friction_nm() const -> double { return healthy_.fit->torque->friction(); }

  /// Takes the loop's numbers from this law.
  void measure(const LawForm& law) {
    size_.emplace(p_, healthy_, before_, law);
    search_.loop->half_width_rad = size_->half_width_rad();
  }
  [[nodiscard]] auto loop_sentence(const Loop& now) const -> std::string {
    return "the loop between motor and joint is " + rounded(now.half_width_rad, 3) +
           " rad to either side, at the motor, and takes " + rounded(now.torque_nm, 3) +
           " Nm; the healthy joint's: " + rounded(before_.half_width_rad, 3) + " rad and " +
           rounded(before_.torque_nm, 3) + " Nm";
  }

  auto by_angle() -> std::optional<Search> {
    if (left_ <= enough_ || is_as_before()) {
      return complete(tendons_, left_, {});
    }
    if (left_ < left_by_found_) {
      return std::nullopt;
    }
    return left_by_loop_ <= enough_ ? of_the_loop_alone() : of_what_came_beside();
  }

  /// Tendons of a loop that is wide beside the noise err by more than that on a healthy day.
  [[nodiscard]] auto is_as_before() const -> bool {
    return std::abs(size_->width() - 1.0) <= kLoopTold && std::abs(force_ - 1.0) <= kLoopTold && healthy_.fit &&
           left_ <= kAboveFloor * healthy_.fit->rmse;
  }

  /// Tendons carry what the torque shows, and in doing so show more of themselves than a free joint's did: the law is
  /// whichever leaves least.
  auto of_the_torque() -> Search {
    if (by_torque_->name.empty()) {
      return nameless("contact at the tip");
    }
    std::pair<double, LawForm> best = {left_by_found_, search_.law};
    const auto offer = [&](LawForm law) {
      const double left = left_to_choose(p_, law);
      if (left < best.first) {
        best = {left, std::move(law)};
      }
    };
    if (left_ <= enough_) {
      best = {left_, tendons_};  // they carry all of it
    } else if (left_by_found_ > enough_) {
      LawForm anew = tendons_;
      anew.held.clear();
      anew.tied_compliance.reset();
      anew = refine_tendon(p_.causal, p_.target, refined(p_.split, p_.factor).learned(), anew);
      anew.held = tendons_.held;
      offer(std::move(anew));
      offer(loop_);
    }
    AddedEffect effect = named(by_torque_->name);
    effect.size = by_torque_->size;
    Search answer = complete(best.second, best.first, {effect});
    answer.by_torque = true;
    answer.share.value = std::max(answer.share.value, by_torque_->share);
    answer.share.lower = std::max(answer.share.lower, by_torque_->share);
    return answer;
  }

  auto of_the_loop_alone() -> Search {
    measure(loop_);
    const std::string name = name_of_change(size_->width(), force_);
    if (name.empty()) {
      search_.law = loop_;
      return nameless("a torque that the tendons do not carry");
    }
    if (name == kPretensionTerm) {  // or it was another one only later
      const Course course = course_of(p_, loop_);
      if (course.narrows() || course.widens()) {
        return course.narrows() && course.early ? complete(loop_, left_by_loop_, {named("viscoelastic_creep")})
                                                : nameless(course.widens() ? "wear" : "");
      }
      if (const auto eta = friction_number_drift(healthy_, *search_.loop)) {
        search_.law = loop_;
        return nameless(eta->value > 1.0 ? "tendons that rub more at the same pretension, by wear or dirt"
                                         : "tendons that rub less at the same pretension");
      }
    }
    AddedEffect effect = named(name);
    effect.size = size_->of_change(name);
    if (name != kPretensionTerm) {  // the gauge says it
      search_.sizes.push_back(change_sentence(name, *effect.size));
    }
    const LawForm moved = changed_tendons(tendons_, name, size_->width());
    const double left_by_moved = left_to_choose(p_, moved);
    const bool tendons_say_it = left_by_moved <= enough_;
    return complete(tendons_say_it ? moved : loop_, tendons_say_it ? left_by_moved : left_by_loop_, {effect});
  }

  /// Calls what makes the joint later than the healthy one by its name; a delay and drag that were found beside each
  /// other are one lateness. Whether the law's term is another then.
  auto name_lateness() -> bool {
    auto& effects = search_.effects;
    const auto is_lateness = [](const AddedEffect& effect) { return is_late_term(effect.name); };
    const auto first = std::find_if(effects.begin(), effects.end(), is_lateness);
    if (first == effects.end()) {
      return false;
    }
    const auto others = std::remove_if(first + 1, effects.end(), is_lateness);
    const bool were_two = others != effects.end();
    effects.erase(others, effects.end());
    const std::string found_as = std::exchange(first->name, name_of_lateness());
    first->alternatives.clear();
    first->size = size_->of_delay(first->name);
    return were_two || first->name != found_as;
  }

  /// A lateness and nothing else: by the term that it is called by, if that leaves little enough.
  auto of_lateness_alone() -> std::optional<Search> {
    const std::string name = name_of_lateness();
    for (const std::string& term : {name, std::string(name == kDelayTerm ? kDragTerm : kDelayTerm)}) {
      const LawForm late = late_loop(term);
      if (const double left_by_it = left_to_choose(p_, late); left_by_it <= enough_) {
        measure(late);
        AddedEffect effect = named(name);
        effect.size = size_->of_delay(name);
        return complete(late, left_by_it, {effect});
      }
    }
    return std::nullopt;
  }

  auto of_what_came_beside() -> Search {
    const bool is_as_late = loop_.has(kDelayTerm);
    const bool late_otherwise = !is_as_late && name_lateness();
    const auto& found = search_.effects;
    const bool about_tendons = may_be_tendons(search_);  // beside a loop that is no name
    if (!found.empty() && !about_tendons && !late_otherwise && left_by_found_ <= enough_) {
      return on_tendons(found);
    }
    if (auto late = is_as_late ? std::nullopt : of_lateness_alone()) {
      return *late;
    }
    const Course course = course_of(p_, loop_);
    if (!found.empty() && found.front().name == "thermal_drift") {
      // What grows on one side lengthens or shortens the tendons too: their pretension goes with the drift.
      const bool rubs_otherwise = change_ && friction_has_changed(*change_, friction_nm());
      if (!course.narrows() && !course.widens() && !rubs_otherwise) {
        return nameless("a slip");
      }
      AddedEffect drift = found.front();
      if (rubs_otherwise) {
        std::erase(drift.alternatives, "jump");
      }
      return complete(search_.law, left_by_found_, {drift});
    }
    if (course.narrows() && course.early) {
      return on_tendons({named("viscoelastic_creep")});
    }
    if (about_tendons || course.widens()) {
      return nameless(course.widens() ? "wear" : "");
    }
    Search answer = search_;
    answer.lacks_something = true;
    return answer;
  }

  /// Drag delays the joint by what its torque stretches; a late clock takes none.
  [[nodiscard]] auto name_of_lateness() const -> std::string {
    bool drags = force_ > 1.0 + kLoopTold;
    if (change_ && before_.late_s) {
      const double later_s = lateness_of(late_loop(kDelayTerm)) - *before_.late_s;
      drags = change_->size_of(TorqueCause::kDrag) > kTorqueOfStretch * before_.torque_stretching(later_s);
    }
    return drags ? kDragTerm : kDelayTerm;
  }
  [[nodiscard]] auto late_loop(const std::string& by) const -> LawForm {
    LawForm law = loop_;
    const CatalogueTerm& term = law.catalogue->term(by);
    law.terms.push_back(by);
    if (!term.shapes.empty()) {
      law.set_shapes(term, {p_.coarse_period_s});
    }
    return refine_shapes(p_.noncausal, p_.target, p_.certain(), law);
  }
  [[nodiscard]] auto named(const std::string& name) const -> AddedEffect {
    AddedEffect effect;
    effect.name = name;
    effect.explained = explained_by(left_by_found_);
    return effect;
  }
  [[nodiscard]] auto explained_by(double left) const -> double { return 1.0 - left * left / (left_ * left_); }

  /// The healthy joint's tendons with these effects, whose shapes begin where the search left them; with another
  /// pretension where theirs leaves more than noise.
  [[nodiscard]] auto tendons_with(const std::vector<AddedEffect>& effects) const -> LawForm {
    LawForm law = tendons_;
    for (const AddedEffect& effect : effects) {
      const CatalogueTerm& term = law.catalogue->term(effect.name);
      if (!law.has(effect.name)) {
        law.terms.push_back(effect.name);
        law.set_shapes(term, search_.law.shapes_of(term));
      }
    }
    law = refine_shapes(p_.causal, p_.target, p_.certain(), std::move(law));
    if (left_to_choose(p_, law) > enough_) {
      law = with_other_pretension(p_.causal, p_.target, refined(p_.split, p_.factor).learned(), std::move(law));
      law = refine_shapes(p_.causal, p_.target, p_.certain(), std::move(law));
    }
    return law;
  }
  /// In the law of the healthy tendons, unless these leave more than noise and more than the loop that stood in for
  /// them: the loop's law has no torque in it or what the log made of that, and holds for motions like this one.
  auto on_tendons(const std::vector<AddedEffect>& effects) -> Search {
    const LawForm law = tendons_with(effects);
    const double left = left_to_choose(p_, law);
    return left <= std::max(enough_, left_by_found_) ? complete(law, left, effects)
                                                     : complete(search_.law, left_by_found_, effects);
  }

  /// @param effects  that leave nothing but noise, in this law
  auto complete(const LawForm& law, double left, std::vector<AddedEffect> effects) -> Search {
    Search answer = search_;
    answer.law = law;
    for (const auto& effect : effects) {
      if (effect.name == kDelayTerm && effect.size && effect.size->ci95) {
        answer.sizes.push_back(change_sentence(effect.name, *effect.size));
      }
    }
    answer.effects = std::move(effects);
    answer.unlisted.clear();
    answer.lacks_something = false;
    answer.share = {explained_by(left), explained_by(left)};
    return answer;
  }
  /// @param like  what it is most like; may be empty
  auto nameless(const std::string& like) -> Search {
    Search answer = search_;
    answer.effects.clear();
    answer.unlisted = like;
    answer.lacks_something = true;
    return answer;
  }

  const Preparation& p_;
  const JointFile& healthy_;
  const Loop before_;
  const LawForm& tendons_;
  LawForm loop_;
  Search search_;
  std::optional<LoopSize> size_;  ///< of the law whose numbers are compared with the healthy joint's
  double left_;                   ///< by the healthy tendons, rms, of the rows to choose by; and by the others
  double left_by_loop_;
  double left_by_found_;
  double enough_;
  double force_ = 1.0;                  ///< the loop's torque, over the healthy joint's
  std::optional<TorqueChange> change_;  ///< of the torque, where both logs tell it
  std::optional<TorqueFinding> by_torque_;
};

}  // namespace

auto by_loop(const Preparation& p, const JointFile& healthy, const LawForm& tendons,
             const std::function<void(const std::string&)>& progress) -> std::optional<Search> {
  const auto before = loop_of(healthy);
  const auto torque = steady_torque(p.logs, p.causal);
  if (!before || !torque) {
    return std::nullopt;
  }
  progress("comparing the loop with the healthy joint's");
  return LoopSearch(p, healthy, *before, *torque, tendons, progress).answer();
}

}  // namespace capstan::tools
