// SPDX-License-Identifier: Apache-2.0

#include "capstan/tools/apply/machine_lines.hpp"
#include "capstan/tools/commission/commission.hpp"
#include "capstan/tools/report/html.hpp"
#include "capstan/tools/response/response_report.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {

auto machine_file(const std::vector<CommissionOptions>& joints, const std::vector<Progress>& progress) -> std::string {
  std::string text =
      "# Found by 'capstan commission'; every line is one of the board's: set JOINT.NAME VALUE\n"
      "schema = \"" +
      std::string(kMachineSchema) + "\"\n";
  for (std::size_t i = 0; i < joints.size(); ++i) {
    text += "\n[joint" + std::to_string(joints[i].axis) + "]\n";
    for (const auto& [name, value] : progress[i].set) {
      text += "\"" + name + "\" = \"" + value + "\"\n";
    }
  }
  return text;
}

auto write_commission_report(const std::string& folder, const Commissioned& commissioned) -> std::string {
  make_folder(folder);
  std::string items;
  for (const std::string& sentence : commissioned.progress.found) {
    items += "<li>" + escaped(sentence) + "</li>\n";
  }
  std::string rows;
  for (const auto& [name, value] : commissioned.progress.set) {
    rows += "<tr>" + html_cell(name) + html_cell(value) + "</tr>\n";
  }
  std::string page =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Commissioning</title></head><body>\n"
      "<h1>Commissioning</h1>\n<ol>\n" +
      items + "</ol>\n<h2>Parameters</h2>\n<table><tr><th>name</th><th>value</th></tr>\n" + rows + "</table>\n";
  if (commissioned.response) {
    write_response_report(folder + "/response", *commissioned.response, commissioned.tuning,
                          commissioned.progress.axis.value_or(0));
    page += "<p><a href=\"response/index.html\">Frequency response and margins</a></p>\n";
  }
  const std::string path = folder + "/index.html";
  write_text_file(path, page + "</body></html>\n");
  return path;
}

}  // namespace capstan::tools
