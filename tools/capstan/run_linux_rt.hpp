// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace capstan::tools {

/// Becomes the program of the linux_rt board, which lies beside this one, with these arguments. Returns only by
/// throwing BadInput.
[[noreturn]] void run_linux_rt(std::vector<std::string> words);

}  // namespace capstan::tools
