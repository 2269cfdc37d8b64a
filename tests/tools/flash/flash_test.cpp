// SPDX-License-Identifier: Apache-2.0
// `capstan flash` with programs in PATH that write a file instead of a chip, and a board that is a socket.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include "capstan/hal/linux/file_descriptor.hpp"
#include "capstan/tests/tools/flash/made_images.hpp"
#include "capstan/tools/apply/shell_client.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

namespace fs = std::filesystem;

/// Answers every line with what the test says, like a board's console on a socket.
class FakeBoard {
 public:
  FakeBoard(std::string version, std::string state) : version_(std::move(version)), state_(std::move(state)) {
    door_ = FileDescriptor(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(::bind(door_.get(), reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(::listen(door_.get(), 4), 0);
    EXPECT_EQ(::getsockname(door_.get(), reinterpret_cast<sockaddr*>(&address), &size), 0);
    port_ = ntohs(address.sin_port);
    server_ = std::thread([this] { serve(); });
  }
  ~FakeBoard() {
    ::shutdown(door_.get(), SHUT_RDWR);
    server_.join();
  }
  [[nodiscard]] auto port() const -> std::string { return "tcp:" + std::to_string(port_); }

 private:
  void serve() {
    for (;;) {
      const FileDescriptor line(::accept(door_.get(), nullptr, nullptr));
      if (!line) {
        return;
      }
      std::array<char, 256> buffer{};
      for (ssize_t count = 0; (count = ::read(line.get(), buffer.data(), buffer.size())) > 0;) {
        const std::string asked(buffer.data(), static_cast<std::size_t>(count));
        const std::string answer = asked.starts_with("version") ? version_ : "state " + state_ + " fault none";
        const std::string text = "# a line of another kind\r\n" + answer + "\r\nok\r\n";
        if (::write(line.get(), text.data(), text.size()) < 0) {
          break;
        }
      }
    }
  }

  std::string version_, state_;
  FileDescriptor door_;
  std::uint16_t port_ = 0;
  std::thread server_;
};

class FlashCommand : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              ("capstan_flash_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "bin");
    write_text_file(path("image.bin"), bin_);
    write_text_file(path("image.hex"), hex_image(bin_));
    write_text_file(path("image.elf"), elf_image(bin_));
  }
  void TearDown() override { fs::remove_all(folder_); }
  [[nodiscard]] auto path(const std::string& name) const -> std::string { return (folder_ / name).string(); }

  /// A program that notes its words and keeps copies of the files that were among them.
  void install(const std::string& name, int status = 0) {
    const std::string file = path("bin/" + name);
    write_text_file(
        file, "#!/bin/sh\necho \"$(basename $0) $*\" >> " + path("calls") +
                  "\nfor word in $*; do word=${word#?}; case \"$word\" in *sector0.bin*) cat \"/${word%\\}}\" > " +
                  path("sector0") + " ;; *code.bin*) cat \"/${word%\\}}\" > " + path("code") +
                  " ;; esac; done 2>/dev/null\nexit " + std::to_string(status) + "\n");
    fs::permissions(file, fs::perms::owner_all);
  }
  auto run(const std::string& arguments) -> int {
    const std::string command = "PATH=" + path("bin") + ":/usr/bin:/bin \"" + program_ + "\" flash " + arguments +
                                " > \"" + path("output") + "\" 2>&1";
    const int result = std::system(command.c_str());
    output_ = read_text_file(path("output"));
    return WIFEXITED(result) ? WEXITSTATUS(result) : -1;
  }
  [[nodiscard]] auto calls() const -> std::string {
    return fs::exists(path("calls")) ? read_text_file(path("calls")) : "";
  }
  [[nodiscard]] auto says(const std::string& text) const -> bool { return output_.find(text) != std::string::npos; }
  void expect_written() {
    EXPECT_EQ(read_text_file(path("sector0")), bin_.substr(0, kSector0Size));
    EXPECT_EQ(read_text_file(path("code")), bin_.substr(kCodeAt));
  }

  const std::string bin_ = bin_image("stm32f405");
  const std::string hash_ = seal_text(seal_of(bin_));
  fs::path folder_;
  std::string program_ = CAPSTAN_PROGRAM;
  std::string output_;
};

TEST_F(FlashCommand, EveryFormatWritesTheSameTwoPiecesAndLeavesTheBanksAlone) {
  install("st-flash");
  for (const char* name : {"image.bin", "image.hex", "image.elf"}) {
    fs::remove(path("calls"));
    ASSERT_EQ(run("stm32f405 " + path(name)), 0) << output_;
    EXPECT_TRUE(says("stm32f405 1.2.3 image " + hash_)) << output_;
    expect_written();
    EXPECT_NE(calls().find("code.bin 0x0800C000\n"), std::string::npos) << calls();
    EXPECT_NE(calls().find("sector0.bin 0x08000000\n"), std::string::npos) << calls();
    EXPECT_LT(calls().find("code.bin"), calls().find("sector0.bin")) << "vectors last";
    EXPECT_TRUE(says("not verified; give --port"));
  }
}

TEST_F(FlashCommand, TakesWhicheverProgramIsThereInOrder) {
  install("stm32flash");
  EXPECT_EQ(run("stm32f405 " + path("image.hex")), 1) << "stm32flash needs to know its device";
  EXPECT_TRUE(says("no program that writes the board is installed; install openocd"));
  EXPECT_EQ(calls(), "");
  ASSERT_EQ(run("stm32f405 --boot-port /dev/ttyUSB7 " + path("image.hex")), 0) << output_;
  EXPECT_NE(calls().find("stm32flash -w"), std::string::npos);
  const auto bytes = [this](const char* piece) { return std::to_string(fs::file_size(path(piece))); };
  EXPECT_NE(calls().find("-v -S 0x0800C000:" + bytes("code") + " /dev/ttyUSB7\n"), std::string::npos) << calls();
  EXPECT_NE(calls().find("-S 0x08000000:" + bytes("sector0") + " -g 0x08000000 /dev/ttyUSB7\n"), std::string::npos)
      << calls();
  for (const char* name : {"dfu-util", "st-flash", "openocd"}) {
    fs::remove(path("calls"));
    install(name);
    ASSERT_EQ(run("stm32f405 " + path("image.hex")), 0) << output_;
    EXPECT_TRUE(calls().starts_with(name)) << calls();
    expect_written();
  }
  EXPECT_NE(calls().find("verify reset exit 0x08000000"), std::string::npos);
  fs::remove(path("calls"));
  ASSERT_EQ(run("stm32f405 --tool dfu-util " + path("image.hex")), 0);
  EXPECT_NE(calls().find("dfu-util -d 0483:df11 -a 0 -s 0x08000000:leave -D "), std::string::npos) << calls();
}

TEST_F(FlashCommand, DryRunPrintsTheCommandsAndRunsNothing) {
  install("openocd");
  ASSERT_EQ(run("stm32f405 --dry-run " + path("image.elf")), 0) << output_;
  EXPECT_TRUE(says("openocd -f interface/stlink.cfg"));
  EXPECT_EQ(calls(), "");
}

// Without a name: in the package's folder beside the program, and in a build the one that was built there.
TEST_F(FlashCommand, ImageOfThePackageOrTheBuildIsFoundBesideTheProgram) {
  install("openocd");
  struct Place {
    const char* program;
    const char* images;
  };
  for (const Place& place :
       {Place{"usr/bin", "usr/share/capstan/firmware"}, Place{"build/host-release/bin", "build/stm32f405/bin"}}) {
    fs::create_directories(path(place.program));
    fs::create_directories(path(place.images));
    program_ = path(std::string(place.program) + "/capstan");
    fs::copy_file(CAPSTAN_PROGRAM, program_);
    EXPECT_EQ(run("stm32f405 --dry-run"), 2) << "no image is there yet";
    EXPECT_TRUE(says("install the package capstan-firmware")) << output_;
    EXPECT_TRUE(says("cmake --workflow --preset stm32f405")) << output_;
    const std::string image = path(std::string(place.images) + "/capstan_stm32f405.hex");
    write_text_file(image, hex_image(bin_));
    EXPECT_EQ(run("stm32f405 --dry-run"), 0) << output_;
    EXPECT_TRUE(says(image + ": stm32f405 1.2.3 image " + hash_)) << output_;
  }
}

TEST_F(FlashCommand, ImageForAnotherBoardIsRefused) {
  install("st-flash");
  write_text_file(path("other.bin"), bin_image("stm32f405-emulated"));
  EXPECT_EQ(run("stm32f405 " + path("other.bin")), 1);
  EXPECT_TRUE(says("the image is for 'stm32f405-emulated', not for 'stm32f405'; choose the other")) << output_;
  EXPECT_EQ(calls(), "");
}

TEST_F(FlashCommand, WhatIsNoImageOrDamagedIsRefusedWithItsSentence) {
  install("st-flash");
  struct Case {
    std::string text;
    int status;
    std::string sentence;
  };
  const std::string hex = hex_image(bin_);
  std::string flipped = hex;
  flipped[flipped.find('\n') + 12] ^= 1;
  std::string banks = bin_;
  banks[0x5000] = 0;
  std::string longer = bin_ + "x";
  std::string elf = elf_image(bin_);
  std::string foreign = elf;
  foreign[18] = EM_386;
  const std::vector<Case> cases = {
      {"nothing", 1, "no image of Capstan for this board; build one with"},
      {"", 1, "no image of Capstan"},
      {flipped, 2, ":2: the HEX record is damaged; copy the file again"},
      {hex.substr(0, hex.size() - 13), 2, "the HEX file has no end"},
      {hex_record(0, 4, {"\x20\x00", 2}) + hex_record(0, 0, "data") + hex_record(0, 1, ""), 1,
       "bytes outside the board's flash"},
      {banks, 1, "write over the parameter banks"},
      {longer, 2, "not as long as its header says"},
      {bin_.substr(0, bin_.size() - 1), 2, "not as long as its header says"},
      {elf.substr(0, elf.size() - 1), 2, "the ELF file is damaged"},
      {elf.substr(0, 30), 2, "the ELF file is damaged"},
      {foreign, 1, "for another processor"},
  };
  for (const Case& one : cases) {
    write_text_file(path("bad"), one.text);
    EXPECT_EQ(run("stm32f405 " + path("bad")), one.status) << one.sentence << "\n" << output_;
    EXPECT_TRUE(says(one.sentence)) << output_;
  }
  EXPECT_EQ(run("stm32f405 " + path("none")), 2) << output_;
  EXPECT_EQ(calls(), "");
}

TEST_F(FlashCommand, ABitThatIsNotAsItWasSealedIsRefusedInEveryFormatAndNothingIsWritten) {
  install("st-flash");
  // First and last byte of each piece, both sides of the seal, the seal, the image's names, their last and the code.
  for (const std::size_t at :
       {std::size_t{0}, kSealAt - 1, kSealAt, kSealAt + 3, std::size_t{0x208}, std::size_t{0x220}, kSector0Size - 1,
        kCodeAt, kCodeAt + kCodeSize / 2, kCodeAt + kCodeSize - 1}) {
    std::string flipped = bin_;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x10);
    for (const std::string& file : {flipped, hex_image(flipped), elf_image(flipped)}) {
      write_text_file(path("bad"), file);
      EXPECT_EQ(run("stm32f405 " + path("bad")), 2) << at;
      EXPECT_TRUE(
          says("bad: the image is damaged, its bytes do not agree with its seal; copy the file again or "
               "rebuild it"))
          << at << output_;
    }
  }
  EXPECT_EQ(calls(), "");
}

TEST_F(FlashCommand, AnImageWithoutASealIsSaidToHaveNone) {
  install("st-flash");
  std::string older = bin_;
  put_word(older, kSealAt, 0);
  for (const std::string& file : {older, hex_image(older), elf_image(older)}) {
    write_text_file(path("older"), file);
    EXPECT_EQ(run("stm32f405 " + path("older")), 2);
    EXPECT_TRUE(says("older: the image has no seal to check it by, as older ones have not; rebuild it")) << output_;
  }
  EXPECT_EQ(calls(), "");
}

TEST_F(FlashCommand, BoardThatAnswersWithTheImageIsTheProof) {
  install("st-flash");
  const FakeBoard board("capstan 1.2.3 board stm32f405 joints 4 parameters 60 image " + hash_, "disarmed");
  EXPECT_EQ(run("stm32f405 --port " + board.port() + " " + path("image.hex")), 0) << output_;
  EXPECT_TRUE(says("board answers: capstan 1.2.3 board stm32f405")) << output_;
}

TEST_F(FlashCommand, BoardThatStillRunsTheOldImageIsToldApart) {
  install("st-flash");
  const FakeBoard board("capstan 1.2.3 board stm32f405 joints 4 parameters 60 image 00000000", "disarmed");
  EXPECT_EQ(run("stm32f405 --port " + board.port() + " " + path("image.hex")), 1);
  EXPECT_TRUE(says("image " + hash_ + " was written; press its reset")) << output_;
}

TEST_F(FlashCommand, AnotherBoardAtThePortIsRefusedBeforeAnythingIsWritten) {
  install("st-flash");
  const FakeBoard board("capstan 1.2.3 board linux_rt joints 1 parameters 60", "disarmed");
  EXPECT_EQ(run("stm32f405 --port " + board.port() + " " + path("image.hex")), 1);
  EXPECT_TRUE(says("is 'linux_rt' and the image is for 'stm32f405'; connect the right board")) << output_;
  EXPECT_EQ(calls(), "");
}

TEST_F(FlashCommand, BoardThatSaysThatItsImageIsDamagedIsQuotedByItsClientAndCanBeFlashed) {
  install("st-flash");
  const std::string sentence =
      "the image in flash is damaged, so nothing of it runs; flash it again with 'capstan flash stm32f405'";
  const FakeBoard board("# " + sentence, "disarmed");
  try {
    ShellClient(board.port()).ask("version");
    ADD_FAILURE() << "a board answers whose image is damaged";
  } catch (const Refusal& refusal) {
    EXPECT_EQ(refusal.what(), board.port() + ": " + sentence);
  }
  EXPECT_EQ(run("stm32f405 --port " + board.port() + " " + path("image.hex")), 1) << "it still does not answer";
  EXPECT_TRUE(says("as on an empty board; going on")) << output_;
  expect_written();
}

TEST_F(FlashCommand, BoardWithTorqueOnIsLeftAlone) {
  install("st-flash");
  for (const char* state : {"armed", "holding", "moving", "stopping", "experiment"}) {
    const FakeBoard board("capstan 1.2.3 board stm32f405 joints 4 parameters 60 image " + hash_, state);
    EXPECT_EQ(run("stm32f405 --port " + board.port() + " " + path("image.hex")), 1);
    EXPECT_TRUE(says("has torque on; bring its joints to rest and 'disarm' first")) << output_;
  }
  EXPECT_EQ(calls(), "");
}

TEST_F(FlashCommand, ProgramThatFailsIsReportedAndNothingIsCalledDone) {
  install("st-flash", 9);
  EXPECT_EQ(run("stm32f405 " + path("image.hex")), 1);
  EXPECT_TRUE(says("st-flash failed with status 9")) << output_;
  EXPECT_EQ(calls().find("sector0"), std::string::npos) << "no vectors for code that is not there";
}

TEST_F(FlashCommand, AStopEndsTheWritingProgramAndItsFolderAndSaysWhatTheBoardMayHold) {
  const std::string program = path("bin/st-flash");
  for (const char* signal : {"INT", "TERM"}) {
    write_text_file(program, "#!/bin/sh\necho $$ > " + path("writer") + "\nexec sleep 60\n");
    fs::permissions(program, fs::perms::owner_all);
    fs::create_directories(path("tmp"));
    const std::string command = "cd " + folder_.string() + " && TMPDIR=" + path("tmp") + " PATH=" + path("bin") +
                                ":/usr/bin:/bin timeout --preserve-status -s " + signal + " 1 \"" + CAPSTAN_PROGRAM +
                                "\" flash stm32f405 image.hex --tool st-flash > output 2>&1";
    const int result = std::system(command.c_str());
    output_ = read_text_file(path("output"));
    EXPECT_TRUE(WIFEXITED(result) && WEXITSTATUS(result) == 1) << signal;
    EXPECT_TRUE(says("the board may hold half an image")) << output_;
    EXPECT_TRUE(fs::is_empty(path("tmp"))) << signal;
    EXPECT_NE(::kill(std::stoi(read_text_file(path("writer"))), 0), 0) << "the writer still runs";
  }
}

TEST_F(FlashCommand, WrongNamesAreBadInput) {
  EXPECT_EQ(run("sim " + path("image.hex")), 2);
  EXPECT_TRUE(says("'sim' is not a board that can be flashed")) << output_;
  EXPECT_EQ(run("stm32f405 --tool hammer " + path("image.hex")), 2);
  EXPECT_TRUE(says("use one of openocd, st-flash, dfu-util, stm32flash")) << output_;
  EXPECT_EQ(run("stm32f405 --tool stm32flash " + path("image.hex")), 2);
  EXPECT_EQ(run("stm32f405 --tool openocd " + path("image.hex")), 1);
  EXPECT_TRUE(says("openocd is not installed")) << output_;
}

}  // namespace
}  // namespace capstan::tools
