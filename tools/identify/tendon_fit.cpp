// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/tendon_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "capstan/model/terms/tendon.hpp"
#include "capstan/tools/identify/thinned_design.hpp"
#include "capstan/tools/select/deciding_numbers.hpp"
#include "capstan/tools/support/side_by_side.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

/// Enough to tell one start from another, and to settle. Each trial goes through the whole motion.
constexpr Eigen::Index kRowsToSearch = 2000;
constexpr Eigen::Index kRowsToSettle = 8000;

/// Where the share of the tendons' ends that is free of friction is looked for from, if there are free ends.
constexpr double kFreeShareToBegin = 0.05;

auto torque_range(const Thinned& data) -> double {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const auto& samples : data.design.samples()) {
    for (const auto& sample : samples) {
      low = std::min(low, sample.tau);
      high = std::max(high, sample.tau);
    }
  }
  return high - low;
}

/// While both tendons slide and the tip is free, tau = eta I r1 (from (2.16) with equal tensions at the joint): so the
/// friction seen gives the pretension to each friction number.
/// @param free_share  of the tendons' ends; 0 stays 0
auto starts(const Thinned& data, const LawForm& form, double free_share) -> std::vector<LawForm> {
  const CatalogueTerm& term = form.catalogue->term(kTendonModel);
  const double friction =
      std::max(friction_torque(data.design, pieces_of(data.design.log_rows())), 0.02 * torque_range(data));
  std::vector<LawForm> all;
  for (const double eta : {0.15, 0.4, 0.8, 1.2, 2.0}) {
    for (const double share : {0.1, 0.4}) {  // of the friction, ahead of the tendons
      Shapes shapes = form.shapes_of(term);
      const auto& pretension = term.shapes[TendonShape::kPretension];
      shapes[TendonShape::kEtaTop] = shapes[TendonShape::kEtaBottom] = eta;
      shapes[TendonShape::kPretension] =
          std::clamp((1.0 - share) * friction / eta, pretension.minimum, pretension.maximum);
      shapes[TendonShape::kTopShare] = 0.5;
      shapes[TendonShape::kFriction] = share * friction;
      shapes[TendonShape::kFreeShare] = free_share;
      all.push_back(form);
      all.back().set_shapes(term, shapes);
    }
  }
  return all;
}

/// What a law leaves, and the law.
using Fitted = std::pair<double, LawForm>;

auto fitted_law(const Thinned& data, LawForm law) -> Fitted {
  const double left = fit_law(data.design, data.target, data.rows, law).rmse;
  return {left, std::move(law)};
}
auto refined(const Thinned& data, LawForm law) -> Fitted {
  return fitted_law(data, refine_shapes(data.design, data.target, data.rows, std::move(law)));
}

/// A law whose tendons were seen at many places, to run with the few of the board: with the same numbers, which say
/// what the tendons are made of, unless numbers of its own serve it much better.
auto as_it_runs(const Thinned& data, const Catalogue& own, LawForm law) -> LawForm {
  law.catalogue = &own;
  Fitted same = fitted_law(data, std::move(law));
  Fitted better = refined(data, same.second);
  return better.first < kWorthOwnPlaces * same.first ? std::move(better.second) : std::move(same.second);
}

}  // namespace

auto friction_torque(const LawDesign& design, const Blocks& rows,
                     const std::function<bool(const Sample<double>&)>& counts) -> double {
  double torque[2] = {0.0, 0.0};  // times the way, backward and forward
  double way[2] = {0.0, 0.0};
  Eigen::Index first = 0;  // of the log
  for (const auto& samples : design.samples()) {
    const auto end = first + static_cast<Eigen::Index>(samples.size());
    for (const auto& block : rows) {
      for (Eigen::Index i = std::max(block.begin, first); i < std::min(block.end, end); ++i) {
        const auto& sample = samples[static_cast<std::size_t>(i - first)];
        const double speed = counts(sample) ? std::abs(sample.dq1) : 0.0;
        torque[sample.forward] += speed * sample.tau;
        way[sample.forward] += speed;
      }
    }
    first = end;
  }
  return way[0] > 0.0 && way[1] > 0.0 ? std::abs(0.5 * (torque[1] / way[1] - torque[0] / way[0])) : 0.0;
}

