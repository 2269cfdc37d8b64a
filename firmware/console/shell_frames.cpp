// SPDX-License-Identifier: Apache-2.0
// The shell's machine mode: signals as binary frames between the lines of text, while everything else goes on.
#include "capstan/firmware/console/shell_commands.hpp"
#include "capstan/firmware/telemetry/telemetry_frames.hpp"

namespace capstan {
namespace {

/// Puts the column of a signal into a packet.
class PacketSink final : public TextSink {
 public:
  explicit PacketSink(telemetry::PacketWriter& packet) : packet_(packet) {}

 private:
  void do_write(std::string_view text) override { packet_.text(text); }
  telemetry::PacketWriter& packet_;
};

void send(Print& out, const telemetry::PacketWriter& packet) {
  std::array<std::uint8_t, telemetry::kMostWireBytes> wire{};
  const std::size_t size = packet.wire(wire);
  out << std::string_view(reinterpret_cast<const char*>(wire.data()), size);
}

}  // namespace

void ShellCommands::frames(Shell& shell, std::string_view arguments) {
  std::string_view rest = arguments;
  const std::string_view word = next_word(rest);
  if (word.empty()) {
    shell.out_ << "frames " << (shell.framing_ ? "on" : "off") << "\r\n";
    shell.ok();
    return;
  }
  if (word == "off") {
    shell.end_frames();
    shell.ok();
    return;
  }
  RecorderSetup setup;
  std::int32_t every = 10;
  if (parse_integer(word, every) == ParseResult::kOk) {
    arguments = rest;
  } else {
    every = 10;
  }
  if (every < 1 || every > 1000) {
    shell.error("range", "frames come every 1 to 1000 ms", "write 'frames 10 joint0.q2'");
    return;
  }
  if (!parse_signals(arguments, shell.machine_.axes(), setup.signals, setup.count)) {
    shell.error("unknown_signal", "a signal is unknown, or there are more than 8, and nothing was changed",
                "'scope signals' shows all of them; write 'frames 10 joint0.q2'");
    return;
  }
  setup.every = static_cast<std::uint32_t>(every);
  if (!shell.machine_.recorder().start(&shell, setup)) {
    shell.error("busy", "the recorder is in use, by another console or still by the last command",
                "send the line again");
    return;
  }
  shell.recorded_ = setup;
  shell.framing_ = true;
  shell.send_schema();
  shell.ok();
}

void Shell::end_frames() {
  if (framing_) {
    machine_.recorder().stop(this);
    framing_ = false;
  }
}

void Shell::send_schema() {
  telemetry::PacketWriter packet;
  packet.u8(telemetry::kSchemaTag);
  packet.u8(telemetry::kVersion);
  packet.u16(static_cast<std::uint16_t>(recorded_.every));
  packet.u8(static_cast<std::uint8_t>(recorded_.count));
  PacketSink sink(packet);
  Print columns(sink);
  for (std::size_t i = 0; i < recorded_.count; ++i) {
    packet.u8(recorded_.signals[i].info->type == SignalType::kReal ? 0 : 1);
    print_column(columns, recorded_.signals[i]);
    packet.u8(0);
  }
  schema_ = packet.close();
  schema_tick_ = machine_.telemetry().tick;
  send(out_, packet);
}

// Inlined, its packet and the schema's would be on the stack together.
[[gnu::noinline]] void Shell::send_sample(const SignalSample& sample) {
  telemetry::PacketWriter packet;
  packet.u8(telemetry::kDataTag);
  packet.u8(telemetry::kVersion);
  packet.u16(schema_);
  packet.u32(sample.tick);
  for (std::size_t channel = 0; channel < recorded_.count; ++channel) {
    packet.u32(static_cast<std::uint32_t>(sample.raw[channel]));
  }
  static_cast<void>(packet.close());
  send(out_, packet);
}

void Shell::go_on_framing() {
  constexpr int kAtOnce = 32;  // a host may sleep for 20 ms between two looks
  constexpr std::int32_t kSchemaEveryMs = 1000;
  SignalSample sample;
  for (int i = 0; i < kAtOnce && machine_.recorder().next(sample); ++i) {
    if (static_cast<std::int32_t>(sample.tick - schema_tick_) >= kSchemaEveryMs) {
      send_schema();
    }
    send_sample(sample);
  }
}

}  // namespace capstan
