// SPDX-License-Identifier: Apache-2.0
#include "capstan/boards/common/retained_memory.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <thread>

#include "capstan/tests/firmware/support.hpp"

namespace capstan {
namespace {

class RetainedMemoryFile : public testing::Test {
 protected:
  RetainedMemoryFile() { std::filesystem::create_directories(folder); }
  ~RetainedMemoryFile() override { std::filesystem::remove_all(folder); }
  [[nodiscard]] auto content() const -> std::string {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  void put(const std::string& text) const { std::ofstream(path, std::ios::binary) << text; }

  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("capstan_retained_" + std::to_string(::getpid()) + "_" +
                                                testing::UnitTest::GetInstance()->current_test_info()->name());
  const std::string path = folder / "banks.faults";
};

TEST_F(RetainedMemoryFile, WhatWasWrittenIsThereForTheNextProgramAndZeroAtFirst) {
  {
    RetainedMemory memory(path, 100);
    EXPECT_EQ(std::count(memory.words().begin(), memory.words().end(), 0U), 100);
    memory.words()[42] = 7;
    EXPECT_EQ(memory.keep(false), "");
  }
  RetainedMemory memory(path, 100);
  EXPECT_EQ(memory.words()[42], 7U);
  EXPECT_EQ(memory.remark(), "");
}

TEST_F(RetainedMemoryFile, FileTornAtAnyByteOrDamagedIsSaidAndAsGoodAsNone) {
  {
    RetainedMemory memory(path, 12);
    memory.words()[3] = 0x12345678;
    ASSERT_EQ(memory.keep(false), "");
  }
  const std::string whole = content();
  for (std::size_t cut = 0; cut < whole.size(); ++cut) {
    put(whole.substr(0, cut));
    RetainedMemory torn(path, 12);
    EXPECT_NE(torn.remark().find("torn, damaged or of another layout"), std::string::npos) << cut;
    EXPECT_EQ(torn.words()[3], 0U);
    std::string damaged = whole;
    damaged[cut] = static_cast<char>(damaged[cut] ^ 0x10);
    put(damaged);
    RetainedMemory other(path, 12);
    EXPECT_NE(other.remark(), "") << cut;
    EXPECT_EQ(other.words()[3], 0U);
  }
  put(whole + "x");
  EXPECT_NE(RetainedMemory(path, 12).remark(), "");
  put(whole);
  EXPECT_NE(RetainedMemory(path, 13).remark(), "") << "of a board with another number of joints";
}

TEST_F(RetainedMemoryFile, AFileOfSomebodyElseIsRefusedAndLeftAsItIs) {
  for (const std::string text : {"notes", "me", "time_s,axis0/q1_rad\n0,0\n"}) {
    put(text);
    EXPECT_THROW(RetainedMemory(path, 12), std::runtime_error) << text;
    EXPECT_EQ(content(), text);
  }
  put(std::string(56, '\0'));
  EXPECT_NE(RetainedMemory(path, 12).remark(), "") << "zeros are what a power cut leaves";
}

TEST_F(RetainedMemoryFile, WriteThatNeverEndedLeavesTheOldFile) {
  {
    RetainedMemory memory(path, 12);
    memory.words()[3] = 5;
    ASSERT_EQ(memory.keep(false), "");
  }
  std::ofstream(path + ".new") << "half a";
  EXPECT_EQ(RetainedMemory(path, 12).words()[3], 5U);
}

TEST_F(RetainedMemoryFile, PathThatCanNotBeWrittenIsRefusedAtOnceAndADiskThatFailsLaterIsSaidOnce) {
  EXPECT_THROW(RetainedMemory(folder / "nowhere" / "x", 12), std::runtime_error);
  RetainedMemory memory(path, 12);
  std::filesystem::remove_all(folder);
  memory.words()[0] = 1;
  EXPECT_NE(memory.keep(false).find("can not be written"), std::string::npos);
  memory.words()[0] = 2;
  EXPECT_EQ(memory.keep(false), "");
}

/// A board in a process of its own, which a fault stops or which ends with torque on, without a word.
void live_and_die(const std::string& path, bool fault) {
  RetainedMemory memory(path, FaultLog::words_for(1));
  test::FakeIo<1> io;
  test::FlashBanks banks;
  Application<test::FakeIo<1>> application(io, banks, memory.words());
  const auto cycle = [&] {
    application.rt_tick();
    static_cast<void>(memory.keep(energised(application.telemetry().state)));
  };
  cycle();
  static_cast<void>(application.post({.kind = Request::Kind::kArm}));
  for (int i = 0; i < 700; ++i) {
    cycle();
  }
  if (fault) {
    io.estop = true;
    cycle();
  } else {
    std::this_thread::sleep_for(RetainedMemory::kOldest);
    cycle();
  }
  ::kill(::getpid(), SIGKILL);
}

TEST_F(RetainedMemoryFile, FaultLogOutlivesAProgramThatIsKilledWithTheSecondBeforeTheFaultOrBeforeTheEnd) {
  for (const bool fault : {true, false}) {
    std::filesystem::remove(path);
    const pid_t child = ::fork();
    if (child == 0) {
      live_and_die(path, fault);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status));
    RetainedMemory memory(path, FaultLog::words_for(1));
    EXPECT_EQ(memory.remark(), "");
    const FaultLog log(memory.words(), 1);
    ASSERT_EQ(log.count(), 1U);
    EXPECT_EQ(log.entry(0).fault, fault ? Fault::kEmergencyStop : Fault::kNone);
    EXPECT_NEAR(static_cast<double>(log.kept()), 70.0, 2.0);
    EXPECT_EQ(log.cycles_from_fault(log.kept() - 1), 0);
  }
}

}  // namespace
}  // namespace capstan
