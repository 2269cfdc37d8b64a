// SPDX-License-Identifier: Apache-2.0
// By libgpiod 1 (Debian 12 has 1.6).
#include <fcntl.h>
#include <gpiod.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "capstan/hal/linux/gpio_request.hpp"

namespace capstan {

struct GpioRequest::Lines {
  explicit Lines(const std::string& name) : chip(gpiod_chip_open(name.c_str())) {}
  Lines(const Lines&) = delete;
  auto operator=(const Lines&) -> Lines& = delete;
  ~Lines() {
    if (chip != nullptr) {
      gpiod_chip_close(chip);  // releases its lines too
    }
  }
  gpiod_chip* chip;
  gpiod_line_bulk lines{};
  int events = -1;
};

GpioRequest::GpioRequest(const std::string& chip, std::span<const std::uint32_t> offsets, Direction direction,
                         std::uint32_t levels)
    : lines_(std::make_shared<Lines>(chip)) {
  const auto check = [](bool good) {
    if (!good) {
      throw std::runtime_error(std::strerror(errno));
    }
  };
  check(lines_->chip != nullptr);
  std::array<unsigned, kMostLines> numbers{};
  std::array<int, kMostLines> values{};
  const std::size_t count = std::min(offsets.size(), kMostLines);
  for (std::size_t i = 0; i < count; ++i) {
    numbers[i] = offsets[i];
    values[i] = static_cast<int>(levels >> i & 1U);
  }
  check(gpiod_chip_get_lines(lines_->chip, numbers.data(), static_cast<unsigned>(count), &lines_->lines) == 0);
  if (direction == Direction::kOutput) {
    check(gpiod_line_request_bulk_output(&lines_->lines, "capstan", values.data()) == 0);
    return;
  }
  check(gpiod_line_request_bulk_both_edges_events(&lines_->lines, "capstan") == 0);
  lines_->events = gpiod_line_event_get_fd(gpiod_line_bulk_get_line(&lines_->lines, 0));
  check(fcntl(lines_->events, F_SETFL, O_NONBLOCK) == 0);
}

auto GpioRequest::rt_edges() -> Edges {
  constexpr std::size_t kMostEvents = 16;  // of the kernel's own queue for one line
  std::array<gpiod_line_event, kMostEvents> events{};
  if (gpiod_line_event_read_fd_multiple(lines_->events, events.data(), kMostEvents) > 0) {
    return Edges::kSeen;
  }
  return errno == EAGAIN ? Edges::kNone : Edges::kFailed;
}

auto GpioRequest::rt_get(bool& high) -> bool {
  const int level = gpiod_line_get_value(gpiod_line_bulk_get_line(&lines_->lines, 0));
  high = level == 1;
  return level >= 0;
}

auto GpioRequest::rt_set(std::uint32_t levels) -> bool {
  std::array<int, kMostLines> values{};
  for (std::size_t i = 0; i < kMostLines; ++i) {
    values[i] = static_cast<int>(levels >> i & 1U);
  }
  return gpiod_line_set_value_bulk(&lines_->lines, values.data()) == 0;
}

}  // namespace capstan
