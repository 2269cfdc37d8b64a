// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

namespace fs = std::filesystem;

class TextFile : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  static auto contents(const fs::path& path) -> std::string {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  const fs::path folder_ = fs::temp_directory_path() / ("capstan_text_file_" + std::to_string(getpid()));
};

TEST_F(TextFile, ReplacesAFileAndLeavesNoPart) {
  const fs::path path = folder_ / "law.toml";
  write_text_file(path.string(), "before");
  write_text_file(path.string(), "now");
  EXPECT_EQ(contents(path), "now");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
}

TEST_F(TextFile, GoesIntoAPipeThatStays) {
  const fs::path path = folder_ / "pipe";
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  std::string read;
  std::thread reader([&] { read = contents(path); });
  write_text_file(path.string(), "into the pipe");
  reader.join();
  EXPECT_EQ(read, "into the pipe");
  EXPECT_TRUE(fs::is_fifo(path));
}

TEST_F(TextFile, ThatCanNotBeWrittenIsRefusedAndNothingIsLeft) {
  EXPECT_THROW(write_text_file((folder_ / "no" / "law.toml").string(), "x"), BadInput);
  EXPECT_THROW(write_text_file(folder_.string(), "x"), BadInput);
  EXPECT_TRUE(fs::is_empty(folder_));
}

}  // namespace
}  // namespace capstan::tools
