// SPDX-License-Identifier: Apache-2.0
#include "capstan/boards/common/shell_feed.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>

#include <string>

#include "capstan/boards/common/file_banks.hpp"
#include "capstan/firmware/loop/application.hpp"

namespace capstan {
namespace {

/// A joint that stands still.
struct StillIo {
  static constexpr std::size_t kAxes = 1;
  auto read(Sensed<kAxes>& sensed) noexcept -> Status {
    sensed.axis[0] = {.encoder_counts = 0, .current_a = {}, .encoder = Quality::kOk, .current = Quality::kOk};
    return Status::kOk;
  }
  auto write(const Drive<kAxes>& /*drive*/) noexcept -> Status { return Status::kOk; }
  void release() noexcept {}
};

struct StillBoard final : Board {
  [[nodiscard]] auto name() const -> const char* override { return "test"; }
  void print_timing(Print& /*out*/) const override {}
  void reboot() override {}
  [[nodiscard]] auto simulated() const -> bool override { return true; }
};

/// A whole firmware on a pty; the cycle runs when the test says so.
class ShellFeedTest : public testing::Test {
 protected:
  ShellFeedTest() : peer_(::open(console_.name().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK)) {
    EXPECT_TRUE(static_cast<bool>(peer_));
    for (int i = 0; i < 3; ++i) {
      application_.rt_tick();
    }
  }

  void send(const std::string& text) {
    ASSERT_EQ(::write(peer_.get(), text.data(), text.size()), static_cast<std::ptrdiff_t>(text.size()));
  }
  /// Background and cycle by turns, long enough for everything that is on its way.
  auto run() -> bool {
    bool lost = false;
    for (int i = 0; i < 200; ++i) {
      lost = feed_.poll() || lost;
      application_.rt_tick();
      feed_.wait(std::chrono::milliseconds(1));
    }
    return lost;
  }
  auto answers() -> std::string {
    std::array<char, 4096> bytes{};
    std::string all;
    for (;;) {
      const auto count = ::read(peer_.get(), bytes.data(), bytes.size());
      if (count <= 0) {
        return all;
      }
      all.append(bytes.data(), static_cast<std::size_t>(count));
    }
  }
  static auto count_of(const std::string& what, const std::string& text) -> int {
    int count = 0;
    for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + what.size())) {
      ++count;
    }
    return count;
  }
  auto state() const -> State { return application_.telemetry().state; }

  StillIo io_;
  FileBanks banks_ = FileBanks::temporary();
  Console console_ = Console::pty();
  Application<StillIo> application_{io_, banks_};
  StillBoard board_;
  Shell shell_{application_, console_, board_, false};
  ShellFeed feed_{console_, shell_};
  FileDescriptor peer_;
};

TEST_F(ShellFeedTest, LinesSentAllAtOnceAreAllAnsweredAndNoneIsRefusedAsBusy) {
  std::string all;
  for (int i = 0; i < 50; ++i) {
    all += "arm\ndisarm\n";  // each waits for the cycle
  }
  send(all);
  EXPECT_FALSE(run());
  const std::string got = answers();
  EXPECT_EQ(count_of("ok\r\n", got), 100) << got;
  EXPECT_EQ(count_of("error", got), 0) << got;
}

TEST_F(ShellFeedTest, CtrlCOvertakesAndEndsALog) {
  send("log joint0 1000000\n");
  run();
  ASSERT_TRUE(shell_.busy());
  send("status\n\x03");
  run();
  EXPECT_FALSE(shell_.busy());
}

TEST_F(ShellFeedTest, ADisarmBehindMoreThanFindsRoomTakesTheTorqueAndEndsTheLog) {
  send("arm\nlog joint0 1000000\n");
  run();
  ASSERT_EQ(state(), State::kHolding);
  std::string many;
  for (int i = 0; i < 300; ++i) {
    many += "status\n";
  }
  send(many + "disarm\n");
  for (int i = 0; i < 10; ++i) {
    static_cast<void>(feed_.poll());
    application_.rt_tick();
  }
  EXPECT_EQ(state(), State::kDisarmed);
  EXPECT_FALSE(shell_.busy());
}

TEST_F(ShellFeedTest, BehindALogWithoutTorqueNothingIsLost) {
  send("log joint0 20\n");
  std::string many;
  for (int i = 0; i < 100; ++i) {
    many += "timing\n";
  }
  send(many);
  EXPECT_FALSE(run());
  const std::string got = answers();
  EXPECT_EQ(count_of("ok\r\n", got), 101) << got;
  EXPECT_EQ(count_of("error", got), 0) << got;
}

TEST_F(ShellFeedTest, APeerThatLeavesIsReportedOnceAndItsHalfTypedLineIsForgotten) {
  send("arm\n");
  run();
  ASSERT_EQ(state(), State::kHolding);
  send("sta");
  EXPECT_FALSE(run());
  peer_.close();
  EXPECT_TRUE(run());
  EXPECT_FALSE(run());
  EXPECT_FALSE(feed_.done()) << "another peer may come";
  peer_ = FileDescriptor(::open(console_.name().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK));
  send("version\n");
  run();
  const std::string got = answers();
  EXPECT_EQ(count_of("ok\r\n", got), 1) << got;
  EXPECT_EQ(count_of("error", got), 0) << "stale characters reached the new line: " << got;
}

TEST_F(ShellFeedTest, CommandsOfAPeerThatHasLeftAreNotCarriedOut) {
  send("log joint0 1000000\n");
  run();
  ASSERT_TRUE(shell_.busy());
  send("arm\n");
  peer_.close();
  EXPECT_TRUE(run());
  EXPECT_EQ(state(), State::kDisarmed);
}

}  // namespace
}  // namespace capstan
