// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "capstan/tools/response/tuning.hpp"

namespace capstan::tools {

/// The points, what is distorted, and how far the loop is from -1, as text.
auto response_text(const Response& response) -> std::string;
/// Plant, gains, margins and what limits them, as text.
auto tuning_text(const Tuning& tuning, const LoopGains& present) -> std::string;
/// Bode, coherence and Nyquist, of backward and forward by themselves where they differ (views_of), with the circles of
/// 95 %, in folder/index.html, self-contained. Returns the page's path. Throws BadInput if the folder can not be
/// written.
/// @param axis  of the gains' lines
auto write_response_report(const std::string& folder, const Response& response, const std::optional<Tuning>& tuning,
                           int axis) -> std::string;

}  // namespace capstan::tools
