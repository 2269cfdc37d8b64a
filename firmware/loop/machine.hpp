// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "capstan/firmware/control/experiment.hpp"
#include "capstan/firmware/control/palpation.hpp"
#include "capstan/firmware/loop/cycle.hpp"
#include "capstan/firmware/parameters/storage.hpp"
#include "capstan/firmware/safety/fault_log.hpp"
#include "capstan/firmware/telemetry/recorder.hpp"
#include "capstan/firmware/telemetry/scope.hpp"

namespace capstan {

/// The machine as slow code sees it: the shell on one side, an application of any number of joints on the other.
/// Nothing here waits for the cycle or makes it wait.
class Machine {
 public:
  [[nodiscard]] virtual auto axes() const -> std::size_t = 0;
  [[nodiscard]] virtual auto telemetry() const -> MachineTelemetry = 0;
  [[nodiscard]] virtual auto axis_telemetry(std::size_t axis) const -> AxisTelemetry = 0;
  /// The parameters in force.
  [[nodiscard]] virtual auto config() const -> std::span<const AxisConfig> = 0;
  /// Room for one console at a time to put a set together, one element a joint, and what it left there until it lets go
  /// of it. Empty: somebody else is at it.
  virtual auto staging(const void* owner) -> std::span<AxisConfig> = 0;
  virtual void end_staging(const void* owner) = 0;
  /// Hands a set to the cycle, which takes it whole before its next step; or says why not, and nothing is changed. The
  /// one place where a set is judged, whoever brings it.
  virtual auto configure(std::span<const AxisConfig> axes, Rights rights) -> SetAnswer = 0;
  /// Hands a request to the cycle, one at a time. False: the last one is still under way, or there is no such joint.
  /// What takes torque away (kDisarm, kRest) waits for no other and is never refused; the request that the cycle takes
  /// with it gives no torque.
  virtual auto post(const Request& request) -> bool = 0;
  /// True once the cycle has carried out or refused the last request and taken the last parameters.
  [[nodiscard]] virtual auto requests_taken() const -> bool = 0;
  /// False: torque is on (saving may stop the processor) or the storage failed. The old set is then still there.
  virtual auto save() -> bool = 0;
  /// Takes the stored parameters into force. The room for staging serves it: kRefused also while somebody has it.
  virtual auto load() -> LoadResult = 0;
  /// What the last load made of what was stored, at start or since; after a save there is nothing to report.
  [[nodiscard]] virtual auto load_report() const -> const LoadReport& = 0;
  /// Digest of the maintenance key in force, as loaded or set last; save() keeps it. Who may set it is the caller's
  /// business.
  [[nodiscard]] virtual auto maintenance_key() const -> KeyDigest = 0;
  virtual void set_maintenance_key(const KeyDigest& key) = 0;
  virtual auto recorder() -> Recorder& = 0;
  virtual auto scope() -> Scope& = 0;
  virtual auto fault_log() -> FaultLog& = 0;
  /// For whoever has the recorder.
  virtual auto palpation() -> Palpation& = 0;
  /// Hands an experiment to the cycle, which begins it if every joint holds still; or says why not, "sentence; cure",
  /// and nothing moves: what check_experiment() has against it, no such joint, or the last one still under way to the
  /// cycle. nullptr: handed over.
  [[nodiscard]] virtual auto begin_experiment(const ExperimentSetup& setup) -> const char* = 0;

 protected:
  ~Machine() = default;  // never owned through this face: a virtual one would need operator delete
};

}  // namespace capstan
