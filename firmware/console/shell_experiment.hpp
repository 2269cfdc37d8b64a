// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/firmware/console/recording.hpp"

namespace capstan {

/// The rows of an experiment while it runs, and how it ended.
struct ExperimentStream final : Stream {
  ExperimentSetup setup;
  Recording recording;
  bool palpating = false;  ///< with a law that tells stiffness

  /// Begins `setup`, as `recording` shows it. False: it can not begin now, and that was answered.
  auto begin(Session& session) -> bool;
  void step(Session& session) override;
  void cancel(Session& /*session*/) override { cancelled_ = true; }

 private:
  auto print_rows(Session& session) -> bool;
  void answer(Session& session, const MachineTelemetry& now);

  bool cancelled_ = false;
};

/// Answers that nothing moves, and why. @param problem  "sentence; cure"
void refuse_experiment(Session& session, const char* problem);
/// Hands the setup to the cycle, whose recorder is this console's. False: it was refused, which was answered, and the
/// recorder is free again.
auto hand_over(Session& session, const ExperimentSetup& setup) -> bool;

/// Whether an experiment is one that measures a frequency response, by its name and the words behind it.
auto asks_for_response(std::string_view recipe, std::string_view arguments) -> bool;
/// Begins such a one, or says why not.
void begin_response(Session& session, std::string_view recipe, std::size_t axis, std::string_view arguments);
/// The last signal that the log of such an experiment prints, and no other log.
inline constexpr std::string_view kResponseMark = "excitation";

/// What was palpated last, and the map of all sites.
void print_stiffness(Session& session);
/// @param factor  times the median from which on a site is marked
void print_palpation_map(Session& session, Q24 factor);

}  // namespace capstan
