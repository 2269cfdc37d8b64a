// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/sim/drivetrain.hpp"

#include <cmath>
#include <initializer_list>
#include <stdexcept>

namespace capstan::sim {

TendonParameters tendon_parameters(const PlantParameters& p, bool top) {
  const Effects& e = p.effects;
  const double forward = e.transmission_viscous_forward_ns_per_m;
  const double backward = e.transmission_viscous_backward_ns_per_m;
  return {.element_count = p.element_count,
          .stiffness_n_per_m = top ? p.stiffness_top_n_per_m : p.stiffness_bottom_n_per_m,
          .eta = top ? p.eta_top : p.eta_bottom,
          .drag_to_input_ns_per_m = top ? forward : backward,
          .drag_to_output_ns_per_m = top ? backward : forward,
          .hardening_per_n = e.hardening_per_n,
          .creep_ratio = e.creep_ratio,
          .creep_time_s = e.creep_time_s};
}

// Hardening makes this a quadratic.
double initial_elongation(const PlantParameters& p) {
  const double top = p.stiffness_top_n_per_m;
  const double bottom = p.stiffness_bottom_n_per_m;
  const double linear = top + bottom;
  const double square = p.effects.hardening_per_n * (top * top + bottom * bottom);
  return 2.0 * p.pretension_n / (linear + std::sqrt(linear * linear + 4.0 * square * p.pretension_n));
}

Drivetrain::Drivetrain(const PlantParameters& parameters)
    : parameters_(parameters),
      top_(tendon_parameters(parameters, true), initial_elongation(parameters)),
      bottom_(tendon_parameters(parameters, false), initial_elongation(parameters)),
      contact_(parameters.effects.play_half_width_rad > 0.0 ? Contact::kGap : Contact::kJoined) {}

void Drivetrain::advance(const Loads& loads, double dt_s) {
  advance(Step{loads, dt_s, false, 0.0, contact_});
}

void Drivetrain::advance_to(double q1_rad, const Loads& loads, double dt_s) {
  advance(Step{loads, dt_s, true, q1_rad - state_.q1_rad, contact_});
}

void Drivetrain::advance(Step step) {
  if (contact_ == Contact::kJoined) {
    const Moves moves = solve(step, last_moves_);
    accept(step, moves, moves.output);
    return;
  }
  for (const Contact contact : {contact_, Contact::kGap, Contact::kForward, Contact::kBackward}) {
    if (try_contact(step, contact))
      return;
  }
  throw std::runtime_error("the plant diverged: no state of the play balances; use smaller substeps or a wider gap");
}

// The contact is right if it only pushes; the gap is right if it stays within its width.
bool Drivetrain::try_contact(Step& step, Contact contact) {
  step.contact = contact;
  const double joint_move_in_gap = contact == Contact::kGap ? free_joint_move(step) : 0.0;
  const Moves moves = solve(step, contact == contact_ ? last_moves_ : Moves{last_moves_.q1, 0.0});
  const double joint_move = contact == Contact::kGap ? joint_move_in_gap : moves.output;
  if (contact == Contact::kGap) {
    const double gap = state_.pulley_rad + moves.output - state_.q2_rad - joint_move;
    if (std::fabs(gap) > parameters_.effects.play_half_width_rad * (1.0 + 1.0e-12))
      return false;
  } else {
    const double bearing = pulley_viscous(parameters_) / step.dt_s * pulley_move(step, moves.output);
    if ((last_torques_.out - bearing) * static_cast<double>(contact) < -2.0 * kBalanceToleranceNm)
      return false;
  }
  accept(step, moves, joint_move);
  return true;
}

Drivetrain::Moves Drivetrain::solve(const Step& step, Moves guess) {
  Moves moves = guess;
  if (!newton(step, moves) && !newton(step, moves, kRoundingShare)) {
    ++relaxations_;
    moves = guess;
    relax(step, moves);
  }
  return moves;
}

bool Drivetrain::newton(const Step& step, Moves& moves, double rounding_share) {
  for (int round = 0; round < kMaxRounds; ++round) {
    ++rounds_;
    const double damping = round < kFullRounds ? 1.0 : 0.5;
    const Torques t = torques(step, moves);
    const Balance m = balance_motor(step, moves.q1);
    const Balance o = balance_output(step, moves.output);
    const double a11 = m.slope + t.in_by_q1;
    const double a22 = o.slope - t.out_by_q2;
    Row r1 = pick_row(m.residual + t.in, a11, m.coulomb, moves.q1,
                      balance_tolerance(m, a11, moves.q1, t.in, rounding_share));
    Row r2 = pick_row(o.residual - t.out, a22, o.coulomb, moves.output,
                      balance_tolerance(o, a22, moves.output, t.out, rounding_share));
    if (m.prescribed)
      r1 = {true, moves.q1 == m.target, m.target - moves.q1, 0.0};
    if (o.prescribed)
      r2 = {true, moves.output == o.target, o.target - moves.output, 0.0};
    if (r1.satisfied && r2.satisfied)
      return true;
    double step1 = r1.step;
    double step2 = r2.step;
    if (r1.fixed && !r2.fixed) {
      step2 = (-r2.residual + t.out_by_q1 * step1) / a22;
    } else if (!r1.fixed && r2.fixed) {
      step1 = (-r1.residual - t.in_by_q2 * step2) / a11;
    } else if (!r1.fixed) {
      const double determinant = a11 * a22 + t.in_by_q2 * t.out_by_q1;
      step1 = (-r1.residual * a22 + t.in_by_q2 * r2.residual) / determinant;
      step2 = (-a11 * r2.residual - t.out_by_q1 * r1.residual) / determinant;
    }
    moves.q1 = r1.fixed && m.prescribed ? m.target : (r1.fixed ? 0.0 : moves.q1 + damping * step1);
    moves.output = r2.fixed && o.prescribed ? o.target : (r2.fixed ? 0.0 : moves.output + damping * step2);
    if (!std::isfinite(moves.q1) || !std::isfinite(moves.output))
      return false;
  }
  return false;
}

// Sweeps bring any start near the solution; Newton, tried again from there now and then, ends what they would only
// approach.
void Drivetrain::relax(const Step& step, Moves& moves) {
  for (int sweep = 1; sweep <= kMaxRelaxations; ++sweep) {
    moves.q1 = relax_one(step, moves, false);
    moves.output = relax_one(step, moves, true);
    if (sweep % kSweepsPerNewton != 0)
      continue;
    Moves trial = moves;
    if (newton(step, trial, kRoundingShare)) {
      moves = trial;
      return;
    }
  }
  throw std::runtime_error("the plant diverged: motor and joint find no common balance; use smaller substeps");
}

double Drivetrain::relax_one(const Step& step, Moves moves, bool output) {
  double& move = output ? moves.output : moves.q1;
  return balanced_move([&](double at) {
    move = at;
    Balance b = output ? balance_output(step, at) : balance_motor(step, at);
    if (b.prescribed)
      return b;
    const Torques t = torques(step, moves);
    b.residual += output ? -t.out : t.in;
    b.slope += output ? -t.out_by_q2 : t.in_by_q1;
    return b;
  });
}

// What the tendons pull with this share of the moves made.
Drivetrain::Torques Drivetrain::torques(const Step& step, const Moves& moves, double instant) {
  const double r1 = parameters_.input_radius_m;
  const double r2 = parameters_.output_radius_m;
  const double input = r1 * moves.q1;
  double output = r2 * pulley_move(step, moves.output);
  if (step.loads.path_move_m != 0.0)
    output += step.loads.path_move_m;
  // The top tendon's material moves toward the input when q1 grows; displacements count toward the output.
  const TendonEnds& t = top_.trial(-instant * input, -instant * output, instant * step.dt_s);
  const TendonEnds& b = bottom_.trial(instant * input, instant * output, instant * step.dt_s);
  last_torques_ = {.in = r1 * (t.input_n - b.input_n),
                   .out = r2 * (t.output_n - b.output_n),
                   .in_by_q1 = -r1 * r1 * instant * (t.input_by_input + b.input_by_input),
                   .in_by_q2 = -r1 * r2 * instant * (t.input_by_output + b.input_by_output),
                   .out_by_q1 = -r2 * r1 * instant * (t.output_by_input + b.output_by_input),
                   .out_by_q2 = -r2 * r2 * instant * (t.output_by_output + b.output_by_output)};
  return last_torques_;
}

Balance Drivetrain::balance_motor(const Step& step, double move) const {
  Balance balance = motor_balance(parameters_, state_, step.loads, step.dt_s, move);
  balance.prescribed = step.kinematic;
  balance.target = step.q1_move;
  return balance;
}

Balance Drivetrain::balance_joint(const Step& step, double move) const {
  return joint_balance(parameters_, state_, step.loads, step.dt_s, move);
}

// With play the pulley's bearing acts in every state: only then do pushing and parting exclude each other.
Balance Drivetrain::balance_output(const Step& step, double move) const {
  if (step.contact == Contact::kJoined)
    return balance_joint(step, move);
  const double viscous = pulley_viscous(parameters_) / step.dt_s;
  Balance balance = step.contact == Contact::kGap ? Balance{0.0, 0.0, 0.0, false, 0.0, 0.0} : balance_joint(step, move);
  balance.residual += viscous * pulley_move(step, move);
  balance.slope += viscous;
  return balance;
}

double Drivetrain::free_joint_move(const Step& step) const {
  double move = 0.0;
  for (int round = 0; round < kMaxRounds; ++round) {
    const Balance b = balance_joint(step, move);
    if (b.prescribed)
      return b.target;
    const Row row =
        pick_row(b.residual, b.slope, b.coulomb, move, balance_tolerance(b, b.slope, move, 0.0, kRoundingShare));
    if (row.satisfied)
      break;
    move = row.fixed ? 0.0 : move - row.residual / b.slope;
  }
  return move;
}

double Drivetrain::pulley_move(const Step& step, double output_move) const {
  if (step.contact == Contact::kJoined || step.contact == Contact::kGap)
    return output_move;
  const double offset = static_cast<double>(step.contact) * parameters_.effects.play_half_width_rad;
  return state_.q2_rad + output_move + offset - state_.pulley_rad;
}

void Drivetrain::accept(const Step& step, const Moves& moves, double joint_move) {
  if (balance_instant(parameters_) < 1.0)
    torques(step, moves, 1.0);
  top_.commit();
  bottom_.commit();
  state_.pulley_rad += pulley_move(step, moves.output);
  advance_state(parameters_, state_, step.dt_s, moves.q1, joint_move);
  state_.tau_in_nm = last_torques_.in;
  state_.tau_out_nm = last_torques_.out;
  state_.joint_torque_nm = last_torques_.out;
  last_moves_ = moves;
  contact_ = step.contact;
  const bool bounded = std::fabs(state_.q1_rad) < kLargestAngleRad && std::fabs(state_.q2_rad) < kLargestAngleRad;
  if (!bounded || !std::isfinite(state_.tau_in_nm)) {
    throw std::runtime_error(
        "the plant diverged: an angle left the range of 10000 rad; check loads and controller gains");
  }
}

}  // namespace capstan::sim
