// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <stdexcept>

#include "capstan/tools/console_server/hub.hpp"

namespace capstan::tools {

struct Board {
  std::string sent;
  int disarmed = 0;
  int left = 0;
  int opened = 0;
  bool simulated = false;
  std::string effect = "not started anew";
  std::string refuses;
  Hub::Listener listener;
};

class FakeLine final : public BoardLine {
 public:
  explicit FakeLine(Board& board) : board_(board) {}
  void send(std::string_view bytes) override { board_.sent += bytes; }
  void disarm() override { ++board_.disarmed; }
  void peer_left() override { ++board_.left; }
  [[nodiscard]] auto every_ms() const -> int override { return 10; }
  [[nodiscard]] auto starts_anew() const -> bool override { return board_.simulated; }
  void start_anew(std::string_view effect) override {
    if (!board_.simulated) {
      BoardLine::start_anew(effect);
    } else if (effect == "no_such=1") {
      throw std::runtime_error("no such effect");
    }
    board_.effect = effect;
  }

 private:
  Board& board_;
};

class Page final : public Guest {
 public:
  std::string heard;
  std::vector<std::string> words;
  void bytes(std::string_view bytes) override { heard += bytes; }
  void say(std::string_view words_said) override { words.emplace_back(words_said); }
};

class HubTest : public testing::Test {
 protected:
  Board board;
  Hub::Clock::time_point now = Hub::Clock::now();
  Hub hub{[this](Hub::Listener listener) -> std::unique_ptr<BoardLine> {
    if (!board.refuses.empty()) {
      throw std::runtime_error(board.refuses);
    }
    ++board.opened;
    board.listener = std::move(listener);
    return std::make_unique<FakeLine>(board);
  }};
  Page first;
  Page second;
};

}  // namespace capstan::tools
