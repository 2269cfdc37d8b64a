// SPDX-License-Identifier: Apache-2.0
#include "tools/campaign/fault_campaign.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>

#include "boards/common/file_banks.hpp"
#include "firmware/application.hpp"
#include "tools/campaign/faulty_io.hpp"

namespace capstan::tools {
namespace {

constexpr std::array kInputs = {Input::kEncoder,       Input::kCurrent, Input::kAmplifier, Input::kReference,
                                Input::kEmergencyStop, Input::kClock,   Input::kSupply};
constexpr std::array kModes = {Mode::kOff,  Mode::kStuck,   Mode::kGarbage,      Mode::kWrongSign,
                               Mode::kSlow, Mode::kDelayed, Mode::kIntermittent, Mode::kNan};
constexpr std::array kSituations = {Situation::kDisarmed,  Situation::kHolding,    Situation::kMoving,
                                    Situation::kFollowing, Situation::kExperiment, Situation::kFaulted};

constexpr double kSupplyMinV = 18.0;  // of 24
constexpr int kSettleCycles = 1500;
constexpr int kObservedCycles = 5000;
constexpr int kRestCycles = 1000;  // of a disarmed machine before somebody arms it
/// A joint that goes on is as good as its limits ask: the following error, and what it may grow until that is a fault.
constexpr double kToleratedRad = 0.5;

/// Firmware, joint and operator.
class Rig {
 public:
  explicit Rig(Situation situation) : situation_(situation) {
    AxisConfig config;
    config.limits.supply_min_v = Q24::from_double(kSupplyMinV);
    static_cast<void>(application_.configure({&config, 1}));
    step();
    if (situation == Situation::kDisarmed) {
      run(kSettleCycles);
      return;
    }
    post({.kind = Request::Kind::kArm});
    run(kSettleCycles);
    if (situation == Situation::kMoving) {
      move(kFarRad);
      run(kIntoTheMoveCycles);
    }
    if (situation == Situation::kExperiment) {
      static_cast<void>(application_.begin_experiment({.recipe = Recipe::kTriangle,
                                                       .amplitude = Q24::from_double(kFarRad),
                                                       .rungs = {Q24::from_int(1)},
                                                       .rung_count = 1,
                                                       .cycles = 1000}));
      run(kIntoTheExperimentCycles);
    }
    if (situation == Situation::kFaulted) {
      application_.set_board_faults(bit(Fault::kBoardClock));
      step();
      application_.set_board_faults(0);
      step();
    }
  }

  auto observe(std::optional<std::pair<Input, Mode>> fault) -> CampaignRow {
    CampaignRow row;
    row.situation = situation_;
    if (fault) {
      row.input = fault->first;
      row.mode = fault->second;
      if (row.input == Input::kReference) {
        stream_.emplace(row.mode, 100.0, false);
      } else {
        io_.begin(row.input, row.mode);
      }
    }
    const double begin = plant_.truth().q2_rad;
    bool blocked = false;
    int detected = -1;
    for (int cycle = 1; cycle <= kObservedCycles; ++cycle) {
      const bool had_torque = energised(telemetry().state);
      if (situation_ == Situation::kDisarmed && cycle == kRestCycles) {
        post({.kind = Request::Kind::kArm});
      }
      if (moves() && cycle % kMoveCycles == 0 && energised(telemetry().state)) {
        move(cycle / kMoveCycles % 2 == 0 ? kFarRad : -kFarRad);
      }
      step();
      const MachineTelemetry now = telemetry();
      row.travel_rad = std::max(row.travel_rad, std::fabs(plant_.truth().q2_rad - begin));
      if (detected < 0 && (now.conditions != 0 || (had_torque && !energised(now.state)))) {
        detected = cycle;
        row.fault = now.first_fault != Fault::kNone ? now.first_fault : lowest(now.conditions);
      }
      if (detected >= 0 && row.off_after_cycles < 0 && !io_.enabled()) {
        row.off_after_cycles = cycle - detected;
      }
      torque_returned_ |= row.off_after_cycles >= 0 && io_.enabled();
      if (energised(now.state)) {
        const double reference = application_.axis_telemetry(0).q2_reference_rad.to_double();
        row.error_rad = std::max(row.error_rad, std::fabs(plant_.truth().q2_rad - reference));
      }
      blocked |= situation_ == Situation::kDisarmed && cycle == kRestCycles && now.state == State::kDisarmed;
    }
    row.detected_ms = detected;
    row.end = telemetry().state;
    row.fault = situation_ == Situation::kFaulted ? telemetry().first_fault : row.fault;
    row.outcome = judge(row, blocked);
    return row;
  }

