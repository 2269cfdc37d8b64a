// SPDX-License-Identifier: Apache-2.0
#include "tools/log/csv_log.hpp"

#include <algorithm>
#include <cmath>

#include "tools/support/errors.hpp"
#include "tools/support/text.hpp"

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

/// Lines that begin so are a board's remarks between the rows, and are skipped.
constexpr char kRemark = '#';

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

auto CsvLog::parse(std::string text, std::string name, std::vector<ColumnMapping> mappings) -> CsvLog {
  CsvLog log;
  log.name_ = std::move(name);
  log.text_ = std::move(text);
  log.mappings_ = std::move(mappings);
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  std::size_t begin = log.text_.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0;
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
  return log;
}

void CsvLog::read_header(std::string_view line) {
  for (std::size_t i = 0; i < cells_in(line); ++i) {
    names_.emplace_back(trimmed(cell_of(line, i)));
    if (std::count(names_.begin(), names_.end(), names_.back()) > 1) {
      throw BadInput(place(name_, 1) + "column " + names_.back() + " appears twice; rename one of them");
    }
  }
  if (std::all_of(names_.begin(), names_.end(), [](const auto& name) { return parse_number(name).has_value(); })) {
    throw BadInput(place(name_, 1) + "the first line holds numbers; put the column names there");
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
    if (trimmed(text).empty() && last) {
      break;
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

auto CsvLog::find(const std::string& wanted) const -> std::optional<Source> {
  auto index_of = [this](const std::string& name) -> std::optional<std::size_t> {
    const auto at = std::find(names_.begin(), names_.end(), name);
    return at == names_.end() ? std::nullopt : std::optional(static_cast<std::size_t>(at - names_.begin()));
  };
  for (const auto& mapping : mappings_) {
    if (mapping.wanted == wanted) {
      const auto index = index_of(mapping.source);
      return index ? std::optional(Source{*index, mapping.factor}) : std::nullopt;
    }
  }
  const auto index = index_of(wanted);
  return index ? std::optional(Source{*index, 1.0}) : std::nullopt;
}

auto CsvLog::has(const std::string& wanted) const -> bool {
  for (const auto& mapping : mappings_) {
    if (mapping.wanted == wanted) {
      return true;  // column() says what is wrong if the mapping's source is not there
    }
  }
  return find(wanted).has_value();
}

auto CsvLog::source_name(const std::string& wanted) const -> std::string {
  const auto source = find(wanted);
  return source && source->factor == 1.0 ? names_[source->index] : wanted;
}

auto CsvLog::missing(const std::string& wanted) const -> std::string {
  std::string source = wanted;
  for (const auto& mapping : mappings_) {
    source = mapping.wanted == wanted ? mapping.source : source;
  }
  return place(name_, 1) + "there is no column " + source + " among " + joined(names_) +
         "; name the right one with --map " + wanted + "=COLUMN";
}

auto CsvLog::column(const std::string& wanted) const -> Eigen::VectorXd {
  const auto source = find(wanted);
  if (!source) {
    throw BadInput(missing(wanted));
  }
  Eigen::VectorXd values(static_cast<Eigen::Index>(rows()));
  for (std::size_t row = 0; row < rows(); ++row) {
    const std::string_view cell = cell_of(line_text(lines_[row]), source->index);
    const auto value = parse_number(cell);
    if (!value || !std::isfinite(*value)) {
      throw BadInput(place(name_, lines_[row].number) + "column " + names_[source->index] + " holds '" +
                     std::string(trimmed(cell)) + "', which is not a number; repair the line or cut the log before it");
    }
    values[static_cast<Eigen::Index>(row)] = *value * source->factor;
  }
  return values;
}

auto CsvLog::time() const -> Eigen::VectorXd {
  Eigen::VectorXd time = column("time_s");
  for (Eigen::Index i = 1; i < time.size(); ++i) {
    if (!(time[i] > time[i - 1])) {
      const bool repeated = time[i] == time[i - 1];
      throw BadInput(place(name_, lines_[static_cast<std::size_t>(i)].number) + "time_s " +
                     (repeated ? "repeats " : "runs backward to ") + exact(time[i]) +
                     (repeated ? "" : " after " + exact(time[i - 1])) +
                     "; remove the line, or split the file if two recordings were joined");
    }
  }
  return time;
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
