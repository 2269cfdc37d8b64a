// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "capstan/firmware/loop/exchange.hpp"
#include "capstan/firmware/loop/machine.hpp"
#include "capstan/firmware/parameters/parameters.hpp"

namespace capstan {

/// The firmware of a board: the cycle on one side, the machine that the shell sees on the other. `rt_tick` belongs to
/// the timer interrupt or the real-time thread, everything else to the background.
template <JointIo Io>
class Application final : public Machine {
 public:
  static constexpr std::size_t kAxes = Io::kAxes;
  using Streamed = std::array<Request, kAxes>;
  static_assert(stored_bytes(kAxes) <= kBankLimit, "a bank holds fewer: lower CAPSTAN_PREISACH_LEVELS or the axes");

  /// Starts disarmed with what the storage holds, or with defaults if nothing was ever saved. If what is there is not
  /// sound, it is defaults too, and arming is blocked until a set is saved or loaded.
  /// @param fault_memory  FaultLog::words_for(kAxes) words that outlive a reset; empty: faults are not logged
  Application(Io& io, Banks& banks, std::span<std::uint32_t> fault_memory = {})
      : io_(io), storage_(banks), load_report_(load_at_start()), state_(config_), fault_log_(fault_memory, kAxes) {
    published_.rt_publish({});
    const LoadResult start = load_report_.result;
    const bool unusable = start == LoadResult::kCorrupt || start == LoadResult::kForeign;
    parameter_faults_.store(unusable                           ? bit(Fault::kModelInvalid)
                            : start == LoadResult::kUnreadable ? bit(Fault::kStorageFailed)
                                                               : 0,
                            std::memory_order_relaxed);
    for (std::size_t i = 0; i < kAxes; ++i) {
      state_.axis[i].begin_at_heat(fault_log_.heat(i));
    }
  }

  /// One cycle. `streamed` carries references that arrived since the last one; kNone where none did.
  void rt_tick(const Streamed& streamed = {}) {
    rt_take_config();
    Sensed<kAxes> sensed;
    const Status read = io_.read(sensed);
    const Drive<kAxes> drive = cycle(state_, sensed, rt_command(streamed));
    state_.drive_faults = 0;
    if (read == Status::kFailed) {
      io_.release();
    } else if (io_.write(drive) != Status::kOk) {
      io_.release();
      state_.drive_faults = bit(Fault::kDriveFailed);  // or torque would come back with the next write that succeeds
    }
    rt_publish();
  }

  /// The console is gone: whatever moves must not go on. Takes torque away within a cycle, and leaves a latched fault
  /// for the operator to see. Callable from the background at any time.
  void link_lost() { static_cast<void>(post({.kind = Request::Kind::kRest})); }

  /// What the board itself found wrong since it started. Callable from the background at any time.
  void set_board_faults(FaultSet faults) { board_faults_.store(faults, std::memory_order_relaxed); }