 private:
  static constexpr int kMoveCycles = 700;
  static constexpr int kIntoTheMoveCycles = 300;
  static constexpr int kIntoTheExperimentCycles = 1000;
  static constexpr double kFarRad = 0.6;

  [[nodiscard]] auto moves() const -> bool {
    return situation_ == Situation::kMoving || situation_ == Situation::kDisarmed;
  }
  static auto lowest(FaultSet faults) -> Fault {
    for (const FaultInfo& entry : kFaultTable) {
      if ((faults & bit(entry.fault)) != 0) {
        return entry.fault;
      }
    }
    return Fault::kNone;
  }
  auto judge(const CampaignRow& row, bool blocked) const -> Outcome {
    const bool off_in_time = row.off_after_cycles >= 0 && row.off_after_cycles <= 2 && !torque_returned_;
    if (situation_ == Situation::kFaulted) {  // it was before, and whatever else goes wrong changes nothing
      return row.end == State::kFaulted && row.fault == Fault::kBoardClock && !io_.enabled() ? Outcome::kFaulted
                                                                                             : Outcome::kUnsafe;
    }
    if (row.end == State::kFaulted && row.fault != Fault::kNone && off_in_time) {
      return Outcome::kFaulted;
    }
    if (blocked && row.end == State::kDisarmed && row.fault != Fault::kNone && off_in_time) {
      return Outcome::kBlocked;
    }
    if (energised(row.end) && row.fault == Fault::kNone && row.error_rad <= kToleratedRad) {
      return Outcome::kTolerated;
    }
    return Outcome::kUnsafe;
  }
  [[nodiscard]] auto telemetry() const -> MachineTelemetry { return application_.telemetry(); }
  void move(double target_rad) {
    post({.kind = Request::Kind::kMove,
          .position_rad = Q24::from_double(target_rad),
          .speed_rad_s = Q24::from_double(1.0)});
  }
  void post(const Request& request) { static_cast<void>(application_.post(request)); }
  void run(int cycles) {
    for (int i = 0; i < cycles; ++i) {
      step();
    }
  }
  void step() {
    Application<FaultyIo>::Streamed streamed{};
    constexpr double kHz = 0.5;
    const double reference = 0.3 * std::sin(2.0 * std::numbers::pi * kHz * sim::kStepS * cycle_++);
    std::optional<double> sent;
    if (stream_) {
      sent = (*stream_)(reference);
    } else if (situation_ == Situation::kFollowing) {
      sent = reference;
    }
    if (sent) {
      streamed[0] = {AxisCommand::Kind::kFollow, Q24::from_double(*sent), {}};
    }
    application_.rt_tick(streamed);
  }

