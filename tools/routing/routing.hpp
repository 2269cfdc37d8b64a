// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "capstan/model/belt_drive.hpp"
#include "capstan/tools/report/svg_plot.hpp"

namespace capstan::tools {

/// One tendon's way from the input pulley to the output pulley.
struct RoutedRun {
  std::vector<std::string> names;  ///< of the pulleys, in order
  std::vector<Idler> pulleys;
  std::vector<double> spans_m;  ///< free lengths, one more than pulleys
  [[nodiscard]] auto view() const -> BeltRun { return {pulleys, spans_m}; }
};

/// What a routing file says: two runs between a motor's pulley and a joint's.
struct Routing {
  double input_radius_m, output_radius_m;
  double axial_stiffness_n;  ///< E A
  double pretension_n;       ///< at rest
  double load_nm;            ///< of the joint, at which the costs are told; above 0 the top run pulls
  double torque_nm;          ///< of the motor, up to which one surface is compared; 0: that which drives the load
  RoutedRun top, bottom;
  [[nodiscard]] auto drive() const -> BeltDrive {
    return {input_radius_m, output_radius_m, axial_stiffness_n, pretension_n, top.view(), bottom.view()};
  }
};

/// From TOML text. Throws BadInput with file, line, and the range of what is out of it.
auto read_routing(const std::string& text, const std::string& name) -> Routing;

/// How a routing carries its load, slow steady motion.
struct RoutingState {
  double driving_nm;     ///< motor torque that moves the load on
  double giving_way_nm;  ///< at which the load moves the motor back
  /// Joint angle between both at the same place of the motor, rad: what a reversal under this load loses.
  double lost_motion_rad;
  /// Torque at the joint, held, per radian that the motor would turn it, driving, N m/rad.
  double stiffness_nm_per_rad;
  bool one_slack;  ///< driving
};

/// What would be saved if one pulley were without friction and all else stayed. Costs of several do not add up.
struct PulleyCost {
  std::string run, name;
  double eta;                   ///< -ln of the tension ratio across it
  double torque_nm;             ///< of the motor, driving
  double lost_motion_rad;       ///< of the joint
  double stiffness_nm_per_rad;  ///< lost; below 0: friction makes the routing stiffer here
};

/// One surface for every pulley of a run (5.2.1) beside the pulleys: largest errors at motor torques up to a given
/// one, either way, the motor moving forward, as shares of the largest value.
struct SurfaceError {
  double eta_top, eta_bottom;
  double torque, angle;
  [[nodiscard]] auto warns() const -> bool;
};

struct RoutingCost {
  RoutingState state, frictionless;
  std::vector<PulleyCost> pulleys;
  SurfaceError one_surface;
};
auto cost_of(const Routing& routing) -> RoutingCost;

/// For people, JSON (schema capstan.routing/1), and tension along the top run as a picture.
auto routing_text(const Routing& routing, const RoutingCost& cost) -> std::string;
auto routing_json(const Routing& routing, const RoutingCost& cost) -> nlohmann::json;
auto routing_plot(const Routing& routing) -> Plot;

}  // namespace capstan::tools
