// SPDX-License-Identifier: Apache-2.0
// Two consoles at one machine, whose lines may fall into the same cycle.
#include <gtest/gtest.h>

#include "capstan/tests/firmware/support.hpp"

namespace capstan {
namespace {

struct TwoConsoles : test::Bench<1> {
  void cycles(int count) {
    for (int i = 0; i < count; ++i) {
      application.rt_tick();
      shell.poll();
      other.poll();
    }
  }
  static void type(Shell& shell, const std::string& line) {
    for (const char c : line + "\n") {
      shell.receive(c);
    }
  }
  /// A capture of one channel that fills the memory.
  void capture() {
    type(shell, "scope channels joint0.q2");
    type(shell, "scope start 8000 0");
    cycles(8010);
    sink.take();
  }
  void choose_eight_channels() {
    type(other,
         "scope channels joint0.q1 joint0.q2 joint0.torque joint0.current joint0.drive joint0.reference joint0.force "
         "joint0.misfit");
    cycles(2);
    ASSERT_EQ(test::verdict(other_sink.take()), "ok");
  }

  test::StringSink other_sink;
  Shell other{application, other_sink, board, false};
};

TEST(TwoConsoles, ADisarmIsCarriedOutThoughTheOthersRequestOfThatCycleCameFirst) {
  for (const char* first : {"move joint0 0.5 rad", "hold joint0", "arm"}) {
    TwoConsoles bench;
    bench.say("arm");
    ASSERT_EQ(bench.state(), State::kHolding);
    TwoConsoles::type(bench.other, first);
    TwoConsoles::type(bench.shell, "disarm");
    bench.cycles(1);
    EXPECT_EQ(bench.state(), State::kDisarmed) << first;
    bench.cycles(300);
    EXPECT_EQ(test::verdict(bench.sink.take()), "ok") << first;
    EXPECT_EQ(bench.state(), State::kDisarmed) << first;
    EXPECT_FALSE(bench.io.has_torque()) << first;
  }
}

TEST(TwoConsoles, ADisarmThatOvertakesALogDoesSoBehindTheOthersRequestToo) {
  TwoConsoles bench;
  bench.say("arm");
  TwoConsoles::type(bench.shell, "log joint0 100000");
  bench.cycles(5);
  TwoConsoles::type(bench.other, "move joint0 0.5 rad");
  bench.shell.disarm_now();
  bench.cycles(1);
  EXPECT_EQ(bench.state(), State::kDisarmed);
}

TEST(TwoConsoles, ACaptureThatIsBeingDumpedCanNotBeWrittenOver) {
  TwoConsoles bench;
  bench.capture();
  bench.choose_eight_channels();
  TwoConsoles::type(bench.shell, "scope dump");
  bench.cycles(3);
  ASSERT_TRUE(bench.shell.busy());
  for (const char* line : {"scope start 1000", "scope stop"}) {
    TwoConsoles::type(bench.other, line);
    bench.cycles(2);
    EXPECT_EQ(test::error_of(bench.other_sink.take()), "busy") << line;
  }
  bench.cycles(8000);
  EXPECT_EQ(test::lines_of(bench.sink.take()).size(), 8003U);
  TwoConsoles::type(bench.other, "scope start 1000");
  bench.cycles(2);
  EXPECT_EQ(test::verdict(bench.other_sink.take()), "ok") << "the dump is over";
}

TEST(TwoConsoles, NoDumpBeginsOfACaptureThatIsAboutToBeWrittenOver) {
  TwoConsoles bench;
  bench.capture();
  bench.choose_eight_channels();
  TwoConsoles::type(bench.other, "scope start 1000");
  TwoConsoles::type(bench.shell, "scope dump");
  EXPECT_EQ(test::error_of(bench.sink.take()), "nothing_captured");
}

TEST(TwoConsoles, ADumpWhosePeerLeftLetsTheNextCaptureBegin) {
  TwoConsoles bench;
  bench.capture();
  TwoConsoles::type(bench.shell, "scope dump");
  bench.cycles(3);
  bench.shell.receive(0x03);
  bench.cycles(2);
  bench.choose_eight_channels();
  TwoConsoles::type(bench.other, "scope start 1000");
  bench.cycles(2);
  EXPECT_EQ(test::verdict(bench.other_sink.take()), "ok");
}

}  // namespace
}  // namespace capstan
