// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "capstan/hal/sim/axis_mechanics.hpp"
#include "capstan/hal/sim/tendon.hpp"

namespace capstan::sim {

/// The two tendons of an axis as its parameters and effects make them.
[[nodiscard]] TendonParameters tendon_parameters(const PlantParameters& parameters, bool top);

/// Both begin equally long, with integral(Tt) + integral(Tb) = I.
[[nodiscard]] double initial_elongation(const PlantParameters& parameters);

/// Input pulley, two tendons, output pulley, joint and environment.
///
/// Implicit Euler in the two angles (SolverMode::kDynamic: nearly the midpoint rule): at the end of every sub-step
/// inertia, viscous and Coulomb friction, environment and both tendon chains balance together. A free tip on a stiff
/// tendon has a natural frequency far above the step rate; the implicit step follows its equilibrium without a
/// stability limit, and tends to the quasi-static solution as stiffness grows. Each torque balance is monotone in its
/// own angle and never rises with the other (the tendons' tangents form an M-matrix), so the solution is unique; Newton
/// on the piecewise smooth system finds it in two or three rounds, and bracketed relaxation of one angle after the
/// other, which converges from anywhere, is the fallback.
class Drivetrain {
 public:
  explicit Drivetrain(const PlantParameters& parameters);

  /// One sub-step under a motor torque. Throws std::runtime_error if no balance is found.
  void advance(const Loads& loads, double dt_s);

  /// One sub-step with the input pulley moved to `q1_rad`.
  void advance_to(double q1_rad, const Loads& loads, double dt_s);

  [[nodiscard]] const DrivetrainState& state() const { return state_; }
  [[nodiscard]] const Tendon& top() const { return top_; }
  [[nodiscard]] const Tendon& bottom() const { return bottom_; }
  [[nodiscard]] Tendon& top() { return top_; }
  [[nodiscard]] Tendon& bottom() { return bottom_; }

  /// Moves the tip along the surface of a layered environment.
  void set_site(double site_m) { parameters_.environment.site_m = site_m; }
  /// Moves what the tip touches: its rest angle, or where the contact begins.
  void set_environment_angle(double angle_rad) { parameters_.environment.angle_rad = angle_rad; }

  /// How often Newton had to be replaced by relaxation.
  [[nodiscard]] std::uint64_t relaxations() const { return relaxations_; }
  [[nodiscard]] std::uint64_t rounds() const { return rounds_; }

 private:
  /// Which side of the play touches: the pulley pushes the joint forward (+1), backward (-1), not at all (0).
  /// Without play it is always kJoined.
  enum class Contact { kBackward = -1, kGap = 0, kForward = 1, kJoined = 2 };

  struct Torques {
    double in, out;
    double in_by_q1, in_by_q2, out_by_q1, out_by_q2;
  };
  struct Step {
    Loads loads;
    double dt_s;
    bool kinematic;
    double q1_move;
    Contact contact;
  };
  struct Moves {
    double q1 = 0.0, output = 0.0;  // output: the joint's increment in contact, the pulley's in the gap
  };

  void advance(Step step);
  bool try_contact(Step& step, Contact contact);
  Moves solve(const Step& step, Moves guess);
  bool newton(const Step& step, Moves& moves, double rounding_share = 0.0);
  void relax(const Step& step, Moves& moves);
  double relax_one(const Step& step, Moves moves, bool output);
  Torques torques(const Step& step, const Moves& moves) { return torques(step, moves, balance_instant(parameters_)); }
  Torques torques(const Step& step, const Moves& moves, double instant);
  [[nodiscard]] Balance balance_motor(const Step& step, double move) const;
  [[nodiscard]] Balance balance_joint(const Step& step, double move) const;
  [[nodiscard]] Balance balance_output(const Step& step, double move) const;
  [[nodiscard]] double free_joint_move(const Step& step) const;
  [[nodiscard]] double pulley_move(const Step& step, double output_move) const;
  void accept(const Step& step, const Moves& moves, double joint_move);

  PlantParameters parameters_;
  Tendon top_;
  Tendon bottom_;
  DrivetrainState state_;
  Contact contact_ = Contact::kJoined;
  Moves last_moves_;
  Torques last_torques_{};
  std::uint64_t relaxations_ = 0, rounds_ = 0;
};

}  // namespace capstan::sim
