// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/thesis/table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "capstan/tools/report/html.hpp"

namespace capstan::tools {
namespace {

constexpr std::size_t kWidth = 9;
const std::string kPrinted = "printed";
const std::string kOurs = "simulated";

auto is_fitted(const ThesisTable::Row& row, const std::string& key) -> bool {
  return std::find(row.fitted.begin(), row.fitted.end(), key) != row.fitted.end();
}

auto is_fitted(const ThesisTable::Trial& trial, std::size_t row, const std::string& key) -> bool {
  return std::any_of(trial.fitted.begin(), trial.fitted.end(),
                     [&](const auto& place) { return place.row == row && place.key == key; });
}

auto padded(const std::string& text, std::size_t width) -> std::string {
  return text.size() < width ? std::string(width - text.size(), ' ') + text : " " + text;
}

auto number(double value, int decimals) -> std::string {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return std::isnan(value) ? "-" : text.data();
}

/// Each group's name over its columns.
auto group_line(const ThesisTable& table, std::size_t first) -> std::string {
  std::string line(first, ' ');
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    const bool begins = i == 0 || table.columns[i].group != table.columns[i - 1].group;
    line += padded(begins ? table.columns[i].group : "", kWidth);
  }
  return line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
}

/// A sentence on lines of at most 120 characters, after its head.
auto wrapped(const std::string& sentence, const std::string& head) -> std::string {
  constexpr std::size_t kLine = 120;
  const std::string text = head + sentence;
  const std::string indent = "  ";
  std::string result;
  std::string line = indent;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    if (line.size() + word.size() + 1 > kLine && line.size() > indent.size()) {
      result += line + "\n";
      line = std::string(indent.size(), ' ');
    }
    line += (line.size() > indent.size() ? " " : "") + word;
    begin = end + 1;
  }
  return result + line + "\n";
}

auto in_percent(double value) -> std::string {
  return (value >= 0.0 ? "+" : "") + number(value, std::fabs(value) < 9.95 ? 1 : 0) + " %";
}

/// "with X instead of Y: value, difference".
auto tested_text(const ThesisDifference& d, const ThesisDifference::Tested& tested) -> std::string {
  return "with " + tested.trial->with + " instead of " + tested.trial->instead_of + ": " +
         number(tested.value, d.decimals) + (tested.fitted ? "f" : "") + ", " + in_percent(tested.percent);
}

auto difference_text(const ThesisDifference& d) -> std::string {
  return d.row + ", " + d.heading + ": printed " + number(d.printed, d.decimals) + ", ours " +
         number(d.ours, d.decimals) + ", " + in_percent(d.percent);
}

/// The table without the trials' columns, which stand with the differences.
auto without_trials(const ThesisTable& table) -> ThesisTable {
  ThesisTable result = table;
  const auto is_trial = [&](std::size_t i) {
    return std::any_of(table.trials.begin(), table.trials.end(),
                       [&](const auto& trial) { return trial.group == table.columns[i].group; });
  };
  for (std::size_t i = table.columns.size(); i-- > 0;) {
    if (is_trial(i)) {
      result.columns.erase(result.columns.begin() + static_cast<std::ptrdiff_t>(i));
      for (auto& row : result.rows) {
        row.values.erase(row.values.begin() + static_cast<std::ptrdiff_t>(i));
      }
    }
  }
  return result;
}

template <typename Visit>
void visit_tested(std::vector<ThesisDifference>& all, const ThesisTable::Trial& trial, Visit&& visit) {
  for (ThesisDifference& d : all) {
    for (ThesisDifference::Tested& t : d.tested) {
      if (t.trial == &trial) {
        visit(d, t);
      }
    }
  }
}

auto group_span(const ThesisTable& table, std::size_t first) -> std::size_t {
  std::size_t last = first;
  while (last < table.columns.size() && table.columns[last].group == table.columns[first].group) {
    ++last;
  }
  return last - first;
}

auto html_head(const ThesisTable& table) -> std::string {
  std::string html = "<thead><tr><th rowspan=\"2\"></th>";
  for (std::size_t i = 0; i < table.columns.size(); i += group_span(table, i)) {
    html += html_cell(table.columns[i].group, "th",
                      " class=\"g\" colspan=\"" + std::to_string(group_span(table, i)) + "\"");
  }
  html += "</tr><tr>";
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    const auto& column = table.columns[i];
    const bool begins = i == 0 || table.columns[i - 1].group != column.group;
    const std::string unit = column.unit == "1" || column.unit == "%" ? "" : " [" + column.unit + "]";
    html += html_cell(column.heading + unit, "th", begins ? " class=\"n g\"" : " class=\"n\"");
  }
  return html + "</tr></thead>\n";
}

