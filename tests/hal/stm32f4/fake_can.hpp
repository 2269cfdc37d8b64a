// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <vector>

#include "capstan/hal/stm32f4/can.hpp"
#include "capstan/tests/hal/stm32f4/fake_register.hpp"

namespace capstan::stm32f4 {

/// A bxCAN controller as RM0090 section 32 describes it: initialisation by request and acknowledge, three mailboxes to
/// send, two FIFOs of three frames behind identifier lists, flags cleared by writing 1, bus-off that ends only through
/// initialisation and 128 x 11 recessive bits, which are here one call of bus_is_idle().
class FakeCan {
 public:
  FakeCan() {
    registers.tsr.value = can::kTsrEmpty;
    registers.msr.value = 2;  // asleep after reset
    registers.mcr.on_write = [this](std::uint32_t, std::uint32_t written) {
      if ((written & can::kMcrInit) != 0 && enters_initialisation) {
        registers.msr.value = (registers.msr.value | can::kMsrInit) & ~2U;
      } else if ((written & can::kMcrInit) == 0 && !off && joins_at_once) {
        registers.msr.value &= ~can::kMsrInit;
      }
      return written;
    };
    registers.tsr.on_write = [this](std::uint32_t old, std::uint32_t written) { return write_tsr(old, written); };
    for (std::size_t fifo = 0; fifo < 2; ++fifo) {
      registers.rfr[fifo].on_write = [this, fifo](std::uint32_t old, std::uint32_t written) {
        return write_rfr(fifo, old, written);
      };
    }
    for (std::size_t box = 0; box < 3; ++box) {
      registers.send[box].identifier.on_write = [this, box](std::uint32_t, std::uint32_t written) {
        if ((written & can::kTransmitRequest) != 0) {
          registers.tsr.value &= ~((1U << (can::kTsrEmptyShift + box)) | (0xFU << (8 * box)));
          order.push_back(box);
        }
        return written;
      };
    }
  }

  /// A frame on the bus. Only identifiers of an active list reach a FIFO; a fourth unread frame overruns it.
  void arrive(const CanFrame& frame, std::uint32_t flags = 0) {
    for (std::size_t bank = 0; bank < 2; ++bank) {
      if ((registers.fa1r.value >> bank & 1U) == 0) {
        continue;
      }
      for (const auto& half : registers.filter[bank]) {
        const std::uint32_t wanted = (static_cast<std::uint32_t>(frame.id) << 5U) | (flags != 0 ? 0x10U : 0U);
        if ((half.value & 0xFFFFU) == wanted || half.value >> 16U == wanted) {
          deliver(registers.ffa1r.value >> bank & 1U, frame, flags);
          return;
        }
      }
    }
  }
  void deliver(std::size_t fifo, const CanFrame& frame, std::uint32_t flags = 0) {
    auto& queue = fifos.at(fifo);
    if (queue.size() == 3) {
      registers.rfr[fifo].value |= can::kRfrOverrun;  // not locked: the newest one is overwritten
      queue.back() = {frame, flags};
    } else {
      queue.push_back({frame, flags});
    }
    show(fifo);
  }

  /// The oldest waiting mailbox leaves; false if there is none.
  auto send_one() -> bool {
    if (order.empty() || off) {
      return false;
    }
    const std::size_t box = order.front();
    order.pop_front();
    const auto& mailbox = registers.send[box];
    CanFrame frame{.id = static_cast<std::uint16_t>(mailbox.identifier.value >> can::kIdentifierShift),
                   .size = static_cast<std::uint8_t>(mailbox.length.value & 0xFU)};
    for (std::uint32_t k = 0; k < 4; ++k) {
      frame.data[k] = static_cast<std::uint8_t>(mailbox.low.value >> (8 * k));
      frame.data[4 + k] = static_cast<std::uint8_t>(mailbox.high.value >> (8 * k));
    }
    sent.push_back(frame);
    registers.tsr.value |= (3U << (8 * box)) | (1U << (can::kTsrEmptyShift + box));
    return true;
  }

  void go_bus_off() {
    off = true;
    registers.esr.value = (255U << 16U) | can::kEsrBusOff | can::kEsrPassive | 1U;
  }
  void bus_is_idle() {
    if ((registers.mcr.value & can::kMcrInit) == 0) {
      off = off && (registers.msr.value & can::kMsrInit) == 0;  // recovers only on its way out of initialisation
      if (!off) {
        registers.msr.value &= ~can::kMsrInit;
        registers.esr.value = 0;
      }
    }
  }

  struct Received {
    CanFrame frame;
    std::uint32_t flags;
  };
  CanRegisters<FakeRegister> registers;
  std::array<std::deque<Received>, 2> fifos;
  std::deque<std::size_t> order;
  std::vector<CanFrame> sent;
  bool enters_initialisation = true;
  bool joins_at_once = true;
  bool off = false;

 private:
  auto write_tsr(std::uint32_t old, std::uint32_t written) -> std::uint32_t {
    for (std::uint32_t box = 0; box < 3; ++box) {
      const std::uint32_t flags = 0xFU << (8 * box);
      if ((written >> (8 * box) & 1U) != 0) {
        old &= ~flags;  // the result goes with the flag that it is there
      }
      if ((written >> (8 * box + 7) & 1U) != 0 && (old & (1U << (can::kTsrEmptyShift + box))) == 0) {
        std::erase(order, box);
        old = (old & ~flags) | (1U << (8 * box)) | (1U << (can::kTsrEmptyShift + box));  // done, not sent
      }
    }
    return old;
  }

  auto write_rfr(std::size_t fifo, std::uint32_t old, std::uint32_t written) -> std::uint32_t {
    old &= ~(written & (can::kRfrOverrun | can::kRfrFull));
    if ((written & can::kRfrRelease) != 0 && !fifos.at(fifo).empty()) {
      fifos.at(fifo).pop_front();
    }
    registers.rfr[fifo].value = old;
    show(fifo);
    return registers.rfr[fifo].value;
  }

  void show(std::size_t fifo) {
    auto& queue = fifos.at(fifo);
    auto& state = registers.rfr[fifo].value;
    state = (state & ~can::kRfrPending) | static_cast<std::uint32_t>(queue.size());
    state |= queue.size() == 3 ? can::kRfrFull : 0U;
    if (queue.empty()) {
      return;
    }
    auto& mailbox = registers.receive[fifo];
    const auto& [frame, flags] = queue.front();
    mailbox.identifier.value = (std::uint32_t{frame.id} << can::kIdentifierShift) | flags;
    mailbox.length.value = frame.size | 0x1200'0500U;  // filter number and time stamp are beside it
    mailbox.low.value = mailbox.high.value = 0;
    for (std::uint32_t k = 0; k < 4; ++k) {
      mailbox.low.value |= std::uint32_t{frame.data[k]} << (8 * k);
      mailbox.high.value |= std::uint32_t{frame.data[4 + k]} << (8 * k);
    }
  }
};

}  // namespace capstan::stm32f4
