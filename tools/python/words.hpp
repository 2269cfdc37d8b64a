// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace capstan::python {

/// The name of a log that was made of arrays.
inline constexpr const char* kArrays = "the arrays";

/// A sentence of the command line for a caller in Python: options are arguments, lines of a log of arrays are its rows,
/// counted from 0.
auto in_python(const std::string& sentence) -> std::string;

}  // namespace capstan::python
