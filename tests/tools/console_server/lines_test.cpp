// SPDX-License-Identifier: Apache-2.0
// A board by TCP that sends faster than who listens takes it, and what waits meanwhile.
#include "capstan/tools/console_server/lines.hpp"

#include <gtest/gtest.h>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "capstan/tools/console_server/backlog.hpp"

namespace capstan::tools {
namespace {

using namespace std::chrono_literals;
using boost::asio::ip::tcp;

/// The board's end of the line, and what was heard at the other one.
class FastBoard : public testing::Test {
 protected:
  static constexpr std::size_t kBytes = std::size_t{24} << 20U;  // more than the system keeps for a connection

  void SetUp() override {
    line = open_port_line(io, "tcp:" + std::to_string(acceptor.local_endpoint().port()),
                          {[this](std::string_view bytes) { heard += bytes.size(); }, [](const std::string&) {},
                           [this] { return behind(); }});
    acceptor.accept(board);
    boost::asio::async_write(board, boost::asio::buffer(said), [](const boost::system::error_code&, std::size_t) {});
  }

  boost::asio::io_context io;
  tcp::acceptor acceptor{io, tcp::endpoint(boost::asio::ip::address_v4::loopback(), 0)};
  tcp::socket board{io};
  const std::string said = std::string(kBytes, '.');
  std::size_t heard = 0;
  std::function<bool()> behind = [] { return false; };
  std::unique_ptr<BoardLine> line;
};

TEST_F(FastBoard, WaitsForWhoIsBehindAndLosesNothing) {
  behind = [] { return true; };
  io.run_for(300ms);
  EXPECT_LE(heard, 4096U);
  behind = [] { return false; };
  for (int i = 0; i < 100 && heard < kBytes; ++i) {
    io.run_for(100ms);
  }
  EXPECT_EQ(heard, kBytes);
}

TEST_F(FastBoard, IsHeardByTheOthersWhenOneHangs) {
  Backlog hangs;  // who listens takes nothing
  behind = [&] {
    hangs.add(heard, Backlog::Clock::now());
    return hangs.behind(Backlog::Clock::now());
  };
  for (int i = 0; i < 100 && heard < kBytes; ++i) {
    io.run_for(100ms);
  }
  EXPECT_EQ(heard, kBytes);
}

TEST(BacklogTest, IsBehindWhileMuchWaitsAndSomeIsTaken) {
  Backlog backlog;
  Backlog::Clock::time_point now{};
  backlog.add(Backlog::kMuch, now);
  EXPECT_FALSE(backlog.behind(now)) << "little waits";
  backlog.add(1000, now);
  for (int i = 0; i < 10; ++i) {
    now += 900ms;
    EXPECT_TRUE(backlog.behind(now)) << "slow, but it takes";
    backlog.take(10, now);
  }
  backlog.take(900, now);
  EXPECT_FALSE(backlog.behind(now)) << "it has caught up";
}

TEST(BacklogTest, WhoTakesNothingStopsTheOthersForASecondOnly) {
  Backlog backlog;
  Backlog::Clock::time_point now{};
  now += 1h;
  backlog.add(Backlog::kMost / 2, now);
  EXPECT_TRUE(backlog.behind(now)) << "what was long ago does not count";
  now += 1s;
  backlog.add(1, now);
  EXPECT_FALSE(backlog.behind(now));
  backlog.take(1, now);
  EXPECT_TRUE(backlog.behind(now)) << "it is back";
}

TEST(BacklogTest, WhoTakesMoreThanThereWasHasTakenAll) {
  Backlog backlog;
  backlog.add(100, {});
  backlog.take(Backlog::kMost, {});
  EXPECT_TRUE(backlog.has_room_for(Backlog::kMost));
}

TEST(BacklogTest, HasRoomForSoMuch) {
  Backlog backlog;
  backlog.add(Backlog::kMost - 1, {});
  EXPECT_TRUE(backlog.has_room_for(1));
  EXPECT_FALSE(backlog.has_room_for(2));
}

}  // namespace
}  // namespace capstan::tools
