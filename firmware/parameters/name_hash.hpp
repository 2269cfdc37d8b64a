// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

namespace capstan {

/// What stands for a parameter's name in the storage: FNV-1a of the joint's number, group, a dot and name.
constexpr auto name_hash(std::size_t axis, std::string_view group, std::string_view name) -> std::uint32_t {
  std::uint32_t hash = 2166136261U;
  const auto add = [&hash](std::uint8_t byte) { hash = (hash ^ byte) * 16777619U; };
  add(static_cast<std::uint8_t>(axis));
  for (const char c : group) {
    add(static_cast<std::uint8_t>(c));
  }
  add('.');
  for (const char c : name) {
    add(static_cast<std::uint8_t>(c));
  }
  return hash;
}

}  // namespace capstan
