// SPDX-License-Identifier: Apache-2.0
// Any text as an expression of --map: it is refused with a reason, or it gives one number per row and changes no
// column.
#include <cmath>
#include <cstdlib>

#include "capstan/tools/log/column_expression.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace capstan::tools;
  const auto require = [](bool holds) {
    if (!holds) {
      std::abort();
    }
  };
  const std::vector<std::string> names = {"a", "b", "a-b", "Motor [deg]", "2", "axis0/q1_rad", "strom(A)", "deg", "v0"};
  try {
    const ColumnExpression expression(std::string_view(reinterpret_cast<const char*>(data), size), names);
    std::vector<Eigen::VectorXd> values;
    for (const std::size_t index : expression.columns()) {
      require(index < names.size());
      values.push_back(Eigen::VectorXd::LinSpaced(5, -1.0, static_cast<double>(index)));
    }
    const auto before = values;
    require(expression.evaluate(values).size() == 5);
    for (std::size_t i = 0; i < values.size(); ++i) {
      require(values[i] == before[i]);
    }
  } catch (const BadExpression& why) {
    require(!std::string(why.what()).empty());
  }
  return 0;
}
