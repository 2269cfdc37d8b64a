// SPDX-License-Identifier: Apache-2.0
#include "capstan/boards/browser/browser_board.hpp"

#include <algorithm>

namespace capstan {

void BrowserBoard::Sink::do_write(std::string_view more) {
  const std::size_t fits = std::min(more.size(), kMost - text.size());
  text.append(more.substr(0, fits));
  dropped_ += static_cast<std::uint32_t>(more.size() - fits);
}

BrowserBoard::BrowserBoard(std::string_view scenario)
    : BrowserBoard(scenario.empty() ? sim::Scenario{} : sim::parse_scenario(scenario, "scenario")) {}

BrowserBoard::BrowserBoard(sim::Scenario scenario)
    : scenario_(std::move(scenario)), fault_memory_(FaultLog::words_for(1 + scenario_.other_axes.size())) {
  start();
}

void BrowserBoard::start() {
  input_.reset();
  board_.reset();
  board_.emplace(scenario_, banks_, sink_, false, fault_memory_);
  input_.emplace(board_->shell());
}

auto BrowserBoard::receive(std::string_view bytes) -> std::size_t {
  const std::size_t count = std::min(bytes.size(), input_->wants());
  for (const char c : bytes.substr(0, count)) {
    input_->take(c);
  }
  return count;
}

void BrowserBoard::tick() {
  board_->tick();
  input_->poll();
  if (board_->reboot_wanted()) {
    start();
    board_->tick();
    print_banner();
  }
}

void BrowserBoard::peer_left() {
  input_->peer_left();
  board_->link_lost();
}

}  // namespace capstan
