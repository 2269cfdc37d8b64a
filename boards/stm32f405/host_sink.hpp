// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "capstan/firmware/console/text.hpp"
#include "capstan/hal/stm32f4/semihosting.hpp"

namespace capstan::stm32f405 {

/// The emulator's standard output, for test images.
class HostSink final : public TextSink {
 private:
  void do_write(std::string_view text) override {
    const std::span bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
    static_cast<void>(output_.write(bytes));
  }
  stm32f4::semihosting::File output_{std::string_view(":tt"), stm32f4::semihosting::File::Mode::kWrite};
};

}  // namespace capstan::stm32f405
