// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/campaign/rig.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "capstan/boards/common/file_banks.hpp"
#include "capstan/firmware/loop/application.hpp"
#include "capstan/hal/sim/instrument.hpp"
#include "capstan/tools/campaign/commissioned.hpp"
#include "capstan/tools/campaign/faulty_io.hpp"

namespace capstan::tools {
namespace {

constexpr double kSupplyMinV = 18.0;  // of 24
constexpr int kRestCycles = 300;      // from the start, and from arming, to whatever comes next
constexpr int kPeriodCycles = 2000;   // of every motion; its phases are parts of it
constexpr int kArmCycle = 100;        // after the onset, where a machine is disarmed at it
constexpr int kStandsCycles = 60;
constexpr double kStandsRadS = 0.02;
constexpr int kSecondFaultCycle = 50;
constexpr double kSlipRad = 0.1;
constexpr double kLooseShare = 0.9;

auto instrument_axis(const char* name, std::size_t axis) -> sim::PlantParameters {
  return sim::parse_instrument(sim::built_in_instrument(name), name).axes[axis].plant;
}

/// What goes wrong with the transmission is the plant's own.
void break_transmission(sim::PlantParameters& plant, Mode mode, double time_s) {
  if (mode == Mode::kSlips) {
    plant.effects.pulley_slip_rad = kSlipRad;
    plant.effects.pulley_slip_at_s = time_s;
  } else if (mode == Mode::kLoose) {
    plant.effects.pretension_change_n = -kLooseShare * plant.pretension_n;
    plant.effects.pretension_change_at_s = time_s;
  }
}

/// Firmware, joint and operator.
class Rig {
 public:
  Rig(const Scene& scene, const std::optional<Trouble>& trouble)
      : scene_(scene),
        trouble_(trouble),
        setup_(setup_of(scene.joint)),
        onset_(scene.situation == Situation::kStarting
                   ? 0
                   : 2 * kRestCycles + kPeriodCycles / 2 +
                         (has_phases(scene.situation) ? scene.phase * kPeriodCycles / kPhases : 0)),
        plant_(broken(), 3) {
    static_cast<void>(application_.configure({&setup_.config, 1}, Rights::kMaintenance));
  }

  auto run() -> RunResult {
    while (cycle_ < onset_) {
      operate();
      step();
    }
    begin_trouble();
    RunResult result;
    for (int since = 1; since <= kObservedCycles && !stood_; ++since) {
      if (trouble_ && trouble_->second && since == kSecondFaultCycle) {
        begin(*trouble_->second);
      }
      operate();
      const bool had_torque = energised(telemetry().state);
      const bool arming = since == kArmCycle + 1;
      step();
      note(result, since, had_torque);
      result.blocked |= !under_torque(scene_.situation) && arming && telemetry().state == State::kDisarmed;
    }
    result.end = telemetry().state;
    if (scene_.situation == Situation::kFaulted) {
      result.fault = telemetry().first_fault;
    }
    return result;
  }

 private:
  auto broken() -> sim::PlantParameters {
    sim::PlantParameters plant = setup_.plant;
    for (const OneFault& fault : faults()) {
      break_transmission(plant, fault.mode, onset_ * sim::kStepS);
    }
    return plant;
  }
  [[nodiscard]] auto faults() const -> std::vector<OneFault> {
    std::vector<OneFault> all;
    if (trouble_) {
      all.push_back(trouble_->first);
      if (trouble_->second) {
        all.push_back(*trouble_->second);
      }
    }
    return all;
  }
  void begin_trouble() {
    if (scene_.situation == Situation::kSaving) {
      static_cast<void>(application_.save());
    } else if (scene_.situation == Situation::kApplying) {
      AxisConfig next = setup_.config;
      next.control.kp = Q24::from_double(0.25);
      static_cast<void>(application_.configure({&next, 1}, Rights::kMaintenance));
    }
    if (!trouble_) {
      return;
    }
    if (trouble_->cut_at_onset) {
      post({.kind = Request::Kind::kDisarm});
    }
    begin(trouble_->first);
  }
  void begin(OneFault fault) {
    const double now = plant_.truth().time_s;
    if (fault.input == Input::kReference) {
      stream_.emplace(fault.mode, Sizes{.garbage = 100.0, .drift_per_s = 0.2, .coarse = 0.05});
    } else if (fault.mode == Mode::kTopBreaks || fault.mode == Mode::kBottomBreaks) {
      plant_.schedule(
          {.time_s = now + sim::kStepS,
           .target = fault.mode == Mode::kTopBreaks ? sim::FaultTarget::kTendonTop : sim::FaultTarget::kTendonBottom,
           .kind = sim::FaultKind::kSnap});
    } else if (fault.mode == Mode::kBrownout) {
      plant_.schedule({.time_s = now + sim::kStepS,
                       .target = sim::FaultTarget::kSupply,
                       .kind = sim::FaultKind::kDip,
                       .amount = 0.45,
                       .duration_s = 0.3});
      io_.begin(fault);
    } else if (fault.input != Input::kTransmission) {
      io_.begin(fault);
    }
  }