auto fit_tendon(const LawDesign& design, const Eigen::VectorXd& target, const Blocks& rows, const LawForm& form)
    -> LawForm {
  constexpr std::size_t kFollowed = 2;
  const Thinned few = thinned(design, target, rows, kRowsToSearch);
  const Thinned many = thinned(design, target, rows, kRowsToSettle);
  LawForm fine = form;
  fine.catalogue = &fine_tendon_catalogue();
  const auto find = [&](double free_share) {
    const auto by_error = [](const auto& a, const auto& b) { return a.first < b.first; };
    std::vector<Fitted> tried;
    for (auto& start : starts(few, fine, free_share)) {
      tried.push_back(fitted_law(few, std::move(start)));
    }
    std::sort(tried.begin(), tried.end(), by_error);
    tried.resize(std::min(kFollowed, tried.size()));
    for (auto& each : tried) {
      each = refined(few, std::move(each.second));
    }
    return refined(many, std::min_element(tried.begin(), tried.end(), by_error)->second);
  };
  std::array<Fitted, 2> found;
  two_at_a_time(found.size(), [&](std::size_t i) { found[i] = find(i == 0 ? 0.0 : kFreeShareToBegin); });
  const auto& [taut, with_free_ends] = found;
  const bool has_free_ends = with_free_ends.first < kWorthFreeEnds * taut.first;
  return as_it_runs(many, *form.catalogue, has_free_ends ? with_free_ends.second : taut.second);
}

auto refine_tendon(const LawDesign& design, const Eigen::VectorXd& target, const Blocks& rows, LawForm form)
    -> LawForm {
  const Thinned many = thinned(design, target, rows, kRowsToSettle);
  const Catalogue* own = std::exchange(form.catalogue, &fine_tendon_catalogue());
  return as_it_runs(many, *own, refined(many, std::move(form)).second);
}

auto try_pretensions(const LawDesign& design, const Eigen::VectorXd& target, const Blocks& rows, const LawForm& law)
    -> PretensionTrial {
  const Thinned many = thinned(design, target, rows, kRowsToSettle);
  LawForm fine = law;
  fine.catalogue = &fine_tendon_catalogue();
  const Fitted best = refined(many, std::move(fine));
  const CatalogueTerm& term = best.second.catalogue->term(kTendonModel);
  std::array<double, 2> left{};
  two_at_a_time(left.size(), [&](std::size_t i) {
    const double times = i == 0 ? 0.8 : 1.25;
    LawForm other = best.second;
    Shapes shapes = other.shapes_of(term);
    shapes[TendonShape::kPretension] *= times;
    shapes[TendonShape::kEtaTop] /= times;  // the product, which is sure
    shapes[TendonShape::kEtaBottom] /= times;
    other.set_shapes(term, shapes);
    other.held.push_back(term.name + "." + term.shapes[TendonShape::kPretension].name);
    left[i] = refined(many, std::move(other)).first;
  });
  const auto beyond = [](double all, double part) { return std::sqrt(std::max(0.0, all * all - part * part)); };
  const double rows_per_mean = static_cast<double>(rows_in(rows)) / static_cast<double>(rows_in(many.rows));
  return {beyond(best.first, white_noise_level(target) / std::sqrt(rows_per_mean)),
          beyond(std::min(left[0], left[1]), best.first)};
}

auto with_other_pretension(const LawDesign& design, const Eigen::VectorXd& target, const Blocks& rows, LawForm form)
    -> LawForm {
  constexpr double kMostTimes = 4.0;
  constexpr int kHalvings = 24;  // of the golden section: to a thousandth
  constexpr double kGolden = 0.6180339887498949;
  const Thinned few = thinned(design, target, rows, kRowsToSearch);
  const CatalogueTerm& term = form.catalogue->term(kTendonModel);
  const auto& pretension = term.shapes[TendonShape::kPretension];
  const std::size_t shape = term.first_shape + TendonShape::kPretension;
  const double now = form.shapes[shape];
  const auto left = [&](double place) {
    form.shapes[shape] = std::clamp(now * std::exp(place), pretension.minimum, pretension.maximum);
    return fit_law(few.design, few.target, few.rows, form).rmse;
  };
  double low = -std::log(kMostTimes);
  double high = std::log(kMostTimes);
  double inner[2] = {high - kGolden * (high - low), low + kGolden * (high - low)};
  double error[2] = {left(inner[0]), left(inner[1])};
  for (int i = 0; i < kHalvings; ++i) {
    if (error[0] < error[1]) {
      high = inner[1];
      inner[1] = inner[0];
      error[1] = error[0];
      error[0] = left(inner[0] = high - kGolden * (high - low));
    } else {
      low = inner[0];
      inner[0] = inner[1];
      error[0] = error[1];
      error[1] = left(inner[1] = low + kGolden * (high - low));
    }
  }
  left(0.5 * (low + high));
  return form;
}

}  // namespace capstan::tools
