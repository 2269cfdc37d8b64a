// SPDX-License-Identifier: Apache-2.0
// The shell's machine mode: signals as binary frames between the lines of text, while everything else goes on.
#include "capstan/firmware/console/recording.hpp"
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

/// Goes on beside the text: sends no answer of its own.
struct FrameStream final : Stream {
  RecorderSetup setup;

  void step(Session& session) override;
  void cancel(Session& session) override { session.machine().recorder().stop(&session); }
  void send_schema(Session& session);

 private:
  void send_sample(Print& out, const SignalSample& sample) const;

  std::uint16_t schema_ = 0;       ///< CRC of the schema that was sent last ...
  std::uint32_t schema_tick_ = 0;  ///< ... and when
};

void send(Print& out, const telemetry::PacketWriter& packet) {
  std::array<std::uint8_t, telemetry::kMostWireBytes> wire{};
  const std::size_t size = packet.wire(wire);
  out << std::string_view(reinterpret_cast<const char*>(wire.data()), size);
}

void FrameStream::send_schema(Session& session) {
  telemetry::PacketWriter packet;
  packet.u8(telemetry::kSchemaTag);
  packet.u8(telemetry::kVersion);
  packet.u16(static_cast<std::uint16_t>(setup.every));
  packet.u8(static_cast<std::uint8_t>(setup.count));
  PacketSink sink(packet);
  Print columns(sink);
  for (std::size_t i = 0; i < setup.count; ++i) {
    packet.u8(setup.signals[i].info->type == SignalType::kReal ? 0 : 1);
    print_column(columns, setup.signals[i]);
    packet.u8(0);
  }
  schema_ = packet.close();
  schema_tick_ = session.machine().telemetry().tick;
  send(session.out(), packet);
}

// Inlined, its packet and the schema's would be on the stack together.
[[gnu::noinline]] void FrameStream::send_sample(Print& out, const SignalSample& sample) const {
  telemetry::PacketWriter packet;
  packet.u8(telemetry::kDataTag);
  packet.u8(telemetry::kVersion);
  packet.u16(schema_);
  packet.u32(sample.tick);
  for (std::size_t channel = 0; channel < setup.count; ++channel) {
    packet.u32(static_cast<std::uint32_t>(sample.raw[channel]));
  }
  static_cast<void>(packet.close());
  send(out, packet);
}

void FrameStream::step(Session& session) {
  constexpr int kAtOnce = 32;  // a host may sleep for 20 ms between two looks
  constexpr std::int32_t kSchemaEveryMs = 1000;
  const StepTime time(session.machine());
  SignalSample sample;
  for (int i = 0; i < kAtOnce && time.left() && session.machine().recorder().next(sample); ++i) {
    if (static_cast<std::int32_t>(sample.tick - schema_tick_) >= kSchemaEveryMs) {
      send_schema(session);
    }
    send_sample(session.out(), sample);
  }
}

}  // namespace

void commands::frames(Session& session, std::string_view arguments) {
  std::string_view rest = arguments;
  const std::string_view word = next_word(rest);
  if (word.empty()) {
    session.out() << "frames " << (session.has_beside() ? "on" : "off") << "\r\n";
    session.ok();
    return;
  }
  if (word == "off") {
    if (!refuses_more(session, rest)) {
      session.end_beside();
      session.ok();
    }
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
    session.error("range", "frames come every 1 to 1000 ms", "write 'frames 10 joint0.q2'");
    return;
  }
  if (!parse_signals(arguments, session.machine().axes(), setup.signals, setup.count)) {
    session.error("unknown_signal",
                  "a signal is unknown or named twice, or there are more than 8, and nothing was changed",
                  "'scope signals' shows all of them; write 'frames 10 joint0.q2'");
    return;
  }
  setup.every = static_cast<std::uint32_t>(every);
  if (!start_recorder(session, setup)) {
    return;
  }
  auto& stream = session.make_beside<FrameStream>();
  stream.setup = setup;
  stream.send_schema(session);
  session.begin_beside(stream);
  session.ok();
}

}  // namespace capstan
