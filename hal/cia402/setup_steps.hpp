// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "capstan/hal/cia402/drive_profile.hpp"

namespace capstan::cia402 {

/// One object of a drive that has to be as it is needed. What a drive takes otherwise is a row of the table, or of its
/// profile, and not code.
struct SetupStep {
  enum class Action : std::uint8_t {
    kRead,     ///< must have one of the values, if there are any
    kWrite,    ///< has the first of the values that the drive takes and gives back when read
    kDisable,  ///< a PDO: its present COB-ID with bit 31 set, because CiA 301 keeps bits 0 to 29 while it is valid
  };
  /// What becomes of a drive that lacks the object or takes none of the values.
  enum class Need : std::uint8_t {
    kRequired,       ///< it is refused
    kIfThere,        ///< it is refused, but not for lacking the object: without it there is nothing that could be wrong
    kOptional,       ///< what is lost is said
    kOnLoss,         ///< that its torque goes when this firmware is gone has to be proved in another way
    kOnLossIfThere,  ///< the same, but not for lacking the object
  };
  enum class Meaning : std::uint8_t {
    kNothing,
    kVendor,
    kProduct,
    kRatedCurrent,
    kTorqueLimit,
    kConsumerTime,
    kMode,
    kStatusMapping,
  };
  Object object;
  Action action = Action::kWrite;
  Need need = Need::kRequired;
  std::vector<std::uint32_t> values;  ///< acceptable ones, best first
  std::uint32_t mask = 0xFFFFFFFF;    ///< bits that are compared
  Meaning meaning = Meaning::kNothing;
  const char* lost = "";  ///< without the object, or with another value than the first
  const char* cure = "it would not be safe to enable it; set this object with the maker's tool, or use another drive";

  /// Place of the first acceptable value that this is; values.size() if it is none.
  [[nodiscard]] auto rank(std::uint32_t value) const -> std::size_t;
  /// A value as it is said.
  [[nodiscard]] auto text(std::uint32_t value) const -> std::string;
};

/// "object 6007:00, abort connection option code".
auto object_text(const Object& object) -> std::string;

/// That it is a drive, and whose.
auto identity_steps() -> std::vector<SetupStep>;
/// Everything a drive needs before it may be enabled: that it has the mode that we use, nothing stored that moves it or
/// turns it round, what it does when it loses us (1016, 6007, 605A, 605E: torque off), the mode, and which objects
/// travel in its messages.
auto setup_steps(const DriveMaps& maps, const DriveProfile& profile) -> std::vector<SetupStep>;

inline constexpr std::uint32_t kPdoNotValid = 0x80000000;  ///< in its COB-ID
inline constexpr std::uint32_t kPdoNoRemote = 0x40000000;

}  // namespace capstan::cia402
