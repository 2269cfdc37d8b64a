// SPDX-License-Identifier: Apache-2.0
// By libgpiod 2 (Debian 13 has 2.2).
#include <fcntl.h>
#include <gpiod.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "capstan/hal/linux/gpio_request.hpp"

namespace capstan {
namespace {

template <auto kFree>
struct Free {
  void operator()(auto* what) const { kFree(what); }
};
using Chip = std::unique_ptr<gpiod_chip, Free<gpiod_chip_close>>;
using LineSettings = std::unique_ptr<gpiod_line_settings, Free<gpiod_line_settings_free>>;
using LineConfig = std::unique_ptr<gpiod_line_config, Free<gpiod_line_config_free>>;
using RequestConfig = std::unique_ptr<gpiod_request_config, Free<gpiod_request_config_free>>;
using Request = std::unique_ptr<gpiod_line_request, Free<gpiod_line_request_release>>;
using Events = std::unique_ptr<gpiod_edge_event_buffer, Free<gpiod_edge_event_buffer_free>>;

constexpr std::size_t kMostEvents = 16;  // of the kernel's own queue for one line

auto level_of(std::uint32_t levels, std::size_t line) -> gpiod_line_value {
  return (levels >> line & 1U) != 0 ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
}

}  // namespace

struct GpioRequest::Lines {
  Request request;
  Events events;
  unsigned first = 0;  // its offset
};

GpioRequest::GpioRequest(const std::string& chip, std::span<const std::uint32_t> offsets, Direction direction,
                         std::uint32_t levels)
    : lines_(std::make_shared<Lines>()) {
  const auto check = [](bool good) {
    if (!good) {
      throw std::runtime_error(std::strerror(errno));
    }
  };
  const Chip opened(gpiod_chip_open(chip.c_str()));
  check(opened != nullptr);
  const LineSettings settings(gpiod_line_settings_new());
  const LineConfig config(gpiod_line_config_new());
  const RequestConfig consumer(gpiod_request_config_new());
  check(settings && config && consumer);
  gpiod_request_config_set_consumer(consumer.get(), "capstan");
  const bool input = direction == Direction::kInput;
  check(gpiod_line_settings_set_direction(settings.get(),
                                          input ? GPIOD_LINE_DIRECTION_INPUT : GPIOD_LINE_DIRECTION_OUTPUT) == 0);
  if (input) {
    check(gpiod_line_settings_set_edge_detection(settings.get(), GPIOD_LINE_EDGE_BOTH) == 0);
  }
  const std::size_t count = std::min(offsets.size(), kMostLines);
  for (std::size_t i = 0; i < count; ++i) {
    const unsigned offset = offsets[i];
    if (!input) {
      check(gpiod_line_settings_set_output_value(settings.get(), level_of(levels, i)) == 0);
    }
    check(gpiod_line_config_add_line_settings(config.get(), &offset, 1, settings.get()) == 0);
  }
  lines_->request.reset(gpiod_chip_request_lines(opened.get(), consumer.get(), config.get()));
  check(lines_->request != nullptr);
  lines_->first = offsets[0];
  lines_->events.reset(gpiod_edge_event_buffer_new(kMostEvents));
  check(lines_->events && fcntl(gpiod_line_request_get_fd(lines_->request.get()), F_SETFL, O_NONBLOCK) == 0);
}

auto GpioRequest::rt_edges() -> Edges {
  if (gpiod_line_request_read_edge_events(lines_->request.get(), lines_->events.get(), kMostEvents) > 0) {
    return Edges::kSeen;
  }
  return errno == EAGAIN ? Edges::kNone : Edges::kFailed;
}

auto GpioRequest::rt_get(bool& high) -> bool {
  const gpiod_line_value level = gpiod_line_request_get_value(lines_->request.get(), lines_->first);
  high = level == GPIOD_LINE_VALUE_ACTIVE;
  return level != GPIOD_LINE_VALUE_ERROR;
}

auto GpioRequest::rt_set(std::uint32_t levels) -> bool {
  std::array<gpiod_line_value, kMostLines> values{};
  for (std::size_t i = 0; i < kMostLines; ++i) {
    values[i] = level_of(levels, i);
  }
  return gpiod_line_request_set_values(lines_->request.get(), values.data()) == 0;
}

}  // namespace capstan
