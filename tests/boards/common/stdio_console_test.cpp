// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <string>
#include <thread>

#include "capstan/boards/common/console.hpp"
#include "capstan/boards/common/terminal_mode.hpp"

namespace capstan {
namespace {

/// A terminal with a program on it that copies its console's input to its output until the input ends.
class ProgramOnATerminal {
 public:
  ProgramOnATerminal() : master_(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)) {
    EXPECT_EQ(grantpt(master_.get()), 0);
    EXPECT_EQ(unlockpt(master_.get()), 0);
    std::array<char, 64> name{};
    EXPECT_EQ(ptsname_r(master_.get(), name.data(), name.size()), 0);
    slave_ = FileDescriptor(::open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC));
    child_ = fork();
    if (child_ == 0) {
      setsid();
      const int terminal = ::open(name.data(), O_RDWR);  // becomes the controlling one
      dup2(terminal, STDIN_FILENO);
      dup2(terminal, STDOUT_FILENO);
      copy();
    }
  }
  ~ProgramOnATerminal() {
    if (child_ > 0) {
      kill(child_, SIGKILL);
      waitpid(child_, nullptr, 0);
    }
  }

  void type(const std::string& text) const {
    EXPECT_EQ(::write(master_.get(), text.data(), text.size()), static_cast<std::ptrdiff_t>(text.size()));
  }
  auto shows(const std::string& wanted) const -> bool {
    std::string all;
    while (all.size() < wanted.size()) {
      pollfd entry{.fd = master_.get(), .events = POLLIN, .revents = 0};
      char c = 0;
      if (::poll(&entry, 1, 10'000) <= 0 || ::read(master_.get(), &c, 1) != 1) {
        break;
      }
      all += c;
    }
    return all == wanted;
  }
  auto local_modes() const -> tcflag_t {
    termios mode{};
    EXPECT_EQ(tcgetattr(slave_.get(), &mode), 0);
    return mode.c_lflag;
  }
  /// The program's end, as waitpid tells it.
  auto end_by(int signal_number) -> int {
    int status = 0;
    kill(child_, signal_number);
    waitpid(std::exchange(child_, -1), &status, 0);
    return status;
  }

 private:
  [[noreturn]] static void copy() {
    Console console = Console::stdio();
    console.write(console.is_terminal() ? "ready\n" : "no terminal\n");
    std::array<char, 64> bytes{};
    while (!console.hung_up()) {
      const std::size_t count = console.receive(bytes);
      console.write({bytes.data(), count});
      console.wait(std::chrono::milliseconds(10));
    }
    std::_Exit(0);
  }

  FileDescriptor master_;
  FileDescriptor slave_;
  pid_t child_ = -1;
};

TEST(StdioConsole, OnATerminalGetsCharactersAsTheyAreTypedAndWithoutEcho) {
  const ProgramOnATerminal program;
  ASSERT_TRUE(program.shows("ready\r\n"));
  EXPECT_EQ(program.local_modes() & (ICANON | ECHO), 0U);
  program.type("a");
  EXPECT_TRUE(program.shows("a")) << "no line end was needed, and one character came back, not two";
}

TEST(StdioConsole, GivesTheTerminalBackWhenASignalEndsTheProgram) {
  for (const int signal_number : {SIGINT, SIGTERM, SIGQUIT}) {
    ProgramOnATerminal program;
    const tcflag_t before = ICANON | ECHO;
    ASSERT_TRUE(program.shows("ready\r\n"));
    ASSERT_EQ(program.local_modes() & before, 0U);
    const int status = program.end_by(signal_number);
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal_number) << "the cause of death stays the signal";
    EXPECT_EQ(program.local_modes() & before, before);
  }
}

TEST(SerialLine, HandsADamagedByteOnAsOneThatIsNoText) {
  for (const tcflag_t before : {tcflag_t{0}, tcflag_t{IGNPAR | PARMRK}}) {
    const FileDescriptor master(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC));
    ASSERT_EQ(unlockpt(master.get()), 0);
    termios mode{};
    ASSERT_EQ(tcgetattr(master.get(), &mode), 0);
    mode.c_iflag = before;
    ASSERT_EQ(tcsetattr(master.get(), TCSANOW, &mode), 0);
    ASSERT_TRUE(make_raw(master.get(), B115200));
    ASSERT_EQ(tcgetattr(master.get(), &mode), 0);
    EXPECT_EQ(mode.c_iflag & (INPCK | IGNPAR | PARMRK), tcflag_t{INPCK}) << "termios(3): it is read as NUL then";
  }
}

TEST(StdioConsole, AFinishedPipeIsReportedOnceAfterItsLastCharacter) {
  std::array<int, 2> pipe{};
  ASSERT_EQ(::pipe(pipe.data()), 0);
  ASSERT_EQ(::write(pipe[1], "ab", 2), 2);
  ::close(pipe[1]);
  const FileDescriptor kept(dup(STDIN_FILENO));
  ASSERT_GE(dup2(pipe[0], STDIN_FILENO), 0);
  ::close(pipe[0]);
  Console console = Console::stdio();
  dup2(kept.get(), STDIN_FILENO);
  EXPECT_FALSE(console.is_terminal());
  EXPECT_TRUE(console.is_script());
  std::array<char, 8> bytes{};
  EXPECT_EQ(console.receive(bytes), 2U);
  EXPECT_FALSE(console.hung_up());
  EXPECT_EQ(console.receive(bytes), 0U);
  EXPECT_TRUE(console.hung_up());
  EXPECT_EQ(console.receive(bytes), 0U);
  EXPECT_FALSE(console.hung_up());
  EXPECT_TRUE(console.finished());
}

}  // namespace
}  // namespace capstan