  auto axes() const -> std::size_t override { return kAxes; }
  auto telemetry() const -> MachineTelemetry override { return published_.read().machine; }
  auto axis_telemetry(std::size_t axis) const -> AxisTelemetry override { return published_.read().axis[axis]; }
  auto config() const -> std::span<const AxisConfig> override { return config_; }
  auto staging(const void* owner) -> std::span<AxisConfig> override {
    if (staging_owner_ != nullptr && staging_owner_ != owner) {
      return {};
    }
    staging_owner_ = owner;
    return staged_;
  }
  void end_staging(const void* owner) override { staging_owner_ = staging_owner_ == owner ? nullptr : staging_owner_; }
  auto configure(std::span<const AxisConfig> axes, Rights rights) -> SetAnswer override {
    const std::size_t count = std::min(axes.size(), kAxes);
    const bool live = has_torque();
    for (std::size_t axis = 0; axis < count; ++axis) {
      SetAnswer answer = judge_change(config_[axis], axes[axis], rights, live);
      const ParameterInfo* nobody = impossible_joint(axes[axis], axis, kAxes);
      if (answer.taken() && nobody != nullptr) {
        answer = {.refusal = SetAnswer::Refusal::kNoSuchJoint, .limit = nobody};
      }
      if (!answer.taken()) {
        answer.axis = axis;
        return answer;
      }
    }
    if (config_waits_.load(std::memory_order_acquire)) {
      return {.refusal = SetAnswer::Refusal::kBusy};
    }
    std::copy_n(axes.begin(), count, config_.begin());
    config_waits_.store(true, std::memory_order_release);
    return {};
  }
  auto post(const Request& request) -> bool override {
    if (request.kind == Request::Kind::kDisarm || request.kind == Request::Kind::kRest) {
      off_.fetch_or(request.kind == Request::Kind::kDisarm ? kOffDisarm : kOffRest, std::memory_order_release);
      return true;
    }
    return request.axis < kAxes && request_box_.offer(request);
  }
  auto requests_taken() const -> bool override {
    return off_.load(std::memory_order_acquire) == 0 && !off_under_way_.load(std::memory_order_acquire) &&
           request_box_.empty() && !config_waits_.load(std::memory_order_acquire) && scope_.requests_taken() &&
           recorder_.requests_taken() && experiment_box_.empty();
  }
  auto save() -> bool override {
    const bool saved = !has_torque() && storage_.save(config_, key_);
    if (saved) {
      load_report_ = {.result = LoadResult::kLoaded};
      parameter_faults_.store(0, std::memory_order_relaxed);
    }
    return saved;
  }
  auto load() -> LoadResult override {
    if (has_torque() || config_waits_.load(std::memory_order_acquire) || staging_owner_ != nullptr) {
      return LoadResult::kRefused;
    }
    staged_.fill(kDefaultAxis);
    const LoadReport report = storage_.load(staged_, &key_);
    if (report.result == LoadResult::kLoaded) {
      // Sound, for the storage has checked it; nothing waits and torque is off.
      static_cast<void>(configure(staged_, Rights::kMaintenance));
      parameter_faults_.store(0, std::memory_order_relaxed);
    }
    load_report_ = report;
    return report.result;
  }
  auto load_report() const -> const LoadReport& override { return load_report_; }
  auto maintenance_key() const -> KeyDigest override { return key_; }
  void set_maintenance_key(const KeyDigest& key) override { key_ = key; }
  auto recorder() -> Recorder& override { return recorder_; }
  auto scope() -> Scope& override { return scope_; }
  auto fault_log() -> FaultLog& override { return fault_log_; }
  auto palpation() -> Palpation& override { return palpation_; }
  auto begin_experiment(const ExperimentSetup& setup) -> const char* override {
    if (setup.axis >= kAxes) {
      return "there is no such joint; choose another";
    }
    const char* problem = check_experiment(setup, config_[setup.axis]);
    if (problem == nullptr && !experiment_box_.offer(setup)) {
      problem = "the cycle has not taken the last experiment yet; send the line again";
    }
    return problem;
  }

 private:
  struct Snapshot {
    MachineTelemetry machine;
    std::array<AxisTelemetry, kAxes> axis{};
  };
  auto load_at_start() -> LoadReport {
    const LoadReport report = storage_.load(config_, &key_);
    if (report.result != LoadResult::kLoaded) {
      config_.fill(kDefaultAxis);
    }
    return report;
  }

  /// Also while a request that may give torque is under way. In this order: what the cycle has taken from the box shows
  /// in the state.
  [[nodiscard]] auto has_torque() const -> bool { return !request_box_.empty() || energised(telemetry().state); }

  /// The experiment's command, if one runs and the joints are still its own.
  void rt_experiment(Command<kAxes>& command) {
    const State state = state_.supervisor.state();
    if (const ExperimentSetup* setup = experiment_box_.rt_peek()) {
      experiment_.rt_start(*setup);
      if (state != State::kHolding) {
        experiment_.rt_end();
      }
      experiment_taken_ = true;
    } else if (!energised(state)) {
      experiment_.rt_end();
    }
    if (experiment_.active()) {
      rt_leave_if_streamed(command, experiment_.axis());  // or it would take the joint when the experiment ends
      command.axis[experiment_.axis()] = experiment_.rt_step(state_.axis[experiment_.axis()]);
      command.experiment = experiment_.active();
    }
  }

  void rt_take_config() {
    if (config_waits_.load(std::memory_order_acquire)) {
      for (std::size_t i = 0; i < kAxes; ++i) {
        state_.axis[i].rt_configure(config_[i]);
      }
      config_waits_.store(false, std::memory_order_release);
    }
    state_.board_faults = board_faults_.load(std::memory_order_relaxed);
    state_.model_faults = parameter_faults_.load(std::memory_order_relaxed);
  }

  /// The operator takes the joint back.
  void rt_end_experiment(Command<kAxes>& command, std::size_t axis) {
    if (axis == experiment_.axis()) {
      experiment_.rt_end();
      command.experiment = false;
    }
  }

  /// What the operator asks of a joint that a stream moves ends that stream: it would take the joint back a cycle
  /// later.
  void rt_leave_stream(std::size_t axis) {
    if (state_.axis[axis].streamed()) {
      left_streams_ |= 1U << axis;
      silent_cycles_[axis] = 0;
    }
  }

  /// A stream that runs while somebody else has the joint, or nobody.
  void rt_leave_if_streamed(const Command<kAxes>& command, std::size_t axis) {
    if (command.axis[axis].kind != Request::Kind::kNone) {
      left_streams_ |= 1U << axis;
    }
  }