  Situation situation_;
  sim::Plant plant_{sim::PlantParameters{}, 3};
  SimIo plant_io_{plant_};
  FaultyIo io_{plant_io_};
  FileBanks banks_ = FileBanks::temporary();
  Application<FaultyIo> application_{io_, banks_};
  std::optional<Corruption> stream_;
  int cycle_ = 0;
  bool torque_returned_ = false;
};

auto why_impossible(Input input, Mode mode) -> const char* {
  if (mode == Mode::kNan && input != Input::kEncoder && input != Input::kCurrent && input != Input::kSupply) {
    return input == Input::kEmergencyStop || input == Input::kClock ? "a bit or a count is always a number"
                                                                    : "fixed point has no NaN";
  }
  if (input == Input::kEmergencyStop && (mode == Mode::kStuck || mode == Mode::kSlow)) {
    return "a stop that does not open is the hardware's: it cuts the set value without the firmware";
  }
  if (input == Input::kClock && mode == Mode::kOff) {
    return "without edges no cycle runs: the watchdog resets the board within 29.9 ms";
  }
  return nullptr;
}

}  // namespace

auto run_without_fault(Situation situation) -> CampaignRow {
  return Rig(situation).observe(std::nullopt);
}

auto run_fault_campaign() -> std::vector<CampaignRow> {
  std::vector<CampaignRow> rows;
  for (const Input input : kInputs) {
    for (const Mode mode : kModes) {
      for (const Situation situation : kSituations) {
        const char* impossible = why_impossible(input, mode);
        CampaignRow row;
        if (impossible == nullptr) {
          row = Rig(situation).observe(std::pair(input, mode));
        }
        row.input = input;
        row.mode = mode;
        row.situation = situation;
        row.impossible = impossible;
        rows.push_back(row);
      }
    }
  }
  return rows;
}

auto name(Input input) -> const char* {
  static constexpr std::array kNames = {"encoder",        "current", "amplifier", "reference",
                                        "emergency stop", "clock",   "supply"};
  return kNames[static_cast<std::size_t>(input)];
}
auto name(Mode mode) -> const char* {
  static constexpr std::array kNames = {"off",  "stuck",   "garbage",      "wrong sign",
                                        "slow", "delayed", "intermittent", "NaN"};
  return kNames[static_cast<std::size_t>(mode)];
}
auto name(Situation situation) -> const char* {
  static constexpr std::array kNames = {"disarmed", "holding", "moving", "following", "experiment", "faulted"};
  return kNames[static_cast<std::size_t>(situation)];
}
auto name(Outcome outcome) -> const char* {
  static constexpr std::array kNames = {"faulted", "blocked", "tolerated", "UNSAFE"};
  return kNames[static_cast<std::size_t>(outcome)];
}

void print_campaign(std::ostream& out, const std::vector<CampaignRow>& rows) {
  std::array<char, 200> line{};
  std::snprintf(line.data(), line.size(), "%-14s %-12s %-10s %-9s %-10s %-16s %11s %9s %8s %7s\n", "input", "mode",
                "while", "outcome", "state", "fault", "detected ms", "off after", "travel", "error");
  out << line.data();
  std::array<int, 5> counts{};
  std::array<int, kFaultTable.size()> longest{};
  for (const CampaignRow& row : rows) {
    if (row.impossible != nullptr) {
      ++counts[4];
      if (row.situation == Situation::kDisarmed) {
        std::snprintf(line.data(), line.size(), "%-14s %-12s %-10s can not be: %s\n", name(row.input), name(row.mode),
                      "any", row.impossible);
        out << line.data();
      }
      continue;
    }
    ++counts[static_cast<std::size_t>(row.outcome)];
    if (row.situation != Situation::kDisarmed && row.situation != Situation::kFaulted) {
      int& most = longest[static_cast<std::size_t>(row.fault)];
      most = std::max(most, row.detected_ms);
    }
    const std::string detected = row.detected_ms < 0 ? "-" : std::to_string(row.detected_ms);
    const std::string off = row.off_after_cycles < 0 ? "-" : std::to_string(row.off_after_cycles);
    std::snprintf(line.data(), line.size(), "%-14s %-12s %-10s %-9s %-10s %-16s %11s %9s %8.3f %7.3f\n",
                  name(row.input), name(row.mode), name(row.situation), name(row.outcome), capstan::name(row.end),
                  info(row.fault).name, detected.c_str(), off.c_str(), row.travel_rad, row.error_rad);
    out << line.data();
  }
  out << "\ntimes are from the onset in ms, travel and error of the true joint in rad; longest detection under "
         "torque\n";
  for (const FaultInfo& entry : kFaultTable) {
    if (const int ms = longest[static_cast<std::size_t>(entry.fault)]; entry.fault != Fault::kNone && ms > 0) {
      out << "  " << entry.name << " " << ms << " ms\n";
    }
  }
  out << counts[0] << " faulted, " << counts[1] << " blocked, " << counts[2] << " tolerated, " << counts[3]
      << " unsafe, " << counts[4] << " that can not be\n";
}

}  // namespace capstan::tools
