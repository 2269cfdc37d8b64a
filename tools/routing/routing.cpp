// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/routing/routing.hpp"

#include <algorithm>

namespace capstan::tools {
namespace {

// A law of one surface per tendon is identified to a few per cent (docs/thesis.md); 5 % is beyond that.
constexpr double kSurfaceErrs = 0.05;

struct LoadShapes {
  RunShape top, bottom;
};
auto shapes_of(const BeltDrive& drive, double s) -> LoadShapes {
  return {exact_shape(drive.top, s), exact_shape(drive.bottom, -s)};
}

auto state_of(const Routing& routing) -> RoutingState {
  const BeltDrive drive = routing.drive();
  const double driving = routing.load_nm < 0.0 ? -1.0 : 1.0;
  const LoadShapes on = shapes_of(drive, driving);
  const LoadShapes back = shapes_of(drive, -driving);
  const double torque_on = torque_in_for(drive, on.top, on.bottom, routing.load_nm);
  const double torque_back = torque_in_for(drive, back.top, back.bottom, routing.load_nm);
  const BeltState moving = solve_belt(drive, on.top, on.bottom, torque_on);
  const BeltState yielding = solve_belt(drive, back.top, back.bottom, torque_back);
  return {torque_on, torque_back, driving * (yielding.joint_shift_rad - moving.joint_shift_rad),
          arriving_stiffness(drive, on.top, on.bottom, moving), moving.one_slack};
}

void free_of_friction(RoutedRun& run) {
  for (Idler& pulley : run.pulleys) {
    pulley.joint_friction = 0.0;
  }
}

void add_costs(const Routing& routing, const RoutingState& whole, RoutedRun Routing::*run, const std::string& name,
               std::vector<PulleyCost>& costs) {
  for (std::size_t i = 0; i < (routing.*run).pulleys.size(); ++i) {
    Routing without = routing;
    (without.*run).pulleys[i].joint_friction = 0.0;
    const RoutingState state = state_of(without);
    const double driving = routing.load_nm < 0.0 ? -1.0 : 1.0;
    costs.push_back({name, (routing.*run).names[i], -std::log(idler_ratio((routing.*run).pulleys[i])),
                     driving * (whole.driving_nm - state.driving_nm), whole.lost_motion_rad - state.lost_motion_rad,
                     state.stiffness_nm_per_rad - whole.stiffness_nm_per_rad});
  }
}

auto surface_error(const BeltDrive& drive, double most_nm) -> SurfaceError {
  constexpr int kSteps = 30;
  SurfaceError error{equivalent_eta(drive.top), equivalent_eta(drive.bottom), 0.0, 0.0};
  double torque_scale = 0.0;
  double angle_scale = 0.0;
  for (int i = -kSteps; i <= kSteps; ++i) {
    const double torque = most_nm * i / kSteps;
    const BeltState exact = solve_exactly(drive, torque, 1.0);
    const BeltState surface = solve_as_surfaces(drive, torque, 1.0);
    error.torque = std::max(error.torque, std::abs(surface.torque_out_nm - exact.torque_out_nm));
    error.angle = std::max(error.angle, std::abs(surface.joint_shift_rad - exact.joint_shift_rad));
    torque_scale = std::max(torque_scale, std::abs(exact.torque_out_nm));
    angle_scale = std::max(angle_scale, std::abs(exact.joint_shift_rad));
  }
  error.torque /= torque_scale > 0.0 ? torque_scale : 1.0;
  error.angle /= angle_scale > 0.0 ? angle_scale : 1.0;
  return error;
}

}  // namespace

auto SurfaceError::warns() const -> bool {
  return torque > kSurfaceErrs || angle > kSurfaceErrs;
}

auto cost_of(const Routing& routing) -> RoutingCost {
  RoutingCost cost{state_of(routing), {}, {}, {}};
  Routing frictionless = routing;
  free_of_friction(frictionless.top);
  free_of_friction(frictionless.bottom);
  cost.frictionless = state_of(frictionless);
  add_costs(routing, cost.state, &Routing::top, "top", cost.pulleys);
  add_costs(routing, cost.state, &Routing::bottom, "bottom", cost.pulleys);
  cost.one_surface =
      surface_error(routing.drive(), routing.torque_nm > 0.0 ? routing.torque_nm : std::abs(cost.state.driving_nm));
  return cost;
}

}  // namespace capstan::tools
