// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace capstan::tools {

/// Text made safe for HTML and SVG.
auto escaped(const std::string& text) -> std::string;

/// A table's cell. @param attributes  as they stand in the tag, each behind a space
auto html_cell(const std::string& text, const char* tag = "td", const std::string& attributes = "") -> std::string;
/// One that is set as numbers are.
auto html_number(const std::string& text) -> std::string;

}  // namespace capstan::tools
