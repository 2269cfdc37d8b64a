// SPDX-License-Identifier: Apache-2.0
#include "capstan/boards/common/console.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <stdexcept>
#include <thread>

namespace capstan {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

/// Other processes decide when bytes arrive: try until it holds, and give up only after a time no sound machine needs.
auto eventually(const std::function<bool()>& holds) -> bool {
  const auto end = steady_clock::now() + std::chrono::seconds(10);
  while (!holds()) {
    if (steady_clock::now() > end) {
      return false;
    }
    std::this_thread::sleep_for(milliseconds(1));
  }
  return true;
}

auto receive_some(Console& console) -> std::string {
  std::array<char, 256> bytes{};
  return std::string(bytes.data(), console.receive(bytes));
}

auto receives(Console& console, const std::string& wanted) -> bool {
  std::string got;
  return eventually([&] {
    got += receive_some(console);
    return got == wanted;
  });
}

/// The other end of a console.
class Peer {
 public:
  static auto on_device(const std::string& device) -> Peer { return Peer(::open(device.c_str(), O_RDWR | O_NOCTTY)); }
  static auto on_port(const std::string& name) -> Peer {
    const int fd = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(std::stoi(name.substr(name.find(':') + 1))));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    return Peer(fd);
  }

  void send(const std::string& text) const {
    EXPECT_EQ(::write(fd_.get(), text.data(), text.size()), static_cast<std::ptrdiff_t>(text.size()));
  }
  /// Reads until so many bytes are there or the line has ended.
  auto read(std::size_t size) const -> std::string {
    std::string all;
    std::array<char, 4096> bytes{};
    while (all.size() < size) {
      pollfd entry{.fd = fd_.get(), .events = POLLIN, .revents = 0};
      if (::poll(&entry, 1, 10'000) <= 0) {
        break;
      }
      const auto count = ::read(fd_.get(), bytes.data(), std::min(bytes.size(), size - all.size()));
      if (count <= 0) {
        break;
      }
      all.append(bytes.data(), static_cast<std::size_t>(count));
    }
    return all;
  }
  void leave() { fd_.close(); }

 private:
  explicit Peer(int fd) : fd_(fd) { EXPECT_GE(fd, 0); }
  FileDescriptor fd_;
};

void expect_bytes_both_ways(Console& console, const Peer& peer) {
  peer.send("status\r\n\x03");
  EXPECT_TRUE(receives(console, "status\r\n\x03"));
  console.write("state disarmed\r\n");
  console.write("ok\r\n");
  EXPECT_EQ(peer.read(20), "state disarmed\r\nok\r\n");
  EXPECT_EQ(console.dropped(), 0U);
}

TEST(PtyConsole, PassesEveryByteUnchangedBothWays) {
  Console console = Console::pty();
  EXPECT_TRUE(console.is_terminal());
  expect_bytes_both_ways(console, Peer::on_device(console.name()));
}

TEST(PtyConsole, NeitherEchoesNorEditsByItself) {
  Console console = Console::pty();
  const Peer peer = Peer::on_device(console.name());
  peer.send("ab\x7f\x15\n");
  EXPECT_TRUE(receives(console, "ab\x7f\x15\n"));
  console.write("!\n");
  EXPECT_EQ(peer.read(2), "!\n") << "anything before it would be an echo";
}

TEST(PtyConsole, ReportsAHangUpOnceForEachPeerThatLeaves) {
  Console console = Console::pty();
  EXPECT_EQ(receive_some(console), "");
  EXPECT_FALSE(console.hung_up()) << "nobody has come yet";
  for (int visit = 0; visit < 2; ++visit) {
    Peer peer = Peer::on_device(console.name());
    peer.send("x");
    EXPECT_TRUE(receives(console, "x"));
    EXPECT_FALSE(console.hung_up());
    peer.leave();
    EXPECT_TRUE(eventually([&] { return receive_some(console).empty() && console.hung_up(); }));
    EXPECT_EQ(receive_some(console), "");
    EXPECT_FALSE(console.hung_up());
  }
  EXPECT_FALSE(console.finished()) << "another one may come";
}

TEST(PtyConsole, WhatNobodyReadIsNotShownToTheNextPeer) {
  Console console = Console::pty();
  receive_some(console);
  console.write("to nobody\r\n");
  const Peer peer = Peer::on_device(console.name());
  peer.send("x");
  EXPECT_TRUE(receives(console, "x"));
  console.write("to you\r\n");
  EXPECT_EQ(peer.read(8), "to you\r\n");
  EXPECT_EQ(console.dropped(), 0U) << "it was not lost, it had no reader";
}

TEST(PtyConsole, AnswersAPeerDidNotWaitForAreNotShownToTheNext) {
  Console console = Console::pty();
  Peer first = Peer::on_device(console.name());
  first.send("x");
  EXPECT_TRUE(receives(console, "x"));
  console.write("to the first\r\n");
  first.leave();
  EXPECT_TRUE(eventually([&] { return receive_some(console).empty() && console.hung_up(); }));
  const Peer second = Peer::on_device(console.name());
  second.send("y");
  EXPECT_TRUE(receives(console, "y"));
  console.write("to the second\r\n");
  EXPECT_EQ(second.read(15), "to the second\r\n");
}

TEST(TcpConsole, PassesEveryByteUnchangedBothWays) {
  Console console = Console::tcp(0);
  EXPECT_FALSE(console.is_terminal());
  expect_bytes_both_ways(console, Peer::on_port(console.name()));
}

TEST(TcpConsole, ListensOnLoopbackOnly) {
  EXPECT_EQ(Console::tcp(0).name().rfind("127.0.0.1:", 0), 0U);
}

TEST(TcpConsole, TakesANextClientAfterTheFirstHasLeftAndReportsThatHangUpOnce) {
  Console console = Console::tcp(0);
  Peer first = Peer::on_port(console.name());
  first.send("one");
  EXPECT_TRUE(receives(console, "one"));
  first.leave();
  EXPECT_TRUE(eventually([&] { return receive_some(console).empty() && console.hung_up(); }));
  EXPECT_FALSE(console.hung_up());
  expect_bytes_both_ways(console, Peer::on_port(console.name()));
  EXPECT_FALSE(console.finished());
}

TEST(TcpConsole, TurnsASecondClientAwayWithASentenceAndKeepsTheFirst) {
  Console console = Console::tcp(0);
  const Peer first = Peer::on_port(console.name());
  first.send("1");
  EXPECT_TRUE(receives(console, "1"));
  const Peer second = Peer::on_port(console.name());
  std::string answer;
  std::atomic<bool> closed = false;
  std::thread reader([&] {
    answer = second.read(1000);  // as far as the end
    closed = true;
  });
  EXPECT_TRUE(eventually([&] {
    EXPECT_EQ(receive_some(console), "");
    return closed.load();
  }));
  reader.join();
  EXPECT_EQ(answer.rfind("error taken: ", 0), 0U);
  EXPECT_FALSE(console.hung_up());
  expect_bytes_both_ways(console, first);
}

TEST(TcpConsole, DropsAndCountsWhatAPeerDoesNotReadWithoutBlockingForLong) {
  Console console = Console::tcp(0);
  const Peer peer = Peer::on_port(console.name());
  peer.send("x");
  EXPECT_TRUE(receives(console, "x"));
  const std::string line = std::string(998, 'a') + "\r\n";
  constexpr std::size_t kLines = 64'000;  // 64 MB: more than any socket holds
  const auto start = steady_clock::now();
  for (std::size_t i = 0; i < kLines; ++i) {
    console.write(line);
  }
  const auto took = steady_clock::now() - start;
  ASSERT_GT(console.dropped(), 0U);
  EXPECT_LT(took, std::chrono::seconds(20)) << "waiting 20 ms for each would take 20 minutes";
  const std::size_t kept = kLines * line.size() - console.dropped();
  std::string got;
  std::thread reader([&] { got = peer.read(kept); });
  console.drain(std::chrono::seconds(20));
  reader.join();
  EXPECT_EQ(got.size(), kept) << "every character was either delivered or counted";
}

TEST(TcpConsole, SurvivesAPeerThatLeavesInTheMiddleOfAnAnswer) {
  Console console = Console::tcp(0);
  Peer peer = Peer::on_port(console.name());
  peer.send("x");
  EXPECT_TRUE(receives(console, "x"));
  peer.leave();
  EXPECT_TRUE(eventually([&] {
    console.write("q2 0.5 rad\r\n");  // would raise SIGPIPE
    return console.hung_up();
  }));
}

TEST(TcpConsole, APortThatIsTakenIsRefusedWithACure) {
  const Console holder = Console::tcp(0);
  const std::string port = holder.name().substr(holder.name().find(':') + 1);
  try {
    Console::open("tcp:" + port);
    FAIL() << "two programs hold one port";
  } catch (const std::runtime_error& refusal) {
    EXPECT_NE(std::string(refusal.what()).find(port), std::string::npos);
    EXPECT_NE(std::string(refusal.what()).find("; "), std::string::npos);
  }
}

TEST(Console, UnknownKindsAndBadPortsAreRefused) {
  for (const char* what :
       {"", "telnet", "tcp:", "tcp:70000", "tcp:12x", "tcp:-1", "serial:", "serial:/dev/null", "serial:/nowhere/tty"}) {
    EXPECT_THROW(Console::open(what), std::runtime_error) << what;
  }
}

TEST(SerialConsole, PassesBytesAndReportsTheUnpluggedDeviceOnce) {
  Console line = Console::pty();  // a pty's device stands in for the serial port, its master for the cable
  receive_some(line);
  std::optional<Console> cable(std::move(line));
  Console console = Console::serial(cable->name());
  console.write("hello\r\n");
  EXPECT_TRUE(receives(*cable, "hello\r\n"));
  cable->write("status\n");
  EXPECT_TRUE(receives(console, "status\n"));
  cable.reset();
  EXPECT_TRUE(eventually([&] { return receive_some(console).empty() && console.hung_up(); }));
  EXPECT_FALSE(console.hung_up());
  EXPECT_TRUE(console.finished());
}

}  // namespace
}  // namespace capstan
