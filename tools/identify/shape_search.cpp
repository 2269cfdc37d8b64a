// SPDX-License-Identifier: Apache-2.0
// The shapes of a law's terms: searched by fits of the coefficients, which are exact once the shapes are given
// (variable projection, Golub and Pereyra 1973).
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "capstan/tools/identify/bounded_search.hpp"
#include "capstan/tools/identify/law_fit.hpp"
#include "capstan/tools/support/random.hpp"

namespace capstan::tools {
namespace {

/// Not for one that is given, nor for one that does nothing.
auto is_searched(const LawForm& form, const TermShape& shape) -> bool {
  const CatalogueTerm& term = *shape.term;
  const int switched = shape.info().idle_without;
  const std::string own = term.name + "." + shape.info().name;
  const bool held = std::any_of(form.held.begin(), form.held.end(),
                                [&](const std::string& name) { return name == term.name || name == own; });
  return !held && !term.shapes_are_given && shape.info().of != ShapeOf::kGiven &&
         (switched < 0 || form.shapes[term.first_shape + static_cast<std::size_t>(switched)] != 0.0);
}

/// A shape that is searched for. A search goes along its scale: the logarithm
/// where settings lie in equal ratios, else the share of its range.
struct ShapeSlot {
  TermShape shape;
  ShapeRange range;
  bool in_ratio;

