// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <string>

#include "capstan/hal/linux/file_descriptor.hpp"
#include "capstan/hal/sim/scenario.hpp"

namespace capstan::sim {

/// Opens the line to a board. "connect:PATH" goes to a Unix socket that the board's emulator opens, waiting up to ten
/// seconds; "listen:PATH" waits there for a board; "tcp:PORT" waits on loopback; "pty" makes a terminal and names it on
/// standard output. Throws std::runtime_error with "sentence; cure".
[[nodiscard]] FileDescriptor open_line(const std::string& line);

struct ServeOptions {
  std::uint64_t most_cycles = UINT64_MAX;
  std::ostream* record = nullptr;  ///< gets one line of numbers for each cycle
};

struct ServeReport {
  std::uint64_t cycles = 0;  ///< how far the plant was advanced
  double first_joint_rad = 0.0;
  std::string failure;  ///< why the plant stopped, or empty
};

/// The plant's end of hal/plant_link: serves a board of `board_axes` axes over an open file, in lock-step, until the
/// board closes it, the most cycles are done or the plant diverges. The scenario's motion plays no part: the board
/// moves the joint. Throws std::invalid_argument if the instrument has more axes than the board or the board more
/// than 4.
[[nodiscard]] ServeReport serve(int file, const Scenario& scenario, std::size_t board_axes,
                                const ServeOptions& options = {});

}  // namespace capstan::sim