auto html_rows(const ThesisTable& table) -> std::string {
  std::string html;
  for (const auto& row : table.rows) {
    html += "<tr>" + html_cell(row.name);
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      const auto& column = table.columns[i];
      const bool begins = i == 0 || table.columns[i - 1].group != column.group;
      const bool fitted = column.group == kOurs && is_fitted(row, column.key);
      html += html_cell(number(row.values[i], column.decimals) + (fitted ? " f" : ""), "td",
                        begins ? " class=\"n g\"" : " class=\"n\"");
    }
    html += "</tr>\n";
  }
  return html;
}

auto html_differences(const ThesisTable& table) -> std::string {
  std::string html;
  for (const auto& d : differences_of(table)) {
    if (!d.large()) {
      continue;
    }
    html += "<tr>" + html_cell(d.row) + html_cell(d.heading) + html_number(number(d.printed, d.decimals)) +
            html_number(number(d.ours, d.decimals) + (d.fitted ? " f" : "")) + html_number(in_percent(d.percent)) +
            "<td>" + escaped(reason_of(d)) + "</td><td>";
    for (const auto& tested : d.tested) {
      html += "<div>" + escaped(tested_text(d, tested)) + "</div>";
    }
    html += "</td></tr>\n";
  }
  return html;
}

}  // namespace

auto ThesisTable::value(std::size_t row, const std::string& group, const std::string& key) const -> double {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i].group == group && columns[i].key == key) {
      return rows.at(row).values.at(i);
    }
  }
  return std::nan("");
}

auto ThesisDifference::large() const -> bool {
  return std::fabs(percent) > kExplainedFromPercent;
}

namespace {

/// Of the trials that help the table, and are fitted to the value or not, the nearest to the print.
auto nearest_of(const ThesisDifference& d, bool fitted) -> const ThesisDifference::Tested* {
  const ThesisDifference::Tested* best = nullptr;
  for (const auto& t : d.tested) {
    if (t.helps && t.fitted == fitted &&
        std::fabs(t.percent) < std::fabs(best == nullptr ? d.percent : best->percent)) {
      best = &t;
    }
  }
  return best;
}

auto if_close(const ThesisDifference::Tested* tested) -> const ThesisDifference::Tested* {
  return tested != nullptr && std::fabs(tested->percent) <= kExplainedFromPercent ? tested : nullptr;
}

}  // namespace

auto ThesisDifference::nearest() const -> const Tested* {
  return nearest_of(*this, false);
}

auto ThesisDifference::cause() const -> const Tested* {
  return if_close(nearest());
}

auto ThesisDifference::fit() const -> const Tested* {
  return cause() == nullptr ? if_close(nearest_of(*this, true)) : nullptr;
}

auto differences_of(const ThesisTable& table) -> std::vector<ThesisDifference> {
  std::vector<ThesisDifference> all;
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    for (const auto& column : table.columns) {
      const double printed = table.value(r, kPrinted, column.key);
      const double ours = table.value(r, kOurs, column.key);
      if (column.group != kPrinted || column.derived || std::isnan(printed) || std::isnan(ours)) {
        continue;
      }
      const auto percent = [&](double value) { return 100.0 * (value - printed) / std::fabs(printed); };
      ThesisDifference d{table.rows[r].name,
                         column.key,
                         column.heading,
                         column.unit,
                         column.decimals,
                         printed,
                         ours,
                         percent(ours),
                         is_fitted(table.rows[r], column.key),
                         {}};
      for (const auto& trial : table.trials) {
        const double value = table.value(r, trial.group, column.key);
        if (!std::isnan(value)) {
          d.tested.push_back({&trial, value, percent(value), is_fitted(trial, r, column.key), false, 0, 0, 0});
        }
      }
      all.push_back(std::move(d));
    }
  }
  for (const auto& trial : table.trials) {
    double before = 0.0;
    double after = 0.0;
    int within = 0;
    int within_before = 0;
    int values = 0;
    visit_tested(all, trial, [&](const ThesisDifference& d, const ThesisDifference::Tested& t) {
      if (d.fitted || t.fitted) {
        return;
      }
      before += std::fabs(d.percent);
      after += std::fabs(t.percent);
      within += std::fabs(t.percent) <= kExplainedFromPercent ? 1 : 0;
      within_before += d.large() ? 0 : 1;
      ++values;
    });
    visit_tested(all, trial, [&](const ThesisDifference&, ThesisDifference::Tested& t) {
      t.helps = values == 0 || after < before;
      t.within = within;
      t.within_before = within_before;
      t.values = values;
    });
  }
  return all;
}