  [[nodiscard]] auto index() const -> std::size_t { return shape.index(); }
  /// Of the law's output.
  [[nodiscard]] auto is_delay() const -> bool { return shape.term->acts_on_output; }
  [[nodiscard]] auto place(double value) const -> double { return in_ratio ? std::log(value) : value / range.size(); }
  [[nodiscard]] auto value(double place) const -> double {
    return std::clamp(in_ratio ? std::exp(place) : place * range.size(), range.low, range.high);
  }
  /// Change of the value per change of the place.
  [[nodiscard]] auto slope(double value) const -> double { return in_ratio ? value : range.size(); }
};

auto goes_in_ratios(const ShapeInfo& info) -> bool {
  return info.scale == ShapeScale::kRatio && info.minimum > 0.0;
}

/// Where one is now always belongs to its range: a law may have been fitted to logs that went farther.
auto shape_slots(const LawDesign& design, const LawForm& form) -> std::vector<ShapeSlot> {
  std::vector<ShapeSlot> slots;
  for (const auto& shape : searched_shapes(form)) {
    const ShapeInfo& info = shape.info();
    const double now = std::clamp(form.shapes[shape.index()], info.minimum, info.maximum);
    slots.push_back({shape, range_of(info, design.reach()).with(now), goes_in_ratios(info)});
  }
  return slots;
}

auto bounds_of(const std::vector<ShapeSlot>& slots) -> SearchBounds {
  const auto count = static_cast<Eigen::Index>(slots.size());
  SearchBounds bounds{Eigen::VectorXd(count), Eigen::VectorXd(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto& slot = slots[static_cast<std::size_t>(i)];
    bounds.lower[i] = slot.place(slot.range.low);
    bounds.upper[i] = slot.place(slot.range.high);
  }
  return bounds;
}

/// What a law leaves of its target, by the places of its shapes, the coefficients fitted exactly within their signs.
class ShapeResidual final : public NonlinearResidual {
 public:
  ShapeResidual(const LawDesign& design, const Eigen::VectorXd& target, const Blocks& blocks, LawForm form)
      : design_(design), target_(target), blocks_(blocks), slots_(shape_slots(design, form)), form_(std::move(form)) {}

  auto at(const Eigen::VectorXd& places) -> Eigen::VectorXd override {
    for (std::size_t i = 0; i < slots_.size(); ++i) {
      form_.shapes[slots_[i].index()] = slots_[i].value(places[static_cast<Eigen::Index>(i)]);
    }
    columns_ = law_columns(design_, form_);
    fit_ = fit_columns(columns_, target_, blocks_, law_signs(form_));
    return stacked(target_ - columns_ * fit_.theta, blocks_);
  }

  /// The law's sensitivities clear of the columns that the fit is free to use (Kaufman 1975).
  auto jacobian() -> Eigen::MatrixXd override {
    // A shape that came to 0 on the way, where it or another is idle, has no sensitivity any more: it stays there.
    std::vector<Eigen::Index> moving;
    std::vector<TermShape> shapes;
    for (std::size_t i = 0; i < slots_.size(); ++i) {
      if (is_searched(form_, slots_[i].shape)) {
        moving.push_back(static_cast<Eigen::Index>(i));
        shapes.push_back(slots_[i].shape);
      }
    }
    Eigen::MatrixXd changes = sensitivities(design_, form_, fit_.theta, shapes);
    std::vector<Eigen::Index> free;
    for (Eigen::Index i = 0; i < columns_.cols(); ++i) {
      if (!fit_.at_bound[static_cast<std::size_t>(i)]) {
        free.push_back(i);
      }
    }
    project_out(columns_(Eigen::all, free), blocks_, changes);
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(rows_in(blocks_), static_cast<Eigen::Index>(slots_.size()));
    for (std::size_t i = 0; i < moving.size(); ++i) {
      const auto& slot = slots_[static_cast<std::size_t>(moving[i])];
      result.col(moving[i]) =
          -slot.slope(form_.shapes[slot.index()]) * stacked(changes.col(static_cast<Eigen::Index>(i)), blocks_);
    }
    return result;
  }

 private:
  const LawDesign& design_;
  const Eigen::VectorXd& target_;
  const Blocks& blocks_;
  std::vector<ShapeSlot> slots_;
  LawForm form_;
  Eigen::MatrixXd columns_;
  LinearFit fit_;
};

/// A law and the rms of what it leaves.
using Fitted = std::pair<double, LawForm>;

/// The form with the shapes nearest to its own that fit best.
auto descended(const LawDesign& design, const Eigen::VectorXd& target, const Blocks& blocks, LawForm form) -> Fitted {
  const auto slots = shape_slots(design, form);
  Eigen::VectorXd start(static_cast<Eigen::Index>(slots.size()));
  for (std::size_t i = 0; i < slots.size(); ++i) {
    start[static_cast<Eigen::Index>(i)] = slots[i].place(form.shapes[slots[i].index()]);
  }
  ShapeResidual residual(design, target, blocks, form);
  const SearchResult found = least_squares_within(bounds_of(slots), start, residual);
  for (std::size_t i = 0; i < slots.size(); ++i) {
    form.shapes[slots[i].index()] = slots[i].value(found.parameters[static_cast<Eigen::Index>(i)]);
  }
  return {std::sqrt(found.squares / static_cast<double>(rows_in(blocks))), std::move(form)};
}

/// The same, and no delay in the wrong sample: between two samples the law is interpolated, which averages its noise,
/// so there is a valley in each sample near the best. A descent goes on from the middle of a neighbour that is lower.
auto followed(const LawDesign& design, const Eigen::VectorXd& target, const Blocks& blocks, const LawForm& form)
    -> Fitted {
  Fitted best = descended(design, target, blocks, form);
  const double period_s = design.period_s(0);
  for (const auto& slot : shape_slots(design, form)) {
    const double here = std::floor(best.second.shapes[slot.index()] / period_s);
    for (const double sample : {here - 1.0, here + 1.0}) {
      LawForm next = best.second;
      next.shapes[slot.index()] = (sample + 0.5) * period_s;
      if (slot.is_delay() && sample >= 0.0 && next.shapes[slot.index()] < slot.range.high &&
          fit_law(design, target, blocks, next).rmse < best.first) {
        return followed(design, target, blocks, next);
      }
    }
  }
  return best;
}

/// Starts that take every shape once through each part of its range (Latin hypercube: McKay, Beckman and Conover 1979).
auto hypercube(const std::vector<ShapeSlot>& slots, const LawForm& form, std::size_t count) -> std::vector<LawForm> {
  Random random(0x1A71);
  std::vector<LawForm> starts(count, form);
  for (const auto& slot : slots) {
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (std::size_t i = count; i-- > 1;) {
      std::swap(order[i], order[static_cast<std::size_t>(random.uniform() * static_cast<double>(i + 1))]);
    }
    const double low = slot.place(slot.range.low);
    const double high = slot.place(slot.range.high);
    for (std::size_t i = 0; i < count; ++i) {
      const double share = (static_cast<double>(order[i]) + random.uniform()) / static_cast<double>(count);
      starts[i].shapes[slot.index()] = slot.value(low + share * (high - low));
    }
  }
  return starts;
}

/// The form with every shape that is searched for inside what the logs can tell.
auto moved_inside(const LawDesign& design, LawForm form) -> LawForm {
  for (const auto& shape : searched_shapes(form)) {
    const ShapeRange range = range_of(shape.info(), design.reach());
    double& value = form.shapes[shape.index()];
    value = std::clamp(value, range.low, range.high);
  }
  return form;
}

}  // namespace

auto refine_shapes(const LawDesign& design, const Eigen::VectorXd& target, const Blocks& blocks, LawForm form)
    -> LawForm {
  return shape_slots(design, form).empty() ? form : followed(design, target, blocks, std::move(form)).second;
}

auto search_shapes(const LawDesign& design, const Eigen::VectorXd& target, const Blocks& blocks, const LawForm& form)
    -> LawForm {
  constexpr std::size_t kStarts = 24;
  constexpr std::size_t kFollowed = 5;
  const LawForm inside = moved_inside(design, form);
  const auto slots = shape_slots(design, inside);
  if (slots.empty()) {
    return form;
  }
  std::vector<Fitted> starts;
  for (auto& start : hypercube(slots, inside, kStarts)) {
    starts.emplace_back(fit_law(design, target, blocks, start).rmse, std::move(start));
  }
  std::sort(starts.begin(), starts.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  Fitted best = {std::numeric_limits<double>::infinity(), form};
  for (std::size_t i = 0; i < kFollowed; ++i) {
    Fitted found = followed(design, target, blocks, starts[i].second);
    if (found.first < best.first) {
      best = std::move(found);
    }
  }
  return best.second;
}

auto shape_step(const ShapeInfo& info, double value) -> double {
  constexpr double kShare = 0.02;
  const double range = info.maximum - info.minimum;
  const double own = kShare * std::abs(value);
  const double step = goes_in_ratios(info) ? own : std::clamp(own, 1e-5 * range, 1e-3 * range);
  return value + step > info.maximum ? -step : step;
}

auto searched_shapes(const LawForm& form) -> std::vector<TermShape> {
  std::vector<TermShape> shapes;
  for (const auto* term : ordered_terms(form)) {
    for (std::size_t i = 0; i < term->shapes.size(); ++i) {
      if (is_searched(form, {term, i})) {
        shapes.push_back({term, i});
      }
    }
  }
  return shapes;
}

auto shapes_at_limits(const LawDesign& design, const LawForm& form) -> std::vector<std::string> {
  constexpr double kMargin = 2e-3;       // of the range, at its upper end
  constexpr double kMarginBelow = 0.02;  // of the lower end
  std::vector<std::string> names;
  for (const auto& shape : searched_shapes(form)) {
    if (shape.term->shapes_are_open) {
      continue;
    }
    const ShapeRange range = range_of(shape.info(), design.reach());
    const double value = form.shapes[shape.index()];
    if (value > range.high - kMargin * range.size() || value < range.low + kMarginBelow * std::max(0.0, range.low)) {
      names.push_back(shape.term->name + "." + shape.info().name);
    }
  }
  return names;
}

}  // namespace capstan::tools
