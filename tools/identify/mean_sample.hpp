// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "capstan/model/sample.hpp"

namespace capstan::tools {

/// One sample in the place of several that follow each other: ways add up, the direction is that of most, the rest are
/// means; what is no signal (a filter's gain, say) is that of the last. @pre there is one
auto mean_sample(std::span<const Sample<double>> samples) -> Sample<double>;

}  // namespace capstan::tools
