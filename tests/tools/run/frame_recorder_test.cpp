// SPDX-License-Identifier: Apache-2.0
// Binary telemetry from the firmware's shell to the host's log, over lines that lose and damage bytes.
#include "capstan/tools/telemetry/frame_recorder.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <sstream>

#include "capstan/tests/firmware/support.hpp"
#include "capstan/tools/log/csv_log.hpp"

namespace capstan::tools {
namespace {

using Bench = test::Bench<2>;
using test::verdict;

/// What the joint did, by cycle.
using Truth = std::map<std::uint32_t, AxisTelemetry>;

/// The bytes that a board sends while it moves and answers, every cycle noted.
auto session(Bench& bench, const std::string& frames, int cycles, Truth& truth) -> std::string {
  bench.say("arm");
  std::string bytes = bench.say(frames);
  const auto type = [&bench](const std::string& line) {
    for (const char c : line + "\n") {
      bench.shell.receive(c);
    }
  };
  for (int i = 0; i < cycles; ++i) {
    if (i % 500 == 100) {
      type(i % 1000 == 100 ? "move joint0 0.5" : "move joint0 -0.5");
    }
    if (i % 500 == 300) {
      type("get joint0.control.kp");
    }
    bench.application.rt_tick();
    truth[bench.application.telemetry().tick] = bench.joint(0);
    bench.shell.poll();
    bytes += bench.sink.take();
  }
  return bytes;
}

/// Rows of a log whose values are not what the joint did.
auto wrong_rows(const std::string& log, const Truth& truth) -> int {
  int wrong = 0;
  std::istringstream lines(log);
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    double time = 0.0, q2 = 0.0, reference = 0.0;
    unsigned state = 0;
    const bool read = std::sscanf(line.c_str(), "%lf,%lf,%lf,%u", &time, &q2, &reference, &state) == 4;
    const auto then = truth.find(static_cast<std::uint32_t>(std::lround(time * 1000.0)));
    wrong += read && then != truth.end() && std::fabs(q2 - then->second.q2_rad.to_double()) < 1e-9 &&
                     std::fabs(reference - then->second.q2_reference_rad.to_double()) < 1e-9
                 ? 0
                 : 1;
  }
  return wrong;
}

TEST(Frames, EveryValueArrivesExactlyAndTheTextBetweenThemStaysWhole) {
  for (const auto& [every, cycles] : {std::pair{1, 3000}, {7, 3000}}) {
    Bench bench;
    Truth truth;
    const std::string bytes =
        session(bench, "frames " + std::to_string(every) + " joint0.q2 joint0.reference machine.state", cycles, truth);
    std::ostringstream log;
    const auto log_sink = csv_sink(log);
    FrameRecorder recorder(*log_sink);
    const std::string text = recorder.feed(bytes);
    EXPECT_NEAR(static_cast<double>(recorder.rows()), cycles / every, 1.0);
    EXPECT_EQ(recorder.lost() + recorder.damaged() + recorder.foreign(), 0U);
    EXPECT_EQ(log.str().substr(0, log.str().find('\n')), "time_s,axis0/q2_est_rad,axis0/q2_ref_rad,state");
    EXPECT_EQ(wrong_rows(log.str(), truth), 0);
    const CsvLog read = CsvLog::parse(log.str(), "frames");
    EXPECT_EQ(read.time().size(), static_cast<Eigen::Index>(recorder.rows())) << "a log by the contract";
    std::string wanted = "ok\r\n";  // of the frames command itself
    for (int i = 0; i < cycles; i += 500) {
      wanted += "ok\r\njoint0.control.kp 0.2 (0 to 20)\r\nok\r\n";
    }
    EXPECT_EQ(text, wanted);
  }
}

TEST(Frames, HoweverTheBytesAreCutIntoPiecesTheResultIsTheSame) {
  Bench bench;
  Truth truth;
  const std::string bytes = session(bench, "frames 3 joint0.q2 joint0.reference machine.state", 2000, truth);
  std::ostringstream whole;
  const auto whole_sink = csv_sink(whole);
  FrameRecorder at_once(*whole_sink);
  const std::string text = at_once.feed(bytes);
  std::mt19937 random(2);
  std::ostringstream log;
  const auto log_sink = csv_sink(log);
  FrameRecorder recorder(*log_sink);
  std::string pieces;
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t count = std::min<std::size_t>(1 + random() % 40, bytes.size() - at);
    pieces += recorder.feed(std::string_view(bytes).substr(at, count));
    at += count;
  }
  EXPECT_EQ(log.str(), whole.str());
  EXPECT_EQ(pieces, text);
}

