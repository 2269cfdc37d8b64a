// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "capstan/tests/tools/machines/drawn_machines.hpp"

namespace capstan::tools::machines {

/// A way in which somebody else might have recorded the same motion of the same machine.
struct Way {
  std::string name;
  auto(*record)(DrawnMachine log) -> DrawnMachine;
};

/// As it is; behind a rest; from other zeros; with half of the rows, twice as many or some lost; with time stamps that
/// tremble; with noise, coarse steps or a few wild values in what a law is to explain. What is drawn is the same in
/// every run.
auto ways() -> std::vector<Way>;

/// The CSV files of a folder. Throws BadInput as CsvLog does.
auto read_machines(const std::string& folder) -> std::vector<DrawnMachine>;

}  // namespace capstan::tools::machines
