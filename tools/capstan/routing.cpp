// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/routing/routing.hpp"

#include <iostream>
#include <memory>

#include "capstan/tools/capstan/commands.hpp"
#include "capstan/tools/capstan/options.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

struct RoutingOptions {
  std::string file, json, svg;
};

auto run_routing(const RoutingOptions& options) -> int {
  const Routing routing = read_routing(read_text_file(options.file), options.file);
  const RoutingCost cost = cost_of(routing);
  std::cout << routing_text(routing, cost);
  if (cost.one_surface.warns()) {
    warn(
        "one surface for each run is not this routing: a law with one friction number per tendon (pseudo_kinematic, "
        "pull_push, tendon) carries that error; spread the pulleys along the run, or trust the figures by pulley");
  }
  if (!options.json.empty()) {
    write_text_file(options.json, routing_json(routing, cost).dump(2) + "\n");
  }
  if (!options.svg.empty()) {
    write_text_file(options.svg, svg_of(routing_plot(routing)));
    std::cerr << "wrote " << options.svg << "\n";
  }
  return kExitDone;
}

}  // namespace

void add_routing(CLI::App& app, int& exit_status) {
  auto options = std::make_shared<RoutingOptions>();
  CLI::App* command =
      app.add_subcommand("routing", "compute what friction costs on a tendon's path over pulleys, pulley by pulley");
  command->add_option("FILE", options->file, "the routing, as below")->required();
  command->add_option("--json", options->json, "write the result as JSON (schema capstan.routing/1)");
  command->add_option("--svg", options->svg, "file for a picture of the tension along the top run");
  command->footer(
      "A routing, in order from the motor's pulley to the joint's (examples/routing.toml):\n"
      "  input_radius_m = 0.0026\n"
      "  output_radius_m = 0.0024\n"
      "  axial_stiffness_N = 25000   # E A of the tendon: force per strain\n"
      "  pretension_N = 14\n"
      "  load_Nm = 0.03              # of the joint; above 0 the top run pulls\n"
      "  torque_Nm = 0.06            # may be left out: of the motor, up to which one surface is compared\n"
      "  [top]\n"
      "  spans_m = [0.05, 0.3, 0.05] # free lengths: one more than pulleys\n"
      "  [[top.pulley]]              # turns on a pin\n"
      "  name = \"elbow\"\n"
      "  wrap_rad = 1.57\n"
      "  radius_m = 0.004\n"
      "  friction = 0.2              # tendon on pulley\n"
      "  bore_radius_m = 0.001\n"
      "  bearing_friction = 0.15\n"
      "  [[top.pulley]]              # without a bore: a surface that stands still\n"
      "  wrap_rad = 0.8\n"
      "  radius_m = 0.01\n"
      "  friction = 0.1\n"
      "[bottom] is like [top]; without it both runs are the same. Steady slow motion, (5.1), (5.5) to (5.7); a\n"
      "negative stiffness loss is a gain: friction stops the part behind it from stretching. Exit status 0 done, 2 "
      "bad\n"
      "input.");
  command->callback([options, &exit_status] { exit_status = run_routing(*options); });
}

}  // namespace capstan::tools
