// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace capstan::cia402 {

/// Everything that can be wrong with a bus or a drive on it. Each has a counter and a sentence.
enum class Anomaly : std::uint8_t {
  // frames of a drive
  kStatusLength,
  kStatusLate,
  kStatusRepeated,
  kStatusContradicts,
  kStatusMissing,
  kStatusUnknown,
  kHeartbeatLength,
  kHeartbeatState,
  kHeartbeatLost,
  kRestarted,
  kNotOperational,
  kEmergency,
  kEmergencyLength,
  kSdoLength,
  kSdoUnexpected,
  kSdoOtherObject,
  kSdoCommand,
  kSdoSize,
  kSdoTimeout,
  // the drive itself
  kDriveFault,
  kDroppedOut,
  kNotEnabled,
  kAnswersLate,
  kWrongMode,
  kModeUnknown,
  // the bus
  kUnknownId,
  kRemoteFrame,
  kExtendedFrame,
  kForeignSync,
  kFlood,
  kSyncStuck,
  kSendQueueFull,
  kLinkDown,
  kSendFailed,
  kReceiveFailed,
  kReceiveLost,
  kBusOff,
  kErrorPassive,
  kErrorWarning,
  kControllerOverflow,
  kNoAcknowledge,
  kBusError,
  kControllerRestarted,
  kCount
};
inline constexpr std::size_t kAnomalies = static_cast<std::size_t>(Anomaly::kCount);

struct AnomalyInfo {
  Anomaly anomaly;
  const char* name;
  const char* sentence;
  const char* cure;
};
auto info(Anomaly anomaly) -> const AnomalyInfo&;

/// What an emergency message carries.
struct Emergency {
  std::uint16_t code = 0;  ///< 0: an error is over
  std::uint8_t error_register = 0;
};
/// CiA 301 table 26 and CiA 402-2 annex: what the code means; for a code that is not listed, what its class means.
auto emergency_text(std::uint16_t code) -> const char*;
/// CiA 301 table 22: why a drive refused an SDO.
auto abort_text(std::uint32_t code) -> const char*;

/// What went wrong on one bus since start. The cycle writes, slow code reads; neither waits.
class Journal {
 public:
  static constexpr std::size_t kBus = 0;      ///< source: the bus as a whole
  static constexpr std::size_t kSources = 5;  ///< and up to four drives, from 1
  static constexpr std::size_t kEmergencies = 8;

  /// @param detail  what the sentence is about: a length, a statusword, an errno, a code
  void note(Anomaly anomaly, std::size_t source, std::uint32_t detail = 0) {
    Entry& entry = entries_[source][static_cast<std::size_t>(anomaly)];
    entry.detail.store(detail, std::memory_order_relaxed);
    entry.count.store(entry.count.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  }
  void note(const Emergency& emergency, std::size_t source) {
    const std::uint32_t number = count(Anomaly::kEmergency, source);
    emergencies_[source][number % kEmergencies].store(
        static_cast<std::uint32_t>(emergency.error_register) << 16U | emergency.code, std::memory_order_relaxed);
    note(Anomaly::kEmergency, source, emergency.code);
  }

  [[nodiscard]] auto count(Anomaly anomaly, std::size_t source) const -> std::uint32_t {
    return entries_[source][static_cast<std::size_t>(anomaly)].count.load(std::memory_order_acquire);
  }
  /// Of all sources.
  [[nodiscard]] auto count(Anomaly anomaly) const -> std::uint32_t {
    std::uint32_t sum = 0;
    for (std::size_t source = 0; source < kSources; ++source) {
      sum += count(anomaly, source);
    }
    return sum;
  }
  /// The latest one's.
  [[nodiscard]] auto detail(Anomaly anomaly, std::size_t source) const -> std::uint32_t {
    return entries_[source][static_cast<std::size_t>(anomaly)].detail.load(std::memory_order_relaxed);
  }
  /// Emergency number `number` of this source, from 0; the last kEmergencies are kept.
  [[nodiscard]] auto emergency(std::size_t source, std::uint32_t number) const -> Emergency {
    const std::uint32_t word = emergencies_[source][number % kEmergencies].load(std::memory_order_relaxed);
    return {static_cast<std::uint16_t>(word), static_cast<std::uint8_t>(word >> 16U)};
  }

 private:
  struct Entry {
    std::atomic<std::uint32_t> count = 0;
    std::atomic<std::uint32_t> detail = 0;
  };
  std::array<std::array<Entry, kAnomalies>, kSources> entries_{};
  std::array<std::array<std::atomic<std::uint32_t>, kEmergencies>, kSources> emergencies_{};
};

}  // namespace capstan::cia402
