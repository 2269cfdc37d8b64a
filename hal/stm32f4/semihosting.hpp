// SPDX-License-Identifier: Apache-2.0
// Calls to the host of an emulated or debugged core (Arm "Semihosting for AArch32 and AArch64", version 2.0). Only the
// images for the emulator include this: without a host to answer, the trap would be a hard fault.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace capstan::stm32f4::semihosting {

namespace detail {

enum class Operation : std::uint32_t {
  kOpen = 0x01,
  kClose = 0x02,
  kWrite = 0x05,
  kRead = 0x06,
  kSeek = 0x0A,
  kCommandLine = 0x15,
  kExitExtended = 0x20,
};

/// M-profile trap: the operation in r0, the address of its arguments in r1, the answer in r0.
inline auto call(Operation operation, const void* arguments) noexcept -> std::int32_t {
  register auto r0 asm("r0") = static_cast<std::uint32_t>(operation);
  register auto r1 asm("r1") = arguments;
  asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
  return static_cast<std::int32_t>(r0);
}

inline auto word(const volatile void* pointer) noexcept -> std::uint32_t {
  return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(pointer));
}

}  // namespace detail

/// Ends the emulator with this status (0 to 255).
[[noreturn]] inline void exit(std::uint32_t status) noexcept {
  constexpr std::uint32_t kApplicationExit = 0x20026;
  const std::array<std::uint32_t, 2> arguments{kApplicationExit, status};
  detail::call(detail::Operation::kExitExtended, arguments.data());
  for (;;) {
  }
}

/// Copies the words given to the image on its command line into `text`, ended by a zero. Returns the length, 0 when
/// there is none or it does not fit.
[[nodiscard]] inline auto command_line(std::span<char> text) noexcept -> std::size_t {
  std::array<std::uint32_t, 2> arguments{detail::word(text.data()), static_cast<std::uint32_t>(text.size())};
  if (detail::call(detail::Operation::kCommandLine, arguments.data()) != 0) {
    return 0;
  }
  return arguments[1];
}

/// A file of the host, as a stream of bytes. Closed when the object goes.
class File {
 public:
  enum class Mode : std::uint32_t { kRead = 1, kUpdate = 3, kWrite = 5 };  ///< "rb", "r+b" and "wb"
  static constexpr std::size_t kLongestPath = 255;

  /// ":tt" is the host's console. A path that is longer than kLongestPath is not opened.
  File(std::string_view path, Mode mode) noexcept {
    std::array<char, kLongestPath + 1> name{};  // the host wants it ended by a zero
    if (path.size() > kLongestPath) {
      return;
    }
    std::copy(path.begin(), path.end(), name.begin());
    const std::array<std::uint32_t, 3> arguments{detail::word(name.data()), static_cast<std::uint32_t>(mode),
                                                 static_cast<std::uint32_t>(path.size())};
    handle_ = detail::call(detail::Operation::kOpen, arguments.data());
  }
  File(const File&) = delete;
  auto operator=(const File&) -> File& = delete;
  ~File() {
    if (is_open()) {
      const std::array<std::uint32_t, 1> arguments{static_cast<std::uint32_t>(handle_)};
      detail::call(detail::Operation::kClose, arguments.data());
    }
  }

  [[nodiscard]] auto is_open() const noexcept -> bool { return handle_ >= 0; }

  /// The next byte read or written is the one at `offset`, which is not beyond the end.
  [[nodiscard]] auto seek(std::size_t offset) noexcept -> bool {
    const std::array<std::uint32_t, 2> arguments{static_cast<std::uint32_t>(handle_),
                                                 static_cast<std::uint32_t>(offset)};
    return detail::call(detail::Operation::kSeek, arguments.data()) == 0;
  }
  /// Bytes read; fewer than asked for only at the end of the file.
  [[nodiscard]] auto read(std::span<std::uint8_t> bytes) noexcept -> std::size_t {
    return bytes.size() - transfer(detail::Operation::kRead, bytes.data(), bytes.size());
  }
  /// True when every byte was written.
  [[nodiscard]] auto write(std::span<const std::uint8_t> bytes) noexcept -> bool {
    return transfer(detail::Operation::kWrite, bytes.data(), bytes.size()) == 0;
  }

 private:
  /// Both calls answer with the number of bytes that were NOT transferred.
  auto transfer(detail::Operation operation, const std::uint8_t* data, std::size_t size) noexcept -> std::size_t {
    const std::array<std::uint32_t, 3> arguments{static_cast<std::uint32_t>(handle_), detail::word(data),
                                                 static_cast<std::uint32_t>(size)};
    const std::int32_t left = detail::call(operation, arguments.data());
    return left < 0 || static_cast<std::size_t>(left) > size ? size : static_cast<std::size_t>(left);
  }

  std::int32_t handle_ = -1;
};

}  // namespace capstan::stm32f4::semihosting
