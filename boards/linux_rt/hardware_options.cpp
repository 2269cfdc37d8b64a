// SPDX-License-Identifier: Apache-2.0
#include "capstan/boards/linux_rt/hardware_options.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace capstan {
namespace {

constexpr std::size_t kMostBuses = 2;
constexpr std::size_t kMostDrives = 4;

[[noreturn]] void refuse(const std::string& what, const std::string& cure) {
  throw std::runtime_error(what + "; " + cure);
}

auto quoted(std::string_view text) -> std::string {
  return std::string(1, '\'').append(text).append(1, '\'');
}

auto words_of(std::string_view text) -> std::vector<std::string_view> {
  std::vector<std::string_view> words;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(',', start), text.size());
    words.push_back(text.substr(start, end - start));
    start = end + 1;
  }
  return words;
}

auto whole(std::string_view text, unsigned lowest, unsigned highest, unsigned& value) -> bool {
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  return problem == std::errc{} && end == text.data() + text.size() && value >= lowest && value <= highest;
}

auto line_of(GpioSetup& setup, std::string_view name) -> std::optional<GpioSetup::Line>* {
  if (name == "estop") {
    return &setup.estop;
  }
  if (name == "enable") {
    return &setup.enable;
  }
  if (name == "brake") {
    return &setup.brake;
  }
  return name == "watchdog" ? &setup.watchdog : nullptr;
}

}  // namespace

auto parse_can_bus(const std::string& text) -> CanBusSetup {
  const std::string cure = "write an interface and node numbers from 1 to 126, as in can0:1,2";
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0) {
    refuse(quoted(text) + " names no bus with drives", cure);
  }
  CanBusSetup bus{.name = text.substr(0, colon), .nodes = {}};
  for (const std::string_view word : words_of(std::string_view(text).substr(colon + 1))) {
    unsigned node = 0;
    if (!whole(word, 1, cia402::kLastNode, node)) {
      refuse(quoted(word) + " is no node number", cure);
    }
    if (std::find(bus.nodes.begin(), bus.nodes.end(), node) != bus.nodes.end()) {
      refuse("Node " + std::to_string(node) + " is given twice for " + bus.name, "each drive has a number of its own");
    }
    bus.nodes.push_back(static_cast<std::uint8_t>(node));
  }
  return bus;
}

auto parse_pdo_layout(const std::string& text) -> cia402::PdoLayout {
  if (text != "separate" && text != "packed") {
    refuse(quoted(text) + " is no way to send set values", "write --pdo separate or --pdo packed");
  }
  return text == "packed" ? cia402::PdoLayout::kPacked : cia402::PdoLayout::kSeparate;
}

auto read_drive_profile(const std::string& file) -> cia402::DriveProfile {
  std::ifstream in(file);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  if (!in) {
    refuse("The drive profile " + file + " can not be read", "give a text file, as in hal/cia402/profiles");
  }
  return cia402::parse_profile(text, file);
}

auto parse_gpio(const std::string& text) -> GpioSetup {
  const std::string cure = "write the chip and its lines, as in /dev/gpiochip0:estop=3,enable=4,brake=!5,watchdog=6";
  constexpr unsigned kMostLines = 1023;
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0) {
    refuse(quoted(text) + " names no GPIO chip with lines", cure);
  }
  GpioSetup setup{.chip = text.substr(0, colon), .estop = {}, .enable = {}, .brake = {}, .watchdog = {}};
  std::vector<unsigned> used;
  for (std::string_view word : words_of(std::string_view(text).substr(colon + 1))) {
    const std::size_t equals = word.find('=');
    std::optional<GpioSetup::Line>* const line =
        equals == std::string_view::npos ? nullptr : line_of(setup, word.substr(0, equals));
    if (line == nullptr || line->has_value()) {
      refuse(quoted(word) + " is no line's duty, or one that is given twice", cure);
    }
    std::string_view digits = word.substr(equals + 1);
    const bool inverted = digits.starts_with('!');
    digits.remove_prefix(inverted ? 1 : 0);
    unsigned offset = 0;
    if (!whole(digits, 0, kMostLines, offset) || std::find(used.begin(), used.end(), offset) != used.end()) {
      refuse(quoted(word) + " is no line's number, or one that is given twice", cure);
    }
    used.push_back(offset);
    *line = GpioSetup::Line{.offset = offset, .inverted = inverted};
  }
  return setup;
}

void check(const CanSetup& setup) {
  std::size_t drives = 0;
  for (const CanBusSetup& bus : setup.buses) {
    drives += bus.nodes.size();
    if (std::count_if(setup.buses.begin(), setup.buses.end(),
                      [&bus](const CanBusSetup& other) { return other.name == bus.name; }) > 1) {
      refuse(bus.name + " is given twice", "name all its drives at once, as in --can " + bus.name + ":1,2");
    }
  }
  if (setup.buses.size() > kMostBuses || drives > kMostDrives) {
    refuse(std::to_string(drives) + " drives on " + std::to_string(setup.buses.size()) + " buses are too many",
           "a board has up to four on up to two");
  }
}

}  // namespace capstan
