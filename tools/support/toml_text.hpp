// SPDX-License-Identifier: Apache-2.0
#pragma once

// The library asserts what a person can type ("[$x]"); without that its own error says so.
#define TOML_ASSERT(expr) static_assert(true)
#include <toml++/toml.h>

#include <string>

#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {

/// TOML of any bytes, as a table of ASCII: the library's tables of letters run into undefined behaviour beyond it
/// (3.3.0, found by fuzzing), so other letters pass it as "~x" and two hexadecimal digits for each byte. Throws
/// BadInput: file, line, what is wrong and `cure`, "repair the line ..."
auto parse_toml(const std::string& text, const std::string& name, const std::string& cure) -> toml::table;

/// A text as a TOML file holds it, in quotes.
auto quoted(const std::string& text) -> std::string;

/// A text of such a table as it was written.
auto as_written(const std::string& ascii) -> std::string;

/// What `read` makes of such a table; its refusals, BadInput, name keys and values as they were written.
template <typename Read>
auto read_toml(const std::string& text, const std::string& name, const std::string& cure, Read&& read) {
  try {
    return read(parse_toml(text, name, cure));
  } catch (const BadInput& refusal) {
    throw BadInput(as_written(refusal.what()));
  }
}

}  // namespace capstan::tools
