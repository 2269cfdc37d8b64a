// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <deque>
#include <optional>
#include <vector>

#include "capstan/hal/cia402/frame.hpp"
#include "capstan/hal/cia402_sim/peculiarity.hpp"
#include "capstan/hal/sim/plant.hpp"

namespace capstan::drive_sim {

using cia402::Frame;
using cia402::Time;

/// A CiA 402 drive in cyclic synchronous torque mode with a simulated axis behind it, seen from the bus. SYNC is its
/// millisecond: what an RPDO brought takes effect at the next one, TPDOs are sampled there, and the axis goes on by
/// 1 ms. Without SYNC the axis stands still and only network timing goes on.
class SimulatedDrive {
 public:
  SimulatedDrive(std::uint8_t node, const sim::PlantParameters& axis, std::uint64_t seed,
                 Peculiarities peculiarities = {});

  /// A frame from the bus. Answers are appended to `out`.
  void receive(const Frame& frame, Time now, std::vector<Frame>& out);
  /// What happens by itself: boot-up, heartbeat, a missed master. Call it every millisecond or so.
  void tick(Time now, std::vector<Frame>& out);

  /// Something in the drive fails: fault and emergency message with this code.
  void fail(std::uint16_t code, std::vector<Frame>& out);
  /// Its supply failed and came back: it starts anew with what the factory set.
  void restart();

  [[nodiscard]] auto node() const -> std::uint8_t { return node_; }
  [[nodiscard]] auto enabled() const -> bool { return state_ == State::kOperationEnabled; }
  [[nodiscard]] auto faulted() const -> bool { return state_ == State::kFault; }
  [[nodiscard]] auto operational() const -> bool { return nmt_ == Nmt::kOperational; }
  [[nodiscard]] auto statusword() const -> std::uint16_t;
  /// Of the motor, A; 0 without torque.
  [[nodiscard]] auto current_a() const -> double;
  [[nodiscard]] auto truth() const -> const sim::Truth& { return plant_.truth(); }
  [[nodiscard]] auto objects() -> ObjectDictionary& { return objects_; }

 private:
  enum class Nmt : std::uint8_t { kStarting, kStopped = 4, kOperational = 5, kPreOperational = 127 };
  enum class State : std::uint8_t {
    kSwitchOnDisabled,
    kReadyToSwitchOn,
    kSwitchedOn,
    kOperationEnabled,
    kFault,
  };

  void receive_nmt(const Frame& frame);
  void receive_sdo(const Frame& frame, Time now, std::vector<Frame>& out);
  auto answer_sdo(const Frame& request, Frame& answer) -> std::optional<std::uint32_t>;
  auto answer_read(std::uint16_t index, std::uint8_t subindex, Frame& answer) -> std::optional<std::uint32_t>;
  auto answer_write(const Frame& request, Frame& answer) -> std::optional<std::uint32_t>;
  void sample();
  [[nodiscard]] auto has(Peculiarity peculiarity) const -> bool { return peculiarities_.contains(peculiarity); }
  [[nodiscard]] auto value_or(std::uint16_t index, std::uint8_t subindex, std::uint32_t otherwise) const
      -> std::uint32_t;
  void receive_rpdo(std::size_t number, const Frame& frame, std::vector<Frame>& out);
  void receive_sync(std::vector<Frame>& out);
  void unpack(std::size_t number, const Frame& frame);
  auto pack(std::size_t number) const -> Frame;
  void leave_operational(Nmt next);
  void obey_controlword();
  auto mapped_bytes(std::uint16_t index) const -> std::size_t;

  struct Sample {
    std::uint32_t statusword = 0;
    std::uint32_t position = 0;
  };
  struct Answer {
    Time due{};
    Frame frame;
  };

  std::uint8_t node_;
  Peculiarities peculiarities_;
  ObjectDictionary objects_;
  sim::Plant plant_;
  Nmt nmt_ = Nmt::kStarting;
  State state_ = State::kSwitchOnDisabled;
  std::uint16_t last_controlword_ = 0;
  std::array<std::optional<Frame>, 4> latched_;  // RPDOs that wait for SYNC
  std::optional<Time> next_heartbeat_;
  std::optional<Time> last_master_;
  std::optional<Time> boots_at_;
  std::deque<Sample> samples_;         // the last ones, for who sends old ones
  std::deque<Answer> answers_;         // that take their time
  std::optional<std::uint32_t> rest_;  // of an answer in segments
  std::uint8_t rest_bytes_ = 0;
};

}  // namespace capstan::drive_sim
