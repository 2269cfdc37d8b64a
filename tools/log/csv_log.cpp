// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/csv_log.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/log/clock_time.hpp"
#include "capstan/tools/log/csv_cells.hpp"
#include "capstan/tools/log/csv_dialect.hpp"
#include "capstan/tools/log/file_form.hpp"
#include "capstan/tools/log/header_units.hpp"
#include "capstan/tools/log/mcap_log.hpp"
#include "capstan/tools/log/prompt_text.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

/// The cell with the given index; empty view if the line is shorter.
auto cell_of(std::string_view line, std::size_t index) -> std::string_view {
  std::size_t begin = 0;
  for (; index > 0; --index) {
    const auto comma = line.find(',', begin);
    if (comma == std::string_view::npos) {
      return {};
    }
    begin = comma + 1;
  }
  return line.substr(begin, std::min(line.find(',', begin), line.size()) - begin);
}

auto cells_in(std::string_view line) -> std::size_t {
  return static_cast<std::size_t>(std::count(line.begin(), line.end(), ',')) + 1;
}

auto without_line_end(std::string_view line) -> std::string_view {
  return !line.empty() && line.back() == '\r' ? line.substr(0, line.size() - 1) : line;
}

}  // namespace

auto CsvLog::read(const std::string& path, std::vector<ColumnMapping> mappings) -> CsvLog {
  return parse(read_text_file(path), path, std::move(mappings));
}

auto CsvLog::parse(std::string bytes, std::string name, std::vector<ColumnMapping> mappings) -> CsvLog {
  CsvLog log;
  log.name_ = std::move(name);
  log.mappings_ = std::move(mappings);
  if (is_mcap(bytes)) {
    log.text_ = csv_of_mcap(bytes, log.name_, log.warnings_);
  } else {
    std::string text = text_of_file(std::move(bytes), log.name_, log.warnings_);
    text = without_prompt(std::move(text), log.name_, log.warnings_);
    log.text_ = canonical_csv(std::move(text), log.name_, log.warnings_);
  }
  std::size_t begin = 0;
  auto end = log.text_.find('\n', begin);
  std::size_t number = 1;
  for (; end != std::string::npos && log.text_[begin] == kRemark; ++number) {
    begin = end + 1;
    end = log.text_.find('\n', begin);
  }
  if (end == std::string::npos) {
    throw BadInput(place(log.name_, 1) + "the log has no data rows; record it again");
  }
  log.read_header(without_line_end(std::string_view(log.text_).substr(begin, end - begin)));
  log.read_rows(end + 1, number + 1);
  for (auto& mapping : log.mappings_) {
    read_by_unit(mapping, log.names_, log.name_, log.warnings_);
  }
  for (auto& mapping : mappings_by_unit(log.names_, log.mappings_, log.name_, log.warnings_)) {
    log.mappings_.push_back(std::move(mapping));
  }
  return log;
}

void CsvLog::read_header(std::string_view line) {
  for (std::size_t i = 0; i < cells_in(line); ++i) {
    names_.emplace_back(trimmed(cell_of(line, i)));
  }
  if (std::all_of(names_.begin(), names_.end(), [](const auto& name) { return parse_number(name).has_value(); })) {
    throw BadInput(place(name_, 1) + "the first line holds numbers; put the column names there");
  }
  for (const std::string& name : names_) {
    if (std::count(names_.begin(), names_.end(), name) > 1) {
      throw BadInput(place(name_, 1) + "column " + name + " appears twice; rename one of them");
    }
  }
}

void CsvLog::read_rows(std::size_t begin, std::size_t number) {
  for (; begin < text_.size(); ++number) {
    const auto found = text_.find('\n', begin);
    const bool ended = found != std::string::npos;
    const std::size_t end = ended ? found : text_.size();
    const Line line{begin, end, number};
    begin = end + 1;
    const std::string_view text = line_text(line);
    if (text.starts_with(kRemark)) {
      continue;
    }
    const bool last = std::string_view(text_).substr(std::min(begin, text_.size())).find_first_not_of("\r\n\t ") ==
                      std::string_view::npos;
    if (trimmed(text).empty() && (last || names_.size() > 1)) {
      continue;
    }
    const std::size_t cells = cells_in(text);
    if (last && (!ended || cells < names_.size())) {
      warnings_.push_back(place(name_, number) + "the last line is cut off and was dropped");
      break;
    }
    if (cells != names_.size()) {
      throw BadInput(place(name_, number) + "the line has " + std::to_string(cells) + " cells where the header has " +
                     std::to_string(names_.size()) + "; repair or remove it");
    }
    lines_.push_back(line);
  }
  if (lines_.empty()) {
    throw BadInput(place(name_, 2) + "the log has no data rows; record it again");
  }
}

auto CsvLog::line_text(const Line& line) const -> std::string_view {
  return without_line_end(std::string_view(text_).substr(line.begin, line.end - line.begin));
}

