// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace capstan {

/// How the transmission passes force after a reversal (thesis 2.3).
enum class ForcePhase : std::uint8_t {
  kUnknown,       ///< the law has no phases, or nothing has reached the output since the start
  kHeld,          ///< I: nothing reaches the output
  kPulledActive,  ///< II: the pulled tendon moves in its whole length, the pushed one does not yet
  kBothActive,    ///< III: both do
  kOneSlack,      ///< IV: one tendon is slack, the other carries everything
};

/// What every force law answers.
template <typename Scalar>
struct ForceEstimate {
  Scalar force{};      ///< tip force or joint torque, in the unit of the law
  bool known = false;  ///< the start state no longer matters
  bool beyond_table =
      false;  ///< the input is outside what the law was measured on, or the law is not usable: see its constructor
  bool history_cut = false;  ///< this step found the memory full and dropped the smallest loop in it
  bool saturated = false;    ///< a number met the end of its range: the force is not to be trusted
  ForcePhase phase = ForcePhase::kUnknown;
};

/// The input that brings a force about.
template <typename Scalar>
struct InputCommand {
  Scalar input{};          ///< within what the law was measured on
  bool reachable = false;  ///< the force lies between the two saturations (or at one of them)
};

}  // namespace capstan
