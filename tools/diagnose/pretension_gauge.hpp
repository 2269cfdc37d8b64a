// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/diagnose/diagnosis.hpp"
#include "capstan/tools/diagnose/preparation.hpp"
#include "capstan/tools/identify/loop.hpp"

namespace capstan::tools {

/// Says what the tendons' pretension is or, beside a healthy joint's law, has become, in one sentence; the size of a
/// pretension that was named is the same figure.
/// @param now  the loop of these logs, where it was compared with the healthy joint's; else something beside the
///             tendons holds the joint
void gauge_pretension(const Preparation& p, const DiagnoseOptions& options, const std::optional<Loop>& now,
                      Diagnosis& d);

}  // namespace capstan::tools
