// SPDX-License-Identifier: Apache-2.0
// The shell's command that prints a log by the contract.
#include "capstan/firmware/console/recording.hpp"
#include "capstan/firmware/console/shell_commands.hpp"

namespace capstan {
namespace {

struct LogStream final : Stream {
  Recording recording;
  std::uint32_t rows_left = 0;

  void step(Session& session) override;
  void cancel(Session& /*session*/) override { rows_left = 0; }
};

void LogStream::step(Session& session) {
  const StepTime time(session.machine());
  SignalSample sample;
  while (rows_left > 0 && time.left() && session.machine().recorder().next(sample)) {
    --rows_left;
    recording.print_row(session.out(), sample);
  }
  if (rows_left == 0) {
    static_cast<void>(recording.end(session));
    session.ok();
  }
}

}  // namespace

void commands::log(Session& session, std::string_view arguments) {
  constexpr std::int32_t kLongest = 1'000'000;
  std::string_view joint = next_word(arguments);
  std::size_t axis = 0;
  const std::string_view count_text = next_word(arguments);
  const std::string_view every_text = next_word(arguments);
  std::int32_t count = 0;
  std::int32_t every = 1;
  if (!session.parse_axis(joint, axis) || !joint.empty() || !parse_count(count_text, 1, kLongest, count) ||
      (!every_text.empty() && !parse_count(every_text, 1, 1000, every))) {
    session.error("usage", "log takes a joint, a count up to 1000000 and a spacing of 1 to 1000 ms",
                  "write 'log joint0 100 10'");
    return;
  }
  if (session.has_beside()) {
    session.error("frames_on", "frames are being sent, and one recorder serves both", "'frames off' first");
    return;
  }
  auto& stream = session.make<LogStream>();
  stream.recording.choose(axis);
  stream.recording.setup.every = static_cast<std::uint32_t>(every);
  stream.rows_left = static_cast<std::uint32_t>(count);
  if (stream.recording.begin(session)) {
    session.begin(stream);
  }
}

}  // namespace capstan
