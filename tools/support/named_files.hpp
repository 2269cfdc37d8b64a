// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace capstan::tools {

/// A file that an option or an argument names.
struct NamedFile {
  std::string option, path;
  bool is_folder = false;  ///< of a report, which makes it
};

/// Throws BadInput where a file that is written is one that is read or is written twice, where its folder is not there,
/// where it is a folder, or a folder a file. Found out before minutes of work, or before a joint moves.
void expect_sound_files(const std::vector<NamedFile>& read, const std::vector<NamedFile>& written);

}  // namespace capstan::tools
