// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/thesis/page.hpp"

#include <algorithm>

#include "capstan/tools/report/html.hpp"

namespace capstan::tools {
namespace {

constexpr const char* kStyle = R"(
body { font: 15px/1.5 sans-serif; max-width: 66rem; margin: 2rem auto; padding: 0 1rem; color: #222 }
h1 { font-size: 1.5rem }
h2 { font-size: 1.15rem; margin-top: 2.5rem; border-top: 1px solid #ccc; padding-top: 1rem }
.wide { overflow-x: auto; margin: .5rem 0 }
table { border-collapse: collapse; font-size: .86rem }
th, td { text-align: left; vertical-align: top; padding: .15rem .6rem .15rem 0; border-bottom: 1px solid #ddd }
th.n, td.n { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap }
th.g, td.g { border-left: 1px solid #bbb; padding-left: .6rem }
td:first-child { white-space: nowrap }
summary { font-weight: bold; margin: .5rem 0 }
svg { max-width: 100%; height: auto; display: block; margin: .5rem 0 }
.dim { color: #555; font-size: .9rem }
nav a { margin-right: .8rem }
)";

auto summary(const std::vector<ThesisTable>& tables) -> std::string {
  std::string rows;
  for (const ThesisTable& table : tables) {
    const auto all = differences_of(table);
    if (all.empty()) {
      continue;  // nothing is printed of it
    }
    const auto count = [&](auto&& is) { return std::to_string(std::count_if(all.begin(), all.end(), is)); };
    rows += "<tr><td>" + escaped(table.number) + "</td><td class=\"n\">" + std::to_string(all.size()) +
            "</td><td class=\"n\">" + count([](const auto& d) { return d.fitted; }) + "</td><td class=\"n\">" +
            count([](const auto& d) { return !d.fitted && !d.large(); }) + "</td><td class=\"n\">" +
            count([](const auto& d) { return d.large() && d.cause() != nullptr; }) + "</td><td class=\"n\">" +
            count([](const auto& d) { return d.large() && d.fit() != nullptr; }) + "</td><td class=\"n\">" +
            count([](const auto& d) {
              return d.large() && d.cause() == nullptr && d.fit() == nullptr && d.nearest() != nullptr;
            }) +
            "</td><td class=\"n\">" +
            count([](const auto& d) { return d.large() && d.fit() == nullptr && d.nearest() == nullptr; }) +
            "</td></tr>\n";
  }
  return "<table><thead><tr><th>table</th><th class=\"n\">values</th><th class=\"n\">fitted</th>"
         "<th class=\"n\">predicted within 10 %</th><th class=\"n\">beyond, explained</th>"
         "<th class=\"n\">by a change fitted to it</th><th class=\"n\">explained in part</th><th class=\"n\">not "
         "explained</th></tr></thead><tbody>\n" +
         rows + "</tbody></table>\n";
}

auto figure_html(const ThesisFigure& figure) -> std::string {
  std::string html = "<h2>Figure " + escaped(figure.number) + "</h2>\n<p>" + escaped(figure.title) + "</p>\n";
  for (const Plot& plot : figure.plots) {
    html += svg_of(plot);
  }
  return html + "<p class=\"dim\">" + escaped(figure.caption) + "</p>\n";
}

}  // namespace

auto thesis_page(const std::vector<ThesisTable>& tables, const std::vector<ThesisFigure>& figures) -> std::string {
  std::string html = std::string("<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">") +
                     "<title>The reference thesis on the simulator</title><style>" + kStyle + "</style></head><body>\n";
  html +=
      "<h1>The reference thesis on the simulator</h1>\n"
      "<p>F. Anooshahpour, 2017: tables and figures of the thesis beside the same experiments on the simulated "
      "instruments. KM is q2 = &beta; q1; PM is the thesis's law; <i>law</i> is PM with two more effects of the "
      "catalogue. An <b>f</b> marks a value that is fitted to the print; all others are predicted. A difference over "
      "10 % is explained where a changed experiment that is not fitted to it comes within 10 % of the print, in part "
      "where it comes nearer, and otherwise is not. What only a change comes to that was fitted to the value is "
      "counted apart.</p>\n";
  html += summary(tables);
  for (const ThesisTable& table : tables) {
    html += table_html(table);
  }
  for (const ThesisFigure& figure : figures) {
    html += figure_html(figure);
  }
  return html + "</body></html>\n";
}

}  // namespace capstan::tools
