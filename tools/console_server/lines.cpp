// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/console_server/lines.hpp"

#include <fcntl.h>
#include <poll.h>

#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cmath>

#include "capstan/boards/browser/browser_board.hpp"
#include "capstan/hal/sim/scenario.hpp"
#include "capstan/tools/apply/board_port.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;

/// Ctrl-C ends what streams and forgets the lines that wait.
constexpr std::string_view kDisarm =
    "\x03"
    "disarm\n";

/// A port outlives its line while something of it is under way.
class Port : public std::enable_shared_from_this<Port> {
 public:
  Port(asio::io_context& io, int descriptor, std::string name, Hub::Listener listener)
      : line_(io, descriptor), pause_(io), name_(std::move(name)), listener_(std::move(listener)) {}

  void read() {
    line_.async_read_some(asio::buffer(in_), [self = shared_from_this()](const error_code& error, std::size_t count) {
      if (self->closed_) {
        return;
      }
      if (error) {
        self->fail(error);
        return;
      }
      self->listener_.bytes({self->in_.data(), count});
      self->read_on();
    });
  }
  void send(std::string_view bytes) {
    constexpr std::size_t kMostWaiting = std::size_t{64} * 1024;
    if (waiting_.size() + bytes.size() <= kMostWaiting) {  // a board that takes nothing for so long is not there
      waiting_ += bytes;
      write();
    }
  }
  void send_first(std::string_view bytes) {
    waiting_ = bytes;
    write();
  }
  /// What waits is given a moment to go out.
  void close() {
    closed_ = true;
    constexpr int kPatienceMs = 200;
    const std::string rest = going_.substr(gone_) + waiting_;
    for (std::size_t sent = 0; sent < rest.size();) {
      pollfd set{line_.native_handle(), POLLOUT, 0};
      const auto count =
          ::poll(&set, 1, kPatienceMs) > 0 ? ::write(set.fd, rest.data() + sent, rest.size() - sent) : -1;
      if (count <= 0) {
        break;
      }
      sent += static_cast<std::size_t>(count);
    }
    pause_.cancel();
    error_code ignored;
    line_.close(ignored);
  }

 private:
  /// A board that sends faster than its listeners take is read later.
  void read_on() {
    constexpr std::chrono::milliseconds kPause{5};
    if (!listener_.behind()) {
      read();
      return;
    }
    pause_.expires_after(kPause);
    pause_.async_wait([self = shared_from_this()](const error_code&) {
      if (!self->closed_) {
        self->read_on();
      }
    });
  }
  void write() {
    if (!going_.empty() || closed_) {
      return;
    }
    going_ = std::move(waiting_);
    waiting_.clear();
    gone_ = 0;
    write_on();
  }
  void write_on() {
    line_.async_write_some(asio::buffer(going_.data() + gone_, going_.size() - gone_),
                           [self = shared_from_this()](const error_code& error, std::size_t count) {
                             if (self->closed_) {
                               return;
                             }
                             if (error) {
                               self->fail(error);
                               return;
                             }
                             self->gone_ += count;
                             if (self->gone_ < self->going_.size()) {
                               self->write_on();
                               return;
                             }
                             self->going_.clear();
                             self->gone_ = 0;
                             if (!self->waiting_.empty()) {
                               self->write();
                             }
                           });
  }
  void fail(const error_code& error) {
    closed_ = true;
    listener_.lost(name_ + ": the connection to the board is lost (" + error.message() +
                   "); check cable and board, then reload the page");
  }

  asio::posix::stream_descriptor line_;
  asio::steady_timer pause_;
  std::string name_;
  Hub::Listener listener_;
  std::array<char, 4096> in_{};
  std::string waiting_;
  std::string going_;
  std::size_t gone_ = 0;
  bool closed_ = false;
};

