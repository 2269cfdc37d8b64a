// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>

#include <string>

namespace capstan::python {

/// Numbers of a caller's array. What a masked array hides is NaN; times of the calendar are seconds from the first on.
struct Column {
  Eigen::VectorXd values;
};

/// Throws a TypeError that says `what` can not be used.
auto column_of(pybind11::handle source, const std::string& what) -> Column;

}  // namespace capstan::python

template <>
struct pybind11::detail::type_caster<capstan::python::Column> {
  PYBIND11_TYPE_CASTER(capstan::python::Column, const_name("numpy.ndarray"));

  auto load(handle source, bool) -> bool {
    value = capstan::python::column_of(source, "an array");
    return true;
  }
};