/// What a change makes of the whole table: a cause of one value may spoil others, and each value has the one that comes
/// nearest to it.
auto over_the_table(const ThesisDifference::Tested& tested) -> std::string {
  return " Values that it is tried on and nothing is fitted to: " + std::to_string(tested.values) +
         "; within 10 % with this change alone " + std::to_string(tested.within) + ", without it " +
         std::to_string(tested.within_before) + ".";
}

auto reason_of(const ThesisDifference& d) -> std::string {
  if (const auto* cause = d.cause()) {
    return "explained: " + cause->trial->because + over_the_table(*cause);
  }
  if (const auto* fit = d.fit()) {
    return "fitted: a number of this change was chosen by this value. It is blamed because " + fit->trial->because +
           over_the_table(*fit);
  }
  if (const auto* part = d.nearest()) {
    return "in part: " + part->trial->because + " The rest is not explained." + over_the_table(*part);
  }
  return "not explained: of the changes that bring the whole table nearer to the print, none does it here.";
}

auto table_text(const ThesisTable& whole) -> std::string {
  const ThesisTable table = without_trials(whole);
  std::size_t first = 8;
  for (const auto& row : table.rows) {
    first = std::max(first, row.name.size() + 4);
  }
  std::string text = "Table " + table.number + "  " + table.title + "\n" + group_line(table, first);
  text += std::string(first, ' ');
  for (const auto& column : table.columns) {
    text += padded(column.heading, kWidth);
  }
  text += "\n";
  for (const auto& row : table.rows) {
    text += "  " + row.name + std::string(first - row.name.size() - 2, ' ');
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      const bool fitted = table.columns[i].group == kOurs && is_fitted(row, table.columns[i].key);
      text += padded(number(row.values[i], table.columns[i].decimals) + (fitted ? "f" : ""), kWidth);
    }
    text += "\n";
  }
  for (const auto& condition : table.conditions) {
    text += wrapped(condition, "");
  }
  for (const auto& d : differences_of(whole)) {
    if (d.large()) {
      std::string sentence = reason_of(d);
      for (const auto& tested : d.tested) {
        sentence += " - " + tested_text(d, tested) + ".";
      }
      text += wrapped(sentence, difference_text(d) + ": ");
    }
  }
  return text;
}

auto table_json(const ThesisTable& table) -> nlohmann::json {
  nlohmann::json rows = nlohmann::json::array();
  for (const auto& row : table.rows) {
    nlohmann::json entry = {{"name", row.name}, {"fitted", row.fitted}};
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      const auto& column = table.columns[i];
      entry[column.group][column.key] = std::isnan(row.values[i]) ? nlohmann::json() : nlohmann::json(row.values[i]);
    }
    rows.push_back(std::move(entry));
  }
  nlohmann::json units;
  for (const auto& column : table.columns) {
    units[column.key] = column.unit;
  }
  nlohmann::json large = nlohmann::json::array();
  for (const auto& d : differences_of(table)) {
    if (d.large()) {
      nlohmann::json tested = nlohmann::json::array();
      for (const auto& t : d.tested) {
        tested.push_back({{"with", t.trial->with},
                          {"instead_of", t.trial->instead_of},
                          {"value", t.value},
                          {"fitted", t.fitted},
                          {"difference_percent", t.percent}});
      }
      large.push_back({{"row", d.row},
                       {"key", d.key},
                       {"printed", d.printed},
                       {"simulated", d.ours},
                       {"difference_percent", d.percent},
                       {"reason", reason_of(d)},
                       {"tested", std::move(tested)}});
    }
  }
  return {{"table", table.number},          {"title", table.title}, {"units", units},
          {"conditions", table.conditions}, {"rows", rows},         {"large_differences", large}};
}

auto table_html(const ThesisTable& table) -> std::string {
  const ThesisTable shown = without_trials(table);
  std::string html = "<h2>Table " + escaped(table.number) + "</h2>\n<p>" + escaped(table.title) + "</p>\n";
  html += "<div class=\"wide\"><table>" + html_head(shown) + "<tbody>" + html_rows(shown) + "</tbody></table></div>\n";
  for (const auto& condition : table.conditions) {
    html += "<p class=\"dim\">" + escaped(condition) + "</p>\n";
  }
  const std::string large = html_differences(table);
  if (large.empty()) {
    return differences_of(table).empty() ? html : html + "<p>No difference is over 10 %.</p>\n";
  }
  return html +
         "<details open><summary>Differences over 10 %, and what was changed to explain them</summary>"
         "<div class=\"wide\"><table><thead><tr><th>row</th><th>value</th><th class=\"n\">printed</th>"
         "<th class=\"n\">ours</th><th class=\"n\">difference</th><th>reason</th><th>experiment</th></tr></thead>"
         "<tbody>\n" +
         large + "</tbody></table></div></details>\n";
}

}  // namespace capstan::tools
