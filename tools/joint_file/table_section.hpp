// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "capstan/tools/joint_file/joint_file.hpp"

namespace capstan::tools {

/// The form-free term: in a joint.toml its knots and values are lists, not a line for each.
inline constexpr const char* kTableTerm = "table";

/// The lines of its section.
///   signal = "motor_angle"
///   knots = [-1, 0, 1]                 # in the signal's unit, increasing, evenly spaced
///   forward = [0.01, 0, -0.01]         # rad
///   backward = [0.02, 0, -0.02]
///   factor = "torque"                  # left out: none; else the values are in rad per unit of it
auto table_text(const JointFile& joint, const CatalogueTerm& term) -> std::string;

/// Words for TableSignal, in its order.
auto table_signal_words() -> const std::vector<std::string>&;

/// Words for TableFactor, in its order.
auto table_factor_words() -> const std::vector<std::string>&;

/// The signal that a table is over and its factor, in words for people: "motor rate, rad/s, times motor torque, Nm".
auto described_table(const double* shapes) -> std::string;

/// Slots of the coupling that its signal needs.
auto slots_of_table(const JointFile& joint) -> std::size_t;

/// A table as lists. Both directions have a value for every knot.
struct TableLists {
  std::size_t signal = 0;
  std::vector<double> knots, forward, backward;
  std::size_t factor = 0;
};

/// What is wrong with it, with the cure; empty: nothing.
auto fault_of(const TableLists& table) -> std::string;
/// Puts it into the law's numbers. @pre fault_of() finds nothing
void set_table(const TableLists& table, JointFile& joint);

}  // namespace capstan::tools
