// SPDX-License-Identifier: Apache-2.0
#include <numbers>

#include "capstan/tools/joint_file/section_reader.hpp"
#include "capstan/tools/routing/routing.hpp"

namespace capstan::tools {
namespace {

constexpr double kMostTurnsOfSurface = 6.0;
// -ln of the tension ratio over a whole run: beyond this 1 N holds 22,000, which is a knot and no tendon drive.
constexpr double kMostEta = 10.0;
// Of the tendon. Steel and polyethylene break below it; elongation is linear in tension here.
constexpr double kMostStrain = 0.05;
const std::vector<std::string> kPulleyKeys = {"name",     "wrap_rad",      "radius_m",
                                              "friction", "bore_radius_m", "bearing_friction"};

/// The highest tension of a state, N: at an end of a run, for it only falls or only rises between.
auto highest_n(const BeltState& state) -> double {
  return std::max({state.top_in_n, state.top_out_n, state.bottom_in_n, state.bottom_out_n});
}

/// Under the load, driven and giving way.
auto highest_under_load_n(const Routing& routing) -> double {
  const BeltDrive drive = routing.drive();
  double highest = routing.pretension_n;
  for (const double s : {1.0, -1.0}) {
    const RunShape top = exact_shape(drive.top, s);
    const RunShape bottom = exact_shape(drive.bottom, -s);
    highest = std::max(highest,
                       highest_n(solve_belt(drive, top, bottom, torque_in_for(drive, top, bottom, routing.load_nm))));
  }
  return highest;
}

/// Under the motor torques that one surface is compared at.
auto highest_under_torque_n(const Routing& routing) -> double {
  const BeltDrive drive = routing.drive();
  return std::max(highest_n(solve_exactly(drive, routing.torque_nm, 1.0)),
                  highest_n(solve_exactly(drive, -routing.torque_nm, 1.0)));
}

/// A routing's numbers, each within what makes sense, and what they come to together.
class RoutingReader {
 public:
  explicit RoutingReader(const std::string& name) : reader_(name) {}

  auto read(const toml::table& root) const -> Routing {
    reader_.only(root,
                 {"input_radius_m", "output_radius_m", "axial_stiffness_N", "pretension_N", "load_Nm", "torque_Nm",
                  "top", "bottom"},
                 "a routing");
    Routing routing{number(root, "input_radius_m", {1e-4, 1.0}),
                    number(root, "output_radius_m", {1e-4, 1.0}),
                    number(root, "axial_stiffness_N", {1.0, 1e9}),
                    number(root, "pretension_N", {0.0, 1e5}),
                    number(root, "load_Nm", {-1e4, 1e4}),
                    root.contains("torque_Nm") ? number(root, "torque_Nm", {0.0, 1e4}) : 0.0,
                    run(root, "top"),
                    {}};
    routing.bottom = root.contains("bottom") ? run(root, "bottom") : routing.top;
    if (routing.pretension_n == 0.0 && routing.load_nm == 0.0) {
      reader_.fail(*root.get("load_Nm"),
                   "pretension_N and load_Nm are both zero, so no tendon is under tension; give one of them");
    }
    expect_bearable(root, "load_Nm", routing, highest_under_load_n(routing));
    if (routing.torque_nm > 0.0) {
      expect_bearable(root, "torque_Nm", routing, highest_under_torque_n(routing));
    }
    return routing;
  }

 private:
  auto number(const toml::table& parent, const std::string& key, const NumberLimits& limits) const -> double {
    const toml::node* node = parent.get(key);
    const std::string range = rounded(limits.low, 4) + " to " + rounded(limits.high, 4);
    if (node == nullptr) {
      reader_.fail(parent, key + " is missing; give a number from " + range);
    }
    const double value = reader_.number(*node, key);
    if (value < limits.low || value > limits.high) {
      reader_.fail(*node, key + " = " + rounded(value, 6) + " is out of range; it must be from " + range);
    }
    return value;
  }