TEST(Frames, DamagedAndLostBytesCostFramesButNeverGiveAWrongRow) {
  Bench bench;
  Truth truth;
  const std::string bytes = session(bench, "frames 2 joint0.q2 joint0.reference machine.state", 8000, truth);
  for (const double rate : {1e-4, 1e-3, 1e-2}) {
    std::mt19937 random(3);
    std::string damaged;
    int damages = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      const bool hit = i > 200 && static_cast<double>(random()) < rate * 4294967296.0;
      damages += hit ? 1 : 0;
      if (!hit) {
        damaged += bytes[i];
      } else if (random() % 2 == 0) {
        damaged += static_cast<char>(random());
      }
    }
    std::ostringstream log;
    const auto log_sink = csv_sink(log);
    FrameRecorder recorder(*log_sink);
    static_cast<void>(recorder.feed(damaged));
    EXPECT_EQ(wrong_rows(log.str(), truth), 0) << rate;
    EXPECT_GT(static_cast<double>(recorder.rows()), 4000.0 - 4.0 * damages) << damages << " damages";
    EXPECT_LE(recorder.rows() + recorder.lost(), 4000U);
  }
}

TEST(Frames, WhoComesLateIsToldTheSchemaWithinASecond) {
  Bench bench;
  Truth truth;
  const std::string bytes = session(bench, "frames 10 joint0.q2 joint0.reference machine.state", 3000, truth);
  std::ostringstream log;
  const auto log_sink = csv_sink(log);
  FrameRecorder recorder(*log_sink);
  static_cast<void>(recorder.feed(std::string_view(bytes).substr(300)));
  EXPECT_GT(recorder.rows(), 190U);
  EXPECT_EQ(wrong_rows(log.str(), truth), 0);
}

TEST(Frames, OtherSignalsAndATimeThatRunsBackwardAreNoRowsOfThisLog) {
  Bench first;
  Bench second;
  Truth truth;
  const std::string bytes = session(first, "frames 10 joint0.q2 joint0.reference machine.state", 1000, truth);
  const std::string others = session(second, "frames 10 joint1.q2", 500, truth);
  std::ostringstream log;
  const auto log_sink = csv_sink(log);
  FrameRecorder recorder(*log_sink);
  static_cast<void>(recorder.feed(bytes));
  const auto rows = recorder.rows();
  static_cast<void>(recorder.feed(others));
  const auto foreign = recorder.foreign();
  EXPECT_EQ(foreign, 50U);
  static_cast<void>(recorder.feed(bytes));
  EXPECT_EQ(recorder.rows(), rows);
  EXPECT_EQ(recorder.foreign(), foreign);
  EXPECT_EQ(recorder.after_restart(), rows);
}

TEST(Frames, ABoardThatStartedAnewDoesNotGoOnInTheLogOnceItsTimeHasCaughtUp) {
  Bench first;
  Bench second;
  Truth truth;
  const std::string shorter = session(first, "frames 10 joint0.q2 joint0.reference machine.state", 300, truth);
  const std::string longer = session(second, "frames 10 joint0.q2 joint0.reference machine.state", 1000, truth);
  std::ostringstream log;
  const auto log_sink = csv_sink(log);
  FrameRecorder recorder(*log_sink);
  static_cast<void>(recorder.feed(shorter));
  const auto rows = recorder.rows();
  static_cast<void>(recorder.feed(longer));
  EXPECT_EQ(recorder.rows(), rows);
  EXPECT_GT(recorder.after_restart(), rows);
}

TEST(Frames, AreSwitchedOffByTheCommandAndWhenThePeerLeavesAndShareTheRecorderWithLogs) {
  Bench bench;
  EXPECT_EQ(verdict(bench.say("frames 10 joint0.q2")).find("error"), std::string::npos);
  EXPECT_EQ(verdict(bench.say("log joint0 5")).rfind("error frames_on: ", 0), 0U);
  bench.say("arm");
  EXPECT_EQ(verdict(bench.say("experiment joint0 triangle")).rfind("error frames_on: ", 0), 0U);
  EXPECT_EQ(bench.state(), State::kHolding);
  EXPECT_EQ(verdict(bench.say("frames off")), "ok");
  const auto bytes_of_a_second = [&bench] {
    for (int i = 0; i < 1000; ++i) {
      bench.ticks(1);
      bench.shell.poll();
    }
    return bench.sink.take().size();
  };
  EXPECT_EQ(bytes_of_a_second(), 0U);
  bench.say("frames 10 joint0.q2");
  EXPECT_GT(bytes_of_a_second(), 1500U);
  bench.shell.peer_left();
  EXPECT_EQ(bytes_of_a_second(), 0U);
  EXPECT_EQ(verdict(bench.say("log joint0 5")), "ok");
}

TEST(Frames, WrongArgumentsChangeNothing) {
  Bench bench;
  for (const auto& [line, name] : {std::pair{"frames 0 joint0.q2", "range"},
                                   {"frames 1001 joint0.q2", "range"},
                                   {"frames 10", "unknown_signal"},
                                   {"frames joint0.nonsense", "unknown_signal"},
                                   {"frames 10 joint2.q2", "unknown_signal"}}) {
    EXPECT_EQ(verdict(bench.say(line)).rfind(std::string("error ") + name + ": ", 0), 0U) << line;
  }
  EXPECT_TRUE(test::has_line(bench.say("frames"), "frames off"));
}

}  // namespace
}  // namespace capstan::tools
