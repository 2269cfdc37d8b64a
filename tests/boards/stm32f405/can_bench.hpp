// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "capstan/boards/stm32f405/can_node.hpp"
#include "capstan/boards/stm32f405/can_setpoints.hpp"
#include "capstan/tests/boards/stm32f405/can_frames.hpp"
#include "capstan/tests/firmware/support.hpp"
#include "capstan/tests/hal/stm32f4/fake_can.hpp"

namespace capstan::stm32f405 {

using stm32f4::CanFrame;
using stm32f4::FakeRegister;

struct Milliseconds {
  /// While the firmware waits, time goes on and the bus takes a frame.
  [[nodiscard]] auto count() const -> std::uint32_t {
    if (++looks % 10 == 0) {
      ++now;
      if (bus != nullptr) {
        bus->send_one();
      }
    }
    return now;
  }
  mutable std::uint32_t now = 0;
  mutable std::uint32_t looks = 0;
  stm32f4::FakeCan* bus = nullptr;
};

class NamedBoard final : public Board {
 public:
  [[nodiscard]] auto name() const -> const char* override { return "on_can"; }
  void print_timing(Print& /*out*/) const override {}
  void reboot() override {}
  [[nodiscard]] auto simulated() const -> bool override { return true; }
};

class TextOf final : public TextSink {
 public:
  std::string text;

 private:
  void do_write(std::string_view more) override { text += more; }
};

/// The firmware behind a CAN controller that behaves as RM0090 says, four joints that turn freely, and the bus.
class CanBench {
 public:
  using Port = stm32f4::Can<FakeRegister>;
  [[nodiscard]] auto start() -> bool {
    return port.start(stm32f4::can_bit_timing(42'000'000, kCanBitRate), {setpoints.identifiers(), node.identifiers()});
  }

  /// One millisecond: interrupts, the cycle, the background; the bus takes all that is to be sent.
  void step() {
    ++clock.now;
    clock.looks = 0;
    clock.bus = bus_works ? &chip : nullptr;
    port.rt_isr(0);
    port.rt_isr(1);
    setpoints.rt_begin_cycle();
    CanFrame frame;
    while (port.rt_receive(0, frame)) {
      setpoints.rt_take(frame);
    }
    application.rt_tick(setpoints.rt_streamed());
    for (int round = 0; round < 4; ++round) {  // the background goes round more often than the cycle
      node.poll();
      while (bus_works && chip.send_one()) {
      }
    }
    if (node.take_bus_loss()) {
      application.link_lost();
    }
  }
  void steps(int count) {
    for (int i = 0; i < count; ++i) {
      step();
    }
  }
  /// Frames that were sent with this identifier.
  [[nodiscard]] auto sent(std::uint16_t id) const -> std::vector<CanFrame> {
    std::vector<CanFrame> found;
    std::copy_if(chip.sent.begin(), chip.sent.end(), std::back_inserter(found),
                 [id](const CanFrame& frame) { return frame.id == id; });
    return found;
  }
  /// A line as a host sends it, and the answer to it.
  auto ask(const std::string& line) -> std::string {
    const std::size_t before = sent(0x585).size();
    std::string rest = line + "\r";
    while (!rest.empty()) {
      CanFrame frame{.id = 0x605, .size = 1};
      frame.data[0] = ++sequence;
      for (const char c : rest.substr(0, 7)) {
        frame.data.at(frame.size++) = static_cast<std::uint8_t>(c);
      }
      rest.erase(0, 7);
      chip.arrive(frame);
      step();
    }
    steps(60);
    std::string answer;
    for (const CanFrame& frame : sent_from(before)) {
      answer.append(frame.data.begin() + 1, frame.data.begin() + frame.size);
    }
    return answer;
  }
  auto sent_from(std::size_t first) const -> std::vector<CanFrame> {
    const auto all = sent(0x585);
    return {all.begin() + static_cast<long>(first), all.end()};
  }
  [[nodiscard]] auto report() const -> std::string {
    TextOf sink;
    Print out(sink);
    node.print(out);
    return sink.text;
  }
  [[nodiscard]] auto state() const -> State { return application.telemetry().state; }

  stm32f4::FakeCan chip;
  Port port{chip.registers};
  Milliseconds clock;
  test::FakeIo<4> io;
  test::FlashBanks banks;
  Application<test::FakeIo<4>> application{io, banks};
  NamedBoard board;
  CanTroubleCounters troubles;
  CanSetpoints<4> setpoints{kTestNode, troubles};
  CanNode<Port, Milliseconds> node{port, clock, application, board, kTestNode, troubles};
  bool bus_works = true;
  std::uint8_t sequence = 40;
};

}  // namespace capstan::stm32f405