  void expect_bearable(const toml::table& root, const std::string& key, const Routing& routing,
                       double highest_n) const {
    const double strain = highest_n / routing.axial_stiffness_n;
    if (!(strain <= kMostStrain)) {
      reader_.fail(*root.get(key),
                   key + " and pretension_N strain the tendon by " + rounded(100.0 * strain, 3) +
                       " %; it must be from 0 to " + rounded(100.0 * kMostStrain, 2) +
                       " %: lower them, or give the axial_stiffness_N (E A) of a tendon that bears them");
    }
  }

  auto pulley(const toml::table& entry) const -> Idler {
    reader_.only(entry, kPulleyKeys, "a pulley");
    const bool turns = entry.contains("bearing_friction") || entry.contains("bore_radius_m");
    const double most_wrap = turns ? std::numbers::pi : kMostTurnsOfSurface * 2.0 * std::numbers::pi;
    Idler result{number(entry, "wrap_rad", {0.0, most_wrap}), 1.0, kSeizedBearing,
                 number(entry, "friction", {1e-3, 5.0}), number(entry, "radius_m", {1e-4, 1.0})};
    if (turns) {
      result.radius_ratio = number(entry, "bore_radius_m", {0.0, result.radius_m}) / result.radius_m;
      result.joint_friction = number(entry, "bearing_friction", {0.0, 1.0});
    }
    return result;
  }

  auto run(const toml::table& root, const std::string& key) const -> RoutedRun {
    const toml::table* table = reader_.table(root, key);
    if (table == nullptr) {
      reader_.fail(root, "there is no [" + key + "] run; write [" + key + "] with spans_m and a [[" + key +
                             ".pulley]] for each pulley on its way");
    }
    reader_.only(*table, {"spans_m", "pulley"}, "[" + key + "]");
    RoutedRun run;
    if (const toml::array* pulleys = (*table)["pulley"].as_array()) {
      for (const auto& entry : *pulleys) {
        if (entry.as_table() == nullptr) {
          reader_.fail(entry, "a pulley is not a table; write [[" + key + ".pulley]]");
        }
        run.pulleys.push_back(pulley(*entry.as_table()));
        run.names.push_back(name_of(*entry.as_table(), run.pulleys.size()));
      }
    }
    read_spans(*table, run);
    if (const double eta = equivalent_eta(run.view()); eta > kMostEta) {
      reader_.fail(*table, "the pulleys of [" + key + "] have eta = " + rounded(eta, 3) +
                               " in all, -ln of the tension that is left; it must be from 0 to " +
                               rounded(kMostEta, 2) + ": correct wrap_rad or friction");
    }
    return run;
  }

  auto name_of(const toml::table& entry, std::size_t number) const -> std::string {
    const toml::node* node = entry.get("name");
    if (node == nullptr) {
      return std::to_string(number);
    }
    if (!node->is_string()) {
      reader_.fail(*node, "the name of a pulley is no text; write it in quotes, name = \"elbow\"");
    }
    return as_written(*node->value<std::string>());
  }

  void read_spans(const toml::table& table, RoutedRun& run) const {
    const toml::array* spans = table["spans_m"].as_array();
    const std::size_t wanted = run.pulleys.size() + 1;
    if (spans == nullptr || spans->size() != wanted) {
      reader_.fail(table, "spans_m must list the free lengths before, between and behind the pulleys: " +
                              std::to_string(wanted) + " for " + std::to_string(wanted - 1) + " pulleys, not " +
                              std::to_string(spans == nullptr ? 0 : spans->size()));
    }
    double sum = 0.0;
    for (const auto& entry : *spans) {
      run.spans_m.push_back(reader_.number(entry, "spans_m"));
      if (run.spans_m.back() < 0.0 || run.spans_m.back() > 100.0) {
        reader_.fail(entry, rounded(run.spans_m.back(), 6) + " in spans_m is out of range; it must be from 0 to 100");
      }
      sum += run.spans_m.back();
    }
    if (sum <= 0.0) {
      reader_.fail(table, "spans_m add up to nothing; give the free lengths of the tendon, 0 to 100 each");
    }
  }

  SectionReader reader_;
};

}  // namespace

auto read_routing(const std::string& text, const std::string& name) -> Routing {
  return read_toml(text, name, "repair the line; 'capstan routing --help' shows a routing file",
                   [&name](const toml::table& root) { return RoutingReader(name).read(root); });
}

}  // namespace capstan::tools
