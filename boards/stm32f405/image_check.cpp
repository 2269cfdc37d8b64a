// SPDX-License-Identifier: Apache-2.0
// Runs before anything of the image is believed, so it may neither call nor read what lies outside of sector 0:
// functions and constants have their section said, and what they call is inlined (flatten).
#include "capstan/boards/stm32f405/image_check.hpp"

#include <array>

#include "capstan/boards/stm32f405/board.hpp"
#include "capstan/boards/stm32f405/image.hpp"
#include "capstan/firmware/parameters/crc32.hpp"
#include "capstan/hal/stm32f4/memory_map.hpp"

namespace {

using namespace capstan;
using Table = std::array<std::uint32_t, 256>;

consteval auto make_table() -> Table {
  Table table{};
  for (std::uint32_t byte = 0; byte < table.size(); ++byte) {
    table.at(byte) = crc32_step(0, static_cast<std::uint8_t>(byte));
  }
  return table;
}

/// Four bytes at once: at 16 MHz, bit by bit, the board would stand still for half a second.
constexpr auto add_word(const Table& table, std::uint32_t remainder, std::uint32_t word) -> std::uint32_t {
  remainder ^= word;
  remainder = (remainder >> 8) ^ table[remainder & 0xFFU];  // a loop would add half of the time
  remainder = (remainder >> 8) ^ table[remainder & 0xFFU];
  remainder = (remainder >> 8) ^ table[remainder & 0xFFU];
  return (remainder >> 8) ^ table[remainder & 0xFFU];
}

constexpr auto bytewise(std::uint32_t remainder, std::uint32_t word) -> std::uint32_t {
  for (int byte = 0; byte < 4; ++byte) {
    remainder = crc32_step(remainder, static_cast<std::uint8_t>(word >> (8 * byte)));
  }
  return remainder;
}
static_assert(add_word(make_table(), 0xFFFF'FFFFU, 0x3412'A85CU) == bytewise(0xFFFF'FFFFU, 0x3412'A85CU));

consteval auto make_line() {
  constexpr std::size_t kSize = stm32f405::kDamagedImage.size();
  auto line = stm32f405::padded<kSize + 2>(stm32f405::kDamagedImage);
  line[kSize] = '\r';
  line[kSize + 1] = '\n';
  return line;
}

[[gnu::section(".sector0_constants")]] constinit const Table kTable = make_table();
[[gnu::section(".sector0_constants")]] constinit const auto kSentence = make_line();

[[gnu::section(".sector0"), gnu::flatten, gnu::noinline]] auto add_words(std::uint32_t remainder,
                                                                         const std::uint32_t* word,
                                                                         const std::uint32_t* end) -> std::uint32_t {
  for (; word < end; ++word) {
    remainder = add_word(kTable, remainder, *word);
  }
  return remainder;
}

/// Nothing but the console's sending half is touched: every other pin stays the input that the reset made it, so the
/// pull-downs hold enables and set values low. The watchdog does not run yet.
[[noreturn, gnu::section(".sector0"), gnu::flatten]] void say_damaged() {
  auto& rcc = stm32f4::rcc_registers();
  // After a reset the core runs from the internal oscillator; a boot loader that jumped here may have left another
  // clock.
  stm32f4::modify(rcc.cfgr, stm32f4::rcc::kCfgrPrescalerMask | stm32f4::rcc::kCfgrSwitchMask, 0);
  stm32f4::set_bits(rcc.ahb1enr, stm32f4::rcc::kAhb1GpioA);
  stm32f4::set_bits(rcc.apb2enr, stm32f4::rcc::kApb2Usart1);
  stm32f4::configure_pin(stm32f4::gpio_registers(stm32f4::Port::kA), stm32f405::kConsoleTx);
  auto& console = stm32f4::usart1_registers();
  console.brr.write(stm32f4::baud_divider(stm32f4::kInternalHz, stm32f405::kConsoleBaud));
  console.cr1.write(stm32f4::usart::kCr1Enable | stm32f4::usart::kCr1Transmit);
  auto& tick = stm32f4::systick_registers();
  tick.rvr.write(stm32f4::kInternalHz - 1);  // a second
  tick.cvr.write(0);
  tick.csr.write(stm32f4::systick::kCsrEnable | stm32f4::systick::kCsrCoreClock);
  constexpr std::uint32_t kPolls = stm32f4::kInternalHz;  // four seconds at least
  for (;;) {
    for (const char character : kSentence) {
      static_cast<void>(
          stm32f4::wait_for(console.sr, stm32f4::usart::kSrTransmitEmpty, stm32f4::usart::kSrTransmitEmpty, kPolls));
      console.dr.write(static_cast<std::uint8_t>(character));
    }
    static_cast<void>(
        stm32f4::wait_for(tick.csr, stm32f4::systick::kCsrCounted, stm32f4::systick::kCsrCounted, kPolls));
  }
}

}  // namespace

[[gnu::section(".sector0"), gnu::used]] void capstan_check_image() {
  std::uint32_t remainder = add_words(0xFFFF'FFFFU, capstan_sector0_begin, capstan_seal);
  remainder = add_words(remainder, capstan_seal_end, capstan_sector0_end);
  remainder = add_words(remainder, capstan_code_begin, capstan_image_end);
  if (~remainder != capstan_seal[0]) {
    say_damaged();
  }
}
