// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/thesis/rig.hpp"

#include <cmath>
#include <numbers>

namespace capstan::tools {
namespace {

constexpr int kRecordEvery = 10;  // ms

class Pid {
 public:
  explicit Pid(const Gains& gains) : gains_(gains), dt_s_(0.001 * gains.every_ms) {}

  auto step(double error) -> double {
    const double rate = started_ ? (error - last_) / dt_s_ : 0.0;
    integral_ += dt_s_ * error;
    last_ = error;
    started_ = true;
    return gains_.kp_a_per_rad * error + gains_.kd_as_per_rad * rate + gains_.ki_a_per_rads * integral_;
  }

 private:
  Gains gains_;
  double dt_s_;
  double integral_ = 0.0;
  double last_ = 0.0;
  bool started_ = false;
};

/// What can be measured of a motor.
struct Motor {
  explicit Motor(const sim::PlantParameters& p)
      : rad_per_count(2.0 * std::numbers::pi / p.encoder_counts_per_turn),
        torque_constant(p.torque_constant_nm_per_a) {}
  [[nodiscard]] auto angle_rad(const sim::Readings& r) const -> double { return rad_per_count * r.encoder_counts; }
  [[nodiscard]] auto torque_nm(const sim::Readings& r) const -> double { return torque_constant * r.current_a; }
  double rad_per_count;
  double torque_constant;
};

}  // namespace

auto thesis_gains() -> Gains {
  return {0.05 * kDegreesPerRadian, 0.0004 * kDegreesPerRadian, 0.01 * kDegreesPerRadian, 10};
}

auto stiff_gains() -> Gains {
  return {20.0, 0.05, 40.0, 1};
}

auto run_experiment(const std::vector<sim::InstrumentAxis>& instrument, std::size_t axis, const sim::Motion& motion,
                    const Gains& gains, std::uint64_t seed, const Controlled& controlled) -> Experiment {
  sim::MultiPlant plant(instrument, seed);
  std::vector<Motor> motors;
  std::vector<Pid> loops;
  for (std::size_t i = 0; i < instrument.size(); ++i) {
    motors.emplace_back(instrument[i].plant);
    loops.emplace_back(i == axis ? gains : stiff_gains());
  }
  const auto steps = static_cast<long>(std::lround(1000.0 * motion.duration_s()));
  const Eigen::Index rows = steps / kRecordEvery;
  Experiment result;
  result.wanted_rad.resize(rows);
  AxisLog& log = result.log;
  log.name = instrument[axis].name;
  log.period_s = 0.001 * kRecordEvery;
  log.has_torque = true;
  for (Eigen::VectorXd* column : {&log.time_s, &log.q1_rad, &log.tau_nm, &log.q2_rad}) {
    column->resize(rows);
  }
  std::vector<sim::MotorCommand> commands(instrument.size(), {0.0, true});
  double held = 0.0;
  for (long step = 0; step < rows * kRecordEvery; ++step) {
    const double time_s = 0.001 * static_cast<double>(step);
    for (std::size_t i = 0; i < instrument.size(); ++i) {
      const double q1 = motors[i].angle_rad(plant.readings(i));
      const double tau = motors[i].torque_nm(plant.readings(i));
      if (i == axis && step % kRecordEvery == 0) {
        held = controlled ? controlled(q1, tau) : q1;
        const Eigen::Index row = step / kRecordEvery;
        result.wanted_rad[row] = motion.reference_rad(time_s);
        log.time_s[row] = time_s;
        log.q1_rad[row] = q1;
        log.tau_nm[row] = tau;
        log.q2_rad[row] = plant.truth(i).q2_camera_rad;
      }
      if (i == axis && step % gains.every_ms == 0) {
        commands[i].current_a = loops[i].step(motion.reference_rad(time_s) - (controlled ? held : q1));
      } else if (i != axis) {
        commands[i].current_a = loops[i].step(-q1);
      }
    }
    plant.step(commands);
  }
  return result;
}

}  // namespace capstan::tools
