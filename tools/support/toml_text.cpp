// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/support/toml_text.hpp"

#include <algorithm>
#include <string_view>

namespace capstan::tools {
namespace {

constexpr std::string_view kDigits = "0123456789ABCDEF";

auto to_ascii(const std::string& text) -> std::string {
  std::string ascii;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte > 0x7F || c == '~') {
      ascii += {'~', 'x', kDigits[byte >> 4U], kDigits[byte & 0xFU]};
    } else {
      ascii += c;
    }
  }
  return ascii;
}

/// TOML allows no control characters, and the library relies on it.
void require_text(const std::string& text, const std::string& name, const std::string& cure) {
  const auto bad = std::find_if(text.begin(), text.end(), [](char c) {
    return (c >= 0 && c < ' ' && c != '\t' && c != '\n' && c != '\r') || c == '\x7F';
  });
  if (bad != text.end()) {
    const auto line = static_cast<std::size_t>(std::count(text.begin(), bad, '\n')) + 1;
    throw BadInput(place(name, line) + "there are bytes that are no text; " + cure);
  }
}

}  // namespace

auto quoted(const std::string& text) -> std::string {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      result += '\\';
    }
    result += c;
  }
  return result + "\"";
}

auto as_written(const std::string& ascii) -> std::string {
  std::string text;
  for (std::size_t i = 0; i < ascii.size(); ++i) {
    const std::size_t high = i + 3 < ascii.size() ? kDigits.find(ascii[i + 2]) : std::string_view::npos;
    const std::size_t low = i + 3 < ascii.size() ? kDigits.find(ascii[i + 3]) : std::string_view::npos;
    if (ascii.compare(i, 2, "~x") == 0 && high != std::string_view::npos && low != std::string_view::npos) {
      text += static_cast<char>(static_cast<unsigned char>(high * kDigits.size() + low));
      i += 3;
    } else {
      text += ascii[i];
    }
  }
  return text;
}

auto parse_toml(const std::string& text, const std::string& name, const std::string& cure) -> toml::table {
  require_text(text, name, cure);
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // some editors begin every text with it
  try {
    return toml::parse(to_ascii(text.starts_with(kByteOrderMark) ? text.substr(kByteOrderMark.size()) : text), name);
  } catch (const toml::parse_error& error) {
    throw BadInput(place(name, static_cast<std::size_t>(error.source().begin.line)) +
                   "this is not TOML: " + std::string(error.description()) + "; " + cure);
  }
}

}  // namespace capstan::tools
