// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace capstan {

inline constexpr const char* kVersion = CAPSTAN_VERSION;  // from the project() line of CMakeLists.txt

}  // namespace capstan
