// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/csv_dialect.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <optional>

#include "capstan/tools/log/clock_time.hpp"
#include "capstan/tools/log/csv_cells.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

/// Lines looked at beside remarks to tell the separator and the header. A preamble may have as many.
constexpr std::size_t kSampleLines = 60;

struct Line {
  std::string_view text;
  std::size_t number = 0;  // from 1
};

auto lines_of(std::string_view text, std::size_t most) -> std::vector<Line> {
  std::vector<Line> lines;
  std::size_t number = 1;
  std::size_t remarks = 0;
  for (std::size_t begin = 0; begin < text.size() && lines.size() < most + remarks; ++number) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back({trimmed(text.substr(begin, end - begin)), number});
    remarks += is_remark(lines.back().text) ? 1 : 0;
    begin = end + 1;
  }
  return lines;
}

struct Layout {
  Separator separator = Separator::kComma;
  std::size_t cells = 1;
  std::size_t header = 0, units = 0, types = 0;  ///< line numbers; 0: none
  bool header_is_remark = false;
};

auto cells_or_none(std::string_view line, Separator separator) -> std::vector<std::string> {
  try {
    return cells_of(line, separator);
  } catch (const Unclosed&) {
    return {};
  }
}

/// The separator that cuts most lines into the same number of cells, and that number.
void find_separator(const std::vector<Line>& lines, Layout& layout) {
  std::size_t most = 0;
  for (const auto separator : {Separator::kTab, Separator::kSemicolon, Separator::kComma, Separator::kBar,
                               Separator::kWideBlanks, Separator::kBlanks}) {
    std::map<std::size_t, std::size_t> counts;
    for (const auto& line : lines) {
      if (!line.text.empty() && !is_remark(line.text)) {
        ++counts[cells_or_none(line.text, separator).size()];
      }
    }
    for (const auto& [cells, count] : counts) {
      if (cells >= 2 && count > most) {
        most = count;
        layout.separator = separator;
        layout.cells = cells;
      }
    }
  }
}

/// Where the numbers begin: the first line of them that no line of names follows. A preamble may hold a number, too.
auto first_data(const std::vector<Line>& lines, const Layout& layout) -> std::size_t {
  enum class Kind { kData, kNames, kOther };
  std::vector<std::pair<std::size_t, Kind>> kinds;  // index of a line with text
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!lines[i].text.empty() && !is_remark(lines[i].text)) {
      const auto cells = cells_or_none(lines[i].text, layout.separator);
      kinds.emplace_back(i, cells.size() != layout.cells ? Kind::kOther : is_data(cells) ? Kind::kData : Kind::kNames);
    }
  }
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    if (kinds[k].second == Kind::kData && (k + 1 == kinds.size() || kinds[k + 1].second != Kind::kNames)) {
      return kinds[k].first;
    }
  }
  return lines.size();
}

/// Header and row of units: the last two lines of that many cells before the numbers.
void find_header(const std::vector<Line>& lines, Layout& layout) {
  const Line* last_remark = nullptr;
  const std::size_t data = first_data(lines, layout);
  for (std::size_t i = 0; i < data; ++i) {
    const Line& line = lines[i];
    const bool remark = is_remark(line.text);
    last_remark = remark ? &line : last_remark;
    const auto cells = remark ? std::vector<std::string>{} : cells_or_none(line.text, layout.separator);
    if (cells.size() == layout.cells && layout.header > 0 && is_units_row(cells)) {
      layout.units = line.number;
    } else if (cells.size() == layout.cells && layout.header > 0 && is_types_row(cells)) {
      layout.types = line.number;
    } else if (cells.size() == layout.cells) {
      layout.header = line.number;
      layout.units = layout.types = 0;
    }
  }
  if (layout.header == 0 && last_remark != nullptr &&
      cells_or_none(trimmed(last_remark->text.substr(1)), layout.separator).size() == layout.cells) {
    layout.header = last_remark->number;  // as numpy.savetxt writes it
    layout.header_is_remark = true;
  }
}

