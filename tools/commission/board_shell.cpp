// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/commission/board_shell.hpp"

#include <cmath>
#include <sstream>

#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

constexpr long kMostCycles = 1'000'000;  // of one answer, 1000 s

}  // namespace

auto BoardShell::ask(const std::string& line) -> std::vector<std::string> {
  const auto stop = [&] {
    told_ = true;
    throw Stopped();
  };
  if (stopping() && (!told_ || line == "arm")) {
    stop();
  }
  try {
    return do_ask(line);
  } catch (const Refusal&) {
    if (stopping() && !told_) {
      stop();  // it cut the answer off
    }
    throw;
  }
}

auto PortShell::do_ask(const std::string& line) -> std::vector<std::string> {
  // An experiment may stay silent while the joint goes to where it begins, and commissioning until it is over. What
  // puts parameters back does not.
  return stopping() ? shell_.ask(line) : shell_.ask(line, kLongestAnswer);
}

void SimShell::tick() {
  board_.tick();
  board_.shell().poll();
  const sim::Truth& truth = board_.truth(0);
  if (!begun_) {
    begun_ = true;
    motor0_ = truth.q1_rad;
    joint0_ = truth.q2_rad;
  }
  way_.motor_rad = std::max(way_.motor_rad, std::fabs(truth.q1_rad - motor0_));
  way_.joint_rad = std::max(way_.joint_rad, std::fabs(truth.q2_rad - joint0_));
  way_.seconds += 1e-3;
}

auto SimShell::take_way() -> Way {
  begun_ = false;
  return std::exchange(way_, {});
}

auto SimShell::do_ask(const std::string& line) -> std::vector<std::string> {
  sink_.text.clear();
  for (const char c : line + "\n") {
    board_.shell().receive(c);
  }
  tick();
  for (long i = 0; i < kMostCycles && board_.shell().busy(); ++i) {
    tick();
  }
  std::vector<std::string> answer;
  std::istringstream all(sink_.text);
  for (std::string one; std::getline(all, one);) {
    while (!one.empty() && one.back() == '\r') {
      one.pop_back();
    }
    if (one == "ok") {
      return answer;
    }
    if (one.starts_with("error ")) {
      throw Refusal("the board refused '" + line + "': " + one.substr(6));
    }
    if (!one.starts_with("# ") && one != line) {
      answer.push_back(one);
    }
  }
  throw Refusal("the board did not finish its answer to '" + line + "'; restart it");
}

}  // namespace capstan::tools
