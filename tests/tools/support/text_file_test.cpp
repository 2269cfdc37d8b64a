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

TEST_F(TextFile, LeavesOtherFilesAloneWhateverTheyAreCalled) {
  const fs::path part = folder_ / "law.toml.part";
  std::ofstream(part) << "mine";
  const fs::path taken = folder_ / ("law.toml." + std::to_string(getpid()) + ".part");
  std::ofstream(taken) << "mine too";
  write_text_file((folder_ / "law.toml").string(), "now");
  EXPECT_EQ(contents(part), "mine");
  EXPECT_EQ(contents(taken), "mine too");
  EXPECT_EQ(contents(folder_ / "law.toml"), "now");
}

TEST_F(TextFile, ThroughALinkReplacesWhatItPointsToAndKeepsItsPermissions) {
  const fs::path real = folder_ / "law_3.toml";
  const fs::path link = folder_ / "current.toml";
  std::ofstream(real) << "before";
  fs::permissions(real, fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("law_3.toml", link);
  write_text_file(link.string(), "now");
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(contents(real), "now");
  EXPECT_EQ(fs::status(real).permissions(), fs::perms::owner_read | fs::perms::owner_write);
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
