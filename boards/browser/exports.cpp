// SPDX-License-Identifier: Apache-2.0
// The module's face: numbers and one buffer, through which texts and bytes go both ways. A page drives it from one
// thread; a call that fails leaves a sentence in the buffer.
#include <array>
#include <cstdint>
#include <cstring>
#include <exception>
#include <memory>

#include "capstan/boards/browser/browser_board.hpp"
#include "capstan/boards/browser/tables.hpp"

namespace {

using namespace capstan;

std::array<char, 65536> buffer;
std::unique_ptr<BrowserBoard> board;

/// Puts a text, or its beginning, into the buffer.
auto put(std::string_view text) -> std::int32_t {
  const std::size_t size = std::min(text.size(), buffer.size());
  std::memcpy(buffer.data(), text.data(), size);
  return static_cast<std::int32_t>(size);
}

auto given(std::int32_t size) -> std::string_view {
  return {buffer.data(), std::min(static_cast<std::size_t>(std::max(size, 0)), buffer.size())};
}

}  // namespace

#define CAPSTAN_EXPORT extern "C" [[gnu::used, gnu::visibility("default")]]

CAPSTAN_EXPORT auto capstan_buffer() -> char* {
  return buffer.data();
}
CAPSTAN_EXPORT auto capstan_buffer_size() -> std::int32_t {
  return static_cast<std::int32_t>(buffer.size());
}

/// Starts anew with the scenario in the buffer. 0, or minus the length of a sentence: the board before goes on then.
CAPSTAN_EXPORT auto capstan_start(std::int32_t size) -> std::int32_t {
  try {
    board = std::make_unique<BrowserBoard>(given(size));
    return 0;
  } catch (const std::exception& problem) {
    return -put(problem.what());
  }
}

/// How many of the buffer's characters the shell has room for; it has them now.
CAPSTAN_EXPORT auto capstan_receive(std::int32_t size) -> std::int32_t {
  return board ? static_cast<std::int32_t>(board->receive(given(size))) : 0;
}

/// Lets time go on by so many cycles of 1 ms. Bytes that wait to be taken, or minus the length of a sentence: the plant
/// diverged, and this board is at its end.
CAPSTAN_EXPORT auto capstan_tick(std::int32_t cycles) -> std::int32_t {
  try {
    for (std::int32_t i = 0; board && i < cycles; ++i) {
      board->tick();
    }
    return board ? static_cast<std::int32_t>(board->output().size()) : 0;
  } catch (const std::exception& problem) {
    board.reset();
    return -put(problem.what());
  }
}

/// Moves what the shell said into the buffer, as much as fits; returns how much.
CAPSTAN_EXPORT auto capstan_take() -> std::int32_t {
  if (!board) {
    return 0;
  }
  const std::int32_t size = put(board->output());
  board->output().erase(0, static_cast<std::size_t>(size));
  return size;
}

CAPSTAN_EXPORT void capstan_greet() {
  if (board) {
    board->print_banner();
  }
}
CAPSTAN_EXPORT void capstan_peer_left() {
  if (board) {
    board->peer_left();
  }
}

/// The firmware's own tables, for whoever draws them; returns their length.
CAPSTAN_EXPORT auto capstan_tables() -> std::int32_t {
  return put(tables());
}
