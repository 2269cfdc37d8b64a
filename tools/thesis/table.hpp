// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace capstan::tools {

/// One table of the thesis beside the same experiment on the simulator.
struct ThesisTable {
  struct Column {
    std::string group;    ///< "printed", "simulated" or "capstan"
    std::string key;      ///< in JSON
    std::string heading;  ///< in text
    std::string unit;
    int decimals = 3;
  };
  struct Row {
    std::string name;
    std::vector<double> values;  ///< one per column; NaN: there is none
    std::string why;             ///< one sentence of physics about the difference
  };
  std::string number;
  std::string title;
  std::vector<std::string> conditions;
  std::vector<Column> columns;
  std::vector<Row> rows;
};

/// For people: aligned columns, the rows' reasons below.
auto table_text(const ThesisTable& table) -> std::string;
auto table_json(const ThesisTable& table) -> nlohmann::json;

}  // namespace capstan::tools