auto by_contract(std::string_view text, const std::vector<Line>& lines, const Layout& layout) -> bool {
  const auto first = std::find_if(lines.begin(), lines.end(), [](const Line& line) { return !is_remark(line.text); });
  const bool header_first = first == lines.end() || layout.header == 0 || layout.header == first->number;
  const bool no_end = first == lines.end() || first->text.empty() || first->text.back() != ',';
  const bool percent =
      std::any_of(lines.begin(), lines.end(), [](const Line& line) { return line.text.starts_with('%'); });
  return layout.separator == Separator::kComma && header_first && !layout.header_is_remark && no_end &&
         layout.units == 0 && layout.types == 0 && !percent && text.find('"') == std::string_view::npos;
}

class Rewriter {
 public:
  Rewriter(const Layout& layout, const std::string& name) : layout_(layout), name_(name) {}

  auto rewritten(std::string_view text) -> std::string {
    std::string result;
    result.reserve(text.size());
    std::size_t number = 1;
    for (std::size_t begin = 0; begin < text.size(); ++number) {
      const auto found = text.find('\n', begin);
      const std::size_t end = std::min(found, text.size());
      append_line(result, trimmed(text.substr(begin, end - begin)), number);
      result += found == std::string_view::npos ? "" : "\n";
      begin = end + 1;
    }
    refuse_mixed();
    return result;
  }

  void take_units(std::vector<std::string> units) { units_ = std::move(units); }
  [[nodiscard]] auto decimal_commas() const -> bool { return comma_line_ > 0; }

 private:
  void append_line(std::string& result, std::string_view line, std::size_t number) {
    const bool header = number == layout_.header;
    if (header && layout_.header_is_remark) {
      line = trimmed(line.substr(1));
    } else if (number < layout_.header || number == layout_.units || number == layout_.types || line.starts_with('%')) {
      result += kRemark;
      return;
    } else if (line.empty() || is_remark(line)) {
      result += line;
      return;
    }
    auto cells = cells_at(line, number);
    while (cells.size() == layout_.cells && cells.size() > 1 && drops_last(cells, header)) {
      cells.pop_back();
    }
    for (std::size_t i = 0; i < cells.size(); ++i) {
      result += i > 0 ? "," : "";
      result += header ? header_name(cells[i], i) : value(std::move(cells[i]), number);
    }
  }

  /// A separator at the end of every line makes one column too many.
  auto drops_last(const std::vector<std::string>& cells, bool header) -> bool {
    ends_empty_ = header ? cells.back().empty() : ends_empty_;
    return ends_empty_ && cells.back().empty();
  }

  auto cells_at(std::string_view line, std::size_t number) const -> std::vector<std::string> {
    try {
      return cells_of(line, layout_.separator);
    } catch (const Unclosed&) {
      throw BadInput(place(name_, number) + "a quote is opened and not closed; put the cell on one line, or take the " +
                     "quotes out with `tr -d '\"' < " + name_ + " > log.csv`");
    }
  }

  auto header_name(std::string cell, std::size_t index) const -> std::string {
    std::replace(cell.begin(), cell.end(), ',', ';');
    if (index < units_.size() && !units_[index].empty() && units_[index] != "-" &&
        cell.find_first_of("[(") == std::string::npos && !cell.ends_with("_" + units_[index])) {
      const std::string& unit = units_[index];
      cell += unit.front() == '[' || unit.front() == '(' ? " " + unit : " [" + unit + "]";
    }
    return cell;
  }

  auto value(std::string cell, std::size_t number) -> std::string {
    if (cell.find(',') == std::string::npos) {
      point_line_ =
          point_line_ == 0 && cell.find('.') != std::string::npos && parse_number(cell) ? number : point_line_;
      return cell;
    }
    if (layout_.separator != Separator::kComma && has_thousands(cell)) {
      const bool points = cell.rfind('.') < cell.rfind(',');
      throw BadInput(place(name_, number) + "'" + cell + "' has both a point and a comma, one of them between " +
                     "thousands; export without thousands separators, or take the " + (points ? "points" : "commas") +
                     " out with `tr -d " + (points ? "." : ",") + " < " + name_ + " > log.csv` if the " +
                     (points ? "commas" : "points") + " are the decimals'");
    }
    if (auto number_text = with_decimal_point(cell)) {
      comma_line_ = comma_line_ == 0 ? number : comma_line_;
      return *number_text;
    }
    std::replace(cell.begin(), cell.end(), ',', parse_clock(cell) ? '.' : ';');
    return cell;
  }

