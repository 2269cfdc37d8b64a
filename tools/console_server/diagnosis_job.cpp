// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/console_server/diagnosis_job.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/post.hpp>
#include <csignal>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "capstan/tools/apply/law_lines.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

auto temporary_folder() -> std::filesystem::path {
  std::string name = (std::filesystem::temp_directory_path() / "capstan_console_XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) {
    throw BadInput(name + ": no folder can be made for logs; set TMPDIR to one that can be written");
  }
  return name;
}

/// This program once more, in `folder`; what it says goes into the file `said`.
auto run_self(std::vector<std::string> words, const std::filesystem::path& said) -> pid_t {
  std::vector<char*> arguments;
  for (std::string& word : words) {
    arguments.push_back(word.data());
  }
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, said.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  ::posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  pid_t process = 0;
  const int problem = ::posix_spawn(&process, "/proc/self/exe", &actions, nullptr, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  return problem == 0 ? process : 0;
}

auto text_if_there(const std::filesystem::path& file) -> std::optional<std::string> {
  return std::filesystem::exists(file) ? std::optional(read_text_file(file.string())) : std::nullopt;
}

}  // namespace

DiagnosisJob::DiagnosisJob(boost::asio::io_context& io) : io_(io), folder_(temporary_folder()) {}

DiagnosisJob::~DiagnosisJob() {
  if (process_ != 0) {
    ::kill(process_, SIGKILL);
  }
  if (waiting_.joinable()) {
    waiting_.join();
  }
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

auto DiagnosisJob::start(std::string_view log, const std::string& target, std::function<void(std::string)> done)
    -> bool {
  if (process_ != 0) {
    return false;
  }
  if (waiting_.joinable()) {
    waiting_.join();
  }
  for (const auto& old : std::filesystem::directory_iterator(folder_)) {
    std::filesystem::remove_all(old);
  }
  const auto file = [this](const char* name) { return (folder_ / name).string(); };
  write_text_file(file("log.csv"), std::string(log));
  std::vector<std::string> words = {
      "capstan",      "diagnose", file("log.csv"), "--json", file("diagnosis.json"), "--report",
      file("report"), "-o",       file("law.toml")};
  if (!target.empty()) {
    words.push_back("--target=" + target);
  }
  process_ = run_self(std::move(words), folder_ / "said");
  if (process_ == 0) {
    done(nlohmann::json{{"status", kExitRefused}, {"said", "the diagnosis does not start; try again"}}.dump());
    return true;
  }
  waiting_ = std::thread([this, process = process_, done = std::move(done), work = boost::asio::make_work_guard(io_)] {
    int status = 0;
    ::waitpid(process, &status, 0);
    boost::asio::post(io_, [this, done, status] {
      process_ = 0;
      done(answer(WIFEXITED(status) ? WEXITSTATUS(status) : kExitRefused));
    });
  });
  return true;
}

auto DiagnosisJob::report() const -> std::optional<std::string> {
  return text_if_there(folder_ / "report" / "index.html");
}

auto DiagnosisJob::answer(int status) const -> std::string {
  std::string said = text_if_there(folder_ / "said").value_or("");
  for (std::size_t at = 0; (at = said.find(folder_.string() + "/", at)) != std::string::npos;) {
    said.erase(at, folder_.string().size() + 1);  // the page's user knows no such folder
  }
  nlohmann::json answer = {{"status", status}, {"said", said}, {"lines", nlohmann::json::array()}};
  if (const auto diagnosis = text_if_there(folder_ / "diagnosis.json")) {
    answer["diagnosis"] = nlohmann::json::parse(*diagnosis, nullptr, false);
  }
  if (std::filesystem::exists(folder_ / "law.toml")) {
    try {
      answer["lines"] = law_lines((folder_ / "law.toml").string(), 0, false);
    } catch (const std::runtime_error& why) {
      answer["not_applied"] = why.what();
    }
  }
  return answer.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace capstan::tools
