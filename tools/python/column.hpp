// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>

#include <limits>

namespace capstan::python {

/// Numbers of a caller's array; what a masked array hides is NaN.
struct Column {
  Eigen::VectorXd values;
};

}  // namespace capstan::python

template <>
struct pybind11::detail::type_caster<capstan::python::Column> {
  PYBIND11_TYPE_CASTER(capstan::python::Column, const_name("numpy.ndarray"));

  auto load(handle source, bool convert) -> bool {
    auto numbers = reinterpret_borrow<object>(source);
    if (hasattr(numbers, "filled")) {
      numbers = numbers.attr("astype")("float64").attr("filled")(std::numeric_limits<double>::quiet_NaN());
    }
    make_caster<Eigen::VectorXd> inner;
    if (!inner.load(numbers, convert)) {
      return false;
    }
    value.values = cast_op<Eigen::VectorXd>(inner);
    return true;
  }
};
