// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "capstan/tools/thesis/table.hpp"

/// The tables of the reference thesis (F. Anooshahpour, 2017) on the simulated instruments, beside the printed figures.
/// The instruments are what their files say; nothing of them is fitted to a table.
namespace capstan::tools {

/// Slack instants: torque, eta and the constant I, of a locked tip under a triangle of torque.
auto table_2_1_and_2_2() -> ThesisTable;
/// da Vinci micro-forceps: estimation of the joint angle.
auto table_5_2() -> ThesisTable;
/// da Vinci micro-forceps: control through the estimate.
auto table_5_3() -> ThesisTable;
/// da Vinci wrist, both jaws: dynamic law.
auto table_6_2() -> ThesisTable;
/// RAVEN II elbow.
auto table_7_2() -> ThesisTable;

}  // namespace capstan::tools
