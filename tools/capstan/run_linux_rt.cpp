// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/capstan/run_linux_rt.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {

void run_linux_rt(std::vector<std::string> words) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error).parent_path() / "capstan_linux_rt";
  words.insert(words.begin(), program.string());
  std::vector<char*> arguments;
  for (std::string& word : words) {
    arguments.push_back(word.data());
  }
  arguments.push_back(nullptr);
  execv(arguments.front(), arguments.data());
  throw BadInput(program.string() + " does not run (" + std::strerror(errno) +
                 "); build it: cmake --build build/host-release --target capstan_linux_rt");
}

}  // namespace capstan::tools
