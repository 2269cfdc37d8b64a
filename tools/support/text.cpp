// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/support/text.hpp"

#include <unistd.h>

#include <array>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <sstream>

#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/pending_file.hpp"

namespace capstan::tools {

auto trimmed(std::string_view text) -> std::string_view {
  constexpr std::string_view kBlank = " \t\r";
  const auto first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) {
    return {};
  }
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

auto parse_number(std::string_view text) -> std::optional<double> {
  text = trimmed(text);
  if (!text.empty() && text.front() == '+') {
    text.remove_prefix(1);
  }
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size()) {
    return std::nullopt;
  }
  return value;
}

auto exact(double value) -> std::string {
  std::array<char, 40> buffer{};
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return error == std::errc{} ? std::string(buffer.data(), end) : std::string("nan");
}

auto rounded(double value, int digits) -> std::string {
  std::array<char, 40> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.*g", digits, value);
  return buffer.data();
}

auto with_interval(double value, double low, double high, int digits) -> std::string {
  return rounded(value, digits) + " [" + rounded(low, 3) + ", " + rounded(high, 3) + "]";
}

auto joined(const std::vector<std::string>& words, std::string_view separator) -> std::string {
  std::string result;
  for (const auto& word : words) {
    result += result.empty() ? "" : std::string(separator);
    result += word;
  }
  return result;
}

auto same_file(const std::string& a, const std::string& b) -> bool {
  namespace fs = std::filesystem;
  std::error_code none;
  if (fs::exists(a, none) && fs::exists(b, none)) {
    return fs::is_regular_file(a, none) && fs::equivalent(a, b, none);
  }
  return fs::weakly_canonical(fs::absolute(a, none), none) == fs::weakly_canonical(fs::absolute(b, none), none);
}

void make_folder(const std::string& path) {
  std::error_code failed;
  std::filesystem::create_directories(path, failed);
  if (failed || !std::filesystem::is_directory(path)) {
    throw BadInput(path + ": the folder can not be made (" + failed.message() + "); choose another name");
  }
}

auto read_text_file(const std::string& path) -> std::string {
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path)) {
    throw BadInput(path + ": the file can not be opened; check the path");
  }
  std::ostringstream text;
  text << file.rdbuf();
  if (file.bad()) {
    throw BadInput(path + ": reading stopped half way; check the disk");
  }
  return std::move(text).str();
}

namespace {

[[noreturn]] void refuse_path(const std::string& path) {
  throw BadInput(path + ": the log can not be written; give a path in a folder that exists");
}

}  // namespace

void expect_writable(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code none;
  const bool there = fs::exists(path, none);
  const std::string folder = fs::path(path).parent_path().string();
  const std::string& asked = there ? path : folder.empty() ? "." : folder;
  if (path.empty() || fs::is_directory(path, none) || ::access(asked.c_str(), there ? W_OK : W_OK | X_OK) != 0) {
    refuse_path(path);
  }
}

auto open_to_write(const std::string& path) -> std::ofstream {
  std::ofstream file(path, std::ios::binary);
  if (!file) {
    refuse_path(path);
  }
  return file;
}

void finish_writing(std::ofstream& file, const std::string& path) {
  file.close();
  if (!file) {
    throw BadInput(path + ": the log is cut off, as the disk took no more; free some space, or give a path on another");
  }
}

void write_text_file(const std::string& path, std::string_view text) {
  PendingFile pending(path);
  std::ofstream file(pending.name(), std::ios::binary | std::ios::trunc);
  file.write(text.data(), static_cast<std::streamsize>(text.size()));
  file.close();
  if (!file) {
    throw BadInput(path + ": the file can not be written; check that the folder exists and has room");
  }
  pending.keep();
}

}  // namespace capstan::tools
