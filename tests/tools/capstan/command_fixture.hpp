// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "capstan/tests/tools/synthetic_joint.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {

struct Outcome {
  int status = -1;
  std::string output;  ///< stdout and stderr
};

/// The host program in a folder of the test's own.
class Command : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              ("capstan_command_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  auto path(const std::string& name) const -> std::string { return (folder_ / name).string(); }

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

  std::filesystem::path folder_;
};

inline auto short_log(double rate_hz) -> test::SyntheticRequest {
  test::SyntheticRequest request;
  request.rate_hz = rate_hz;
  request.cycle_s = 12.0;
  request.cycles = 1;
  return request;
}

}  // namespace capstan::tools
