// SPDX-License-Identifier: Apache-2.0
#include "hal/linux/gpio_lines.hpp"

#include <fcntl.h>
#include <linux/gpio.h>
#include <sys/ioctl.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <vector>

namespace capstan {
namespace {

struct Wanted {
  GpioSetup::Line line;
  const char* name;
};

auto request(int chip, const std::string& chip_name, const std::vector<Wanted>& lines, std::uint64_t flags)
    -> FileDescriptor {
  gpio_v2_line_request wanted{};
  std::string("capstan").copy(wanted.consumer, sizeof wanted.consumer - 1);
  wanted.num_lines = static_cast<std::uint32_t>(lines.size());
  wanted.config.flags = flags;
  std::uint64_t inverted = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    wanted.offsets[i] = lines[i].line.offset;
    inverted |= lines[i].line.inverted ? std::uint64_t{1} << i : 0;
  }
  if (inverted != 0) {
    wanted.config.num_attrs = 1;
    wanted.config.attrs[0].attr.id = GPIO_V2_LINE_ATTR_ID_FLAGS;
    wanted.config.attrs[0].attr.flags = flags | GPIO_V2_LINE_FLAG_ACTIVE_LOW;
    wanted.config.attrs[0].mask = inverted;
  }
  if (ioctl(chip, GPIO_V2_GET_LINE_IOCTL, &wanted) != 0) {
    std::string names;
    for (const Wanted& one : lines) {
      names += std::string(names.empty() ? "" : ", ") + one.name + ' ' + std::to_string(one.line.offset);
    }
    throw std::runtime_error("The lines " + names + " of " + chip_name + " can not be had (" + std::strerror(errno) +
                             "); gpioinfo shows which exist and who has them");
  }
  FileDescriptor got(wanted.fd);
  static_cast<void>(fcntl(got.get(), F_SETFL, O_NONBLOCK));
  return got;
}

}  // namespace

GpioLines::GpioLines(const GpioSetup& setup) {
  if (setup.chip.empty()) {
    return;
  }
  const FileDescriptor chip(open(setup.chip.c_str(), O_RDWR | O_CLOEXEC));
  if (!chip) {
    throw std::runtime_error("The GPIO chip " + setup.chip + " can not be opened (" + std::strerror(errno) +
                             "); gpiodetect shows those that exist, and the user needs the right to use it");
  }
  if (setup.estop) {
    input_ = request(chip.get(), setup.chip, {{*setup.estop, "estop"}},
                     GPIO_V2_LINE_FLAG_INPUT | GPIO_V2_LINE_FLAG_EDGE_RISING | GPIO_V2_LINE_FLAG_EDGE_FALLING);
  }
  std::vector<Wanted> outputs;
  const auto add = [&outputs](const std::optional<GpioSetup::Line>& line, const char* name) -> std::uint64_t {
    if (!line) {
      return 0;
    }
    outputs.push_back({*line, name});
    return std::uint64_t{1} << (outputs.size() - 1);
  };
  energised_bits_ = add(setup.enable, "enable") | add(setup.brake, "brake");
  watchdog_bit_ = add(setup.watchdog, "watchdog");
  all_bits_ = energised_bits_ | watchdog_bit_;
  if (!outputs.empty()) {
    outputs_ = request(chip.get(), setup.chip, outputs, GPIO_V2_LINE_FLAG_OUTPUT);
  }
}

GpioLines::~GpioLines() {
  rt_off();
}

auto GpioLines::rt_estop() -> bool {
  if (!input_) {
    return false;
  }
  constexpr std::size_t kMostEvents = 16;  // of the kernel's own queue for one line
  std::array<gpio_v2_line_event, kMostEvents> events{};
  bool opened = false;
  const ssize_t bytes = ::read(input_.get(), events.data(), sizeof events);
  if (bytes < 0 && errno != EAGAIN) {
    ++failures_;
    opened = true;
  }
  for (std::size_t i = 0; bytes > 0 && i < static_cast<std::size_t>(bytes) / sizeof events[0]; ++i) {
    opened |= events[i].id == GPIO_V2_LINE_EVENT_FALLING_EDGE;
  }
  gpio_v2_line_values level{};
  level.mask = 1;
  if (ioctl(input_.get(), GPIO_V2_LINE_GET_VALUES_IOCTL, &level) != 0) {
    ++failures_;
    opened = true;
  }
  return contact_.rt_step(opened, (level.bits & 1U) != 0);
}

auto GpioLines::rt_write(bool energised) -> bool {
  if (!outputs_) {
    return true;
  }
  gpio_v2_line_values values{};
  values.mask = all_bits_;
  values.bits = (energised ? energised_bits_ : 0) | (wave_ ? watchdog_bit_ : 0);
  if (ioctl(outputs_.get(), GPIO_V2_LINE_SET_VALUES_IOCTL, &values) != 0) {
    ++failures_;
    return false;
  }
  return true;
}

auto GpioLines::rt_drive(bool energised) -> bool {
  wave_ = !wave_;
  return rt_write(energised);
}

void GpioLines::rt_off() {
  static_cast<void>(rt_write(false));
}

}  // namespace capstan
