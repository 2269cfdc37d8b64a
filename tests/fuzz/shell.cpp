// SPDX-License-Identifier: Apache-2.0
// Any bytes on the console: every line is answered once, nothing hangs, no set of parameters is unsound, and no joint
// has torque unless somebody armed it.
#include <cstdlib>

#include "capstan/firmware/console/shell_input.hpp"
#include "capstan/tests/firmware/support.hpp"

namespace {

using Bench = capstan::test::Bench<2>;

void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

void look(const Bench& bench, bool armed) {
  require(bench.io.has_torque() == energised(bench.state()));
  require(armed || !bench.io.has_torque());
  for (const capstan::AxisConfig& axis : bench.application.config()) {
    require(check(axis) == nullptr);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kLongest = 2048;
  constexpr int kPatience = 300;
  // The second byte decides whether it is a terminal, with editing, history and completion.
  Bench bench(size > 1 && data[1] % 2 == 0);
  capstan::ShellInput input(bench.shell);
  const std::string_view text(reinterpret_cast<const char*>(data), std::min(size, kLongest));
  const bool may_arm = text.empty() || text.front() % 2 == 0;
  const auto make_room = [&] {  // what takes characters owes it; none comes while a stream runs
    for (int i = 0; i < kPatience && input.room() == 0; ++i) {
      bench.application.rt_tick();
      input.poll();
    }
  };
  for (const char c : text) {
    if (!may_arm && (c == 'm' || c == '\t')) {
      continue;  // without this letter nobody can arm, whatever is edited, dropped, mistaken or completed
    }
    make_room();
    if (input.room() == 0) {
      input.take('\x03');  // it streams: as a person would end it
    } else {
      input.take(c);
    }
    if (c == '\n') {
      bench.application.rt_tick();
      input.poll();
      look(bench, may_arm);
    }
  }
  make_room();
  input.take('\x03');
  for (int i = 0; i < kPatience && (bench.shell.busy() || !input.empty()); ++i) {
    bench.application.rt_tick();
    input.poll();
    if (bench.shell.busy() && i % 100 == 99) {
      input.take('\x03');
    }
  }
  require(!bench.shell.busy());
  look(bench, may_arm);
  input.peer_left();  // frames end with it, or they would stand in the last answer
  bench.sink.take();
  const std::string answer = bench.say("disarm");
  require(bench.answered && answer.find("ok\r\n") != std::string::npos);
  require(!bench.io.has_torque());
  return 0;
}
