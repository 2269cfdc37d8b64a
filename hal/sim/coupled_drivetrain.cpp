// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/sim/coupled_drivetrain.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "capstan/hal/sim/drivetrain.hpp"

namespace capstan::sim {

CoupledDrivetrain::CoupledDrivetrain(const std::vector<InstrumentAxis>& axes) {
  for (const InstrumentAxis& axis : axes) {
    const PlantParameters& p = axis.plant;
    std::vector<double> carried = axis.carried_radius_m;
    carried.resize(axes.size(), 0.0);
    axes_.push_back({.parameters = p,
                     .carried = std::move(carried),
                     .top = Tendon(tendon_parameters(p, true), initial_elongation(p)),
                     .bottom = Tendon(tendon_parameters(p, false), initial_elongation(p)),
                     .state = {},
                     .contact = p.effects.play_half_width_rad > 0.0 ? Contact::kGap : Contact::kJoined});
  }
  lay_out();
}

void CoupledDrivetrain::advance(std::span<const Loads> loads, double dt_s) {
  advance(Step{loads, {}, dt_s});
}

void CoupledDrivetrain::advance_to(std::span<const double> q1_rad, std::span<const Loads> loads, double dt_s) {
  advance(Step{loads, q1_rad, dt_s});
}

// The contacts of all plays are found one change at a time.
void CoupledDrivetrain::advance(const Step& step) {
  const std::size_t most_changes = 4 * axes_.size() + 4;
  for (std::size_t change = 0; change < most_changes; ++change) {
    solve(step);
    bool settled = true;
    for (std::size_t i = 0; i < axes_.size() && settled; ++i) {
      Contact better = axes_[i].contact;
      settled = contact_holds(step, i, better);
      axes_[i].contact = better;
    }
    if (settled) {
      accept(step);
      return;
    }
    lay_out();
  }
  throw std::runtime_error("the plant diverged: no state of the plays balances; use smaller substeps or a wider gap");
}

// Which angles are unknown depends on the contacts.
void CoupledDrivetrain::lay_out() {
  coordinates_.clear();
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    coordinates_.push_back({i, Kind::kMotor});
    coordinates_.push_back({i, Kind::kOutput});
    if (axes_[i].contact == Contact::kGap)
      coordinates_.push_back({i, Kind::kJoint});
  }
  const std::size_t count = coordinates_.size();
  moves_.assign(count, 0.0);
  change_.assign(count, 0.0);
  rows_.assign(count, Row{});
  balances_.assign(count, Balance{});
  system_.assign(count * count, 0.0);
  by_input_.assign(axes_.size() * count, 0.0);
  by_output_.assign(axes_.size() * count, 0.0);
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    for (std::size_t k = 0; k < count; ++k) {
      const auto [axis, kind] = coordinates_[k];
      if (kind == Kind::kMotor) {
        by_input_[i * count + k] = axis == i ? axes_[i].parameters.input_radius_m : 0.0;
        continue;
      }
      const bool turns_joint = kind == Kind::kJoint || axes_[axis].contact != Contact::kGap;
      const double own = axis == i && kind == Kind::kOutput ? axes_[i].parameters.output_radius_m : 0.0;
      by_output_[i * count + k] = own - (turns_joint ? axes_[i].carried[axis] : 0.0);
    }
  }
}

void CoupledDrivetrain::solve(const Step& step) {
  const auto start = [&] {
    for (std::size_t k = 0; k < coordinates_.size(); ++k) {
      const Axis& a = axes_[coordinates_[k].axis];
      const Kind kind = coordinates_[k].kind;
      moves_[k] = kind == Kind::kMotor ? a.last_q1 : (kind == Kind::kOutput ? a.last_output : a.last_joint);
    }
  };
  for (Axis& axis : axes_)
    axis.tried = false;
  start();
  if (newton(step) || newton(step, kRoundingShare))
    return;
  ++relaxations_;
  start();
  relax(step);
}

double CoupledDrivetrain::move_of(std::size_t axis, Kind kind) const {
  for (std::size_t k = 0; k < coordinates_.size(); ++k) {
    if (coordinates_[k].axis == axis && coordinates_[k].kind == kind)
      return moves_[k];
  }
  return 0.0;
}

double CoupledDrivetrain::joint_move(std::size_t axis) const {
  return move_of(axis, axes_[axis].contact == Contact::kGap ? Kind::kJoint : Kind::kOutput);
}

double CoupledDrivetrain::pulley_move(std::size_t axis) const {
  const Axis& a = axes_[axis];
  const double output = move_of(axis, Kind::kOutput);
  if (a.contact == Contact::kJoined || a.contact == Contact::kGap)
    return output;
  const double offset = static_cast<double>(a.contact) * a.parameters.effects.play_half_width_rad;
  return a.state.q2_rad + output + offset - a.state.pulley_rad;
}

