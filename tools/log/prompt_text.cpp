// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/prompt_text.hpp"

#include <algorithm>
#include <cctype>

#include "capstan/tools/log/csv_cells.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

constexpr std::string_view kHeader = "time_s,";

auto is_failure(std::string_view line) -> bool {
  return line.starts_with("error ");
}

/// A line that ends the answer to a command.
auto is_verdict(std::string_view line) -> bool {
  return line == "ok" || is_failure(line);
}

auto is_row(std::string_view line) -> bool {
  return !line.empty() && std::isdigit(static_cast<unsigned char>(line.front())) != 0;
}

template <typename Visit>
void for_each_line(std::string_view text, Visit&& visit) {
  std::size_t number = 1;
  for (std::size_t begin = 0; begin < text.size(); ++number) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    visit(trimmed(text.substr(begin, end - begin)), number);
    begin = end + 1;
  }
}

}  // namespace

auto without_prompt(std::string text, const std::string& name, std::vector<std::string>& notes) -> std::string {
  bool answered = false;
  std::size_t first_header = 0;
  for_each_line(text, [&](std::string_view line, std::size_t number) {
    answered = answered || is_verdict(line);
    first_header = first_header == 0 && line.starts_with(kHeader) ? number : first_header;
  });
  // A terminal or a page that keeps the answers may drop the 'ok' between them.
  if (first_header == 0 || (first_header == 1 && !answered)) {
    return text;
  }
  std::string rows;
  bool begun = false;
  for_each_line(text, [&](std::string_view line, std::size_t number) {
    const bool header = line.starts_with(kHeader);
    if (header && begun) {
      throw BadInput(place(name, number) + "a second log begins here; give each log its own file");
    }
    if (begun && is_failure(line)) {
      notes.push_back(place(name, number) + "the board answered '" + std::string(line) + "'");
    }
    begun = begun || header;
    const bool row = begun && (!answered || is_row(line));
    rows += header || row ? line : std::string_view(&kRemark, 1);
    rows += '\n';
  });
  return rows;
}

}  // namespace capstan::tools
