// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace capstan::tools {

struct PageFile {
  std::string type;
  std::string body;
};

/// The page's files by the names under which they are asked for, "" being the page itself. Nothing else is served.
using PageFiles = std::map<std::string, PageFile, std::less<>>;

/// @param folder  where tools/console was built to; empty: beside this program, as built or as installed
/// Throws BadInput with a sentence if there is no page.
auto read_page_files(const std::string& folder) -> PageFiles;

}  // namespace capstan::tools
