// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace capstan::sim {

struct TendonParameters {
  int element_count = 16;  ///< 2..512
  double stiffness_n_per_m = 5.0e4;
  double eta = 1.14;
  double drag_to_input_ns_per_m = 0.0;   ///< viscous drag of the whole tendon while it moves toward the input
  double drag_to_output_ns_per_m = 0.0;  ///< the same toward the output
  double hardening_per_n = 0.0;          ///< tension = F (1 + hardening F)
  double creep_ratio = 0.0;              ///< creep elongation / elastic elongation at rest
  double creep_time_s = 10.0;
};

/// Tensions at both ends and how they follow the ends' displacements (positive toward the output), N/m.
struct TendonEnds {
  double input_n = 0.0;
  double output_n = 0.0;
  double input_by_input = 0.0, input_by_output = 0.0;
  double output_by_input = 0.0, output_by_output = 0.0;
};

/// One tendon on a curved surface: a chain of springs with capstan friction at the nodes between them.
///
/// N springs, N - 1 nodes, friction number eta / (N - 1) per node; the two end springs have half the length of the
/// others. So a fully sliding chain has T_out = T_in exp(-eta) exactly, and its elongation is the trapezoid rule for
/// (1/Kn) integral(T), off by O(1/N^2). With c = exp(eta / (N - 1)) and v_j the displacement of node j in this step,
/// quasi-static equilibrium is
///     v_j > 0: T_j = c T_{j-1} + drag,   v_j < 0: T_{j-1} = c T_j + drag,   v_j = 0: both within the factor c,
/// that is, min(R_j, max(M_j, v_j)) = 0 with R_j = c T_{j-1} - T_j + b v_j and M_j = T_{j-1} - c T_j + b v_j. R_j, M_j
/// and v_j all grow with v_j and never with its neighbours (every choice of rows is an M-matrix), so the solution is
/// unique. It is found by policy iteration: pick one row per node, solve the tridiagonal system, pick again;
/// warm-started, one or two rounds. If the rows cycle, a nested iteration takes over that cannot; Gauss-Seidel sweeps
/// stand behind both.
class Tendon {
 public:
  /// Starts evenly tensioned with the given elongation.
  Tendon(const TendonParameters& parameters, double elongation_m);

  /// Ends moved by these amounts since the last commit, within `dt_s`. Changes nothing but the warm start.
  /// Throws std::runtime_error if no equilibrium is found.
  const TendonEnds& trial(double input_move_m, double output_move_m, double dt_s);

  /// Accepts the last trial.
  void commit();

  /// Adds free length, evenly: the tendon becomes looser.
  void lengthen(double metres);

  /// Lets every element creep for `dt_s`.
  void creep(double dt_s);

  void set_eta(double eta);

  /// Strands tear along the whole length: this share of the stiffness is left of what there was.
  void weaken(double left);

  /// Tears: no tension from now on, whatever the ends do.
  void snap() { snapped_ = true; }

  /// Free of drag, a tendon is slack as a whole; this is its elongation, negative when slack.
  [[nodiscard]] double elongation() const;
  [[nodiscard]] int element_count() const { return count_; }
  [[nodiscard]] double tension(int element) const;
  /// Share of the tendon's length that this element stands for.
  [[nodiscard]] double length_share(int element) const;
  [[nodiscard]] std::uint64_t rounds() const { return rounds_; }
  [[nodiscard]] std::uint64_t nested_rounds() const { return nested_rounds_; }
  [[nodiscard]] std::uint64_t sweeps() const { return sweeps_; }

 private:
  struct Force {
    double tension, slope;
  };
  [[nodiscard]] Force force(int element, double elongation) const;
  void evaluate_elements();
  bool pick_rows();
  void solve_rows();
  bool solve_nested();
  bool revise_rows(bool outer);
  void sweep_until_balanced();
  void solve();
  [[nodiscard]] TendonEnds ends() const;
  void slack_trial(double total);
  void retension_trial(double input_move_m, double output_move_m, double total);

  TendonParameters parameters_;
  int count_;
  double ratio_ = 1.0;                     // c
  double drag_in_ = 0.0, drag_out_ = 0.0;  // per node and step, N/m
  double scale_ = 1.0;                     // N/m, makes v comparable with R and M
  double tolerance_n_ = 1.0e-9, tolerance_now_n_ = 1.0e-9;
  bool slack_ = false;  // state of the last trial
  bool snapped_ = false;

  // Per element.
  std::vector<double> stiffness_, elongation_, crept_, tension_, slope_, start_;
  // Per node 0..N; 0 and N are the ends.
  std::vector<double> v_, fixed_, left_, right_;
  std::vector<std::int8_t> row_;
  double by_input_first_ = 0.0, by_output_first_ = 0.0;  // dv_1/dv_0, dv_1/dv_N
  double by_input_last_ = 0.0, by_output_last_ = 0.0;    // dv_{N-1}/dv_0, dv_{N-1}/dv_N
  TendonEnds ends_;
  std::uint64_t rounds_ = 0, nested_rounds_ = 0, sweeps_ = 0;
};

}  // namespace capstan::sim
