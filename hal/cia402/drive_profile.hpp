// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "capstan/hal/cia402/drive_link.hpp"

namespace capstan::cia402 {

/// What a kind of drive does otherwise than CiA 301 and 402 lead to expect, as data.
struct DriveProfile {
  /// Which values an object may have, best first.
  struct Values {
    Object object;  ///< without length where the object is one of the set-up's own
    std::vector<std::uint32_t> values;
  };

  std::string name;
  std::string note;  ///< said at start, such as what was not verified
  // Which drives it is for; all that are given have to fit (1018:01, 1018:02, the node number).
  std::optional<std::uint32_t> vendor;
  std::optional<std::uint32_t> product;
  std::optional<std::uint8_t> node;

  std::optional<Object> rated_current;            ///< stands for 6075, in mA
  std::optional<std::uint32_t> rated_current_ma;  ///< where no object says it
  std::size_t objects_per_message = PdoMap::kMostObjects;
  std::uint32_t answer_ms = DriveSetting::kMostCyclesToAnswer;  ///< to a controlword, at best
  std::chrono::milliseconds sdo_timeout{1000};
  bool stops_without_master = false;  ///< torque goes when heartbeats stay out, although no object says so
  std::vector<Values> values;         ///< replace those of the set-up's own table
  std::vector<Values> required;       ///< of the maker's own objects: must be there and have one of them
};

/// Reads a profile. @param origin  its file, for the sentence  Throws std::runtime_error with "sentence; cure".
auto parse_profile(std::string_view text, const std::string& origin) -> DriveProfile;
/// The drives in `profiles/`.
auto known_profiles() -> const std::vector<DriveProfile>&;
/// The first that fits; none if the drive needs no profile.
auto find_profile(std::span<const DriveProfile> profiles, std::uint8_t node, std::optional<std::uint32_t> vendor,
                  std::optional<std::uint32_t> product) -> const DriveProfile*;

}  // namespace capstan::cia402
