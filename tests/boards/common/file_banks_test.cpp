// SPDX-License-Identifier: Apache-2.0
#include "capstan/boards/common/file_banks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <vector>

namespace capstan {
namespace {

class FileBanksTest : public testing::Test {
 protected:
  FileBanksTest() {
    std::string name = (std::filesystem::temp_directory_path() / "capstan_banks_XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~FileBanksTest() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] auto path() const -> std::string { return (folder_ / "banks.bin").string(); }

 private:
  std::filesystem::path folder_;
};

auto contents(Banks& banks, int bank) -> std::vector<std::uint8_t> {
  std::vector<std::uint8_t> bytes(FileBanks::kBankBytes, 0);
  EXPECT_TRUE(banks.read(bank, 0, bytes));
  return bytes;
}

auto is_erased(const std::vector<std::uint8_t>& bytes) -> bool {
  return std::all_of(bytes.begin(), bytes.end(), [](std::uint8_t byte) { return byte == 0xFF; });
}

TEST_F(FileBanksTest, ANewStoreIsErasedAndOf32Kilobytes) {
  FileBanks banks(path());
  EXPECT_TRUE(is_erased(contents(banks, 0)));
  EXPECT_TRUE(is_erased(contents(banks, 1)));
  EXPECT_EQ(std::filesystem::file_size(path()), 32768U);
}

TEST_F(FileBanksTest, AStoreWhoseFirstErasingWasCutShortIsErasedAnew) {
  for (const std::size_t size : {1U, 4096U, 16384U, 32767U}) {
    std::ofstream(path(), std::ios::binary) << std::string(size, '\xFF');
    FileBanks banks(path());
    EXPECT_TRUE(is_erased(contents(banks, 1))) << size;
    EXPECT_EQ(std::filesystem::file_size(path()), 32768U);
  }
  for (const std::size_t at : {0U, 16383U}) {
    std::string held(16384, '\xFF');
    held[at] = 'x';
    std::ofstream(path(), std::ios::binary) << held;
    EXPECT_THROW(FileBanks{path()}, std::runtime_error);
    EXPECT_EQ(std::filesystem::file_size(path()), 16384U) << "it is somebody's, and stays as it was";
  }
}

TEST_F(FileBanksTest, WritingOnlyClearsBitsUntilTheBankIsErased) {
  FileBanks banks(path());
  const std::array<std::uint8_t, 1> first{0xF0};
  const std::array<std::uint8_t, 1> second{0x3C};
  std::array<std::uint8_t, 1> cell{};
  ASSERT_TRUE(banks.write(0, 100, first));
  ASSERT_TRUE(banks.write(0, 100, second));
  ASSERT_TRUE(banks.read(0, 100, cell));
  EXPECT_EQ(cell[0], 0x30);
  ASSERT_TRUE(banks.erase(0));
  ASSERT_TRUE(banks.write(0, 100, second));
  ASSERT_TRUE(banks.read(0, 100, cell));
  EXPECT_EQ(cell[0], 0x3C);
}

TEST_F(FileBanksTest, ErasingOneBankLeavesTheOther) {
  FileBanks banks(path());
  const std::array<std::uint8_t, 4> bytes{1, 2, 3, 4};
  ASSERT_TRUE(banks.write(0, FileBanks::kBankBytes - 4, bytes));
  ASSERT_TRUE(banks.write(1, 0, bytes));
  const auto before = contents(banks, 0);
  ASSERT_TRUE(banks.erase(1));
  EXPECT_EQ(contents(banks, 0), before);
  EXPECT_TRUE(is_erased(contents(banks, 1)));
}

TEST_F(FileBanksTest, NothingOutsideABankCanBeTouched) {
  FileBanks banks(path());
  std::array<std::uint8_t, 4> bytes{};
  for (const int bank : {-1, 2}) {
    EXPECT_FALSE(banks.erase(bank));
    EXPECT_FALSE(banks.write(bank, 0, bytes));
    EXPECT_FALSE(banks.read(bank, 0, bytes));
  }
  for (const std::size_t offset : {FileBanks::kBankBytes - 3, FileBanks::kBankBytes, SIZE_MAX - 1}) {
    EXPECT_FALSE(banks.write(0, offset, bytes));
    EXPECT_FALSE(banks.read(0, offset, bytes));
  }
  EXPECT_TRUE(is_erased(contents(banks, 0)));
  EXPECT_TRUE(is_erased(contents(banks, 1)));
}

TEST_F(FileBanksTest, ParametersSurviveTheProgram) {
  Config<1> saved;
  saved[0].control.kp = Q24::from_double(0.625);
  {
    FileBanks banks(path());
    ASSERT_TRUE(ParameterStorage(banks).save(saved));
    ASSERT_TRUE(ParameterStorage(banks).save(saved)) << "the second save uses the other bank";
    ASSERT_TRUE(ParameterStorage(banks).save(saved)) << "and the third erases the first";
  }
  FileBanks banks(path());
  Config<1> loaded;
  ASSERT_EQ(ParameterStorage(banks).load(loaded).result, LoadResult::kLoaded);
  EXPECT_EQ(loaded[0].control.kp.raw(), saved[0].control.kp.raw());
}

TEST_F(FileBanksTest, TemporaryBanksHaveTheSameMannersAndStartErased) {
  FileBanks banks = FileBanks::temporary();
  EXPECT_TRUE(is_erased(contents(banks, 0)));
  EXPECT_TRUE(is_erased(contents(banks, 1)));
  const std::array<std::uint8_t, 1> zero{0};
  const std::array<std::uint8_t, 1> one{1};
  std::array<std::uint8_t, 1> cell{0xAA};
  ASSERT_TRUE(banks.write(1, 7, zero));
  ASSERT_TRUE(banks.write(1, 7, one));
  ASSERT_TRUE(banks.read(1, 7, cell));
  EXPECT_EQ(cell[0], 0);
}

TEST_F(FileBanksTest, ASecondProgramIsRefusedWhileTheStoreIsInUse) {
  std::optional<FileBanks> first(std::in_place, path());
  EXPECT_THROW(FileBanks{path()}, std::runtime_error);
  first.reset();
  EXPECT_NO_THROW(FileBanks{path()});
}

TEST_F(FileBanksTest, AFileThatIsNoStoreIsRefusedAndLeftAlone) {
  std::ofstream(path()) << "precious";
  EXPECT_THROW(FileBanks{path()}, std::runtime_error);
  std::string text;
  std::ifstream(path()) >> text;
  EXPECT_EQ(text, "precious");
  EXPECT_THROW(FileBanks("/nowhere/banks.bin"), std::runtime_error);
}

}  // namespace
}  // namespace capstan
