// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "capstan/hal/stm32f4/can_registers.hpp"
#include "capstan/hal/stm32f4/ring_buffer.hpp"

namespace capstan::stm32f4 {

/// One classical data frame with an 11-bit identifier.
struct CanFrame {
  std::uint16_t id = 0;
  std::uint8_t size = 0;  ///< as received: 9 to 15 is possible on the wire and means that nothing fits
  std::array<std::uint8_t, 8> data{};
};

/// Bit timing: 14 quanta a bit, sampled behind the 11th (79 %), resynchronised by at most 1.
/// Zero: a bit of that rate has not 14 quanta at this clock.
[[nodiscard]] constexpr auto can_bit_timing(std::uint32_t bus_hz, std::uint32_t bit_rate) -> std::uint32_t {
  constexpr std::uint32_t kBefore = 10;
  constexpr std::uint32_t kBehind = 3;
  constexpr std::uint32_t kQuanta = 1 + kBefore + kBehind;
  const std::uint32_t divider = bus_hz / (bit_rate * kQuanta);
  if (divider == 0 || divider > 1024 || divider * kQuanta * bit_rate != bus_hz) {
    return 0;
  }
  return (divider - 1) | ((kBefore - 1) << 16) | ((kBehind - 1) << 20);
}
static_assert(can_bit_timing(42'000'000, 1'000'000) == 0x0029'0002);
static_assert(can_bit_timing(16'000'000, 1'000'000) == 0);

/// What went wrong on the bus since start. Counters wrap.
struct CanErrors {
  std::uint32_t fifo_overruns = 0;  ///< the interrupt came too late: at least one frame was lost in the controller
  std::uint32_t ring_overruns = 0;  ///< the reader came too late: a frame was lost at the full ring
  std::uint32_t foreign = 0;        ///< a remote or extended frame came through the filters
  std::uint32_t send_full = 0;      ///< a frame was not taken: all three mailboxes were waiting
  std::uint32_t send_lost = 0;      ///< a frame was given up after kStaleTicks: nobody acknowledged it
  std::uint32_t passive = 0;        ///< the controller became error passive
  std::uint32_t bus_off = 0;        ///< the controller switched itself off the bus
  std::uint32_t alone = 0;          ///< frames were given up kTimesToBeAlone times on end: nobody else is there
};

/// CAN controller with two receive FIFOs of exact identifiers: frames of the first are for the cycle, those of the
/// second for the background. rt_isr() runs in the FIFO's interrupt, rt_receive(0) in the cycle, everything else in the
/// background.
///
/// After bus-off the controller stays away for kBusOffTicks and then asks for the bus again, for ever: it may talk, but
/// torque that was on by then is the business of whoever asks bus_off().
template <RegisterCell Cell>
class Can {
 public:
  static constexpr std::size_t kFifos = 2;
  static constexpr std::size_t kIdentifiers = 4;  ///< of each FIFO: one filter bank in list mode
  using Identifiers = std::array<std::uint16_t, kIdentifiers>;
  static constexpr std::uint32_t kStaleTicks = 20;
  static constexpr std::uint32_t kTimesToBeAlone = 5;  ///< 0.1 s where something always waits
  static constexpr std::uint32_t kBusOffTicks = 100;

  explicit Can(CanRegisters<Cell>& registers) noexcept : registers_(registers) {}

  /// The controller's clock, pins and interrupts are the board's business. Unused identifiers repeat another one.
  /// False: the controller does not answer, or sees no idle bus yet; in the latter case it joins when it does.
  [[nodiscard]] auto start(std::uint32_t bit_timing, const std::array<Identifiers, kFifos>& identifiers) noexcept
      -> bool {
    registers_.mcr.write(can::kMcrInit | can::kMcrInOrder);
    if (bit_timing == 0 || !wait_for(registers_.msr, can::kMsrInit, can::kMsrInit, kPolls)) {
      return false;
    }
    answers_ = true;
    registers_.btr.write(bit_timing);
    set_filters(identifiers);
    registers_.ier.write(can::kIerPending);
    registers_.mcr.write(can::kMcrInOrder);
    return wait_for(registers_.msr, can::kMsrInit, 0, kPolls);
  }
  /// False: there is no controller, and nothing works.
  [[nodiscard]] auto answers() const noexcept -> bool { return answers_; }

  /// Empties one FIFO: three frames at most, which is all it holds.
  void rt_isr(std::size_t fifo) noexcept {
    Cell& state = registers_.rfr[fifo];
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t now = state.read();
      if ((now & can::kRfrOverrun) != 0) {
        errors_.fifo_overruns += 1;
        state.write(can::kRfrOverrun | can::kRfrFull);
      }
      if ((now & can::kRfrPending) == 0) {
        return;
      }
      const auto& mailbox = registers_.receive[fifo];
      const std::uint32_t identifier = mailbox.identifier.read();
      CanFrame frame{.id = static_cast<std::uint16_t>(identifier >> can::kIdentifierShift),
                     .size = static_cast<std::uint8_t>(mailbox.length.read() & 0xFU)};
      for (std::uint32_t k = 0; k < 4; ++k) {
        frame.data[k] = static_cast<std::uint8_t>(mailbox.low.read() >> (8 * k));
        frame.data[4 + k] = static_cast<std::uint8_t>(mailbox.high.read() >> (8 * k));
      }
      state.write(can::kRfrRelease);
      static_cast<void>(wait_for(state, can::kRfrRelease, 0, kReleasePolls));  // the next frame moves up meanwhile
      if ((identifier & can::kNotStandard) != 0) {
        errors_.foreign += 1;
      } else if (!rings_[fifo].push(frame)) {
        errors_.ring_overruns += 1;
      }
    }
  }

  /// Next received frame of one FIFO, or false.
  [[nodiscard]] auto rt_receive(std::size_t fifo, CanFrame& frame) noexcept -> bool { return rings_[fifo].pop(frame); }

  /// Gives one frame to the controller, behind those it has. False: all mailboxes wait, or the bus is off. Never waits.
  [[nodiscard]] auto send(const CanFrame& frame) noexcept -> bool {
    const std::uint32_t state = registers_.tsr.read();
    note_done(state);  // the request below would wipe out how the mailbox's last frame fared
    const std::uint32_t empty = (state & can::kTsrEmpty) >> can::kTsrEmptyShift;
    if (empty == 0 || bus_off() || !answers_) {
      errors_.send_full += 1;
      return false;
    }
    const std::size_t number = (empty & 1U) != 0 ? 0 : (empty & 2U) != 0 ? 1 : 2;
    auto& mailbox = registers_.send[number];
    mailbox.length.write(frame.size);
    std::array<std::uint32_t, 2> words{};
    for (std::size_t k = 0; k < frame.data.size(); ++k) {
      words[k / 4] |= std::uint32_t{frame.data[k]} << (8 * (k % 4));
    }
    mailbox.low.write(words[0]);
    mailbox.high.write(words[1]);
    mailbox.identifier.write((std::uint32_t{frame.id} << can::kIdentifierShift) | can::kTransmitRequest);
    return true;
  }
  /// True: send() would take a frame now.
  [[nodiscard]] auto can_send() const noexcept -> bool {
    return answers_ && !bus_off() && (registers_.tsr.read() & can::kTsrEmpty) != 0;
  }

  /// Looks after the controller; call it in every round of the background. `tick` in ms.
  void poll(std::uint32_t tick) noexcept {
    if (!answers_) {
      return;
    }
    look_after_sending(tick);
    const std::uint32_t state = registers_.esr.read();
    const bool passive = (state & can::kEsrPassive) != 0;
    errors_.passive += passive && !was_passive_ ? 1U : 0U;
    was_passive_ = passive;
    look_after_bus(tick, (state & can::kEsrBusOff) != 0);
  }

  [[nodiscard]] auto bus_off() const noexcept -> bool { return recovery_ != Recovery::kNone; }
  [[nodiscard]] auto errors() const noexcept -> CanErrors { return errors_; }
  /// Transmit and receive error counters of the controller, 0 to 255.
  [[nodiscard]] auto transmit_errors() const noexcept -> std::uint32_t { return (registers_.esr.read() >> 16) & 0xFFU; }
  [[nodiscard]] auto receive_errors() const noexcept -> std::uint32_t { return registers_.esr.read() >> 24; }

 private:
  enum class Recovery : std::uint8_t { kNone, kAway, kEntering, kLeaving };

  /// Exact data frames only: a filter of 16 bits compares the remote and the extended bit too (RM0090 32.7.4).
  void set_filters(const std::array<Identifiers, kFifos>& identifiers) noexcept {
    set_bits(registers_.fmr, can::kFmrInit);
    registers_.fa1r.write(0);
    registers_.fs1r.write(0);    // 16 bits
    registers_.fm1r.write(3U);   // lists
    registers_.ffa1r.write(2U);  // bank 1 feeds FIFO 1
    for (std::size_t bank = 0; bank < kFifos; ++bank) {
      for (std::size_t half = 0; half < 2; ++half) {
        const std::uint32_t first = identifiers[bank][2 * half];
        const std::uint32_t second = identifiers[bank][2 * half + 1];
        registers_.filter[bank][half].write((first << 5U) | (second << 21U));
      }
    }
    registers_.fa1r.write(3U);
    clear_bits(registers_.fmr, can::kFmrInit);
  }

  /// How frames fared whose mailboxes are done with them.
  void note_done(std::uint32_t state) noexcept {
    const std::uint32_t done = state & can::kTsrDone;
    if (done == 0) {
      return;
    }
    for (std::uint32_t shift = 0; shift <= 16; shift += 8) {
      const bool lost = ((done >> shift) & 1U) != 0 && ((state >> (shift + can::kTsrSentShift)) & 1U) == 0;
      const bool sent = ((state >> (shift + can::kTsrSentShift)) & 1U) != 0;
      errors_.send_lost += lost ? 1U : 0U;
      times_given_up_ = sent ? 0 : times_given_up_;
    }
    registers_.tsr.write(done);
    moved_ = true;
  }

  /// A frame that nobody acknowledges is sent again and again by the controller, which never leaves the bus for that;
  /// after a while it says nothing true any more and only blocks what is newer.
  void look_after_sending(std::uint32_t tick) noexcept {
    const std::uint32_t state = registers_.tsr.read();
    note_done(state);
    if (moved_ || (state & can::kTsrEmpty) == can::kTsrEmpty) {
      moved_ = false;
      moved_at_ = tick;
    } else if (tick - moved_at_ >= kStaleTicks) {
      registers_.tsr.write(can::kTsrAbort);
      moved_at_ = tick;
      errors_.alone += ++times_given_up_ == kTimesToBeAlone ? 1U : 0U;
    }
  }

  /// Out of bus-off through initialisation (RM0090 32.7.6); what was waiting to be sent is given up first.
  void look_after_bus(std::uint32_t tick, bool off) noexcept {
    const bool initialising = (registers_.msr.read() & can::kMsrInit) != 0;
    switch (recovery_) {
      case Recovery::kNone:
        if (off) {
          errors_.bus_off += 1;
          registers_.tsr.write(can::kTsrAbort);
          off_at_ = tick;
          recovery_ = Recovery::kAway;
        }
        break;
      case Recovery::kAway:
        if (tick - off_at_ >= kBusOffTicks) {
          registers_.mcr.write(can::kMcrInit | can::kMcrInOrder);
          recovery_ = Recovery::kEntering;
        }
        break;
      case Recovery::kEntering:
        if (initialising) {
          registers_.mcr.write(can::kMcrInOrder);
          recovery_ = Recovery::kLeaving;
        }
        break;
      case Recovery::kLeaving:
        recovery_ = initialising || off ? Recovery::kLeaving : Recovery::kNone;
        break;
    }
  }

  static constexpr std::uint32_t kPolls = 50'000;  // a millisecond or more; joining the bus takes 11 bits
  static constexpr std::uint32_t kReleasePolls = 10;
  static constexpr std::size_t kRing = 16;

  CanRegisters<Cell>& registers_;
  std::array<RingBuffer<kRing, CanFrame>, kFifos> rings_;
  CanErrors errors_;
  std::uint32_t moved_at_ = 0;
  std::uint32_t off_at_ = 0;
  std::uint32_t times_given_up_ = 0;  // since a frame was sent
  Recovery recovery_ = Recovery::kNone;
  bool moved_ = false;  // a mailbox became free since the last look
  bool was_passive_ = false;
  bool answers_ = false;
};

}  // namespace capstan::stm32f4