class PortLine final : public BoardLine {
 public:
  PortLine(asio::io_context& io, const std::string& name, Hub::Listener listener) : slow_(!name.starts_with("tcp:")) {
    const FileDescriptor descriptor = open_board_port(name);
    port_ = std::make_shared<Port>(io, ::fcntl(descriptor.get(), F_DUPFD_CLOEXEC, 0), name, std::move(listener));
    port_->read();
  }
  ~PortLine() override { port_->close(); }

  void send(std::string_view bytes) override { port_->send(bytes); }
  void disarm() override { port_->send_first(kDisarm); }
  void peer_left() override { port_->send_first(kDisarm); }
  [[nodiscard]] auto every_ms() const -> int override {
    return slow_ ? 10 : 1;  // what fits 115200 baud; a pseudo-terminal may have an emulated line behind it
  }

 private:
  bool slow_;
  std::shared_ptr<Port> port_;
};

/// As the page's own simulator (tools/console/src/simulator_worker.ts): a machine that is too slow lets the joint's
/// time pass slower instead of catching up.
class SimulatedLine final : public BoardLine {
 public:
  SimulatedLine(asio::io_context& io, const std::string& scenario, Hub::Listener listener)
      : scenario_(scenario.empty() ? sim::Scenario{} : sim::parse_scenario(scenario, "scenario")),
        board_(std::make_unique<BrowserBoard>(scenario_)),
        listener_(std::move(listener)),
        timer_(io),
        last_(Clock::now()) {
    wait();
  }

  void send(std::string_view bytes) override {
    constexpr std::size_t kMostWaiting = std::size_t{64} * 1024;
    if (waiting_.size() + bytes.size() <= kMostWaiting) {
      waiting_ += bytes;
    }
  }
  void disarm() override { waiting_ = kDisarm; }
  void peer_left() override {
    waiting_.clear();
    board_->peer_left();
  }
  [[nodiscard]] auto every_ms() const -> int override { return 1; }
  [[nodiscard]] auto starts_anew() const -> bool override { return true; }
  void start_anew(std::string_view effect) override {
    sim::Scenario scenario = scenario_;
    if (!effect.empty()) {
      sim::override_effect(scenario, effect);
    }
    board_ = std::make_unique<BrowserBoard>(std::move(scenario));
    waiting_.clear();
  }

 private:
  void wait() {
    timer_.expires_after(std::chrono::milliseconds(5));
    timer_.async_wait([this, alive = std::weak_ptr<int>(alive_)](const error_code& error) {
      if (!error && !alive.expired()) {
        step();
      }
    });
  }
  void step() {
    constexpr std::chrono::milliseconds kMostBehind{100};
    const auto now = Clock::now();
    last_ = std::max(last_, now - kMostBehind);
    try {
      for (; last_ + std::chrono::milliseconds(1) <= now; last_ += std::chrono::milliseconds(1)) {
        waiting_.erase(0, board_->receive(waiting_));
        board_->tick();
      }
    } catch (const std::runtime_error& diverged) {
      listener_.lost(std::string("the simulator stopped: ") + diverged.what());
      return;
    }
    if (!board_->output().empty()) {
      listener_.bytes(std::exchange(board_->output(), {}));
    }
    wait();
  }

  sim::Scenario scenario_;
  std::unique_ptr<BrowserBoard> board_;
  Hub::Listener listener_;
  asio::steady_timer timer_;
  Clock::time_point last_;
  std::string waiting_;
  std::shared_ptr<int> alive_ = std::make_shared<int>();
};

}  // namespace

auto open_port_line(asio::io_context& io, const std::string& port, Hub::Listener listener)
    -> std::unique_ptr<BoardLine> {
  return std::make_unique<PortLine>(io, port, std::move(listener));
}

auto open_simulated_line(asio::io_context& io, const std::string& scenario, Hub::Listener listener)
    -> std::unique_ptr<BoardLine> {
  try {
    return std::make_unique<SimulatedLine>(io, scenario, std::move(listener));
  } catch (const sim::ScenarioError& error) {
    throw BadInput(error.what());
  }
}

}  // namespace capstan::tools
