// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "capstan/hal/sim/sim_io.hpp"
#include "capstan/tests/firmware/support.hpp"

namespace capstan::tools::test {

/// For the board's prompt.
using Lines = std::vector<std::string>;

/// The firmware with its shell on the simulated instrument, with a law of what its tip feels.
struct ForceRig {
  ForceRig(const sim::Environment& environment, const Lines& law) : ForceRig(with(environment), law) {}
  ForceRig(const sim::PlantParameters& instrument, const Lines& law) : plant(instrument, 7), io(plant) {
    application.rt_tick();
    say("begin");
    for (const std::string& line : law) {
      say(line);
    }
    say("commit");
    say("arm");
    EXPECT_EQ(application.telemetry().state, State::kHolding);
  }
  static auto with(const sim::Environment& environment) -> sim::PlantParameters {
    sim::PlantParameters parameters;
    parameters.environment = environment;
    return parameters;
  }
  auto say(const std::string& line) -> std::string {
    for (const char c : line + "\n") {
      shell.receive(c);
    }
    for (int i = 0; i < 100 && shell.busy(); ++i) {
      application.rt_tick();
      shell.poll();
    }
    const std::string answer = sink.take();
    EXPECT_EQ(answer.find("error "), std::string::npos) << line << ": " << answer;
    return answer;
  }
  [[nodiscard]] auto joint() const -> AxisTelemetry { return application.axis_telemetry(0); }

  sim::Plant plant;
  SimIo io;
  capstan::test::FlashBanks banks;
  Application<SimIo> application{io, banks};
  capstan::test::StringSink sink;
  capstan::test::FakeBoard board;
  Shell shell{application, sink, board, false};
};

}  // namespace capstan::tools::test
