// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/flash/programmer.hpp"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

extern char** environ;

namespace capstan::tools {
namespace {

constexpr const char* kSector0 = "0x08000000";
constexpr const char* kCode = "0x0800C000";

auto in_path(const std::string& program) -> bool {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  std::string folder;
  while (std::getline(folders, folder, ':')) {
    if (::access((folder + "/" + program).c_str(), X_OK) == 0) {
      return true;
    }
  }
  return false;
}

}  // namespace

auto programmers() -> const std::vector<std::string>& {
  static const std::vector<std::string> kNames = {"openocd", "st-flash", "dfu-util", "stm32flash"};
  return kNames;
}

auto choose_programmer(const std::string& wanted, const std::string& serial) -> std::string {
  const auto& names = programmers();
  if (!wanted.empty() && std::find(names.begin(), names.end(), wanted) == names.end()) {
    throw BadInput("'" + wanted + "' is no program that writes the board; use one of " + joined(names));
  }
  if (wanted == "stm32flash" && serial.empty()) {
    throw BadInput("stm32flash needs the device of the boot loader; give it with --boot-port /dev/ttyUSB0");
  }
  for (const std::string& name : names) {
    const bool usable = wanted.empty() ? name != "stm32flash" || !serial.empty() : name == wanted;
    if (usable && in_path(name)) {
      return name;
    }
  }
  throw Refusal(wanted.empty() ? "no program that writes the board is installed; install openocd, stlink-tools or "
                                 "dfu-util, or stm32flash and give --boot-port"
                               : wanted + " is not installed; install it, or leave --tool out to use another");
}

auto programming_commands(const std::string& programmer, const FlashJob& job) -> std::vector<CommandLine> {
  if (programmer == "openocd") {
    return {{"openocd", "-f", "interface/stlink.cfg", "-f", "target/stm32f4x.cfg", "-c",
             "program {" + job.code_file + "} verify " + kCode, "-c",
             "program {" + job.sector0_file + "} verify reset exit " + kSector0}};
  }
  if (programmer == "st-flash") {  // reads back by itself what it wrote
    return {{"st-flash", "write", job.code_file, kCode}, {"st-flash", "--reset", "write", job.sector0_file, kSector0}};
  }
  if (programmer == "dfu-util") {
    const CommandLine device = {"dfu-util", "-d", "0483:df11", "-a", "0"};
    CommandLine code = device;
    code.insert(code.end(), {"-s", kCode, "-D", job.code_file});
    CommandLine sector0 = device;
    sector0.insert(sector0.end(), {"-s", std::string(kSector0) + ":leave", "-D", job.sector0_file});
    return {code, sector0};
  }
  // The second call goes on with the boot loader that the first one has woken (-c).
  // Without its length a piece at the flash's start has versions up to 0.6 erase the whole chip.
  const auto piece = [](const char* address, std::size_t bytes) {
    return std::string(address) + ":" + std::to_string(bytes);
  };
  return {{"stm32flash", "-w", job.code_file, "-v", "-S", piece(kCode, job.code_bytes), job.serial},
          {"stm32flash", "-c", "-w", job.sector0_file, "-v", "-S", piece(kSector0, job.sector0_bytes), "-g", kSector0,
           job.serial}};
}

auto run_program(const CommandLine& command, HeldStops& stops) -> int {
  std::vector<char*> words;
  for (const std::string& word : command) {
    words.push_back(const_cast<char*>(word.c_str()));
  }
  words.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);
  posix_spawnattr_t attributes;
  ::posix_spawnattr_init(&attributes);
  ::posix_spawnattr_setsigmask(&attributes, &stops.usual());
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  pid_t child = -1;
  const int failed = ::posix_spawnp(&child, words[0], &actions, &attributes, words.data(), environ);
  ::posix_spawnattr_destroy(&attributes);
  ::posix_spawn_file_actions_destroy(&actions);
  int status = 0;
  if (failed != 0) {
    return 127;
  }
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (stops.came(std::chrono::milliseconds(20))) {
      ::kill(child, SIGTERM);
    }
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace capstan::tools
