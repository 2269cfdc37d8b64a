// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "capstan/hal/sim/axis_mechanics.hpp"
#include "capstan/hal/sim/instrument.hpp"
#include "capstan/hal/sim/tendon.hpp"

namespace capstan::sim {

/// Several axes whose tendons may wrap around each other's joints. The same physics as Drivetrain, all axes in one
/// balance: what a joint's turn does to another axis' tendons, and what these then pull, are two sides of one matrix
///     output displacement of axis i = r2_i pulley_i - sum_j carried_ij joint_j,
///     torque on joint j = r2_j F_j - sum_i carried_ij F_i,   F = T_top - T_bottom at the output,
/// so energy is kept whatever the coupling. Implicit Euler; Newton on the piecewise smooth system, with bracketed
/// relaxation of one angle after the other behind it. Work per step does not depend on the stiffnesses.
class CoupledDrivetrain {
 public:
  /// Takes parameters that passed validate().
  explicit CoupledDrivetrain(const std::vector<InstrumentAxis>& axes);

  /// One sub-step under the motors' torques, one entry per axis. Throws std::runtime_error if no balance is found.
  void advance(std::span<const Loads> loads, double dt_s);

  /// One sub-step with the input pulleys moved to these angles.
  void advance_to(std::span<const double> q1_rad, std::span<const Loads> loads, double dt_s);

  [[nodiscard]] std::size_t axis_count() const { return axes_.size(); }
  [[nodiscard]] const DrivetrainState& state(std::size_t axis) const { return axes_[axis].state; }
  [[nodiscard]] const Tendon& top(std::size_t axis) const { return axes_[axis].top; }
  [[nodiscard]] const Tendon& bottom(std::size_t axis) const { return axes_[axis].bottom; }
  [[nodiscard]] Tendon& top(std::size_t axis) { return axes_[axis].top; }
  [[nodiscard]] Tendon& bottom(std::size_t axis) { return axes_[axis].bottom; }
  void set_site(std::size_t axis, double site_m) { axes_[axis].parameters.environment.site_m = site_m; }

  [[nodiscard]] std::uint64_t rounds() const { return rounds_; }
  [[nodiscard]] std::uint64_t relaxations() const { return relaxations_; }

 private:
  enum class Contact { kBackward = -1, kGap = 0, kForward = 1, kJoined = 2 };
  enum class Kind {
    kMotor,
    kOutput,
    kJoint
  };  // kOutput: the joint, but in the gap the pulley; kJoint: only in the gap

  struct Axis {
    PlantParameters parameters;
    std::vector<double> carried;  // zero for the own joint
    Tendon top, bottom;
    DrivetrainState state;
    Contact contact;
    double last_q1 = 0.0, last_output = 0.0, last_joint = 0.0;  // moves of the last step
    // Of the last trial:
    double input = 0.0, output = 0.0;  // displacements
    bool tried = false;
    double in = 0.0, out = 0.0;  // forces
    double in_by_in = 0.0, in_by_out = 0.0, out_by_in = 0.0, out_by_out = 0.0;
  };
  struct Coordinate {
    std::size_t axis;
    Kind kind;
  };
  struct Step {
    std::span<const Loads> loads;
    std::span<const double> q1_target;  // empty: under torque
    double dt_s;
  };

  void advance(const Step& step);
  void lay_out();
  void solve(const Step& step);
  bool newton(const Step& step, double rounding_share = 0.0);
  void relax(const Step& step);
  void relax_one(const Step& step, std::size_t number);
  void pull(const Step& step);
  void pull(const Step& step, Axis& axis, double input, double output, double instant);
  [[nodiscard]] Balance balance(const Step& step, std::size_t number) const;
  [[nodiscard]] double tendon_torque(std::size_t number) const;
  void fill_system(const std::vector<Balance>& balances);
  bool pick_rows(const std::vector<Balance>& balances, double rounding_share);
  bool eliminate();
  [[nodiscard]] double move_of(std::size_t axis, Kind kind) const;
  [[nodiscard]] double pulley_move(std::size_t axis) const;
  [[nodiscard]] double joint_move(std::size_t axis) const;
  [[nodiscard]] bool contact_holds(const Step& step, std::size_t axis, Contact& better) const;
  void accept(const Step& step);

  std::vector<Axis> axes_;
  std::vector<Coordinate> coordinates_;
  std::vector<double> by_input_, by_output_;  // displacement of each axis' tendons by each coordinate, row per axis
  std::vector<double> moves_, change_, system_;
  std::vector<Row> rows_;
  std::vector<Balance> balances_;
  std::uint64_t rounds_ = 0, relaxations_ = 0;
};

}  // namespace capstan::sim
