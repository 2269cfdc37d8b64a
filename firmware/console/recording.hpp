// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "capstan/firmware/console/session.hpp"

namespace capstan {

/// A log by the contract, as several commands print it: header, rows, and a remark about samples that found no room.
struct Recording {
  RecorderSetup setup;            ///< whose last signal, the experiment's phase, is not printed
  std::uint32_t print_every = 1;  ///< of what is recorded, in cycles whose number divides by this
  std::int32_t site = -1;         ///< that is palpated; -1: none

  /// The signals of every log, of one joint.
  void choose(std::size_t axis);
  /// Prints the header. False: the recorder is not free, and that was answered.
  auto begin(Session& session) -> bool;
  /// Prints the sample if it is one of those to be printed.
  void print_row(Print& out, const SignalSample& sample) const;
  /// How many samples found no room.
  auto end(Session& session) -> std::uint32_t;

 private:
  std::uint32_t dropped_before_ = 0;
};

/// Takes the recorder for this console. False: it is not free, and that was answered.
auto start_recorder(Session& session, const RecorderSetup& setup) -> bool;

}  // namespace capstan
