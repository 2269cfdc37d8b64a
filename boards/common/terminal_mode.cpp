// SPDX-License-Identifier: Apache-2.0
#include "capstan/boards/common/terminal_mode.hpp"

#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>

namespace capstan {
namespace {

// A signal handler needs them, so they cannot be members.
termios original_mode{};
volatile std::sig_atomic_t mode_changed = 0;

void restore_mode() {
  if (mode_changed != 0) {
    mode_changed = 0;
    static_cast<void>(tcsetattr(STDIN_FILENO, TCSANOW, &original_mode));
  }
}

extern "C" void restore_mode_and_end(int signal_number) {
  restore_mode();
  static_cast<void>(std::signal(signal_number, SIG_DFL));
  static_cast<void>(std::raise(signal_number));
}

/// Only where the program has not taken the signal itself: then it ends through the destructor.
void restore_on_signals() {
  for (const int signal_number : std::array{SIGINT, SIGTERM, SIGHUP, SIGQUIT}) {
    struct sigaction now {};
    if (sigaction(signal_number, nullptr, &now) == 0 && now.sa_handler == SIG_DFL) {
      now.sa_handler = restore_mode_and_end;
      static_cast<void>(sigaction(signal_number, &now, nullptr));
    }
  }
}

}  // namespace

auto make_raw(int fd, speed_t speed) -> bool {
  termios mode{};
  if (tcgetattr(fd, &mode) != 0) {
    return false;
  }
  cfmakeraw(&mode);
  if (speed != 0) {
    mode.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | CRTSCTS);
    mode.c_cflag |= CLOCAL | CREAD;
    // A byte that came damaged is handed on as NUL, which the shell refuses with its line.
    mode.c_iflag = (mode.c_iflag & ~static_cast<tcflag_t>(IGNPAR)) | INPCK;
    if (cfsetispeed(&mode, speed) != 0 || cfsetospeed(&mode, speed) != 0) {
      return false;
    }
  }
  return tcsetattr(fd, TCSANOW, &mode) == 0;
}

CharacterMode::CharacterMode() {
  if (mode_changed != 0 || tcgetattr(STDIN_FILENO, &original_mode) != 0) {
    return;
  }
  termios mode = original_mode;
  mode.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  mode.c_cc[VMIN] = 1;
  mode.c_cc[VTIME] = 0;
  mode.c_cc[VSUSP] = _POSIX_VDISABLE;
  if (tcsetattr(STDIN_FILENO, TCSANOW, &mode) != 0) {
    return;
  }
  mode_changed = 1;
  active_ = true;
  restore_on_signals();
  static const int kRegistered = std::atexit(restore_mode);
  static_cast<void>(kRegistered);
}

CharacterMode::~CharacterMode() {
  if (active_) {
    restore_mode();
  }
}

}  // namespace capstan
