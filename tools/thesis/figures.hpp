// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <numbers>
#include <string>
#include <vector>

#include "capstan/tools/thesis/page.hpp"

namespace capstan::tools {

inline constexpr double kTurn = 2.0 * std::numbers::pi;
inline const std::array<std::string, 8> kColours = {"#1d4ed8", "#c2410c", "#0f766e", "#7c3aed",
                                                    "#be185d", "#4d7c0f", "#0369a1", "#444"};

auto plot_of(std::string title, std::string x, std::string y) -> Plot;
auto hertz(double frequency) -> std::string;

/// The figures of chapters 2 to 4, tip held: force, palpation, Preisach.
auto force_figures() -> std::vector<ThesisFigure>;
/// The figures of chapters 5 to 7: motion.
auto motion_figures() -> std::vector<ThesisFigure>;
/// The study that section 8.2.3 asks for: one and two idlers, stop and go.
auto study_figures() -> std::vector<ThesisFigure>;

}  // namespace capstan::tools
