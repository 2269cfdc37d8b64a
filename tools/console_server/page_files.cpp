// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/console_server/page_files.hpp"

#include <array>
#include <filesystem>
#include <vector>

#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

struct Name {
  const char* asked;
  const char* file;
  const char* type;
};
constexpr std::array kNames = {Name{"", "served.html", "text/html; charset=utf-8"},
                               Name{"console.js", "console.js", "text/javascript; charset=utf-8"},
                               Name{"console.css", "console.css", "text/css; charset=utf-8"},
                               Name{"icon.svg", "icon.svg", "image/svg+xml"}};

auto page_folder(const std::string& given) -> std::filesystem::path {
  std::vector<std::filesystem::path> folders = {given};
  if (given.empty()) {
    const auto program = std::filesystem::read_symlink("/proc/self/exe").parent_path();
    folders = {program / "../../browser/site", program / "../share/capstan/console"};
  }
  for (const auto& folder : folders) {
    if (std::filesystem::exists(folder / kNames.front().file)) {
      return folder;
    }
  }
  throw BadInput((given.empty() ? std::string("the page") : given + ": the page") +
                 " is not there; build it (cmake --workflow --preset browser), or give its folder with --page");
}

}  // namespace

auto read_page_files(const std::string& folder) -> PageFiles {
  const std::filesystem::path from = page_folder(folder);
  PageFiles files;
  for (const Name& name : kNames) {
    files[name.asked] = {name.type, read_text_file((from / name.file).string())};
  }
  return files;
}

}  // namespace capstan::tools
