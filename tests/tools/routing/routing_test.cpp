// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/routing/routing.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

/// The capstan equation along a way, step by step, and the balance of each bearing: shares nothing with the tool.
struct Roller {
  double wrap, radius, friction, pin, bearing;  ///< bearing below 0: it stands still
};
struct Way {
  std::vector<double> spans;
  std::vector<Roller> rollers;
};
struct Carried {
  double out_n;        ///< tension at the joint's end
  double integral_nm;  ///< of tension over the way
};

auto bearing_ratio(const Roller& r) -> double {
  double low = 0.0;
  double high = 1.0;
  for (int i = 0; i < 100 && r.bearing >= 0.0; ++i) {
    const double middle = 0.5 * (low + high);
    const double force = std::hypot(1.0 - middle * std::cos(r.wrap), middle * std::sin(r.wrap));
    ((1.0 - middle) * r.radius > r.bearing * r.pin * force ? low : high) = middle;
  }
  return r.bearing >= 0.0 ? low : 0.0;
}

/// dT/dangle = -friction T from the tight side, by midpoints, until the bearing turns; then as it is. Tight side 1.
auto over(const Roller& r) -> Carried {
  constexpr int kSteps = 20000;
  const double least = bearing_ratio(r);
  const double step = r.wrap / kSteps;
  double tension = 1.0;
  double integral = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double slope = -r.friction * tension * (1.0 - 0.5 * r.friction * step);
    const double next = std::max(least, tension + slope * step);
    integral += 0.5 * (tension + next) * r.radius * step;
    tension = next;
  }
  return {tension, integral};
}

auto carry(const Way& way, double in_n, bool pulled) -> Carried {
  Carried sum{in_n, way.spans[0] * in_n};
  for (std::size_t i = 0; i < way.rollers.size(); ++i) {
    const Carried one = over(way.rollers[i]);
    const double tight = pulled ? sum.out_n : sum.out_n / one.out_n;
    sum.integral_nm += tight * one.integral_nm;
    sum.out_n = pulled ? tight * one.out_n : tight;
    sum.integral_nm += way.spans[i + 1] * sum.out_n;
  }
  return sum;
}

auto length(const Way& way) -> double {
  double sum = way.spans[0];
  for (std::size_t i = 0; i < way.rollers.size(); ++i) {
    sum += way.spans[i + 1] + way.rollers[i].wrap * way.rollers[i].radius;
  }
  return sum;
}

struct Drive {
  double r1, r2, axial, preset;
  Way top, bottom;
};
struct Stand {
  double motor_nm, joint_nm, shift, stiffness;
  double top_in, bottom_in;
};

/// The tensions that carry a torque at the joint (or at the motor), the motor moving forward or back.
auto stand(const Drive& d, double torque, bool at_joint, bool forward) -> Stand {
  const Carried top = carry(d.top, 1.0, forward);
  const Carried bottom = carry(d.bottom, 1.0, !forward);
  const double stretched = (length(d.top) + length(d.bottom)) * d.preset;
  const double difference = torque / (at_joint ? d.r2 : d.r1);
  const auto top_for = [&](double b) {
    return at_joint ? (difference + b * bottom.out_n) / top.out_n : difference + b;
  };
  double low = 0.0;
  double high = 1e6;
  for (int i = 0; i < 200; ++i) {
    const double b = 0.5 * (low + high);
    (std::max(0.0, top_for(b)) * top.integral_nm + b * bottom.integral_nm > stretched ? high : low) = b;
  }
  double b = low;
  double t = top_for(b);
  if (t < 0.0) {  // the top run hangs
    t = 0.0;
    b = -difference / (at_joint ? bottom.out_n : 1.0);
  }
  const double eased = 1e-3;  // of stretch, m: what the held joint feels of a little more motor
  const double more = (t > 0.0 ? eased / top.integral_nm * top.out_n : 0.0) +
                      (b > 1e-9 ? eased / bottom.integral_nm * bottom.out_n : 0.0);
  const double shift = t > 0.0 ? -(t * top.integral_nm - length(d.top) * d.preset)
                               : b * bottom.integral_nm - length(d.bottom) * d.preset;
  return {d.r1 * (t - b),
          d.r2 * (t * top.out_n - b * bottom.out_n),
          shift / d.axial / d.r2,
          d.r2 * d.axial * more / (eased / d.r2),
          t,
          b};
}