  /// What the operator or the host does in this cycle.
  void operate() {
    const int since = cycle_ - onset_;
    if (!under_torque(scene_.situation) && scene_.situation != Situation::kFaulted) {
      if (since == kArmCycle) {
        post({.kind = Request::Kind::kArm});
      }
      to_and_fro(since - kArmCycle - kRestCycles, 0.5);
      return;
    }
    if (cycle_ == kRestCycles) {
      post({.kind = Request::Kind::kArm});
    }
    switch (scene_.situation) {
      case Situation::kHolding:
        to_and_fro(since - kArmCycle, 0.5);
        break;
      case Situation::kMoving:
        to_and_fro(cycle_ - 2 * kRestCycles, 0.5);
        break;
      case Situation::kFast:
        to_and_fro(cycle_ - 2 * kRestCycles, 1.0);
        break;
      case Situation::kExperiment:
        if (cycle_ == 2 * kRestCycles) {
          begin_experiment();
        }
        break;
      case Situation::kFaulted:
        application_.set_board_faults(cycle_ == onset_ - 100 ? bit(Fault::kBoardClock) : 0);
        break;
      default:
        break;
    }
  }
  /// A move there and one back in each period. @param share  of the largest speed
  void to_and_fro(int since, double share) {
    if (since >= 0 && since % (kPeriodCycles / 2) == 0 && energised(telemetry().state)) {
      const bool there = since % kPeriodCycles == 0;
      const double speed = share * setup_.config.limits.joint_speed_rad_s.to_double();
      const double target = (there ? 1.0 : -1.0) * setup_.amplitude_rad * (share > 0.7 ? 2.0 : 1.0);
      post({.kind = Request::Kind::kMove,
            .position_rad = Q24::from_double(target),
            .speed_rad_s = Q24::from_double(speed)});
    }
  }
  void begin_experiment() {
    ExperimentSetup setup{.recipe = Recipe::kSpeedLadder, .amplitude = Q24::from_double(setup_.amplitude_rad)};
    setup.rungs = {Q24::from_double(0.7), Q24::from_double(1.2), Q24::from_double(1.7)};
    setup.rung_count = 3;
    setup.cycles = 2;
    if (const char* problem = application_.begin_experiment(setup)) {
      throw std::logic_error(problem);
    }
  }

  void step() {
    Application<FaultyIo>::Streamed streamed{};
    const double time_s = sim::kStepS * (cycle_ - 2 * kRestCycles);
    const double reference = setup_.amplitude_rad * std::sin(std::numbers::pi * std::max(time_s, 0.0));
    std::optional<double> sent;
    if (stream_) {
      sent = (*stream_)(reference);
    } else if (scene_.situation == Situation::kFollowing &&
               cycle_ > kRestCycles) {  // one from before arming is ignored
      sent = reference;
    }
    if (sent) {
      streamed[0] = {.kind = Request::Kind::kFollow, .position_rad = Q24::from_double(*sent)};
    }
    application_.rt_tick(streamed);
    ++cycle_;
  }
  void note(RunResult& result, int since, bool had_torque) {
    const MachineTelemetry now = telemetry();
    result.course.add(plant_.truth(), application_.axis_telemetry(0).q2_reference_rad.to_double());
    if (result.detected_ms < 0 && (now.conditions != 0 || (had_torque && !energised(now.state)))) {
      result.detected_ms = since;
      result.fault = now.first_fault != Fault::kNone ? now.first_fault : lowest(now.conditions);
    }
    if (result.detected_ms >= 0 && result.off_after_cycles < 0 && !io_.enabled()) {
      result.off_after_cycles = since - result.detected_ms;
    }
    result.torque_returned |= now.state == State::kFaulted && io_.enabled();
    const bool still = result.off_after_cycles >= 0 && std::fabs(plant_.truth().q2_rate_rad_per_s) < kStandsRadS;
    still_ = still ? still_ + 1 : 0;
    stood_ = still_ >= kStandsCycles && now.state == State::kFaulted;
  }
  [[nodiscard]] auto telemetry() const -> MachineTelemetry { return application_.telemetry(); }
  void post(const Request& request) { static_cast<void>(application_.post(request)); }