auto CsvLog::index_of(const std::string& name) const -> std::optional<std::size_t> {
  const auto at = std::find(names_.begin(), names_.end(), name);
  return at == names_.end() ? std::nullopt : std::optional(static_cast<std::size_t>(at - names_.begin()));
}

auto CsvLog::mapping_of(const std::string& wanted) const -> const ColumnMapping* {
  const auto found =
      std::find_if(mappings_.begin(), mappings_.end(), [&](const auto& mapping) { return mapping.wanted == wanted; });
  return found == mappings_.end() ? nullptr : &*found;
}

auto CsvLog::mapped(const ColumnMapping& mapping) const -> Source {
  if (const auto index = index_of(mapping.expression)) {
    return {{*index}, 1.0, {}};
  }
  const auto scaled = mapping.scaled();
  if (const auto index = scaled ? index_of(scaled->first) : std::nullopt) {
    return {{*index}, scaled->second, {}};
  }
  try {
    ColumnExpression expression(mapping.expression, names_);
    return {expression.columns(), 1.0, expression};
  } catch (const BadExpression& why) {
    const std::string reason = why.what();
    if (reason.starts_with("there is no column")) {
      throw BadInput(missing(mapping.wanted, reason.substr(std::string_view("there is no column ").size())));
    }
    throw BadInput("--map " + mapping.wanted + "=" + mapping.expression + ": " + reason + mapping_form());
  }
}

auto CsvLog::has(const std::string& wanted) const -> bool {
  return replaced_.count(wanted) > 0 || mapping_of(wanted) != nullptr || index_of(wanted).has_value();
}

auto CsvLog::source_of(const std::string& wanted) const -> Source {
  if (const auto* mapping = mapping_of(wanted)) {
    return mapped(*mapping);
  }
  if (const auto index = index_of(wanted)) {
    return {{*index}, 1.0, {}};
  }
  throw BadInput(missing(wanted, wanted));
}

auto CsvLog::source_name(const std::string& wanted) const -> std::string {
  const auto* mapping = mapping_of(wanted);
  return mapping != nullptr && index_of(mapping->expression) ? mapping->expression : wanted;
}

auto CsvLog::expression_of(const std::string& wanted) const -> std::string {
  const auto* mapping = mapping_of(wanted);
  const std::string& text = mapping != nullptr ? mapping->expression : wanted;
  return index_of(text) ? as_operand(text) : mapping != nullptr ? "(" + text + ")" : text;
}

auto CsvLog::missing(const std::string& wanted, const std::string& source) const -> std::string {
  return place(name_, 1) + "there is no column " + source + " among " + joined(names_) +
         "; name the right one with --map " + wanted + "=COLUMN";
}

auto CsvLog::cells(std::size_t index, bool gaps) const -> Eigen::VectorXd {
  Eigen::VectorXd values(static_cast<Eigen::Index>(rows()));
  for (std::size_t row = 0; row < rows(); ++row) {
    const std::string_view cell = cell_of(line_text(lines_[row]), index);
    const auto value = parse_number(cell);
    const bool gap = gaps && trimmed(cell).empty();
    if (!gap && (!value || !std::isfinite(*value))) {
      throw BadInput(place(name_, lines_[row].number) + "column " + names_[index] + " holds '" +
                     std::string(trimmed(cell)) + "'" + no_number(cell, gaps, name_));
    }
    values[static_cast<Eigen::Index>(row)] = gap ? std::nan("") : *value;
  }
  return values;
}

auto CsvLog::values(const std::string& wanted, bool gaps) const -> Eigen::VectorXd {
  if (const auto found = replaced_.find(wanted); found != replaced_.end()) {
    return found->second;
  }
  const Source source = source_of(wanted);
  if (!source.expression) {
    return cells(source.indices.front(), gaps) * source.factor;
  }
  std::vector<Eigen::VectorXd> columns;
  for (const std::size_t index : source.indices) {
    columns.push_back(cells(index, gaps));
  }
  const std::string option = "--map " + wanted + "=" + mapping_of(wanted)->expression + ": ";
  try {
    Eigen::VectorXd result = source.expression->evaluate(columns);
    for (Eigen::Index i = 0; i < result.size(); ++i) {
      const bool known = std::all_of(columns.begin(), columns.end(), [i](const auto& c) { return !std::isnan(c[i]); });
      if (known && !std::isfinite(result[i])) {
        throw BadInput(option + "has no value at line " + std::to_string(line_of(static_cast<std::size_t>(i))) +
                       " of " + name_ + "; check what is divided by, and the roots");
      }
      result[i] = known ? result[i] : std::nan("");
    }
    return result;
  } catch (const BadExpression& why) {
    throw BadInput(option + why.what() + mapping_form());
  }
}

auto CsvLog::column(const std::string& wanted) const -> Eigen::VectorXd {
  return values(wanted, false);
}

