// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/console_server/log_job.hpp"

#include <fcntl.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "capstan/hal/linux/file_descriptor.hpp"
#include "capstan/tools/apply/law_lines.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

constexpr const char* kLog = "log.csv";
constexpr const char* kLogReport = "report";
constexpr const char* kLaw = "law.toml";
constexpr const char* kSaid = "said";
constexpr const char* kLines = "lines";

auto refused(const std::string& why) -> std::string {
  return nlohmann::json{{"status", kExitRefused}, {"said", why}}.dump(-1, ' ', false,
                                                                      nlohmann::json::error_handler_t::replace);
}

auto to_write(const std::string& file) -> FileDescriptor {
  return FileDescriptor(::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600));
}

}  // namespace

auto LogJob::diagnose(std::string_view log, std::string_view options, Done done) -> bool {
  return start(log,
               {"diagnose", folder_.file(kLog), "--json", folder_.file("diagnosis.json"), "--report",
                folder_.file(kLogReport), "-o", folder_.file(kLaw)},
               options, "--target=", false, std::move(done));
}

auto LogJob::identify(std::string_view log, std::string_view options, Done done) -> bool {
  return start(log, {"identify", folder_.file(kLog), "-o", folder_.file(kLaw)}, options, "--model=", false,
               std::move(done));
}

auto LogJob::tune(std::string_view log, std::string_view options, Done done) -> bool {
  return start(log, {"tune", folder_.file(kLog), "--dump", folder_.file(kLog), "--report", folder_.file(kLogReport)},
               options, "--bandwidth=", true, std::move(done));
}

auto LogJob::start(std::string_view log, std::vector<std::string> words, std::string_view options,
                   const std::string& second, bool lines_on_stdout, Done done) -> bool {
  if (process_.running()) {
    return false;
  }
  try {
    begin(log, std::move(words), options, second, lines_on_stdout, done);
  } catch (const std::exception& why) {
    done(refused(why.what()));  // a full disk, or a folder that was swept away, is no end of the console
  }
  return true;
}

void LogJob::begin(std::string_view log, std::vector<std::string> words, std::string_view options,
                   const std::string& second, bool lines_on_stdout, const Done& done) {
  const std::string axis(options.substr(0, options.find('/')));
  axis_ = std::atoi(axis.c_str());  // what is no number, the command refuses
  words.push_back("--axis=" + axis);
  if (axis.size() + 1 < options.size()) {
    words.push_back(second + std::string(options.substr(axis.size() + 1)));
  }
  for (const auto& old : std::filesystem::directory_iterator(folder_.path())) {
    std::filesystem::remove_all(old);
  }
  write_text_file(folder_.file(kLog), std::string(log));
  words.insert(words.begin(), "capstan");
  const FileDescriptor nothing(::open("/dev/null", O_RDONLY | O_CLOEXEC));
  const FileDescriptor said = to_write(folder_.file(kSaid));
  const FileDescriptor lines = to_write(folder_.file(kLines));
  const bool begun = process_.start(
      std::move(words), {.in = nothing.get(), .out = (lines_on_stdout ? lines : said).get(), .err = said.get()},
      [this, done](int status) { done(answer(status)); });
  if (!begun) {
    done(refused("the host program does not start; try again"));
  }
}

auto LogJob::report() const -> std::optional<std::string> {
  return folder_.text(std::filesystem::path(kLogReport) / "index.html");
}

auto LogJob::answer(int status) const -> std::string {
  nlohmann::json answer = {{"status", status},
                           {"said", folder_.without_path(folder_.text(kSaid).value_or(""))},
                           {"lines", nlohmann::json::array()}};
  if (const auto diagnosis = folder_.text("diagnosis.json")) {
    answer["diagnosis"] = nlohmann::json::parse(*diagnosis, nullptr, false);
  }
  std::istringstream printed(folder_.text(kLines).value_or(""));
  for (std::string line; std::getline(printed, line);) {
    answer["lines"].push_back(line);
  }
  if (std::filesystem::exists(folder_.file(kLaw))) {
    try {
      answer["lines"] = law_lines(folder_.file(kLaw), axis_, false);
    } catch (const std::runtime_error& why) {
      answer["not_applied"] = why.what();
    }
  }
  return answer.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace capstan::tools