// Tendons that did not move since the last trial keep its answer.
void CoupledDrivetrain::pull(const Step& step) {
  const std::size_t count = coordinates_.size();
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    Axis& a = axes_[i];
    double input = 0.0;
    double output = step.loads[i].path_move_m;
    if (a.contact == Contact::kForward || a.contact == Contact::kBackward)
      output += a.parameters.output_radius_m * (pulley_move(i) - move_of(i, Kind::kOutput));
    for (std::size_t k = 0; k < count; ++k) {
      input += by_input_[i * count + k] * moves_[k];
      output += by_output_[i * count + k] * moves_[k];
    }
    if (a.tried && input == a.input && output == a.output)
      continue;
    pull(step, a, input, output, balance_instant(a.parameters));
  }
}

// What an axis' tendons pull with this share of the displacements made.
void CoupledDrivetrain::pull(const Step& step, Axis& a, double input, double output, double instant) {
  const TendonEnds& t = a.top.trial(-instant * input, -instant * output, instant * step.dt_s);
  const TendonEnds& b = a.bottom.trial(instant * input, instant * output, instant * step.dt_s);
  a.input = input;
  a.output = output;
  a.tried = true;
  a.in = t.input_n - b.input_n;
  a.out = t.output_n - b.output_n;
  a.in_by_in = -instant * (t.input_by_input + b.input_by_input);
  a.in_by_out = -instant * (t.input_by_output + b.input_by_output);
  a.out_by_in = -instant * (t.output_by_input + b.output_by_input);
  a.out_by_out = -instant * (t.output_by_output + b.output_by_output);
}

Balance CoupledDrivetrain::balance(const Step& step, std::size_t number) const {
  const auto [axis, kind] = coordinates_[number];
  const Axis& a = axes_[axis];
  const Loads& loads = step.loads[axis];
  if (kind == Kind::kMotor) {
    Balance b = motor_balance(a.parameters, a.state, loads, step.dt_s, moves_[number]);
    if (!step.q1_target.empty()) {
      b.prescribed = true;
      b.target = step.q1_target[axis] - a.state.q1_rad;
    }
    return b;
  }
  if (kind == Kind::kJoint || a.contact == Contact::kJoined)
    return joint_balance(a.parameters, a.state, loads, step.dt_s, moves_[number]);
  const double viscous = pulley_viscous(a.parameters) / step.dt_s;
  Balance b = a.contact == Contact::kGap ? Balance{0.0, 0.0, 0.0, false, 0.0, 0.0}
                                         : joint_balance(a.parameters, a.state, loads, step.dt_s, moves_[number]);
  b.residual += viscous * pulley_move(axis);
  b.slope += viscous;
  return b;
}

// What the tendons take from a motor, or, negated, give to a joint.
double CoupledDrivetrain::tendon_torque(std::size_t number) const {
  const std::size_t count = coordinates_.size();
  double torque = 0.0;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    torque += by_input_[i * count + number] * axes_[i].in - by_output_[i * count + number] * axes_[i].out;
  }
  return torque;
}

void CoupledDrivetrain::fill_system(const std::vector<Balance>& balances) {
  const std::size_t count = coordinates_.size();
  std::fill(system_.begin(), system_.end(), 0.0);
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const Axis& a = axes_[i];
    const double* in = &by_input_[i * count];
    const double* out = &by_output_[i * count];
    for (std::size_t k = 0; k < count; ++k) {
      if (in[k] == 0.0 && out[k] == 0.0)
        continue;
      const double by_in = in[k] * a.in_by_in - out[k] * a.out_by_in;
      const double by_out = in[k] * a.in_by_out - out[k] * a.out_by_out;
      for (std::size_t l = 0; l < count; ++l)
        system_[k * count + l] += by_in * in[l] + by_out * out[l];
    }
  }
  for (std::size_t k = 0; k < count; ++k)
    system_[k * count + k] += balances[k].slope;
}

bool CoupledDrivetrain::pick_rows(const std::vector<Balance>& balances, double rounding_share) {
  const std::size_t count = coordinates_.size();
  bool satisfied = true;
  for (std::size_t k = 0; k < count; ++k) {
    const Balance& b = balances[k];
    if (b.prescribed) {
      rows_[k] = {true, moves_[k] == b.target, b.target - moves_[k], 0.0};
    } else {
      const double torque = tendon_torque(k);
      const double slope = system_[k * count + k];
      rows_[k] = pick_row(b.residual + torque, slope, b.coulomb, moves_[k],
                          balance_tolerance(b, slope, moves_[k], torque, rounding_share));
    }
    satisfied = satisfied && rows_[k].satisfied;
  }
  return satisfied;
}

