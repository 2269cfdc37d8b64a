// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstdio>

#include "capstan/tools/routing/routing.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

auto percent(double share) -> std::string {
  return rounded(100.0 * share, 2) + " %";
}

auto row(const std::array<std::string, 6>& cells) -> std::string {
  char text[160];
  std::snprintf(text, sizeof(text), "  %-8s%-20s%8s%16s%18s%20s\n", cells[0].c_str(), cells[1].c_str(),
                cells[2].c_str(), cells[3].c_str(), cells[4].c_str(), cells[5].c_str());
  return text;
}

auto state_json(const RoutingState& state) -> nlohmann::json {
  return {{"driving_Nm", state.driving_nm},
          {"giving_way_Nm", state.giving_way_nm},
          {"lost_motion_rad", state.lost_motion_rad},
          {"stiffness_Nm_per_rad", state.stiffness_nm_per_rad},
          {"one_slack", state.one_slack}};
}

/// Tension at places along a run from its input on.
class Course {
 public:
  explicit Course(double input_n) : tension_n_(input_n) {}

  void free(double length_m) {
    add();
    at_m_ += length_m;
    add();
  }
  /// Over a pulley, to `ratio` times the tension.
  void over(const Idler& pulley, double ratio) {
    constexpr int kPoints = 16;
    const double before = tension_n_;
    const double start = at_m_;
    const double slips = slip_arc(pulley);
    const double sticks = pulley.wrap_rad - slips;
    // The lower tension holds until the tendon slips: before it where tension rises, behind it where it falls.
    const double first = ratio > 1.0 ? sticks : 0.0;
    for (int i = 0; i <= kPoints && slips > 0.0; ++i) {
      const double share = static_cast<double>(i) / kPoints;
      at_m_ = start + pulley.radius_m * (first + share * slips);
      tension_n_ = before * std::pow(ratio, share);
      add();
    }
    at_m_ = start + pulley.radius_m * pulley.wrap_rad;
  }
  [[nodiscard]] auto series(const std::string& label, const std::string& colour) const -> Series {
    const auto size = static_cast<Eigen::Index>(x_.size());
    return {label, colour, Eigen::Map<const Eigen::VectorXd>(x_.data(), size),
            Eigen::Map<const Eigen::VectorXd>(y_.data(), size)};
  }

 private:
  void add() {
    x_.push_back(at_m_);
    y_.push_back(tension_n_);
  }
  double at_m_ = 0.0;
  double tension_n_;
  std::vector<double> x_, y_;
};

auto along(const RoutedRun& run, double input_n, double s) -> Course {
  Course course(input_n);
  course.free(run.spans_m[0]);
  for (std::size_t i = 0; i < run.pulleys.size(); ++i) {
    const double rho = idler_ratio(run.pulleys[i]);
    course.over(run.pulleys[i], s > 0.0 ? rho : 1.0 / rho);
    course.free(run.spans_m[i + 1]);
  }
  return course;
}

}  // namespace

auto routing_text(const Routing& routing, const RoutingCost& cost) -> std::string {
  const RoutingState& state = cost.state;
  const RoutingState& free = cost.frictionless;
  std::string text = "at " + rounded(routing.load_nm) + " Nm of the joint    with friction    without\n";
  const auto line = [&text](const char* what, double with, double without, const char* unit) {
    char buffer[120];
    std::snprintf(buffer, sizeof(buffer), "  %-26s%12s%11s  %s\n", what, rounded(with).c_str(),
                  rounded(without).c_str(), unit);
    text += buffer;
  };
  line("motor torque, driving", state.driving_nm, free.driving_nm, "Nm");
  line("motor torque, giving way", state.giving_way_nm, free.giving_way_nm, "Nm");
  line("joint angle of a reversal", state.lost_motion_rad, free.lost_motion_rad, "rad");
  line("stiffness, joint held", state.stiffness_nm_per_rad, free.stiffness_nm_per_rad, "Nm/rad");
  text += state.one_slack ? "  one tendon is slack while the load is driven\n" : "";
  text += "what each pulley costs: what would be saved if it alone were without friction (does not add up)\n" +
          row({"run", "pulley", "eta", "torque, Nm", "angle, rad", "stiffness, Nm/rad"});
  for (const PulleyCost& p : cost.pulleys) {
    text += row({p.run, p.name, rounded(p.eta, 3), rounded(p.torque_nm, 3), rounded(p.lost_motion_rad, 3),
                 rounded(p.stiffness_nm_per_rad, 3)});
  }
  text += row({"all", "", rounded(cost.one_surface.eta_top + cost.one_surface.eta_bottom, 3),
               rounded(std::abs(state.driving_nm) - std::abs(free.driving_nm), 3),
               rounded(state.lost_motion_rad - free.lost_motion_rad, 3),
               rounded(free.stiffness_nm_per_rad - state.stiffness_nm_per_rad, 3)});
  return text + "one surface for each run (eta " + rounded(cost.one_surface.eta_top, 3) + ", " +
         rounded(cost.one_surface.eta_bottom, 3) + ") errs by " + percent(cost.one_surface.torque) +
         " of the joint's torque, " + percent(cost.one_surface.angle) + " of its angle\n";
}

auto routing_json(const Routing& routing, const RoutingCost& cost) -> nlohmann::json {
  nlohmann::json pulleys = nlohmann::json::array();
  for (const PulleyCost& p : cost.pulleys) {
    pulleys.push_back({{"run", p.run},
                       {"name", p.name},
                       {"eta", p.eta},
                       {"torque_Nm", p.torque_nm},
                       {"lost_motion_rad", p.lost_motion_rad},
                       {"stiffness_Nm_per_rad", p.stiffness_nm_per_rad}});
  }
  const SurfaceError& one = cost.one_surface;
  return {{"schema", "capstan.routing/1"},
          {"load_Nm", routing.load_nm},
          {"with_friction", state_json(cost.state)},
          {"without_friction", state_json(cost.frictionless)},
          {"pulleys", pulleys},
          {"one_surface",
           {{"eta_top", one.eta_top},
            {"eta_bottom", one.eta_bottom},
            {"torque_error", one.torque},
            {"angle_error", one.angle},
            {"warns", one.warns()}}}};
}

auto routing_plot(const Routing& routing) -> Plot {
  const BeltDrive drive = routing.drive();
  const auto input_n = [&](double s) {
    const RunShape top = exact_shape(drive.top, s);
    const RunShape bottom = exact_shape(drive.bottom, -s);
    return solve_belt(drive, top, bottom, torque_in_for(drive, top, bottom, routing.load_nm)).top_in_n;
  };
  const Eigen::Vector2d ends{0.0, length_of(drive.top)};
  const double pulls = input_n(1.0);
  constexpr Eigen::Index kPoints = 100;
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(kPoints, 0.0, ends[1]);
  const Eigen::VectorXd surface = pulls * (-equivalent_eta(drive.top) / ends[1] * x.array()).exp();
  return {"Tension along the top run at " + rounded(routing.load_nm) + " Nm of the joint",
          "way from the motor's pulley, m",
          "tension, N",
          {along(routing.top, pulls, 1.0).series("the top run pulls", "#1f5fa8"),
           along(routing.top, input_n(-1.0), -1.0).series("it yields", "#b5651d"),
           {"one surface, pulling", "#888888", x, surface},
           {"at rest", "#bbbbbb", ends, Eigen::Vector2d::Constant(routing.pretension_n)}},
          {}};
}

}  // namespace capstan::tools
