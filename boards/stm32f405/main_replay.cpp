// SPDX-License-Identifier: Apache-2.0
// Test image for the emulator: plays a recorded run through the cycle and writes what comes out, so that the bytes can
// be compared with the host's. Command line: IMAGE INPUT OUTPUT. Exits with the result and prints the cost of the
// cycle.
#include <algorithm>
#include <string_view>

#include "capstan/boards/stm32f405/board.hpp"
#include "capstan/boards/stm32f405/cycle_replay.hpp"
#include "capstan/boards/stm32f405/host_sink.hpp"
#include "capstan/boards/stm32f405/startup.hpp"
#include "capstan/firmware/console/text.hpp"
#include "capstan/hal/stm32f4/memory_map.hpp"
#include "capstan/hal/stm32f4/semihosting.hpp"
#include "capstan/hal/stm32f4/tick.hpp"

namespace {

using namespace capstan;
namespace semihosting = stm32f4::semihosting;

constexpr std::uint32_t kCoreHz = 168'000'000;  // at which the emulator's timer counts
constexpr std::uint32_t kFaultStatus = 20;
constexpr std::uint32_t kUsageStatus = 21;

stm32f4::Tick<stm32f4::MemoryRegister> tick{stm32f4::systick_registers()};

using Block = std::array<std::uint8_t, 4096>;

/// A file read or written in blocks: each call to the host costs far more than the bytes.
class BlockFile {
 public:
  BlockFile(std::string_view path, semihosting::File::Mode mode, Block& block) : file_(path, mode), block_(block) {}
  [[nodiscard]] auto is_open() const -> bool { return file_.is_open(); }

  auto read(std::span<std::uint8_t> bytes) -> std::size_t {
    std::size_t got = 0;
    while (got < bytes.size()) {
      if (at_ == filled_) {
        filled_ = file_.read(block_);
        at_ = 0;
        if (filled_ == 0) {
          break;
        }
      }
      bytes[got++] = block_[at_++];
    }
    return got;
  }
  auto write(std::span<const std::uint8_t> bytes) -> bool {
    if (filled_ + bytes.size() > block_.size() && !flush()) {
      return false;
    }
    std::copy(bytes.begin(), bytes.end(), block_.begin() + static_cast<std::ptrdiff_t>(filled_));
    filled_ += bytes.size();
    return true;
  }
  [[nodiscard]] auto flush() -> bool {
    const bool done = file_.write(std::span(block_).first(filled_));
    filled_ = 0;
    return done;
  }

 private:
  semihosting::File file_;
  Block& block_;
  std::size_t filled_ = 0;
  std::size_t at_ = 0;
};

/// Cost of the cycles in core cycles of the emulated timer.
class CostMeter {
 public:
  void begin() { begin_ = tick.core_cycles(); }
  void end() {
    const std::uint32_t cost = tick.core_cycles() - begin_;
    total_ += cost;
    if (cost > max_) {
      max_ = cost;
      max_at_ = cycles_;
    }
    ++cycles_;
  }
  void print(Print& out) const {
    const auto mean = cycles_ == 0 ? 0U : static_cast<std::uint32_t>(total_ / cycles_);
    out << "replay: " << cycles_ << " cycles of " << static_cast<std::uint32_t>(stm32f405::kAxes) << " axes, "
        << stm32f4::emulated_instructions(mean, kCoreHz) << " instructions each on average, "
        << stm32f4::emulated_instructions(max_, kCoreHz) << " at most (in cycle " << max_at_ << "), stack unused "
        << stm32f405::stack_unused_bytes() << " of " << stm32f405::stack_size_bytes() << " bytes\n";
  }

 private:
  std::uint32_t begin_ = 0;
  std::uint32_t max_ = 0;
  std::uint32_t max_at_ = 0;
  std::uint32_t cycles_ = 0;
  std::uint64_t total_ = 0;
};

// Too large for the stack.
std::array<char, 1024> command_line;
Block input_block;
Block output_block;

auto run() -> std::uint32_t {
  std::string_view words(command_line.data(), semihosting::command_line(command_line));
  static_cast<void>(next_word(words));  // the image itself
  const std::string_view input_path = next_word(words);
  const std::string_view output_path = next_word(words);
  BlockFile input(input_path, semihosting::File::Mode::kRead, input_block);
  BlockFile output(output_path, semihosting::File::Mode::kWrite, output_block);
  if (input_path.empty() || output_path.empty() || !input.is_open() || !output.is_open() ||
      !tick.start(kCoreHz, kCycleRateHz)) {
    return kUsageStatus;
  }
  CostMeter meter;
  const stm32f405::ReplayResult result = stm32f405::replay<stm32f405::kAxes>(input, output, meter);
  const bool flushed = output.flush();
  stm32f405::HostSink sink;
  Print out(sink);
  meter.print(out);
  return static_cast<std::uint32_t>(flushed ? result : stm32f405::ReplayResult::kWriteFailed);
}

}  // namespace

extern "C" {

/// Nothing is driven here, and a fault ends the run.
void rt_release_outputs() {
  semihosting::exit(kFaultStatus);
}
void rt_systick_isr() {
  tick.rt_isr();
}
void rt_cycle_isr() {
  semihosting::exit(kFaultStatus);
}
void rt_usart1_isr() {
  semihosting::exit(kFaultStatus);
}

}  // extern "C"

int main() {
  semihosting::exit(run());
}