// Gaussian elimination with row exchange of system_ change_ = -residuals, fixed rows being known.
bool CoupledDrivetrain::eliminate() {
  const std::size_t count = coordinates_.size();
  for (std::size_t k = 0; k < count; ++k) {
    change_[k] = rows_[k].fixed ? rows_[k].step : -rows_[k].residual;
    for (std::size_t l = 0; l < count && rows_[k].fixed; ++l)
      system_[k * count + l] = l == k ? 1.0 : 0.0;
  }
  for (std::size_t k = 0; k < count; ++k) {
    std::size_t best = k;
    for (std::size_t r = k + 1; r < count; ++r) {
      if (std::fabs(system_[r * count + k]) > std::fabs(system_[best * count + k]))
        best = r;
    }
    if (!(std::fabs(system_[best * count + k]) > 0.0))
      return false;
    for (std::size_t l = k; l < count && best != k; ++l)
      std::swap(system_[k * count + l], system_[best * count + l]);
    std::swap(change_[k], change_[best]);
    for (std::size_t r = k + 1; r < count; ++r) {
      const double factor = system_[r * count + k] / system_[k * count + k];
      if (factor == 0.0)
        continue;
      for (std::size_t l = k; l < count; ++l)
        system_[r * count + l] -= factor * system_[k * count + l];
      change_[r] -= factor * change_[k];
    }
  }
  for (std::size_t k = count; k-- > 0;) {
    for (std::size_t l = k + 1; l < count; ++l)
      change_[k] -= system_[k * count + l] * change_[l];
    change_[k] /= system_[k * count + k];
  }
  return true;
}

bool CoupledDrivetrain::newton(const Step& step, double rounding_share) {
  const std::size_t count = coordinates_.size();
  for (int round = 0; round < kMaxRounds; ++round) {
    ++rounds_;
    const double damping = round < kFullRounds ? 1.0 : 0.5;
    pull(step);
    for (std::size_t k = 0; k < count; ++k)
      balances_[k] = balance(step, k);
    fill_system(balances_);
    if (pick_rows(balances_, rounding_share))
      return true;
    if (!eliminate())
      return false;
    for (std::size_t k = 0; k < count; ++k) {
      const double fixed = balances_[k].prescribed ? balances_[k].target : 0.0;
      moves_[k] = rows_[k].fixed ? fixed : moves_[k] + damping * change_[k];
      if (!std::isfinite(moves_[k]))
        return false;
    }
  }
  return false;
}

void CoupledDrivetrain::relax(const Step& step) {
  for (int sweep = 1; sweep <= kMaxRelaxations; ++sweep) {
    for (std::size_t k = 0; k < coordinates_.size(); ++k)
      relax_one(step, k);
    if (sweep % kSweepsPerNewton != 0)
      continue;
    const std::vector<double> before = moves_;
    if (newton(step, kRoundingShare))
      return;
    moves_ = before;
  }
  throw std::runtime_error("the plant diverged: motors and joints find no common balance; use smaller substeps");
}

void CoupledDrivetrain::relax_one(const Step& step, std::size_t number) {
  const std::size_t count = coordinates_.size();
  moves_[number] = balanced_move([&](double at) {
    moves_[number] = at;
    pull(step);
    balances_[number] = balance(step, number);
    Balance b = balances_[number];
    fill_system(balances_);
    b.residual += tendon_torque(number);
    b.slope = system_[number * count + number];
    return b;
  });
}

// A contact is right if it only pushes; the gap is right if it stays within its width.
bool CoupledDrivetrain::contact_holds(const Step& step, std::size_t axis, Contact& better) const {
  const Axis& a = axes_[axis];
  if (a.contact == Contact::kJoined)
    return true;
  if (a.contact == Contact::kGap) {
    const double gap = a.state.pulley_rad + pulley_move(axis) - a.state.q2_rad - joint_move(axis);
    if (std::fabs(gap) <= a.parameters.effects.play_half_width_rad * (1.0 + 1.0e-12))
      return true;
    better = gap > 0.0 ? Contact::kForward : Contact::kBackward;
    return false;
  }
  const double bearing = pulley_viscous(a.parameters) / step.dt_s * pulley_move(axis);
  const double push = a.parameters.output_radius_m * a.out - bearing;
  if (push * static_cast<double>(a.contact) >= -2.0 * kBalanceToleranceNm)
    return true;
  better = Contact::kGap;
  return false;
}

void CoupledDrivetrain::accept(const Step& step) {
  for (Axis& a : axes_) {
    if (balance_instant(a.parameters) < 1.0)
      pull(step, a, a.input, a.output, 1.0);
  }
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    Axis& a = axes_[i];
    a.top.commit();
    a.bottom.commit();
    a.last_q1 = move_of(i, Kind::kMotor);
    a.last_output = move_of(i, Kind::kOutput);
    a.last_joint = joint_move(i);
    a.state.pulley_rad += pulley_move(i);
    a.state.tau_in_nm = a.parameters.input_radius_m * a.in;
    a.state.tau_out_nm = a.parameters.output_radius_m * a.out;
    a.state.joint_torque_nm = a.state.tau_out_nm;
    for (const Axis& passing : axes_)
      a.state.joint_torque_nm -= passing.carried[i] * passing.out;
    advance_state(a.parameters, a.state, step.dt_s, a.last_q1, a.last_joint);
    const bool bounded = std::fabs(a.state.q1_rad) < kLargestAngleRad && std::fabs(a.state.q2_rad) < kLargestAngleRad;
    if (!bounded || !std::isfinite(a.state.tau_in_nm)) {
      throw std::runtime_error("the plant diverged: an angle of axis " + std::to_string(i) +
                               " left the range of 10000 rad; check loads and controller gains");
    }
  }
}

}  // namespace capstan::sim
