// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace capstan::sim::test {

/// The same chain as hal/sim/tendon.hpp, solved the obvious way: move one node at a time until both its neighbours'
/// tensions agree within the friction factor, and go round until nothing moves. Slow, and right by construction.
class SlowTendon {
 public:
  SlowTendon(int elements, double stiffness, double eta, double elongation)
      : factor_(std::exp(eta / (elements - 1))), nodes_(static_cast<std::size_t>(elements) - 1) {
    for (int i = 0; i < elements; ++i) {
      const double share = (i == 0 || i == elements - 1 ? 0.5 : 1.0) / (elements - 1);
      k_.push_back(stiffness / share);
      stretch_.push_back(elongation * share);
    }
  }

  void set_drag(double to_input, double to_output) {
    drag_in_ = to_input / static_cast<double>(nodes_);
    drag_out_ = to_output / static_cast<double>(nodes_);
  }

  void move(double input, double output, double dt) {
    const std::vector<double> before = stretch_;
    std::vector<double> moved(nodes_, 0.0);
    stretch_.front() -= input;
    stretch_.back() += output;
    for (int sweep = 0; sweep < 200000; ++sweep) {
      double largest = 0.0;
      for (std::size_t j = 0; j < nodes_; ++j)
        largest = std::max(largest, relax(j, moved[j], dt));
      if (largest < 1.0e-17)
        return;
    }
  }

  [[nodiscard]] double tension(int element) const {
    const auto e = static_cast<std::size_t>(element);
    return std::max(0.0, k_[e] * stretch_[e]);
  }

 private:
  // Finds by bisection where node j comes to rest; returns how far it went.
  double relax(std::size_t j, double& moved, double dt) {
    // Positive: the node is pulled toward the output beyond what friction and drag hold.
    const auto pull = [&](double further) {
      const double before = std::max(0.0, k_[j] * (stretch_[j] + further));
      const double after = std::max(0.0, k_[j + 1] * (stretch_[j + 1] - further));
      const double total = moved + further;
      if (total > 0.0)
        return after - factor_ * before - drag_out_ * total / dt;
      if (total < 0.0)
        return factor_ * after - before - drag_in_ * total / dt;
      if (after > factor_ * before)
        return after - factor_ * before;
      if (before > factor_ * after)
        return factor_ * after - before;
      return 0.0;
    };
    const double now = pull(0.0);
    if (now == 0.0)
      return 0.0;
    // The node may only go past its resting place (total = 0) after stopping there: bisect on the sign change.
    double low = 0.0;
    double high = (now > 0.0 ? 1.0 : -1.0) * 1.0e-9;
    while (pull(high) * now > 0.0 && std::fabs(high) < 1.0)
      high *= 2.0;
    if (moved != 0.0 && (moved + low) * (moved + high) < 0.0 && pull(-moved) == 0.0) {
      low = high = -moved;
    }
    for (int i = 0; i < 80 && low != high; ++i) {
      const double middle = 0.5 * (low + high);
      if (pull(middle) * now > 0.0) {
        low = middle;
      } else {
        high = middle;
      }
    }
    moved += high;
    stretch_[j] += high;
    stretch_[j + 1] -= high;
    return std::fabs(high);
  }

  double factor_;
  std::size_t nodes_;
  double drag_in_ = 0.0;
  double drag_out_ = 0.0;
  std::vector<double> k_;
  std::vector<double> stretch_;
};

}  // namespace capstan::sim::test
