// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/python/column.hpp"

#include <pybind11/numpy.h>

#include <limits>
#include <string_view>

namespace py = pybind11;

namespace capstan::python {
namespace {

auto in_seconds(const py::object& times, bool of_calendar) -> py::object {
  const py::object second = py::module_::import("numpy").attr("timedelta64")(1, "s");
  return (of_calendar ? times - times[py::slice(0, 1, 1)] : times) / second;
}

/// Columns of a DataFrame that NumPy would take for objects: times of a zone, and numbers with pandas.NA.
auto plain(py::object column) -> py::object {
  const py::object dtype = py::getattr(column, "dtype", py::none());
  if (!py::getattr(dtype, "tz", py::none()).is_none()) {
    return py::getattr(column, "dt", column).attr("tz_convert")(py::none());
  }
  constexpr std::string_view kNumbers = "iufb";
  if (py::hasattr(dtype, "na_value") && kNumbers.find(dtype.attr("kind").cast<char>()) != std::string_view::npos) {
    using py::literals::operator""_a;
    return column.attr("to_numpy")("dtype"_a = "float64", "na_value"_a = std::numeric_limits<double>::quiet_NaN());
  }
  return column;
}

}  // namespace

auto column_of(py::handle source, const std::string& what) -> Column {
  auto numbers = plain(py::reinterpret_borrow<py::object>(source));
  const bool masked = py::hasattr(numbers, "filled");
  if (const auto array = py::array::ensure(numbers)) {
    const char kind = array.dtype().kind();
    if (kind == 'c') {
      throw py::type_error(what + " is of complex numbers; give their real part, or what they stand for");
    }
    if (kind == 'M' || kind == 'm') {
      numbers = in_seconds(masked ? numbers : py::object(array), kind == 'M');
    }
  }
  if (masked) {
    numbers = numbers.attr("astype")("float64").attr("filled")(std::numeric_limits<double>::quiet_NaN());
  }
  py::detail::make_caster<Eigen::VectorXd> values;
  if (!values.load(numbers, true)) {
    throw py::type_error(what + " is given as " + std::string(py::str(py::type::of(source).attr("__name__"))) +
                         "; give numbers in one dimension, one for each row");
  }
  return {py::detail::cast_op<Eigen::VectorXd>(values)};
}

}  // namespace capstan::python
