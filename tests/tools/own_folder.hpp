// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace capstan::tools::test {

/// A test with an empty folder of its own.
class OwnFolder : public testing::Test {
 protected:
  void SetUp() override {
    const testing::TestInfo& info = *testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(testing::TempDir()) /
              ("capstan_" + std::string(info.test_suite_name()) + "_" + info.name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  auto path(const std::string& name) const -> std::string { return (folder_ / name).string(); }

  std::filesystem::path folder_;
};

}  // namespace capstan::tools::test
