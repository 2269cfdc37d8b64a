// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace capstan::tools {

/// One table of the thesis beside the same experiment on the simulator.
struct ThesisTable {
  struct Column {
    std::string group;    ///< "printed", "simulated", or a trial
    std::string key;      ///< in JSON
    std::string heading;  ///< in text
    std::string unit;
    int decimals = 3;
    bool derived = false;  ///< follows from other columns: no difference of its own
  };
  struct Row {
    std::string name;
    std::vector<double> values;            ///< one per column; NaN: there is none
    std::vector<std::string> fitted = {};  ///< keys of the simulated values that are fitted to this table
  };
  /// A value by its row and the key of its column.
  struct Place {
    std::size_t row;
    std::string key;
  };
  /// What a difference is blamed for, changed, and the experiment repeated: the column group of that name.
  struct Trial {
    std::string group;
    std::string with, instead_of;
    std::string because;             ///< one sentence: why this may be the cause
    std::vector<Place> fitted = {};  ///< printed values that a number of the change was chosen by
  };
  std::string number;
  std::string title;
  std::vector<std::string> conditions;
  std::vector<Column> columns;
  std::vector<Row> rows;
  std::vector<Trial> trials = {};

  /// A value by row, group and key; NaN if there is none.
  [[nodiscard]] auto value(std::size_t row, const std::string& group, const std::string& key) const -> double;
};

/// Differences beyond this share of the print need a reason.
inline constexpr double kExplainedFromPercent = 10.0;

/// One simulated value beside its printed one.
struct ThesisDifference {
  struct Tested {
    const ThesisTable::Trial* trial;
    double value, percent;
    bool fitted;  ///< a number of the trial was chosen by this value
    bool helps;   ///< over the values that nothing is fitted to the trial comes nearer to the print, or there are none
    int within, within_before, values;  ///< how many of those are within 10 % with it and without, of how many
  };
  std::string row, key, heading, unit;
  int decimals = 3;
  double printed = 0.0, ours = 0.0, percent = 0.0;
  bool fitted = false;
  std::vector<Tested> tested;  ///< every trial of the table that has this value

  [[nodiscard]] auto large() const -> bool;
  /// The same as nearest(), if it brings the value within kExplainedFromPercent; else nullptr.
  [[nodiscard]] auto cause() const -> const Tested*;
  /// Of the trials that help the whole table and are not fitted to this value, the one that comes nearest to the print,
  /// if nearer than the value itself; else nullptr. One that helps a value and harms the table is chance, not a cause.
  [[nodiscard]] auto nearest() const -> const Tested*;
  /// Where there is no cause: the nearest of the trials that help the table and are fitted to this value, if it brings
  /// it within kExplainedFromPercent; else nullptr. That it can be met so is no proof.
  [[nodiscard]] auto fit() const -> const Tested*;
};

/// Every printed value that the simulator has too. The result points into the table.
auto differences_of(const ThesisTable& table) -> std::vector<ThesisDifference>;

/// What a large difference comes from: which trial explains it, or that none does.
auto reason_of(const ThesisDifference& difference) -> std::string;

/// For people: aligned columns, the differences beyond 10 % with their reasons below.
auto table_text(const ThesisTable& table) -> std::string;
auto table_json(const ThesisTable& table) -> nlohmann::json;
/// The same as a piece of a page.
auto table_html(const ThesisTable& table) -> std::string;

}  // namespace capstan::tools
