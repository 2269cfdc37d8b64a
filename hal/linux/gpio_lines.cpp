// SPDX-License-Identifier: Apache-2.0
#include "capstan/hal/linux/gpio_lines.hpp"

#include <stdexcept>
#include <vector>

namespace capstan {
namespace {

struct Wanted {
  GpioSetup::Line line;
  const char* name;
};

auto request(const std::string& chip, const std::vector<Wanted>& lines, GpioRequest::Direction direction,
             std::uint32_t levels) -> GpioRequest {
  std::vector<std::uint32_t> offsets;
  std::string names;
  for (const Wanted& one : lines) {
    offsets.push_back(one.line.offset);
    names += std::string(names.empty() ? "" : ", ") + one.name + ' ' + std::to_string(one.line.offset);
  }
  try {
    return {chip, offsets, direction, levels};
  } catch (const std::runtime_error& problem) {
    throw std::runtime_error(
        "The lines " + names + " of " + chip + " cannot be requested (" + problem.what() +
        "); gpiodetect and gpioinfo show which exist and who has them, and the user needs the right "
        "to use the chip");
  }
}

}  // namespace

GpioLines::GpioLines(const GpioSetup& setup) {
  if (setup.chip.empty()) {
    return;
  }
  if (setup.estop) {
    input_inverted_ = setup.estop->inverted;
    input_ = request(setup.chip, {{*setup.estop, "estop"}}, GpioRequest::Direction::kInput, 0);
  }
  std::vector<Wanted> outputs;
  const auto add = [&](const std::optional<GpioSetup::Line>& line, const char* name) -> std::uint32_t {
    if (!line) {
      return 0;
    }
    const std::uint32_t bit = std::uint32_t{1} << outputs.size();
    outputs.push_back({*line, name});
    inverted_bits_ |= line->inverted ? bit : 0;
    return bit;
  };
  enable_bit_ = add(setup.enable, "enable");
  brake_bit_ = add(setup.brake, "brake");
  watchdog_bit_ = add(setup.watchdog, "watchdog");
  if (!outputs.empty()) {
    outputs_ = request(setup.chip, outputs, GpioRequest::Direction::kOutput, inverted_bits_);
  }
}

GpioLines::~GpioLines() {
  rt_off();
}

auto GpioLines::rt_estop() -> bool {
  if (!input_) {
    return false;
  }
  const GpioRequest::Edges edges = input_.rt_edges();
  bool high = false;
  const bool known = input_.rt_get(high);
  failures_ += (edges == GpioRequest::Edges::kFailed ? 1 : 0) + (known ? 0 : 1);
  return contact_.rt_step(edges != GpioRequest::Edges::kNone, known && high != input_inverted_);
}

auto GpioLines::rt_write(bool enabled, bool brake_open) -> bool {
  if (!outputs_) {
    return true;
  }
  const std::uint32_t high = (enabled ? enable_bit_ : 0) | (brake_open ? brake_bit_ : 0) | (wave_ ? watchdog_bit_ : 0);
  if (!outputs_.rt_set(high ^ inverted_bits_)) {
    ++failures_;
    return false;
  }
  return true;
}

auto GpioLines::rt_drive(bool enabled, bool brake_open) -> bool {
  wave_ = !wave_;
  return rt_write(enabled, brake_open);
}

void GpioLines::rt_off() {
  static_cast<void>(rt_write(false, false));
}

}  // namespace capstan