  Scene scene_;
  std::optional<Trouble> trouble_;
  JointSetup setup_;
  int onset_;
  sim::Plant plant_;
  SimIo plant_io_{plant_};
  FaultyIo io_{plant_io_, setup_.plant.encoder_counts_per_turn / (2.0 * std::numbers::pi)};
  FileBanks banks_ = FileBanks::temporary();
  Application<FaultyIo> application_{io_, banks_};
  std::optional<Corruption> stream_;
  int cycle_ = 0;
  int still_ = 0;
  bool stood_ = false;
};

}  // namespace

auto plain_setup(Joint joint) -> JointSetup {
  JointSetup setup;
  switch (joint) {
    case Joint::kForceps:
      break;
    case Joint::kStiff:
      setup.config.control.stiffness_nm_per_rad = Q24::from_double(2.0);
      setup.config.control.damping_nms_per_rad = Q24::from_double(0.01);
      break;
    case Joint::kContact:
      setup.plant.environment = {.kind = sim::EnvironmentKind::kSpring, .stiffness = 0.3};
      setup.amplitude_rad = 0.15;
      break;
    case Joint::kFinger:
      setup.plant = instrument_axis("robot_finger", 0);
      setup.plant.effects.gravity_torque_nm = 0.03;
      break;
    case Joint::kElbow:
      setup.plant = instrument_axis("raven2", 1);
      setup.config.limits.continuous_current_a =
          Q24::from_double(3.0);  // its friction takes 2.4 A for as long as it moves
      break;
    case Joint::kWristPitch:
      setup.plant = instrument_axis("da_vinci_wrist", 0);
      break;
    case Joint::kWristJaw:
      setup.plant = instrument_axis("da_vinci_wrist", 1);
      break;
  }
  setup.plant.stop_low_rad = -2.2;
  setup.plant.stop_high_rad = 2.2;
  setup.plant.stop_stiffness_nm_per_rad = 5.0;
  AxisConfig& config = setup.config;
  config.motor.encoder_counts_per_turn = static_cast<std::int32_t>(setup.plant.encoder_counts_per_turn);
  config.motor.torque_per_current_nm_per_a = Q24::from_double(setup.plant.torque_constant_nm_per_a);
  config.law.coefficients[0] = Q24::from_double(setup.plant.input_radius_m / setup.plant.output_radius_m);
  config.limits.supply_min_v = Q24::from_double(kSupplyMinV);
  // More than the amplifier gives and its sensor shows would be a current that differs from the wanted one.
  const double most_a = std::min(setup.plant.current_limit_a, setup.plant.current_full_scale_a);
  config.limits.current_a = std::min(config.limits.current_a, Q24::from_double(most_a));
  config.limits.continuous_current_a = std::min(config.limits.continuous_current_a, config.limits.current_a);
  return setup;
}

namespace {

/// The supply is the rig's own input; while a joint is commissioned nobody measures it.
auto commissioned_setup(Joint joint) -> JointSetup {
  constexpr std::uint64_t kSeed = 17;  // not the campaign's own
  JointSetup setup = plain_setup(joint);
  AxisConfig config = setup.config;
  config.limits.supply_min_v = Q24{};
  setup.config.observer = commissioned(setup.plant, config, kSeed);
  return setup;
}

}  // namespace

auto setup_of(Joint joint) -> const JointSetup& {
  static const auto kAll = [] {
    std::array<JointSetup, kJoints.size()> setups;
    std::transform(kJoints.begin(), kJoints.end(), setups.begin(), commissioned_setup);
    return setups;
  }();
  return kAll[static_cast<std::size_t>(joint)];
}

auto run_scene(const Scene& scene, const std::optional<Trouble>& trouble) -> RunResult {
  return Rig(scene, trouble).run();
}

}  // namespace capstan::tools
