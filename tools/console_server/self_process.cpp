// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/console_server/self_process.hpp"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/post.hpp>
#include <csignal>

#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

auto make_folder() -> std::filesystem::path {
  std::string name = (std::filesystem::temp_directory_path() / "capstan_console_XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) {
    throw BadInput(name + ": no folder can be made for logs; set TMPDIR to one that can be written");
  }
  return name;
}

}  // namespace

TemporaryFolder::TemporaryFolder() : path_(make_folder()) {}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

auto TemporaryFolder::text(const std::filesystem::path& name) const -> std::optional<std::string> {
  const std::filesystem::path file = path_ / name;
  return std::filesystem::exists(file) ? std::optional(read_text_file(file.string())) : std::nullopt;
}

auto TemporaryFolder::without_path(std::string said) const -> std::string {
  const std::string own = path_.string() + "/";
  for (std::size_t at = 0; (at = said.find(own, at)) != std::string::npos;) {
    said.erase(at, own.size());
  }
  return said;
}

SelfProcess::~SelfProcess() {
  signal(SIGKILL);
  if (waiting_.joinable()) {
    waiting_.join();
  }
}

void SelfProcess::signal(int number) const {
  if (process_ != 0) {
    ::kill(process_, number);
  }
}

auto SelfProcess::start(std::vector<std::string> words, const Streams& streams, std::function<void(int)> ended)
    -> bool {
  if (waiting_.joinable()) {
    waiting_.join();
  }
  std::vector<char*> arguments;
  for (std::string& word : words) {
    arguments.push_back(word.data());
  }
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, streams.in, STDIN_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, streams.out, STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, streams.err, STDERR_FILENO);
  pid_t process = 0;
  const int problem = ::posix_spawn(&process, "/proc/self/exe", &actions, nullptr, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (problem != 0) {
    return false;
  }
  process_ = process;
  waiting_ = std::thread([this, process, ended = std::move(ended), work = boost::asio::make_work_guard(io_)] {
    // Its number stays its own until the thread that signals it knows that it has ended.
    siginfo_t info{};
    while (::waitid(P_PID, static_cast<id_t>(process), &info, WEXITED | WNOWAIT) != 0 && errno == EINTR) {
    }
    boost::asio::post(io_, [this, process, ended] {
      int status = 0;
      ::waitpid(process, &status, 0);
      process_ = 0;
      ended(WIFEXITED(status) ? WEXITSTATUS(status) : kExitRefused);
    });
  });
  return true;
}

}  // namespace capstan::tools
