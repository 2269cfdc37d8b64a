// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/report/covariance_section.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/report/html.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

auto excitation_table(const Identifiability& told) -> std::string {
  std::string html =
      "<table><tr><th>#</th><th>parameter</th><th>value</th><th>+- (95 %)</th><th>contributes [% of the target]</th>"
      "<th>its own [%]</th><th>most like</th><th>correlation</th></tr>\n";
  for (std::size_t i = 0; i < told.parameters.size(); ++i) {
    const auto& one = told.parameters[i];
    html += "<tr>" + html_number(std::to_string(i + 1)) + html_cell(one.name) + html_number(rounded(one.value, 4)) +
            html_number(one.half_width >= 0.0 ? rounded(one.half_width, 2) : "") +
            html_number(rounded(100.0 * one.share, 3)) + html_number(rounded(100.0 * one.own, 3)) +
            html_cell(one.most_alike) + html_number(one.most_alike.empty() ? "" : rounded(one.correlation, 3)) +
            "</tr>\n";
  }
  return html + "</table>\n";
}

/// Shades a correlation by its size.
auto shaded(double correlation) -> std::string {
  const double size = std::clamp(std::abs(correlation), 0.0, 1.0);
  return "<td class=\"n\" style=\"background: rgba(194, 65, 12, " + rounded(0.7 * size * size, 2) + ")\">" +
         rounded(correlation, 2) + "</td>";
}

auto correlation_table(const Identifiability& told) -> std::string {
  std::string html = "<h3>Correlation of the estimates</h3>\n<table><tr><th></th>";
  const Eigen::Index n = told.correlation.rows();
  for (Eigen::Index i = 0; i < n; ++i) {
    html += "<th>" + std::to_string(i + 1) + "</th>";
  }
  html += "</tr>\n";
  for (Eigen::Index i = 0; i < n; ++i) {
    html += "<tr>" + html_cell(std::to_string(i + 1) + " " + told.parameters[static_cast<std::size_t>(i)].name);
    for (Eigen::Index k = 0; k < n; ++k) {
      html += shaded(told.correlation(i, k));
    }
    html += "</tr>\n";
  }
  return html + "</table>\n";
}

auto what_is_not_told(const Identifiability& told) -> std::string {
  std::string html;
  for (const auto& pair : told.confused) {
    html += "<li>" + escaped(pair.sentence) + "</li>\n";
  }
  for (const auto& one : told.parameters) {
    if (one.holds_zero()) {
      html += "<li>" + escaped(one.name + ": its interval holds zero, so this log does not show that it is there.") +
              "</li>\n";
    }
  }
  return html.empty() ? "<p>No two parameters of the law stand for each other, and no interval holds zero.</p>\n"
                      : "<ul>\n" + html + "</ul>\n";
}

}  // namespace

auto covariance_section(const Identifiability& told) -> std::string {
  if (told.parameters.empty()) {
    return {};
  }
  return "<h2>What this log can and can not tell</h2>\n"
         "<p>What each parameter contributes, and how much of its regressor no other parameter can make up: little of "
         "its own means that the motion hardly excites it apart from the others.</p>\n" +
         excitation_table(told) + what_is_not_told(told) + (told.parameters.size() > 1 ? correlation_table(told) : "");
}

}  // namespace capstan::tools