  /// Until the sender has paused.
  void rt_ignore_streams(Command<kAxes>& command) {
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
      silent_cycles_[axis] = command.axis[axis].kind == Request::Kind::kNone ? silent_cycles_[axis] + 1 : 0;
      if (silent_cycles_[axis] >= kPauseCycles) {
        left_streams_ &= ~(1U << axis);
      } else if ((left_streams_ >> axis & 1U) != 0) {
        command.axis[axis] = {};
      }
    }
  }

  /// What takes torque away, which needs no room and outranks all else of the cycle. Looked at before the mailbox, so
  /// that of an arm and what followed it the latter is never carried out first.
  [[nodiscard]] auto rt_take_off() -> std::uint32_t {
    if (off_.load(std::memory_order_relaxed) == 0) {
      return 0;
    }
    off_under_way_.store(true, std::memory_order_relaxed);
    return off_.exchange(0, std::memory_order_acq_rel);
  }

  /// Streamed references, over them an experiment's, and over them what the shell asked for.
  auto rt_command(const Streamed& streamed) -> Command<kAxes> {
    Command<kAxes> command{.axis = streamed};
    const State state = state_.supervisor.state();
    if (!energised(state)) {  // torque would come with the motion that a stream asks for
      for (std::size_t axis = 0; axis < kAxes; ++axis) {
        rt_leave_if_streamed(command, axis);
      }
    }
    if (left_streams_ != 0) {
      rt_ignore_streams(command);
    }
    rt_experiment(command);
    // What is asked for before the first cycle waits for the second, which can carry it out.
    const bool first = state == State::kBoot;
    const std::uint32_t off = first ? 0 : rt_take_off();
    const Request* request = first ? nullptr : request_box_.rt_peek();
    if (request != nullptr) {
      switch (request->kind) {
        case Request::Kind::kArm:
          command.arm = true;
          command.cautious = request->cautious;
          break;
        case Request::Kind::kZero:
          command.axis[request->axis] = *request;
          break;
        default:
          rt_end_experiment(command, request->axis);
          rt_leave_stream(request->axis);
          command.axis[request->axis] = *request;
          break;
      }
      acknowledge_ = true;
    }
    command.arm = command.arm && off == 0;
    command.disarm = (off & kOffDisarm) != 0;
    command.rest = off != 0;
    return command;
  }

  void rt_publish() {
    Snapshot now;
    now.machine = state_.telemetry;
    now.machine.experiment = experiment_.phase();
    for (std::size_t i = 0; i < kAxes; ++i) {
      now.axis[i] = state_.axis[i].telemetry();
    }
    recorder_.rt_step(now.machine, now.axis);  // first: who sees that a run is over finds all of it
    published_.rt_publish(now);
    scope_.rt_step(now.machine, now.axis);
    fault_log_.rt_step(now.machine, now.axis);
    if (!energised(now.machine.state)) {  // one joint in a cycle is enough
      const std::size_t i = now.machine.tick % kAxes;
      fault_log_.rt_keep_heat(i, state_.axis[i].heat());
    }
    if (acknowledge_) {  // after publishing, so that whoever waits for the answer sees the state it led to
      acknowledge_ = false;
      request_box_.rt_taken();
    }
    off_under_way_.store(false, std::memory_order_release);
    if (experiment_taken_) {
      experiment_taken_ = false;
      experiment_box_.rt_taken();
    }
  }

  Io& io_;
  ParameterStorage storage_;
  Config<kAxes> config_{};                  // the background's copy, which it leaves alone while ...
  std::atomic<bool> config_waits_ = false;  // ... the cycle is to take it
  Config<kAxes> staged_{};
  const void* staging_owner_ = nullptr;
  KeyDigest key_;  // the background's own
  LoadReport load_report_;
  CycleState<kAxes> state_;  // the cycle's
  bool acknowledge_ = false;
  Mailbox<Request> request_box_;
  Published<Snapshot> published_;
  Recorder recorder_;
  static constexpr std::uint32_t kPauseCycles = 100;  // after which a stream is another one, as on the bus
  std::uint32_t left_streams_ = 0;                    // a bit a joint
  std::array<std::uint32_t, kAxes> silent_cycles_{};  // of the streams that were left
  Experiment experiment_;
  bool experiment_taken_ = false;
  Mailbox<ExperimentSetup> experiment_box_;
  Scope scope_;
  FaultLog fault_log_;
  Palpation palpation_;
  static constexpr std::uint32_t kOffRest = 1;
  static constexpr std::uint32_t kOffDisarm = 2;
  std::atomic<std::uint32_t> off_ = 0;       // kOff... that the cycle is to carry out,
  std::atomic<bool> off_under_way_ = false;  // and is carrying out
  std::atomic<FaultSet> board_faults_ = 0;
  std::atomic<FaultSet> parameter_faults_ = 0;
};

}  // namespace capstan
