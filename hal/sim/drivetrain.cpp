// SPDX-License-Identifier: Apache-2.0
#include "hal/sim/drivetrain.hpp"

#include <cmath>
#include <initializer_list>
#include <stdexcept>

#include "hal/sim/deterministic_math.hpp"

namespace capstan::sim {
namespace {

constexpr int kMaxRounds = 40;
constexpr int kMaxRelaxations = 2000;
constexpr int kSweepsPerNewton = 4;
constexpr double kToleranceNm = 1.0e-10;
// With play the output pulley has a bearing of its own: this share of the joint's viscous friction, and a floor.
constexpr double kPulleyViscousShare = 0.05;
constexpr double kPulleyViscousFloor = 1.0e-7;
constexpr double kLargestAngleRad = 1.0e4;

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

// Both tendons begin equally long, with integral(Tt) + integral(Tb) = I; hardening makes that a quadratic.
double initial_elongation(const PlantParameters& p) {
  const double top = p.stiffness_top_n_per_m;
  const double bottom = p.stiffness_bottom_n_per_m;
  const double linear = top + bottom;
  const double square = p.effects.hardening_per_n * (top * top + bottom * bottom);
  return 2.0 * p.pretension_n / (linear + std::sqrt(linear * linear + 4.0 * square * p.pretension_n));
}

struct Row {
  bool fixed;  // the increment is known to become move + step
  bool satisfied;
  double step;      // if fixed
  double residual;  // otherwise, Coulomb friction included
};

// Which branch of residual in -coulomb sgn(move) the projection picks.
Row pick_row(double residual, double slope, double coulomb, double move) {
  const double push = slope * move - residual;
  if (std::fabs(push) <= coulomb)
    return {true, std::fabs(slope * move) <= kToleranceNm, -move, 0.0};
  const double total = residual + (push > 0.0 ? coulomb : -coulomb);
  return {false, std::fabs(total) <= kToleranceNm, 0.0, total};
}

struct Torque {
  double value, slope_angle, slope_rate;
};

Torque environment_torque(const Environment& env, double angle, double rate) {
  const double depth = angle - env.angle_rad;
  switch (env.kind) {
    case EnvironmentKind::kFree:
    case EnvironmentKind::kLocked:
      return {0.0, 0.0, 0.0};
    case EnvironmentKind::kSpring:
      return {env.stiffness * depth, env.stiffness, 0.0};
    case EnvironmentKind::kKelvinVoigt:
      return {env.stiffness * depth + env.damping * rate, env.stiffness, env.damping};
    case EnvironmentKind::kHuntCrossley:
      break;
  }
  const double damp = 1.0 + env.damping * rate;
  if (depth <= 0.0 || damp <= 0.0)
    return {0.0, 0.0, 0.0};  // contact never pulls
  const double root = std::sqrt(depth);
  return {env.stiffness * depth * root * damp, 1.5 * env.stiffness * root * damp,
          env.stiffness * depth * root * env.damping};
}

}  // namespace

Drivetrain::Drivetrain(const PlantParameters& parameters)
    : parameters_(parameters),
      joint_inertia_(parameters.joint_inertia_kgm2 + parameters.effects.load_inertia_kgm2),
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
    const double bearing = pulley_viscous() / step.dt_s * pulley_move(step, moves.output);
    if ((last_torques_.out - bearing) * static_cast<double>(contact) < -2.0 * kToleranceNm)
      return false;
  }
  accept(step, moves, joint_move);
  return true;
}

Drivetrain::Moves Drivetrain::solve(const Step& step, Moves guess) {
  Moves moves = guess;
  if (!newton(step, moves)) {
    ++relaxations_;
    moves = guess;
    relax(step, moves);
  }
  return moves;
}

bool Drivetrain::newton(const Step& step, Moves& moves) {
  for (int round = 0; round < kMaxRounds; ++round) {
    ++rounds_;
    const Torques t = torques(step, moves);
    const Balance m = motor_balance(step, moves.q1);
    const Balance o = output_balance(step, moves.output);
    const double a11 = m.slope + t.in_by_q1;
    const double a22 = o.slope - t.out_by_q2;
    Row r1 = pick_row(m.residual + t.in, a11, m.coulomb, moves.q1);
    Row r2 = pick_row(o.residual - t.out, a22, o.coulomb, moves.output);
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
    moves.q1 = r1.fixed && m.prescribed ? m.target : (r1.fixed ? 0.0 : moves.q1 + step1);
    moves.output = r2.fixed && o.prescribed ? o.target : (r2.fixed ? 0.0 : moves.output + step2);
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
    if (newton(step, trial)) {
      moves = trial;
      return;
    }
  }
  throw std::runtime_error("the plant diverged: motor and joint find no common balance; use smaller substeps");
}

