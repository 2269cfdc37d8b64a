// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "capstan/boards/common/file_banks.hpp"
#include "capstan/boards/sim/sim_board.hpp"
#include "capstan/tests/firmware/support.hpp"

namespace capstan::tools::test {

/// A board on a simulated joint, with an operator.
struct BoardRig {
  explicit BoardRig(const sim::Scenario& scenario) : board(scenario, banks, sink, false) { board.tick(); }
  auto say(const std::string& line) -> std::string {
    for (const char c : line + "\n") {
      board.shell().receive(c);
    }
    for (long i = 0; i < 200'000 && board.shell().busy(); ++i) {
      board.tick();
      board.shell().poll();
    }
    return sink.take();
  }
  void say(const std::vector<std::string>& lines) {
    for (const std::string& line : lines) {
      const std::string answer = say(line);
      EXPECT_EQ(answer.find("error "), std::string::npos) << line << ": " << answer;
    }
  }
  [[nodiscard]] auto joint() const -> AxisTelemetry { return board.machine().axis_telemetry(0); }

  FileBanks banks = FileBanks::temporary();
  capstan::test::StringSink sink;
  SimBoard board;
};

}  // namespace capstan::tools::test