auto CsvLog::column_with_gaps(const std::string& wanted) const -> Eigen::VectorXd {
  return values(wanted, true);
}

auto CsvLog::time_is_mapped() const -> bool {
  return mapping_of("time_s") != nullptr;
}

auto CsvLog::clock_column() const -> std::optional<Eigen::VectorXd> {
  const Source source = source_of("time_s");
  if (source.expression || replaced_.count("time_s") > 0 ||
      !parse_clock(cell_of(line_text(lines_.front()), source.indices.front()))) {
    return std::nullopt;
  }
  constexpr std::int64_t kHour = 3'600'000'000'000;
  Eigen::VectorXd time(static_cast<Eigen::Index>(rows()));
  std::int64_t first = 0;
  std::int64_t last = 0;
  std::int64_t begun = 0;  // days, or hours where the times have minutes only
  for (std::size_t row = 0; row < rows(); ++row) {
    const std::string_view cell = cell_of(line_text(lines_[row]), source.indices.front());
    const auto clock = parse_clock(cell);
    if (!clock) {
      throw BadInput(place(name_, lines_[row].number) + "column " + names_[source.indices.front()] + " holds '" +
                     std::string(trimmed(cell)) + "', which is no time like 2026-11-22T05:18:23.123 as in the rows " +
                     "before; repair the line or cut the log before it");
    }
    const std::int64_t turn = std::count(cell.begin(), cell.end(), ':') == 1 ? kHour : 24 * kHour;
    std::int64_t now = clock->nanoseconds + begun;
    if (!clock->dated && row > 0 && now < last - turn / 2) {  // past midnight, or a full hour
      begun += turn;
      now += turn;
    }
    first = row == 0 ? now : first;
    last = now;
    time[static_cast<Eigen::Index>(row)] = static_cast<double>(now - first) * 1e-9;
  }
  return time;
}

auto CsvLog::time() const -> Eigen::VectorXd {
  const auto clock = clock_column();
  Eigen::VectorXd time = clock ? *clock : column("time_s");
  for (Eigen::Index i = 1; i < time.size(); ++i) {
    if (!(time[i] > time[i - 1])) {
      const bool repeated = time[i] == time[i - 1];
      const Eigen::Index steps = time.size() - 1;
      const bool coarse = (time.tail(steps).array() == time.head(steps).array()).count() > steps / 10;
      const bool whole = clock && repeated && ((time.array() - time.array().round()).abs() < 1e-6).all();
      throw BadInput(place(name_, lines_[static_cast<std::size_t>(i)].number) + "time_s " +
                     (repeated ? "repeats " : "runs backward to ") + exact(time[i]) +
                     (repeated ? "" : " after " + exact(time[i - 1])) +
                     (whole ? ", as the times have no fractions of a second; export them with milliseconds"
                      : repeated && coarse ? ", as many rows do; export the times with more digits"
                                           : "; remove the line, or split the file if two recordings were joined"));
    }
  }
  return time;
}

auto CsvLog::with_rows(const std::vector<std::size_t>& rows, std::map<std::string, Eigen::VectorXd> columns) const
    -> CsvLog {
  CsvLog result = *this;
  result.lines_.clear();
  for (const std::size_t row : rows) {
    result.lines_.push_back(lines_[row]);
  }
  result.replaced_ = std::move(columns);
  return result;
}

auto CsvLog::text_with(const std::vector<std::string>& names, const std::vector<Eigen::VectorXd>& columns) const
    -> std::string {
  std::vector<std::size_t> kept;
  std::vector<std::string> header;
  for (std::size_t i = 0; i < names_.size(); ++i) {
    if (std::find(names.begin(), names.end(), names_[i]) == names.end()) {
      kept.push_back(i);
      header.push_back(names_[i]);
    }
  }
  header.insert(header.end(), names.begin(), names.end());
  std::string result = joined(header, ",");
  result += '\n';
  for (std::size_t row = 0; row < rows(); ++row) {
    const std::string_view line = line_text(lines_[row]);
    if (kept.size() == names_.size()) {
      result += line;
    } else {
      for (std::size_t i = 0; i < kept.size(); ++i) {
        result += i > 0 ? "," : "";
        result += cell_of(line, kept[i]);
      }
    }
    for (const auto& column : columns) {
      result += ',';
      result += log_number(column[static_cast<Eigen::Index>(row)]);
    }
    result += '\n';
  }
  return result;
}

auto log_number(double value) -> std::string {
  std::string text(48, '\0');
  // 12 decimals hold 2^-24 steps to within 1e-12, a hundred thousandth of a step, up to +-128 and far beyond.
  const int length = std::snprintf(text.data(), text.size(), "%.12f", value);
  text.resize(static_cast<std::size_t>(std::clamp(length, 0, 47)));
  return text;
}

}  // namespace capstan::tools
