// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/diagnose/diagnosis.hpp"

namespace capstan::tools {

/// Laws of efforts are grown from more terms than the search for names adds. What it said that the lack is most like,
/// and that it can not add, may be one of them: then the reason says that the delivered law holds it.
void say_what_is_held(Diagnosis& d);

}  // namespace capstan::tools
