// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace capstan::tools {

/// What a board's prompt answered to several commands, one of which wrote a log: all but header and rows become
/// remarks, and line k stays line k. Where no answer is ended by `ok`, only what stands before the header does. An
/// answer 'error ...' behind the rows is added to `notes`. Any other text comes back as it is. Throws BadInput where
/// there are two logs.
auto without_prompt(std::string text, const std::string& name, std::vector<std::string>& notes) -> std::string;

}  // namespace capstan::tools
