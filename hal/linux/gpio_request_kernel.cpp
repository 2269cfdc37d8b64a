// SPDX-License-Identifier: Apache-2.0
// By the kernel's own interface (v2, from Linux 5.10 on): needs no library.
#include <fcntl.h>
#include <linux/gpio.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "capstan/hal/linux/file_descriptor.hpp"
#include "capstan/hal/linux/gpio_request.hpp"

namespace capstan {

struct GpioRequest::Lines {
  FileDescriptor file;
  std::uint64_t all = 0;
};

GpioRequest::GpioRequest(const std::string& chip, std::span<const std::uint32_t> offsets, Direction direction,
                         std::uint32_t levels)
    : lines_(std::make_shared<Lines>()) {
  const FileDescriptor file(open(chip.c_str(), O_RDWR | O_CLOEXEC));
  gpio_v2_line_request wanted{};
  std::string("capstan").copy(wanted.consumer, sizeof wanted.consumer - 1);
  wanted.num_lines = static_cast<std::uint32_t>(std::min(offsets.size(), kMostLines));
  std::copy_n(offsets.begin(), wanted.num_lines, wanted.offsets);
  lines_->all = (std::uint64_t{1} << wanted.num_lines) - 1;
  if (direction == Direction::kInput) {
    wanted.config.flags = GPIO_V2_LINE_FLAG_INPUT | GPIO_V2_LINE_FLAG_EDGE_RISING | GPIO_V2_LINE_FLAG_EDGE_FALLING;
  } else {
    wanted.config.flags = GPIO_V2_LINE_FLAG_OUTPUT;
    wanted.config.num_attrs = 1;
    wanted.config.attrs[0].attr.id = GPIO_V2_LINE_ATTR_ID_OUTPUT_VALUES;
    wanted.config.attrs[0].attr.values = levels;
    wanted.config.attrs[0].mask = lines_->all;
  }
  if (!file || ioctl(file.get(), GPIO_V2_GET_LINE_IOCTL, &wanted) != 0) {
    throw std::runtime_error(std::strerror(errno));
  }
  lines_->file = FileDescriptor(wanted.fd);
  static_cast<void>(fcntl(lines_->file.get(), F_SETFL, O_NONBLOCK));
}

auto GpioRequest::rt_edges() -> Edges {
  constexpr std::size_t kMostEvents = 16;  // of the kernel's own queue for one line
  std::array<gpio_v2_line_event, kMostEvents> events{};
  if (::read(lines_->file.get(), events.data(), sizeof events) > 0) {
    return Edges::kSeen;
  }
  return errno == EAGAIN ? Edges::kNone : Edges::kFailed;
}

auto GpioRequest::rt_get(bool& high) -> bool {
  gpio_v2_line_values level{};
  level.mask = 1;
  if (ioctl(lines_->file.get(), GPIO_V2_LINE_GET_VALUES_IOCTL, &level) != 0) {
    return false;
  }
  high = (level.bits & 1U) != 0;
  return true;
}

auto GpioRequest::rt_set(std::uint32_t levels) -> bool {
  gpio_v2_line_values values{};
  values.mask = lines_->all;
  values.bits = levels;
  return ioctl(lines_->file.get(), GPIO_V2_LINE_SET_VALUES_IOCTL, &values) == 0;
}

}  // namespace capstan
