// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/support/named_files.hpp"

#include <algorithm>
#include <filesystem>

#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

void expect_apart(const std::vector<NamedFile>& read, const std::vector<NamedFile>& written) {
  for (auto output = written.begin(); output != written.end(); ++output) {
    const auto is_output = [&](const NamedFile& other) { return same_file(other.path, output->path); };
    if (const auto input = std::find_if(read.begin(), read.end(), is_output); input != read.end()) {
      throw BadInput(output->option + " would replace " + input->path + ", which " + input->option + " reads; give " +
                     output->option + " another name");
    }
    if (const auto other = std::find_if(written.begin(), output, is_output); other != output) {
      throw BadInput(other->option + " and " + output->option + " would write the same file " + output->path +
                     "; give each its own name");
    }
  }
}

void expect_place_of(const NamedFile& file) {
  namespace fs = std::filesystem;
  std::error_code none;  // what can not be looked at is said by the write
  if (file.is_folder) {
    fs::path there = fs::absolute(file.path);
    while (!fs::exists(there, none) && there.has_relative_path()) {
      there = there.parent_path();
    }
    if (fs::exists(there, none) && !fs::is_directory(there, none)) {
      throw BadInput(file.option + " " + file.path + ": " + there.string() + " is a file; name a folder, new or old");
    }
    return;
  }
  const auto folder = fs::path(file.path).parent_path();
  if (!folder.empty() && !fs::is_directory(folder, none)) {
    throw BadInput(file.option + " " + file.path + ": there is no folder " + folder.string() +
                   "; make it, or name another one");
  }
  if (fs::is_directory(file.path, none)) {
    throw BadInput(file.option + " " + file.path + " is a folder; name a file in it");
  }
}

}  // namespace

void expect_sound_files(const std::vector<NamedFile>& read, const std::vector<NamedFile>& written) {
  std::for_each(written.begin(), written.end(), expect_place_of);
  expect_apart(read, written);
}

}  // namespace capstan::tools