auto text_of(const Drive& d, double load) -> std::string {
  std::string text = "input_radius_m = " + exact(d.r1) + "\noutput_radius_m = " + exact(d.r2) +
                     "\naxial_stiffness_N = " + exact(d.axial) + "\npretension_N = " + exact(d.preset) +
                     "\nload_Nm = " + exact(load) + "\n";
  for (const auto& [name, way] : {std::pair{"top", d.top}, std::pair{"bottom", d.bottom}}) {
    std::vector<std::string> spans;
    for (const double span : way.spans) {
      spans.push_back(exact(span));
    }
    text += std::string("[") + name + "]\nspans_m = [" + joined(spans) + "]\n";
    for (const Roller& r : way.rollers) {
      text += std::string("[[") + name + ".pulley]]\nwrap_rad = " + exact(r.wrap) + "\nradius_m = " + exact(r.radius) +
              "\nfriction = " + exact(r.friction) + "\n";
      if (r.bearing >= 0.0) {
        text += "bore_radius_m = " + exact(r.pin) + "\nbearing_friction = " + exact(r.bearing) + "\n";
      }
    }
  }
  return text;
}

auto example() -> Drive {
  return {0.0026,
          0.0024,
          25000.0,
          14.0,
          {{0.05, 0.2, 0.07, 0.03},
           {{1.57, 0.004, 0.2, 0.001, 0.15}, {4.2, 0.01, 0.1, 0.0, -1.0}, {2.9, 0.005, 0.3, 0.002, 0.4}}},
          {{0.06, 0.3}, {{1.2, 0.008, 0.15, 0.0, -1.0}}}};
}

auto crowded() -> Drive {
  const Roller idler{0.5 * std::numbers::pi, 1e-4, 2.0, 0.5e-4, 0.2};
  const Way way{{0.05, 0.05, 0.05, 0.05, 0.05, 0.05, 0.05, 0.05, 3.6}, std::vector<Roller>(8, idler)};
  return {0.0026, 0.0024, 25000.0, 14.0, way, way};
}

TEST(Routing, CarriesItsLoadAsTheCapstanEquationDoesAlongTheWay) {
  const Drive drive = example();
  for (const double load : {0.0, 0.01, 0.05, 0.3, -0.02, -0.3}) {
    const RoutingCost cost = cost_of(read_routing(text_of(drive, load), "way.toml"));
    const bool forward = load >= 0.0;
    const Stand on = stand(drive, load, true, forward);
    const Stand back = stand(drive, load, true, !forward);
    EXPECT_NEAR(cost.state.driving_nm, on.motor_nm, 1e-6 * std::abs(on.motor_nm)) << load;
    EXPECT_NEAR(cost.state.giving_way_nm, back.motor_nm, 1e-6 * std::abs(on.motor_nm)) << load;
    EXPECT_NEAR(cost.state.lost_motion_rad, std::abs(back.shift - on.shift), 1e-5 * std::abs(on.shift)) << load;
    EXPECT_NEAR(cost.state.stiffness_nm_per_rad, on.stiffness, 1e-6 * on.stiffness) << load;
    EXPECT_EQ(cost.state.one_slack, on.top_in < 1e-6 || on.bottom_in < 1e-6) << load;
  }
}

