// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "capstan/tools/log/csv_log.hpp"

namespace capstan::python {

/// A log as a caller has it: a file, or a log that was read, which is never null.
using LogLike = std::variant<std::filesystem::path, const tools::CsvLog*>;
/// One, or several in a list.
struct Logs {
  std::vector<LogLike> all;
};
/// {"axis0/q1_rad": "motor*0.01"}, or the texts of --map.
using Maps = std::variant<std::map<std::string, std::string>, std::vector<std::string>>;

/// Throws a TypeError for what is no log: pybind11 would take None for a pointer to none.
auto log_like(pybind11::handle object) -> LogLike;
auto logs_of(pybind11::handle object) -> Logs;

/// The files among them: also those of logs that were read.
auto files_of(const Logs& logs) -> std::vector<std::string>;

auto mappings_of(const Maps& maps) -> std::vector<tools::ColumnMapping>;
/// A log of a mapping of names to arrays; cells are empty where nothing was measured. Throws a TypeError for what is no
/// such mapping, BadInput as the rest here.
auto log_of_columns(const pybind11::object& columns, const Maps& maps) -> tools::CsvLog;
auto read_one(const LogLike& log, const Maps& maps) -> tools::CsvLog;
/// Each once, and at least one.
auto read_some(const Logs& logs, const Maps& maps) -> std::vector<tools::CsvLog>;
/// Logs that judge a law; one that is fitted is not unseen.
auto read_tests(const Logs& tests, const Logs& fitted, const Maps& maps) -> std::vector<tools::CsvLog>;

}  // namespace capstan::python

template <>
struct pybind11::detail::type_caster<capstan::python::LogLike> {
  PYBIND11_TYPE_CASTER(capstan::python::LogLike, const_name("Union[os.PathLike, capstan.Log]"));

  auto load(handle source, bool) -> bool {
    value = capstan::python::log_like(source);
    return true;
  }
};

template <>
struct pybind11::detail::type_caster<capstan::python::Logs> {
  PYBIND11_TYPE_CASTER(capstan::python::Logs, const_name("Union[os.PathLike, capstan.Log, list]"));

  auto load(handle source, bool) -> bool {
    value = capstan::python::logs_of(source);
    return true;
  }
};