  void refuse_mixed() const {
    if (comma_line_ > 0 && point_line_ > 0) {
      throw BadInput(place(name_, std::max(comma_line_, point_line_)) + "numbers have decimal commas (line " +
                     std::to_string(comma_line_) + ") and points (line " + std::to_string(point_line_) +
                     "), so what the points mean is not certain; make them one kind, for instance with `tr , . < " +
                     name_ + " > log.csv` if both are decimals");
    }
  }

  const Layout& layout_;
  const std::string& name_;
  std::vector<std::string> units_;
  bool ends_empty_ = false;
  std::size_t comma_line_ = 0, point_line_ = 0;  // first of each kind
};

/// Whether all rows from a line on have so many cells; those that the sample does not show, too.
auto all_rows_have(std::string_view text, std::size_t first_line, std::size_t cells) -> bool {
  std::size_t number = 1;
  for (std::size_t begin = 0; begin < text.size(); ++number) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = trimmed(text.substr(begin, end - begin));
    const auto commas = static_cast<std::size_t>(std::count(line.begin(), line.end(), ','));
    if (number >= first_line && !line.empty() && !is_remark(line) && commas + 1 != cells) {
      return false;
    }
    begin = end + 1;
  }
  return true;
}

/// "0,01,1,5" below "t,q": every number has been cut in two. Which commas are decimals is certain only where each
/// number has one: "0,1,5" may be 0 and 1.5 or 0.1 and 5.
void refuse_cut_numbers(std::string_view text, const std::vector<Line>& lines, const Layout& layout,
                        const std::string& name) {
  if (layout.separator != Separator::kComma || layout.header != 0 || lines.size() < 2) {
    return;
  }
  const auto first = std::find_if(lines.begin(), lines.end(),
                                  [&](const Line& line) { return !line.text.empty() && !is_remark(line.text); });
  if (first == lines.end()) {
    return;
  }
  const auto names = cells_or_none(first->text, Separator::kComma);
  const bool no_points = std::none_of(first + 1, lines.end(),
                                      [](const Line& line) { return line.text.find('.') != std::string_view::npos; });
  if (is_data(names) || names.size() * 2 != layout.cells || !no_points) {
    return;
  }
  const std::size_t line = first->number + 1;
  const std::string cure =
      all_rows_have(text, line, layout.cells)
          ? ", or write points with `sed -E " + std::to_string(line) +
                "',$ s/([0-9]+),([0-9]+([eE][-+]?[0-9]+)?)/\\1.\\2/g' " + name + " > log.csv`"
          : ", or with points; here numbers without decimals stand among the others, so no command can tell which "
            "commas are decimals";
  throw BadInput(place(name, line) + "the rows have twice as many cells as the header: the decimals have commas and " +
                 "so has the table; export with semicolons" + cure);
}

auto separator_word(Separator separator) -> const char* {
  constexpr std::array kWords = {"tabs", "semicolons", "commas", "bars", "blanks", "blanks"};
  return kWords[static_cast<std::size_t>(separator)];
}

}  // namespace

auto canonical_csv(std::string text, const std::string& name, std::vector<std::string>& notes) -> std::string {
  const auto lines = lines_of(text, kSampleLines);
  Layout layout;
  find_separator(lines, layout);
  find_header(lines, layout);
  refuse_cut_numbers(text, lines, layout, name);
  if (by_contract(text, lines, layout)) {
    return text;
  }
  Rewriter rewriter(layout, name);
  if (layout.units > 0) {
    rewriter.take_units(cells_of(lines[layout.units - 1].text, layout.separator));
  }
  std::string result = rewriter.rewritten(text);
  std::vector<std::string> what;
  if (layout.separator != Separator::kComma) {
    what.emplace_back(std::string("cells between ") + separator_word(layout.separator));
  }
  if (rewriter.decimal_commas()) {
    what.emplace_back("decimal commas");
  }
  if (layout.units > 0) {
    what.emplace_back("units in line " + std::to_string(layout.units));
  }
  if (layout.header > 1) {
    what.emplace_back("column names in line " + std::to_string(layout.header));
  }
  if (!what.empty()) {
    notes.push_back(name + ": read with " + joined(what, ", "));
  }
  return result;
}

}  // namespace capstan::tools