TEST(Routing, TellsOfEachPulleyWhatGoesWithItsFriction) {
  Drive drive = example();
  const RoutingCost cost = cost_of(read_routing(text_of(drive, 0.05), "way.toml"));
  ASSERT_EQ(cost.pulleys.size(), 4u);
  const Stand with = stand(drive, 0.05, true, true);
  const Stand back = stand(drive, 0.05, true, false);
  drive.top.rollers[1].friction = 1e-12;  // the surface that stands still
  const Stand without = stand(drive, 0.05, true, true);
  const Stand without_back = stand(drive, 0.05, true, false);
  EXPECT_NEAR(cost.pulleys[1].torque_nm, with.motor_nm - without.motor_nm, 1e-5 * with.motor_nm);
  EXPECT_NEAR(cost.pulleys[1].lost_motion_rad, back.shift - with.shift - (without_back.shift - without.shift),
              1e-5 * std::abs(with.shift));
  EXPECT_NEAR(cost.pulleys[1].stiffness_nm_per_rad, without.stiffness - with.stiffness, 1e-5 * with.stiffness);
  EXPECT_NEAR(cost.pulleys[1].eta, 4.2 * 0.1, 1e-12);
  EXPECT_EQ(cost.pulleys[3].run, "bottom");
  EXPECT_NEAR(cost.frictionless.driving_nm, 0.05 * drive.r1 / drive.r2, 1e-12);
  EXPECT_NEAR(cost.frictionless.lost_motion_rad, 0.0, 1e-15);
}

// Where the 17 % of torque and 47 % of angle come from: eight idlers in the first tenth of the way, a motor that moves
// forward with -0.06 to 0.06 N m.
TEST(Routing, WarnsWhereOneSurfaceStandsForPulleysThatCrowd) {
  const Drive drive = crowded();
  const double most = 0.06;
  const std::string at = "torque_Nm = 0.06\n";
  const RoutingCost cost = cost_of(read_routing(at + text_of(drive, 0.01), "crowd.toml"));
  // One surface over the whole way with the same ratio from end to end.
  Drive surface = drive;
  const double all = length(drive.top);
  const double eta = -std::log(carry(drive.top, 1.0, true).out_n);
  surface.top = surface.bottom = {{0.0, 0.0}, {{1.0, all, eta, 0.0, -1.0}}};
  double torque = 0.0;
  double angle = 0.0;
  double torque_scale = 0.0;
  double angle_scale = 0.0;
  for (int i = -30; i <= 30; ++i) {
    const Stand exact = stand(drive, most * i / 30.0, false, true);
    const Stand one = stand(surface, most * i / 30.0, false, true);
    torque = std::max(torque, std::abs(one.joint_nm - exact.joint_nm));
    angle = std::max(angle, std::abs(one.shift - exact.shift));
    torque_scale = std::max(torque_scale, std::abs(exact.joint_nm));
    angle_scale = std::max(angle_scale, std::abs(exact.shift));
  }
  EXPECT_NEAR(torque / torque_scale, 0.17, 0.006);
  EXPECT_NEAR(angle / angle_scale, 0.47, 0.006);
  EXPECT_NEAR(cost.one_surface.torque, torque / torque_scale, 1e-3);
  EXPECT_NEAR(cost.one_surface.angle, angle / angle_scale, 1e-3);
  EXPECT_TRUE(cost.one_surface.warns());
  Drive even = crowded();
  even.top.spans = even.bottom.spans = {0.25, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.25};
  EXPECT_FALSE(cost_of(read_routing(at + text_of(even, 0.01), "even.toml")).one_surface.warns());
}

auto refusal(const std::string& text) -> std::string {
  try {
    (void)read_routing(text, "way.toml");
  } catch (const BadInput& error) {
    return error.what();
  }
  return "";
}

