// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/mjcf/mjcf.hpp"

#include <iostream>
#include <memory>

#include "capstan/tools/capstan/commands.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

struct MjcfOptions {
  std::string law, output;
  MjcfNames names;
};

auto run_mjcf(const MjcfOptions& options) -> int {
  const Mjcf made = mjcf_of(read_joint_file(options.law), options.names);
  for (const auto& warning : made.warnings) {
    std::cerr << "warning: " << warning << "\n";
  }
  if (options.output.empty()) {
    std::cout << made.text;
  } else {
    write_text_file(options.output, made.text);
    std::cerr << "wrote " << options.output << "\n";
  }
  return kExitDone;
}

}  // namespace

void add_mjcf(CLI::App& app, int& exit_status) {
  auto options = std::make_shared<MjcfOptions>();
  CLI::App* command = app.add_subcommand("mjcf", "make a tendon for a MuJoCo model from a law");
  command->add_option("LAW", options->law, "a joint.toml")->required();
  command->add_option("--motor", options->names.motor, "the model's hinge of the motor")->capture_default_str();
  command->add_option("--joint", options->names.joint, "the hinge that the tendon moves")->capture_default_str();
  command->add_option("--tendon", options->names.tendon, "name of the tendon")->capture_default_str();
  command->add_option("-o,--output", options->output, "file for <include>; without it the text is printed");
  command->callback([options, &exit_status] { exit_status = run_mjcf(*options); });
}

}  // namespace capstan::tools
