// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/firmware/console/stream.hpp"
#include "capstan/firmware/loop/machine.hpp"

namespace capstan {

/// How long a stream's step may print. On a serial line a character takes 87 us, and whoever waits for room in it hears
/// neither `disarm` nor Ctrl-C nor the loss of a bus. So a step ends with the first line that the cycle overtook, and
/// on a line that takes everything at once it prints all there is.
class StepTime {
 public:
  explicit StepTime(const Machine& machine) : machine_(machine), tick_(machine.telemetry().tick) {}
  [[nodiscard]] auto left() const -> bool { return machine_.telemetry().tick == tick_; }

 private:
  const Machine& machine_;
  std::uint32_t tick_;
};

/// An answer of many lines that are there already: prints as many in a step as the console takes.
class PartsStream : public Stream {
 public:
  void step(Session& session) final;
  void cancel(Session& session) override;

 protected:
  /// Prints the part of this number, counted from 0: a few lines at most. False: it has ended the answer instead.
  virtual auto print(Session& session, std::uint32_t part) -> bool = 0;
  ~PartsStream() = default;

 private:
  std::uint32_t next_ = 0;
};

}  // namespace capstan