auto changed(std::string text, const std::string& from, const std::string& to) -> std::string {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(Routing, RefusesWhatMakesNoSenseWithLineAndRange) {
  const std::string good = text_of(example(), 0.05);
  EXPECT_EQ(refusal(good), "");
  struct Bad {
    const char *from, *to, *says;
  };
  for (const Bad& bad : {
           Bad{"pretension_N = 14", "pretension_N = -1",
               "way.toml:4: pretension_N = -1 is out of range; it must be from 0 to"},
           Bad{"wrap_rad = 1.57", "wrap_rad = 3.3", "must be from 0 to 3.142"},
           Bad{"wrap_rad = 4.2", "wrap_rad = 40", "must be from 0 to 37.7"},
           Bad{"friction = 0.2", "friction = nan", "friction is not a finite number"},
           Bad{"friction = 0.2", "friction = 0", "must be from 0.001 to 5"},
           Bad{"bore_radius_m = 0.001", "bore_radius_m = 0.1", "must be from 0 to 0.004"},
           Bad{"bearing_friction = 0.15", "bearing_friction = 7", "must be from 0 to 1"},
           Bad{"0.05, 0.2, ", "0.05, ", "4 for 3 pulleys, not 3"},
           Bad{"0.05, 0.2, ", "-0.05, 0.2, ", "-0.05 in spans_m is out of range"},
           Bad{"[top]", "[up]", "unknown key up"},
           Bad{"load_Nm = 0.05", "", "load_Nm is missing; give a number from -1e+04 to 1e+04"},
           Bad{"load_Nm = 0.05", "load_Nm =", "this is not TOML: "},
           Bad{"[top]", "[\"t\u00fcp\"]", "unknown key t\u00fcp"},
           Bad{"radius_m = 0.004", "radius_mm = 4", "unknown key radius_mm in a pulley"},
           Bad{"radius_m = 0.004", "radius_m = 0.004\nname = 5", "way.toml:11: the name of a pulley is no text"},
           // Each number is within its range, and all of them together are not.
           Bad{"friction = 0.1\n", "friction = 5\n", "the pulleys of [top] have eta = 21"},
           Bad{"load_Nm = 0.05", "load_Nm = 100", "way.toml:5: load_Nm and pretension_N strain the tendon by "},
           Bad{"axial_stiffness_N = 25000", "axial_stiffness_N = 1", "it must be from 0 to 5 %"},
           Bad{"load_Nm = 0.05", "load_Nm = 0.05\ntorque_Nm = 1000", "way.toml:6: torque_Nm and pretension_N strain"},
       }) {
    EXPECT_NE(refusal(changed(good, bad.from, bad.to)).find(bad.says), std::string::npos)
        << bad.to << ": " << refusal(changed(good, bad.from, bad.to));
  }
  const std::string loose =
      changed(changed(good, "pretension_N = 14", "pretension_N = 0"), "load_Nm = 0.05", "load_Nm = 0");
  EXPECT_NE(refusal(loose).find("no tendon is under tension"), std::string::npos);
}

TEST(Routing, SaysFiniteFiguresAtTheEdgeOfWhatItTakes) {
  Drive drive = example();
  drive.top.rollers[1].wrap = 36.0;
  drive.top.rollers[1].friction = 9.0 / 36.0;
  drive.bottom = drive.top;
  const RoutingCost cost = cost_of(read_routing(text_of(drive, 1e-4), "way.toml"));
  const SurfaceError& one = cost.one_surface;
  for (const double figure : {cost.state.driving_nm, cost.state.giving_way_nm, cost.state.lost_motion_rad,
                              cost.state.stiffness_nm_per_rad, one.torque, one.angle}) {
    EXPECT_TRUE(std::isfinite(figure)) << figure;
  }
  EXPECT_TRUE(one.warns());
}

TEST(Routing, DrawsTheTensionThatItReckonsWith) {
  const Drive drive = example();
  const Plot plot = routing_plot(read_routing(text_of(drive, 0.05), "way.toml"));
  const Stand on = stand(drive, 0.05, true, true);
  const Series& pulls = plot.series[0];
  EXPECT_NEAR(pulls.y[0], on.top_in, 1e-6 * on.top_in);
  EXPECT_NEAR(pulls.y.tail(1)[0], carry(drive.top, on.top_in, true).out_n, 1e-6 * on.top_in);
  EXPECT_NEAR(pulls.x.tail(1)[0], length(drive.top), 1e-12);
}

}  // namespace
}  // namespace capstan::tools
