// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace capstan::tools {

/// Motor boards of one bus.
struct DbcRequest {
  std::vector<std::uint8_t> nodes = {1};
  std::size_t axes = 4;
  std::string version;
};

/// The frames of boards/stm32f405/can_messages.hpp as a DBC file. Flags are signals of one bit each, by their names.
/// @pre nodes are 1 to 127 and differ, axes 1 to 4
auto dbc_text(const DbcRequest& request) -> std::string;

}  // namespace capstan::tools
