// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "capstan/tests/tools/own_folder.hpp"
#include "capstan/tests/tools/synthetic_joint.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {

struct Outcome {
  int status = -1;
  std::string output;  ///< stdout and stderr
};

/// The host program in a folder of the test's own.
class Command : public test::OwnFolder {
 protected:
  /// @param before  shell commands that set up the program's surroundings, each with its semicolon
  auto run(const std::string& arguments, const std::string& before = "") const -> Outcome {
    const std::string command =
        before + "\"" + CAPSTAN_PROGRAM + "\" " + arguments + " > \"" + path("output") + "\" 2>&1";
    Outcome outcome;
    const int result = std::system(command.c_str());
    outcome.status = WIFEXITED(result) ? WEXITSTATUS(result) : -1;
    outcome.output = read_text_file(path("output"));
    return outcome;
  }

  auto write_log(const test::SyntheticRequest& request) const -> std::string {
    write_text_file(path("log.csv"), test::log_text(test::synthetic_log(request)));
    return "\"" + path("log.csv") + "\"";
  }
  auto exists(const std::string& name) const -> bool { return std::filesystem::exists(folder_ / name); }
};

/// Shell commands that serve a simulated board; `$port` is its shell and `$board` its process, which ends with the
/// command. @param options  of `capstan run`   @param shell  tcp:0 or pty
inline auto beside_a_board(const std::string& file, const std::string& options = "", const std::string& shell = "tcp:0")
    -> std::string {
  const std::string said = "\"" + file + "\"";
  const std::string name = shell == "pty" ? "s/^shell at //p" : "s/^shell at .*:/tcp:/p";
  return ": > " + said + "; \"" CAPSTAN_PROGRAM "\" run --shell " + shell + " " + options + " >> " + said +
         " 2>&1 & board=$!; trap \"kill $board 2> /dev/null\" EXIT; for i in $(seq 200); do port=$(sed -n '" + name +
         "' " + said + "); [ -z \"$port\" ] || break; sleep 0.05; done; ";
}

inline auto short_log(double rate_hz) -> test::SyntheticRequest {
  test::SyntheticRequest request;
  request.rate_hz = rate_hz;
  request.cycle_s = 12.0;
  request.cycles = 1;
  return request;
}

}  // namespace capstan::tools
