// SPDX-License-Identifier: Apache-2.0
// The shapes of a law's terms: searched by fits of the coefficients, which are exact once the shapes are given
// (variable projection, Golub and Pereyra 1973).
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "tools/identify/law_fit.hpp"
#include "tools/support/random.hpp"

namespace capstan::tools {
namespace {

/// Golden-section search for the least cost in [low, high].
template <typename Cost>
auto golden_section(double low, double high, int steps, Cost&& cost) -> double {
  constexpr double kRatio = 0.6180339887498949;
  double a = high - kRatio * (high - low);
  double b = low + kRatio * (high - low);
  double cost_a = cost(a);
  double cost_b = cost(b);
  for (int i = 0; i < steps; ++i) {
    if (cost_a <= cost_b) {  // where all is alike, towards the smaller
      high = b;
      b = a;
      cost_b = cost_a;
      a = high - kRatio * (high - low);
      cost_a = cost(a);
    } else {
      low = a;
      a = b;
      cost_a = cost_b;
      b = low + kRatio * (high - low);
      cost_b = cost(b);
    }
  }
  return cost_a <= cost_b ? a : b;
}

/// What a step of a shape is measured by where its value says nothing, as at zero. A range of equal ratios has its
/// smallest value for that, or a small joint would be searched in a large one's steps.
auto smallest_span(const ShapeInfo& info) -> double {
  const bool in_ratio = info.scale == ShapeScale::kRatio && info.minimum > 0.0;
  return in_ratio ? info.minimum : info.maximum - info.minimum;
}

/// A shape that is searched for, and where it stands among all shapes.
struct ShapeSlot {
  const ShapeInfo* info;
  std::size_t index;
};

auto shape_slots(const LawForm& form) -> std::vector<ShapeSlot> {
  std::vector<ShapeSlot> slots;
  for (const auto* term : ordered_terms(form)) {
    for (std::size_t i = 0; i < searched_shapes(*term); ++i) {
      slots.push_back({&term->shapes[i], term->first_shape + i});
    }
  }
  return slots;
}

/// Gauss and Newton's steps in coefficients and shapes together, halved until they help, from a start nearby.
auto settled(const LawDesign& design, const Eigen::VectorXd& target, const Blocks& blocks, LawForm form) -> LawForm {
  constexpr int kRounds = 8;
  constexpr int kHalvings = 5;
  constexpr double kEnough = 1e-9;  // of the error
  const auto slots = shape_slots(form);
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::MatrixXd columns = law_columns(design, form);
    auto signs = law_signs(form);
    const LinearFit now = fit_columns(columns, target, blocks, signs);
    signs.resize(signs.size() + slots.size(), Sign::kAny);
    const Eigen::VectorXd step =
        fit_columns(with_sensitivities(design, form, now.theta, columns), target, blocks, signs)
            .theta.tail(static_cast<Eigen::Index>(slots.size()));
    double share = 1.0;
    double left = now.rmse;
    LawForm next = form;
    for (int i = 0; i < kHalvings && left >= now.rmse; ++i, share *= 0.5) {
      for (std::size_t k = 0; k < slots.size(); ++k) {
        const auto& [info, index] = slots[k];
        next.shapes[index] =
            std::clamp(form.shapes[index] + share * step[static_cast<Eigen::Index>(k)], info->minimum, info->maximum);
      }
      left = fit_law(design, target, blocks, next).rmse;
    }
    if (left >= now.rmse) {
      break;
    }
    form = std::move(next);
    if (left > (1.0 - kEnough) * now.rmse) {
      break;
    }
  }
  return form;
}

/// Starts that take every shape once through each part of its range (Latin hypercube: McKay, Beckman and Conover 1979).
auto hypercube(const LawForm& form, std::size_t count) -> std::vector<LawForm> {
  constexpr double kSmallestShare = 1.0 / 400.0;  // of a range that begins at nothing
  Random random(0x1A71);
  std::vector<LawForm> starts(count, form);
  for (const auto& [info, index] : shape_slots(form)) {
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (std::size_t i = count; i-- > 1;) {
      std::swap(order[i], order[static_cast<std::size_t>(random.uniform() * static_cast<double>(i + 1))]);
    }
    for (std::size_t i = 0; i < count; ++i) {
      const double share = (static_cast<double>(order[i]) + random.uniform()) / static_cast<double>(count);
      const double low = std::max(info->minimum, kSmallestShare * info->maximum);
      starts[i].shapes[index] = info->scale == ShapeScale::kRatio
                                    ? low * std::pow(info->maximum / low, share)
                                    : info->minimum + share * (info->maximum - info->minimum);
    }
  }
  return starts;
}

}  // namespace

auto refine_shapes(const LawDesign& design, const Eigen::VectorXd& target, const Blocks& blocks, LawForm form)
    -> LawForm {
  constexpr int kSteps = 12;
  constexpr double kReach = 0.5;  // of the value
  if (shape_slots(form).empty()) {
    return form;
  }
  for (const auto& [info, index] : shape_slots(form)) {
    double& value = form.shapes[index];
    const double reach = std::max(kReach * value, 2e-3 * smallest_span(*info));
    const double low = std::max(info->minimum, value - reach);
    const double high = std::min(info->maximum, value + 2.0 * reach);
    value = golden_section(low, high, kSteps, [&](double trial) {
      value = trial;
      return fit_law(design, target, blocks, form).rmse;
    });
  }
  return settled(design, target, blocks, form);
}

auto search_shapes(const LawDesign& design, const Eigen::VectorXd& target, const Blocks& blocks, const LawForm& form)
    -> LawForm {
  constexpr std::size_t kStarts = 24;
  constexpr std::size_t kFollowed = 3;
  if (shape_slots(form).empty()) {
    return form;
  }
  std::vector<std::pair<double, LawForm>> starts;
  for (auto& start : hypercube(form, kStarts)) {
    starts.emplace_back(fit_law(design, target, blocks, start).rmse, std::move(start));
  }
  std::sort(starts.begin(), starts.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  double least = std::numeric_limits<double>::infinity();
  LawForm best = form;
  for (std::size_t i = 0; i < kFollowed; ++i) {
    LawForm refined = refine_shapes(design, target, blocks, starts[i].second);
    const double rmse = fit_law(design, target, blocks, refined).rmse;
    if (rmse < least) {
      least = rmse;
      best = std::move(refined);
    }
  }
  return best;
}

auto shape_step(const ShapeInfo& info, double value) -> double {
  const double range = info.maximum - info.minimum;
  const double step = std::clamp(0.02 * std::abs(value), 1e-5 * range, 1e-3 * range);
  return value + step > info.maximum ? -step : step;
}

auto searched_shapes(const CatalogueTerm& term) -> std::size_t {
  return term.shapes_are_given ? 0 : term.shapes.size();
}

auto shapes_at_limits(const LawForm& form) -> std::vector<std::string> {
  std::vector<std::string> names;
  for (const auto* term : ordered_terms(form)) {
    for (std::size_t i = 0; !term->shapes_are_open && i < searched_shapes(*term); ++i) {
      const auto& info = term->shapes[i];
      const double value = form.shapes[term->first_shape + i];
      const double margin = 2e-3 * (info.maximum - info.minimum);
      if (value > info.maximum - margin || value < info.minimum + (info.minimum > 0.0 ? 0.02 * info.minimum : 0.0)) {
        names.push_back(term->name + "." + info.name);
      }
    }
  }
  return names;
}

}  // namespace capstan::tools
