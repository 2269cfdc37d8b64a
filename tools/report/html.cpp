// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/report/html.hpp"

namespace capstan::tools {

auto escaped(const std::string& text) -> std::string {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

auto html_cell(const std::string& text, const char* tag, const std::string& attributes) -> std::string {
  return std::string("<") + tag + attributes + ">" + escaped(text) + "</" + tag + ">";
}

auto html_number(const std::string& text) -> std::string {
  return html_cell(text, "td", " class=\"n\"");
}

}  // namespace capstan::tools
