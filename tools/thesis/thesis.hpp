// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "capstan/tools/thesis/table.hpp"

/// The tables of the reference thesis (F. Anooshahpour, 2017) on the simulated instruments, beside the printed figures.
/// Instruments are named by their chapter: the grasper of ch. 2 and 3, the forceps of ch. 4, the micro-forceps of ch.
/// 5, the wrist of ch. 6, RAVEN II of ch. 7. What is fitted to a table is marked in it.
namespace capstan::tools {

/// Slack instants: torque, eta and the constant I, of a locked tip under a triangle of torque.
auto table_2_1_and_2_2() -> ThesisTable;
/// Grasper: weights of the blend of both force models.
auto table_2_27() -> ThesisTable;
/// Forceps, tip locked: the classical Preisach model on three motions.
auto table_4_1() -> ThesisTable;
/// The same motions by other laws, and by other grids, all from one run.
auto table_4_1_laws() -> ThesisTable;
/// Micro-forceps: what identification returns.
auto table_5_1() -> ThesisTable;
/// Micro-forceps: estimation of the joint angle.
auto table_5_2() -> ThesisTable;
/// Micro-forceps: control through the estimate.
auto table_5_3() -> ThesisTable;
/// Wrist: what identification returns, and why (5.29) does not.
auto table_6_1() -> ThesisTable;
/// Wrist, both jaws: dynamic law.
auto table_6_2() -> ThesisTable;
/// RAVEN II elbow.
auto table_7_1() -> ThesisTable;
auto table_7_2() -> ThesisTable;
/// Stop and go over rotating idlers, the study that section 8.2.3 asks for.
auto table_8_2_3() -> ThesisTable;

/// Control errors of a row of table 5.3, one for each torque per ampere: what that is fitted by.
/// @param own  with the micro-forceps' own tendons and late pictures
auto control_errors_deg(const std::vector<double>& torques_per_ampere, std::size_t signal, bool own)
    -> std::vector<double>;

}  // namespace capstan::tools