// Solves one angle's monotone balance by Newton kept inside a bracket, the other angle held.
double Drivetrain::relax_one(const Step& step, Moves moves, bool output) {
  double& move = output ? moves.output : moves.q1;
  const auto balance = [&](double at) {
    move = at;
    Balance b = output ? output_balance(step, at) : motor_balance(step, at);
    if (b.prescribed)
      return b;
    const Torques t = torques(step, moves);
    b.residual += output ? -t.out : t.in;
    b.slope += output ? -t.out_by_q2 : t.in_by_q1;
    return b;
  };
  const Balance still = balance(0.0);
  if (still.prescribed)
    return still.target;
  if (std::fabs(still.residual) <= still.coulomb)
    return 0.0;
  const double direction = still.residual > 0.0 ? -1.0 : 1.0;
  double low = 0.0;
  double high = kLargestAngleRad;
  double distance = 1.0e-9;
  for (int round = 0; round < 200 && high - low > 1.0e-16 * high; ++round) {
    const Balance b = balance(direction * distance);
    const double excess = b.residual * direction + b.coulomb;
    if (std::fabs(excess) <= 0.1 * kToleranceNm)
      break;
    (excess < 0.0 ? low : high) = distance;
    const double next = distance - excess / b.slope;
    distance = next > low && next < high ? next : (high < kLargestAngleRad ? 0.5 * (low + high) : 4.0 * distance);
  }
  return direction * distance;
}

Drivetrain::Torques Drivetrain::torques(const Step& step, const Moves& moves) {
  const double r1 = parameters_.input_radius_m;
  const double r2 = parameters_.output_radius_m;
  const double input = r1 * moves.q1;
  const double output = r2 * pulley_move(step, moves.output);
  // The top tendon's material moves toward the input when q1 grows; displacements count toward the output.
  const TendonEnds& t = top_.trial(-input, -output, step.dt_s);
  const TendonEnds& b = bottom_.trial(input, output, step.dt_s);
  last_torques_ = {.in = r1 * (t.input_n - b.input_n),
                   .out = r2 * (t.output_n - b.output_n),
                   .in_by_q1 = -r1 * r1 * (t.input_by_input + b.input_by_input),
                   .in_by_q2 = -r1 * r2 * (t.input_by_output + b.input_by_output),
                   .out_by_q1 = -r2 * r1 * (t.output_by_input + b.output_by_input),
                   .out_by_q2 = -r2 * r2 * (t.output_by_output + b.output_by_output)};
  return last_torques_;
}

Drivetrain::Balance Drivetrain::motor_balance(const Step& step, double move) const {
  const double h = step.dt_s;
  const double inertia = parameters_.motor_inertia_kgm2 / (h * h);
  const double viscous = parameters_.motor_viscous_nms_per_rad / h;
  const double residual = inertia * (move - h * state_.q1_rate_rad_per_s) + viscous * move - step.loads.motor_torque_nm;
  return {residual, inertia + viscous, parameters_.motor_coulomb_nm, step.kinematic, step.q1_move};
}

Drivetrain::Balance Drivetrain::joint_balance(const Step& step, double move) const {
  const double h = step.dt_s;
  const double angle = state_.q2_rad + move;
  const double inertia = joint_inertia_ / (h * h);
  const double viscous = parameters_.joint_viscous_nms_per_rad / h;
  const Torque env = environment_torque(parameters_.environment, angle, move / h);
  const Effects& e = parameters_.effects;
  double gravity = 0.0;
  double gravity_slope = 0.0;
  if (e.gravity_torque_nm != 0.0) {
    gravity = e.gravity_torque_nm * det_sin(angle + e.gravity_angle_rad);
    gravity_slope = e.gravity_torque_nm * det_cos(angle + e.gravity_angle_rad);
  }
  const double residual =
      inertia * (move - h * state_.q2_rate_rad_per_s) + viscous * move + env.value + gravity - step.loads.tip_torque_nm;
  return {residual, inertia + viscous + env.slope_angle + env.slope_rate / h + gravity_slope,
          parameters_.joint_coulomb_nm + step.loads.extra_joint_coulomb_nm,
          parameters_.environment.kind == EnvironmentKind::kLocked, 0.0};
}

double Drivetrain::pulley_viscous() const {
  return kPulleyViscousFloor + kPulleyViscousShare * parameters_.joint_viscous_nms_per_rad;
}

// With play the pulley's bearing acts in every state: only then do pushing and parting exclude each other.
Drivetrain::Balance Drivetrain::output_balance(const Step& step, double move) const {
  if (step.contact == Contact::kJoined)
    return joint_balance(step, move);
  const double viscous = pulley_viscous() / step.dt_s;
  Balance balance = step.contact == Contact::kGap ? Balance{0.0, 0.0, 0.0, false, 0.0} : joint_balance(step, move);
  balance.residual += viscous * pulley_move(step, move);
  balance.slope += viscous;
  return balance;
}

double Drivetrain::free_joint_move(const Step& step) const {
  double move = 0.0;
  for (int round = 0; round < kMaxRounds; ++round) {
    const Balance b = joint_balance(step, move);
    if (b.prescribed)
      return b.target;
    const Row row = pick_row(b.residual, b.slope, b.coulomb, move);
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
  top_.commit();
  bottom_.commit();
  state_.q1_rad += moves.q1;
  state_.pulley_rad += pulley_move(step, moves.output);
  state_.q2_rad += joint_move;
  state_.q1_rate_rad_per_s = moves.q1 / step.dt_s;
  state_.q2_rate_rad_per_s = joint_move / step.dt_s;
  state_.tau_in_nm = last_torques_.in;
  state_.tau_out_nm = last_torques_.out;
  last_moves_ = moves;
  contact_ = step.contact;
  const bool bounded = std::fabs(state_.q1_rad) < kLargestAngleRad && std::fabs(state_.q2_rad) < kLargestAngleRad;
  if (!bounded || !std::isfinite(state_.tau_in_nm)) {
    throw std::runtime_error(
        "the plant diverged: an angle left the range of 10000 rad; check loads and controller gains");
  }
}

}  // namespace capstan::sim
