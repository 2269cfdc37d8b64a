// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/python/logs.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/python/column.hpp"
#include "capstan/tools/python/words.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/first_repeat.hpp"
#include "capstan/tools/support/text.hpp"

namespace py = pybind11;

namespace capstan::python {
namespace {

using namespace tools;
using std::filesystem::path;

auto name_of(const LogLike& log) -> std::string {
  const auto* file = std::get_if<path>(&log);
  return file != nullptr ? file->string() : std::get<const CsvLog*>(log)->name();
}

/// Of one file, however they are given. Logs of arrays have a name that is no file.
auto is_same(const LogLike& a, const LogLike& b) -> bool {
  return a == b || (std::filesystem::exists(name_of(a)) && same_file(name_of(a), name_of(b)));
}

auto read_all(const Logs& logs, const Maps& maps) -> std::vector<CsvLog> {
  if (const auto log = first_repeat(logs.all, is_same); log != logs.all.end()) {
    throw BadInput(name_of(*log) + " is given twice, and its rows would count as evidence twice; give it once");
  }
  std::vector<CsvLog> all;
  for (const auto& log : logs.all) {
    all.push_back(read_one(log, maps));
  }
  return all;
}

auto type_name(py::handle object) -> std::string {
  return py::str(py::type::of(object).attr("__name__"));
}

/// A column's name, as a file's header can have it.
auto name_in_a_header(py::handle object) -> std::string {
  py::detail::make_caster<std::string> name;
  if (!py::isinstance<py::str>(object) || !name.load(object, false)) {
    PyErr_Clear();
    throw py::type_error("a column is named " + py::str(py::str("{!a}").format(object)).cast<std::string>() +
                         "; give its name, for instance 'axis0/q1_rad'");
  }
  const std::string& text = py::detail::cast_op<std::string&>(name);
  const auto splits = [](char c) { return c == ',' || c == '"' || (static_cast<unsigned char>(c) < ' '); };
  if (text.empty() || std::any_of(text.begin(), text.end(), splits)) {
    throw BadInput("a column is named " + std::string(py::repr(object)) +
                   ", which no log can hold; give it a name without commas, double quotes and line breaks");
  }
  return text;
}

auto items_of(const py::object& columns) -> std::vector<std::pair<std::string, py::object>> {
  if (!py::hasattr(columns, "items")) {
    throw py::type_error("columns are given as " + type_name(columns) +
                         "; give names with their arrays, for instance {'time_s': t, 'axis0/q1_rad': q1}");
  }
  std::vector<std::pair<std::string, py::object>> items;
  for (const auto item : columns.attr("items")()) {
    const auto pair = item.cast<py::tuple>();
    items.emplace_back(name_in_a_header(pair[0]), pair[1]);
  }
  return items;
}

}  // namespace

auto log_like(py::handle object) -> LogLike {
  if (py::isinstance<CsvLog>(object)) {
    return object.cast<const CsvLog*>();
  }
  if (py::detail::make_caster<path> file; file.load(object, true)) {
    return py::detail::cast_op<path>(std::move(file));
  }
  throw py::type_error("a log is given as " + type_name(object) +
                       "; give the path of one, or what read_log() or log() returned");
}

auto logs_of(py::handle object) -> Logs {
  if (!py::isinstance<py::list>(object) && !py::isinstance<py::tuple>(object)) {
    return {{log_like(object)}};
  }
  Logs logs;
  for (const auto one : object) {
    logs.all.push_back(log_like(one));
  }
  return logs;
}

auto files_of(const Logs& logs) -> std::vector<std::string> {
  std::vector<std::string> files;
  for (const auto& log : logs.all) {
    if (std::filesystem::exists(name_of(log))) {
      files.push_back(name_of(log));
    }
  }
  return files;
}

auto mappings_of(const Maps& maps) -> std::vector<ColumnMapping> {
  if (const auto* texts = std::get_if<std::vector<std::string>>(&maps)) {
    return parse_mappings(*texts);
  }
  std::vector<std::string> texts;
  for (const auto& [wanted, expression] : std::get<0>(maps)) {
    texts.push_back(wanted + "=" + expression);
  }
  return parse_mappings(texts);
}

auto log_of_columns(const py::object& columns, const Maps& maps) -> CsvLog {
  std::vector<Column> read;
  std::string text;
  for (const auto& [name, values] : items_of(columns)) {
    read.push_back(column_of(values, "column " + name));
    text += (read.size() > 1 ? "," : "") + name;
    if (const auto rows = read.back().values.size(); rows != read.front().values.size()) {
      throw BadInput("column " + name + " has " + std::to_string(rows) + " values and others have " +
                     std::to_string(read.front().values.size()) + "; give one for each row");
    }
  }
  text += "\n";
  for (Eigen::Index row = 0; !read.empty() && row < read.front().values.size(); ++row) {
    for (const Column& column : read) {
      const double value = column.values[row];
      text += (&column == &read.front() ? "" : ",") + (std::isnan(value) ? "" : exact(value));
    }
    text += "\n";
  }
  return CsvLog::parse(std::move(text), kArrays, mappings_of(maps));
}

auto read_one(const LogLike& log, const Maps& maps) -> CsvLog {
  auto mappings = mappings_of(maps);
  if (const auto* file = std::get_if<path>(&log)) {
    return CsvLog::read(file->string(), std::move(mappings));
  }
  if (!mappings.empty()) {
    throw BadInput("map is for files; give it to read_log() or log(), where the log comes from");
  }
  return *std::get<const CsvLog*>(log);
}

auto read_some(const Logs& logs, const Maps& maps) -> std::vector<CsvLog> {
  auto all = read_all(logs, maps);
  if (all.empty()) {
    throw BadInput("there is no log; give the path of one, or a log that was read");
  }
  return all;
}

auto read_tests(const Logs& tests, const Logs& fitted, const Maps& maps) -> std::vector<CsvLog> {
  for (const auto& test : tests.all) {
    if (std::any_of(fitted.all.begin(), fitted.all.end(), [&](const auto& log) { return is_same(log, test); })) {
      throw BadInput("test has " + name_of(test) + ", which is among the logs that are fitted; give one that is not");
    }
  }
  return read_all(tests, maps);
}

}  // namespace capstan::python
