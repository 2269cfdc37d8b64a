// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace capstan {

/// A table of what stands in a JSON file that the tools write, in Markdown, from its schema.
/// @param path  docs/schema/NAME.schema.json
/// @throws std::runtime_error  there is no such file, or it is no schema
auto json_table(const std::string& path) -> std::string;

}  // namespace capstan
