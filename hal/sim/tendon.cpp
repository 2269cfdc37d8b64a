// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/sim/tendon.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "capstan/hal/sim/deterministic_math.hpp"

namespace capstan::sim {
namespace {

// Measured over random walks of both ends: nearly always 1 to 4 rounds. Beyond this the rows cycle.
constexpr int kMaxRounds = 20;
// Nested rounds end by themselves after at most one change per node; elements that turn slack or harden add some.
constexpr int kMaxNestedRoundsPerNode = 100;
// Gauss-Seidel needs about N^2 sweeps per decade; this is enough for 12 digits several times over.
constexpr int kMaxSweepsPerSquare = 32;
constexpr int kMaxSweeps = 4000000;
// Where the first attempt fails, rounding may be why: then so much of the largest tension is good enough.
constexpr double kRoundingShare = 1.0e-12;

std::size_t index(int i) {
  return static_cast<std::size_t>(i);
}

}  // namespace

Tendon::Tendon(const TendonParameters& parameters, double elongation_m)
    : parameters_(parameters), count_(parameters.element_count) {
  const auto elements = index(count_);
  for (auto* array : {&stiffness_, &elongation_, &crept_, &tension_, &slope_, &start_})
    array->assign(elements, 0.0);
  for (auto* array : {&v_, &fixed_, &left_, &right_})
    array->assign(elements + 1, 0.0);
  row_.assign(elements + 1, 0);
  for (int i = 0; i < count_; ++i) {
    stiffness_[index(i)] = parameters.stiffness_n_per_m / length_share(i);
    elongation_[index(i)] = elongation_m * length_share(i);
  }
  scale_ = parameters.stiffness_n_per_m * static_cast<double>(count_);
  tolerance_n_ = std::max(1.0e-9, 1.0e-17 * scale_);
  set_eta(parameters.eta);
  trial(0.0, 0.0, 1.0);
}

double Tendon::length_share(int element) const {
  const double full = 1.0 / static_cast<double>(count_ - 1);
  return element == 0 || element == count_ - 1 ? 0.5 * full : full;
}

void Tendon::set_eta(double eta) {
  parameters_.eta = eta;
  ratio_ = det_exp(eta / static_cast<double>(count_ - 1));
}

void Tendon::weaken(double left) {
  for (double& stiffness : stiffness_)
    stiffness *= left;
}

double Tendon::elongation() const {
  return std::accumulate(elongation_.begin(), elongation_.end(), 0.0);
}

double Tendon::tension(int element) const {
  return tension_[index(element)];
}

void Tendon::lengthen(double metres) {
  for (int i = 0; i < count_; ++i)
    elongation_[index(i)] -= metres * length_share(i);
}

void Tendon::creep(double dt_s) {
  const double share = 1.0 - det_exp(-dt_s / parameters_.creep_time_s);
  for (std::size_t i = 0; i < index(count_); ++i) {
    const double move = share * (parameters_.creep_ratio * tension_[i] / stiffness_[i] - crept_[i]);
    crept_[i] += move;
    elongation_[i] -= move;
  }
}

inline Tendon::Force Tendon::force(int element, double elongation) const {
  const double k = stiffness_.data()[element];
  const double linear = k * elongation;
  if (linear >= 0.0) {
    const double h = parameters_.hardening_per_n;
    return {.tension = linear * (1.0 + h * linear), .slope = k * (1.0 + 2.0 * h * linear)};
  }
  // Without drag no element of a taut chain can end up slack, so iterates may pass through negative tension. With drag
  // it can.
  const bool may_be_slack = drag_in_ > 0.0 || drag_out_ > 0.0;
  return may_be_slack ? Force{.tension = 0.0, .slope = 0.0} : Force{.tension = linear, .slope = k};
}

// This and the next two are the plant's innermost loops. They go over plain arrays, of the size that the constructor
// gives: with every index checked a simulation takes half as long again.
void Tendon::evaluate_elements() {
  const double* const start = start_.data();
  const double* const v = v_.data();
  double* const tension = tension_.data();
  double* const slope = slope_.data();
  for (int i = 0; i < count_; ++i) {
    const auto e = index(i);
    const Force f = force(i, start[e] + (v[e + 1] - v[e]));
    tension[e] = f.tension;
    slope[e] = f.slope;
  }
}

// Returns true when every node already satisfies min(R, max(M, v)) = 0.
bool Tendon::pick_rows() {
  const double* const tension = tension_.data();
  const double* const v = v_.data();
  std::int8_t* const row = row_.data();
  double worst = 0.0;
  for (std::size_t j = 1; j < index(count_); ++j) {
    const double before = tension[j - 1];
    const double after = tension[j];
    const double to_output = ratio_ * before - after + drag_out_ * v[j];
    const double to_input = before - ratio_ * after + drag_in_ * v[j];
    const double still = scale_ * v[j];
    const double lower = std::max(to_input, still);
    row[j] = static_cast<std::int8_t>(to_output <= lower ? 1 : (to_input > still ? -1 : 0));
    worst = std::max(worst, std::fabs(std::min(to_output, lower)));
  }
  return worst <= tolerance_now_n_;
}

// Tridiagonal elimination of the picked rows, linearised at the current displacements. Each node is kept as
// v_j = fixed_ + left_ v_0 + right_ v_{j+1}, which gives the tangents of both ends in the same pass.
void Tendon::solve_rows() {
  const double* const tension = tension_.data();
  const double* const slope = slope_.data();
  const std::int8_t* const row = row_.data();
  double* const v = v_.data();
  double* const fixed_part = fixed_.data();
  double* const left_part = left_.data();
  double* const right_part = right_.data();
  const auto last = index(count_) - 1;
  double fixed = 0.0;
  double left = 1.0;
  double right = 0.0;
  for (std::size_t j = 1; j <= last; ++j) {
    if (row[j] == 0) {
      fixed = left = right = 0.0;
    } else {
      const bool to_output = row[j] > 0;
      const double g = to_output ? ratio_ : 1.0;
      const double h = to_output ? 1.0 : ratio_;
      const double below = g * slope[j - 1];
      const double above = h * slope[j];
      const double base_before = tension[j - 1] - slope[j - 1] * (v[j] - v[j - 1]);
      const double base_after = tension[j] - slope[j] * (v[j + 1] - v[j]);
      const double diagonal = below + above + (to_output ? drag_out_ : drag_in_) + 1.0e-14 * scale_;
      const double inverse = 1.0 / (diagonal - below * right);
      fixed = (h * base_after - g * base_before + below * fixed) * inverse;
      left = below * left * inverse;
      right = above * inverse;
    }
    fixed_part[j] = fixed;
    left_part[j] = left;
    right_part[j] = right;
  }
  by_input_last_ = left;
  by_output_last_ = right;
  double by_input = 0.0;
  double by_output = 1.0;
  for (std::size_t j = last; j >= 1; --j) {
    by_input = left_part[j] + right_part[j] * by_input;
    by_output = right_part[j] * by_output;
    v[j] = fixed_part[j] + left_part[j] * v[0] + right_part[j] * v[j + 1];
  }
  by_input_first_ = by_input;
  by_output_first_ = by_output;
}

// The same equations as a game of two players, one row choice each: the inner rounds settle max(M, v) with the R rows
// held, the outer rounds then revise the R rows. Both go monotonically for M-matrix rows, so this cannot cycle.
bool Tendon::solve_nested() {
  const int most = kMaxNestedRoundsPerNode * count_;
  int rounds = 0;
  while (rounds < most) {
    bool settled = false;
    for (; rounds < most && !settled; ++rounds) {
      ++nested_rounds_;
      solve_rows();
      evaluate_elements();
      settled = revise_rows(false);
    }
    if (!settled)
      return false;
    if (revise_rows(true))
      return true;
  }
  return false;
}

// Outer: moves nodes to or from the R row. Inner: only among the other two. Returns true if nothing had to change.
bool Tendon::revise_rows(bool outer) {
  bool unchanged = true;
  for (std::size_t j = 1; j < index(count_); ++j) {
    const double to_output = ratio_ * tension_[j - 1] - tension_[j] + drag_out_ * v_[j];
    const double to_input = tension_[j - 1] - ratio_ * tension_[j] + drag_in_ * v_[j];
    const double still = scale_ * v_[j];
    const double lower = std::max(to_input, still);
    const bool held = row_[j] > 0;
    if (!outer && held)
      continue;
    const double current = held ? to_output : (row_[j] < 0 ? to_input : still);
    const double wanted = outer ? std::min(to_output, lower) : lower;
    if (std::fabs(current - wanted) <= tolerance_now_n_)
      continue;
    row_[j] = static_cast<std::int8_t>(wanted == to_output && outer ? 1 : (to_input > still ? -1 : 0));
    unchanged = false;
  }
  return unchanged;
}

void Tendon::sweep_until_balanced() {
  const int most = std::min(kMaxSweeps, kMaxSweepsPerSquare * count_ * count_);
  for (int sweep = 0; sweep < most; ++sweep) {
    ++sweeps_;
    for (int i = 1; i < count_; ++i) {
      const auto j = index(i);
      const Force before = force(i - 1, start_[j - 1] + (v_[j] - v_[j - 1]));
      const Force after = force(i, start_[j] + (v_[j + 1] - v_[j]));
      const double out_slope = ratio_ * before.slope + after.slope + drag_out_ + 1.0e-14 * scale_;
      const double in_slope = before.slope + ratio_ * after.slope + drag_in_ + 1.0e-14 * scale_;
      const double out_root = v_[j] - (ratio_ * before.tension - after.tension + drag_out_ * v_[j]) / out_slope;
      const double in_root = v_[j] - (before.tension - ratio_ * after.tension + drag_in_ * v_[j]) / in_slope;
      v_[j] = std::max(out_root, std::min(in_root, 0.0));
    }
    if (sweep % 16 == 15) {
      evaluate_elements();
      if (pick_rows())
        return;
    }
  }
  throw std::runtime_error("the tendon found no equilibrium; lower its stiffness or the element count");
}

void Tendon::solve() {
  tolerance_now_n_ = tolerance_n_;
  evaluate_elements();
  for (int round = 0; round < kMaxRounds; ++round) {
    ++rounds_;
    solve_rows();
    evaluate_elements();
    if (pick_rows())
      return;
  }
  double largest = 0.0;
  for (const double tension : tension_)
    largest = std::max(largest, std::fabs(tension));
  if (std::isfinite(largest))
    tolerance_now_n_ = std::max(tolerance_n_, kRoundingShare * largest);
  if (!solve_nested())
    sweep_until_balanced();
}

TendonEnds Tendon::ends() const {
  const auto last = index(count_) - 1;
  TendonEnds result;
  result.input_n = tension_[0];
  result.output_n = tension_[last];
  result.input_by_input = slope_[0] * (by_input_first_ - 1.0);
  result.input_by_output = slope_[0] * by_output_first_;
  result.output_by_input = -slope_[last] * by_input_last_;
  result.output_by_output = slope_[last] * (1.0 - by_output_last_);
  return result;
}

void Tendon::slack_trial(double total) {
  slack_ = true;
  for (int i = 0; i < count_; ++i) {
    start_[index(i)] = total * length_share(i);
    tension_[index(i)] = 0.0;
  }
  ends_ = TendonEnds{};
}

// A slack tendon keeps no profile: it becomes taut from zero everywhere, at the fraction of the step where its
// elongation crosses zero. The remaining motion of both ends then builds the profile.
void Tendon::retension_trial(double input_move_m, double output_move_m, double total) {
  std::fill(start_.begin(), start_.end(), 0.0);
  const double change = output_move_m - input_move_m;
  const bool moved = change >= total && change > 0.0;
  const double share = moved ? total / change : 1.0;
  v_.front() = share * input_move_m;
  v_.back() = moved ? share * output_move_m : total + v_.front();
  solve();
  ends_ = ends();
  if (!moved)
    return;
  const double share_by_input = (total - change) / (change * change);
  const auto chain = [&](double& by_input, double& by_output) {
    const double along = by_input * input_move_m + by_output * output_move_m;
    by_input = by_input * share + along * share_by_input;
    by_output = by_output * share - along * share_by_input;
  };
  chain(ends_.input_by_input, ends_.input_by_output);
  chain(ends_.output_by_input, ends_.output_by_output);
}

const TendonEnds& Tendon::trial(double input_move_m, double output_move_m, double dt_s) {
  const double nodes = static_cast<double>(count_ - 1);
  drag_in_ = parameters_.drag_to_input_ns_per_m / (nodes * dt_s);
  drag_out_ = parameters_.drag_to_output_ns_per_m / (nodes * dt_s);
  slack_ = false;
  const bool any_drag = drag_in_ > 0.0 || drag_out_ > 0.0;
  const double before = elongation();
  const double total = before + output_move_m - input_move_m;
  if (snapped_) {
    slack_trial(std::min(total, 0.0));
  } else if (!any_drag && total <= 0.0) {
    slack_trial(total);
  } else if (!any_drag && before <= 0.0) {
    retension_trial(input_move_m, output_move_m, total);
  } else {
    v_.front() = input_move_m;
    v_.back() = output_move_m;
    start_ = elongation_;
    solve();
    ends_ = ends();
  }
  return ends_;
}

void Tendon::commit() {
  for (std::size_t i = 0; i < index(count_); ++i) {
    elongation_[i] = slack_ ? start_[i] : start_[i] + (v_[i + 1] - v_[i]);
  }
}

}  // namespace capstan::sim
