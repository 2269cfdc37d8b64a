// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <string>
#include <vector>

namespace capstan::tools::machines {

/// A machine's log by the contract.
struct DrawnMachine {
  std::string name;  ///< kind, motion and seed
  std::vector<std::string> columns;
  Eigen::MatrixXd rows;
};

/// Machines by the laws of others, numbers and motions drawn by chance: what a diagnosis is chosen on must not be
/// measured machines alone, for there are few. Ten joints with a sensor: hysteresis of Bouc and Wen, alone, under an
/// eccentric pulley, with a drift, with another joint's, before a four-bar linkage and skewed as in a sheath; backlash
/// before a curved ratio, and before creep; Maxwell slip; a spring before Dahl's friction, its torque logged. Eleven
/// axes with an effort: friction of LuGre, of Stribeck, of a power law, asymmetric, with the load, with the speed
/// squared, and warming; a spring with a dead zone, cogging, Bouc-Wen in a spring, and an effort that saturates.
/// Five pendulums on a servo and three gears between two torques (drawn_drives.hpp).
/// Motions: sines, triangles of several heights, a decaying sine, reaches with rests, a chirp. 25 to 70 s at 30 to 200
/// Hz with noise of 0.15 to 1.2 %, or 15 to 45 s at 50 to 500 Hz with noise of 1 to 8 %.
/// The same for a seed, by one compiler: what is drawn within one expression may come in another order.
auto drawn_machines(std::uint64_t seed) -> std::vector<DrawnMachine>;

/// A CSV file each. @param digits  of a number
void write_machines(const std::string& folder, const std::vector<DrawnMachine>& machines, int digits = 7);

}  // namespace capstan::tools::machines
