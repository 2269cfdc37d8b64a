// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace capstan::tools {

/// The text of a log, in UTF-8 with '\n' at each line's end, whatever it came in: gzip, Zstandard or LZ4, UTF-16,
/// Latin-1, byte order mark, carriage returns alone. What was done that may surprise is added to `notes`. Throws
/// BadInput that names what the file is and the command that makes a log of it, if it is no text.
auto text_of_file(std::string bytes, const std::string& name, std::vector<std::string>& notes) -> std::string;

}  // namespace capstan::tools
