// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/plant/hybrid.hpp"

#include <cmath>
#include <cstdio>
#include <limits>

#include "capstan/tests/model/support.hpp"
#include "capstan/tests/tools/plant/plant_gauge.hpp"
#include "capstan/tests/tools/plant/plant_joint.hpp"
#include "capstan/tests/tools/run/by_hand.hpp"
#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/identify/tendon_fit.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools::plant {
namespace {

/// Turned by hand, so that no control has to hold the joint; the motor's own friction is then not in the torque.
auto wander(const sim::PlantParameters& plant, double spring_nm_per_rad, Eigen::VectorXd* angle) -> AxisLog {
  sim::PlantParameters touching = plant;
  if (std::isinf(spring_nm_per_rad)) {
    touching.environment.kind = sim::EnvironmentKind::kLocked;
  } else if (spring_nm_per_rad > 0.0) {
    touching.environment = {.kind = sim::EnvironmentKind::kSpring, .stiffness = spring_nm_per_rad};
  }
  const double reach = pull_of(plant);
  const capstan::test::RandomMultisine motion(14, 1.0, 0.03, 0.4);
  return test::turn_by_hand(
      touching, 60.0, [reach, &motion](double t) { return reach * std::tanh(3.0 * motion(t) + std::sin(0.5 * t)); },
      angle);
}

}  // namespace

auto hybrid_law(const sim::PlantParameters& plant, std::uint64_t seed) -> JointFile {
  const std::vector<AxisLog> logs = free_and_held(plant, seed);
  return identify(logs, form_of_model(kTendonModel, logs)).joint;
}

auto torque_range(const sim::PlantParameters& plant) -> double {
  const AxisLog log = wander(plant, std::numeric_limits<double>::infinity(), nullptr);
  return log.effort.maxCoeff() - log.effort.minCoeff();
}

auto hybrid_error(const JointFile& law, const sim::PlantParameters& plant, double spring_nm_per_rad, double range_nm)
    -> HybridError {
  constexpr Eigen::Index kSettles = 10'000;
  Eigen::VectorXd angle;
  const AxisLog log = wander(plant, spring_nm_per_rad, &angle);
  MotionLaw<Q24> board(SamplePeriod<Q24>(1000), to_fixed(motion_parameters(law)));
  Eigen::VectorXd angle_error(log.samples());
  Eigen::VectorXd torque_error(log.samples());
  double moving = 0.0;
  for (Eigen::Index i = 0; i < log.samples(); ++i) {
    // By hand the motor's friction is missing; the law expects it, in the direction of motion.
    const double way = i > 0 ? log.q1_rad[i] - log.q1_rad[i - 1] : 0.0;
    moving = way != 0.0 ? std::copysign(plant.motor_coulomb_nm, way) : moving;
    const Estimate<Q24> now = board.update(Q24::from_double(log.q1_rad[i]), Q24::from_double(log.tau_nm[i] + moving));
    angle_error[i] = now.q2.to_double() - angle[i];
    torque_error[i] = board.joint_torque().force.to_double() - log.effort[i];
  }
  const Eigen::Index tail = log.samples() - kSettles;
  return {rms(angle_error.tail(tail)), rms(torque_error.tail(tail)) / range_nm,
          log.effort.tail(tail).cwiseAbs().maxCoeff()};
}

void ask_hybrid(std::uint64_t first, int joints) {
  for (int i = 0; i < joints; ++i) {
    const std::uint64_t seed = first + static_cast<std::uint64_t>(i);
    const sim::PlantParameters plant = drawn_plant(seed);
    try {
      const JointFile law = hybrid_law(plant, seed);
      const double range = torque_range(plant);
      for (const double spring : {0.0, 0.02, 0.1, 0.5, 2.0, std::numeric_limits<double>::infinity()}) {
        const HybridError error = hybrid_error(law, plant, spring, range);
        std::printf(
            "seed %llu, tip on %g Nm/rad: q2 off by %.2f camera noises, torque by %.2f %% of %.3f Nm (%.3f here)\n",
            static_cast<unsigned long long>(seed), spring, error.angle_rad / plant.camera_noise_rad,
            100.0 * error.torque_share, range, error.largest_nm);
        std::fflush(stdout);
      }
    } catch (const std::exception& error) {
      std::printf("seed %llu: %s\n", static_cast<unsigned long long>(seed), error.what());
    }
  }
}

}  // namespace capstan::tools::plant
