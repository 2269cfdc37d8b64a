// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/sim/multi_plant.hpp"

#include <cmath>
#include <stdexcept>

namespace capstan::sim {
namespace {

// The first axis draws what a Plant of its own with this seed would.
std::uint64_t seed_of(std::uint64_t seed, std::size_t axis) {
  return axis == 0 ? seed : Random(seed ^ (axis * 0xa0761d6478bd642fU)).next();
}

const std::vector<InstrumentAxis>& checked(const std::vector<InstrumentAxis>& axes) {
  if (axes.empty())
    throw std::invalid_argument("the instrument has no axes; give at least one");
  for (const InstrumentAxis& axis : axes) {
    validate(axis.plant);
    if (axis.plant.substeps != axes.front().plant.substeps)
      throw std::invalid_argument("all axes share their sub-steps; give the same `substeps` everywhere");
    if (axis.plant.mode != axes.front().plant.mode)
      throw std::invalid_argument("all axes share their solver; give the same `mode` everywhere");
    if (axis.carried_radius_m.size() > axes.size())
      throw std::invalid_argument("carried_radius_m names more joints than there are; give one per axis");
  }
  return axes;
}

}  // namespace

MultiPlant::MultiPlant(const std::vector<InstrumentAxis>& axes, std::uint64_t seed) : drivetrain_(checked(axes)) {
  for (std::size_t i = 0; i < axes.size(); ++i)
    peripheries_.emplace_back(axes[i].plant, seed_of(seed, i));
  loads_.resize(axes.size());
  targets_.resize(axes.size());
  starts_.resize(axes.size());
  observe();
}

MultiPlant::MultiPlant(const Scenario& scenario) : MultiPlant(axes_of(scenario), scenario.seed) {
  for (const Fault& fault : scenario.faults)
    schedule(fault);
}

void MultiPlant::begin(std::span<const MotorCommand> commands) {
  for (std::size_t i = 0; i < peripheries_.size(); ++i) {
    peripheries_[i].begin(commands[i].current_a, commands[i].enabled, drivetrain_.top(i), drivetrain_.bottom(i));
    drivetrain_.set_site(i, peripheries_[i].site_m());
  }
}

void MultiPlant::observe() {
  for (std::size_t i = 0; i < peripheries_.size(); ++i)
    peripheries_[i].observe(drivetrain_.state(i));
}

void MultiPlant::step(std::span<const MotorCommand> commands) {
  if (commands.size() != axis_count())
    throw std::invalid_argument("there must be one command per axis; give as many as the instrument has");
  for (const MotorCommand& command : commands)
    require_number(command.current_a);
  divergence_.guard([&] {
    begin(commands);
    const int substeps = parameters(0).substeps;
    const double dt = kStepS / static_cast<double>(substeps);
    for (int step = 1; step <= substeps; ++step) {
      for (std::size_t i = 0; i < axis_count(); ++i)
        loads_[i] = peripheries_[i].powered(step, drivetrain_.state(i));
      drivetrain_.advance(loads_, dt);
    }
  });
  observe();
}

void MultiPlant::step_kinematic(std::span<const double> q1_rad) {
  if (q1_rad.size() != axis_count())
    throw std::invalid_argument("there must be one angle per axis; give as many as the instrument has");
  for (std::size_t i = 0; i < axis_count(); ++i) {
    if (!std::isfinite(q1_rad[i]))
      throw std::runtime_error("an input angle is not a number; give angles in rad");
    starts_[i] = drivetrain_.state(i).q1_rad;
  }
  divergence_.guard([&] {
    begin(std::vector<MotorCommand>(axis_count()));
    const int substeps = parameters(0).substeps;
    const double dt = kStepS / static_cast<double>(substeps);
    for (int step = 1; step <= substeps; ++step) {
      const double share = static_cast<double>(step) / static_cast<double>(substeps);
      for (std::size_t i = 0; i < axis_count(); ++i) {
        targets_[i] = starts_[i] + share * (q1_rad[i] - starts_[i]);
        loads_[i] = peripheries_[i].unpowered(step, drivetrain_.state(i));
      }
      drivetrain_.advance_to(targets_, loads_, dt);
    }
  });
  observe();
}

void MultiPlant::schedule(const Fault& fault) {
  if (fault.axis < 0 || static_cast<std::size_t>(fault.axis) >= axis_count())
    throw std::invalid_argument("fault: the instrument has no such axis; correct `axis`");
  peripheries_[static_cast<std::size_t>(fault.axis)].schedule(fault);
}

}  // namespace capstan::sim
