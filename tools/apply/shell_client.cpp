// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/apply/shell_client.hpp"

#include <poll.h>

#include <array>
#include <string_view>

#include "capstan/boards/stm32f405/image.hpp"
#include "capstan/tools/apply/board_port.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

constexpr std::string_view kPrompt = "capstan> ";

}  // namespace

auto bare_line(std::string_view line) -> std::string_view {
  while (line.ends_with('\r') || line.ends_with('\n')) {
    line.remove_suffix(1);
  }
  while (line.starts_with(kPrompt)) {
    line.remove_prefix(kPrompt.size());
  }
  return line;
}

ShellClient::ShellClient(const std::string& port) : line_(open_board_port(port)), port_(port) {}

auto ShellClient::read_line(std::chrono::steady_clock::time_point deadline) -> std::string {
  for (;;) {
    if (const std::size_t end = received_.find('\n'); end != std::string::npos) {
      std::string line(bare_line(std::string_view(received_).substr(0, end)));
      received_.erase(0, end + 1);
      return line;
    }
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
    pollfd set{line_.get(), POLLIN, 0};
    const int ready = left.count() <= 0 ? 0 : ::poll(&set, 1, static_cast<int>(left.count()));
    if (ready < 0 && errno == EINTR) {
      ++owed_;
      throw Refusal(port_ + ": stopped while the board was answering");
    }
    if (ready == 0) {
      throw Refusal(port_ +
                    ": no answer from the shell in time; check that a board is connected and that no other program "
                    "uses its shell");
    }
    std::array<char, 512> buffer{};
    const auto count = ::read(line_.get(), buffer.data(), buffer.size());
    if (count <= 0) {
      throw Refusal(port_ + ": the board closed the line; check its supply and that no other program uses its shell");
    }
    received_.append(buffer.data(), static_cast<std::size_t>(count));
  }
}

auto ShellClient::ask(const std::string& line, std::chrono::seconds patience) -> std::vector<std::string> {
  const std::string text = line + "\n";
  for (std::size_t sent = 0; sent < text.size();) {
    const auto count = ::write(line_.get(), text.data() + sent, text.size() - sent);
    if (count < 0) {
      throw Refusal(port_ + ": the line broke while sending; check the cable");
    }
    sent += static_cast<std::size_t>(count);
  }
  const auto deadline = std::chrono::steady_clock::now() + patience;
  std::vector<std::string> answer;
  for (;;) {
    const std::string received = read_line(deadline);
    if (owed_ > 0) {
      owed_ -= received == "ok" || received.starts_with("error ") ? 1 : 0;
      continue;
    }
    if (received == "ok") {
      return answer;
    }
    if (received == stm32f405::kDamagedImage) {
      throw Refusal(port_ + ": " + received.substr(2));  // it will never answer
    }
    if (received.starts_with("error ")) {
      throw Refusal("the board refused '" + line + "': " + received.substr(6));
    }
    if (received != line && !received.starts_with("# ")) {  // its echo, and what a board says to who comes or by itself
      answer.push_back(received);
    }
  }
}

}  // namespace capstan::tools
