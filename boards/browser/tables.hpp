// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace capstan {

/// What the firmware and the simulator know about themselves and no shell command prints, one entry a line, fields
/// separated by tabs:
///   version VERSION | state NAME torque(0|1) | transition FROM TRIGGER TO | fault NUMBER NAME CAUSE CURE
///   instrument NAME AXES | effect NAME FIELD LOW HIGH primary(0|1)
[[nodiscard]] auto tables() -> std::string;

}  // namespace capstan
