// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "capstan/hal/plant_link/frames.hpp"

namespace capstan::plant_link {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(Crc16, GivesThePublishedCheckValue) {
  const std::string text = "123456789";
  const Bytes bytes(text.begin(), text.end());
  EXPECT_EQ(crc16(bytes), 0x29B1);  // the check value of CRC-16/CCITT-FALSE in the catalogues
  EXPECT_EQ(crc16({}), 0xFFFF);
}

TEST(Crc16, SeesEveryChangeOfOneOrTwoBits) {
  const Bytes sound = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17};
  const std::uint16_t crc = crc16(sound);
  const std::size_t bits = sound.size() * 8;
  for (std::size_t a = 0; a < bits; ++a) {
    for (std::size_t b = a; b < bits; ++b) {
      Bytes damaged = sound;
      damaged[a / 8] = static_cast<std::uint8_t>(damaged[a / 8] ^ (1U << (a % 8)));
      if (b != a) {
        damaged[b / 8] = static_cast<std::uint8_t>(damaged[b / 8] ^ (1U << (b % 8)));
      }
      ASSERT_NE(crc16(damaged), crc) << a << " " << b;
    }
  }
}

auto stuffed(const Bytes& packet) -> Bytes {
  Bytes out(cobs_max_size(packet.size()));
  out.resize(cobs_encode(packet, out));
  return out;
}

TEST(Cobs, GivesTheExamplesOfThePaper) {
  EXPECT_EQ(stuffed({0}), (Bytes{1, 1}));
  EXPECT_EQ(stuffed({0, 0}), (Bytes{1, 1, 1}));
  EXPECT_EQ(stuffed({0x11, 0x22, 0, 0x33}), (Bytes{3, 0x11, 0x22, 2, 0x33}));
  EXPECT_EQ(stuffed({0x11, 0, 0, 0}), (Bytes{2, 0x11, 1, 1, 1}));
}

TEST(Cobs, RandomPacketsComeBackAndContainNoZero) {
  std::mt19937 random(7);
  for (int round = 0; round < 2000; ++round) {
    Bytes packet(1 + random() % 600);
    const std::uint32_t zeros = random() % 4;
    for (auto& byte : packet) {
      byte = random() % 4 < zeros ? 0 : static_cast<std::uint8_t>(random() & 0xFFU);
    }
    const Bytes wire = stuffed(packet);
    ASSERT_EQ(std::count(wire.begin(), wire.end(), 0), 0);
    Bytes back(packet.size(), 0xAA);
    ASSERT_EQ(cobs_decode(wire, back), packet.size());
    ASSERT_EQ(back, packet);
  }
}

TEST(Cobs, BlocksOf254BytesRoundTrip) {
  for (const std::size_t size : {253U, 254U, 255U, 508U, 509U}) {
    const Bytes packet(size, 0x55);
    Bytes back(size);
    ASSERT_EQ(cobs_decode(stuffed(packet), back), size);
    EXPECT_EQ(back, packet);
  }
}

TEST(Cobs, DamagedOrOverlongFramesGiveNothing) {
  Bytes out(4);
  EXPECT_EQ(cobs_decode(Bytes{5, 1, 2}, out), 0U) << "points beyond the end";
  EXPECT_EQ(cobs_decode(Bytes{3, 0, 2}, out), 0U) << "a zero inside";
  EXPECT_EQ(cobs_decode(Bytes{6, 1, 2, 3, 4, 5}, out), 0U) << "longer than the packet may be";
  EXPECT_EQ(cobs_encode(Bytes{1, 2, 3, 4}, out), 0U) << "no room for the overhead";
}

TEST(Cobs, NoSequenceOfBytesReadsOrWritesOutOfBounds) {
  std::mt19937 random(3);
  for (int round = 0; round < 20'000; ++round) {
    Bytes frame(random() % 40);
    for (auto& byte : frame) {
      byte = static_cast<std::uint8_t>(random() % 12);
    }
    Bytes out(random() % 20);
    ASSERT_LE(cobs_decode(frame, out), out.size());
  }
}

auto example_sensed() -> SensedFrame<2> {
  SensedFrame<2> frame{.sequence = 0x01020304, .estop = true};
  frame.axis[0] = {
      .encoder_counts = -5, .current_a = Q24::from_raw(-123456), .encoder = Quality::kOk, .current = Quality::kInvalid};
  frame.axis[1] = {
      .encoder_counts = 1 << 30, .current_a = Q24::max(), .encoder = Quality::kMissing, .current = Quality::kOk};
  return frame;
}

template <std::size_t Size>
auto packets_in(const Bytes& bytes) -> std::vector<Bytes> {
  FrameReader<Size> reader;
  std::vector<Bytes> packets;
  for (const std::uint8_t byte : bytes) {
    if (reader.take(byte)) {
      packets.emplace_back(reader.packet().begin(), reader.packet().end());
    }
  }
  return packets;
}

template <typename Wire>
auto bytes_of(const Wire& wire) -> Bytes {
  return {wire.view().begin(), wire.view().end()};
}

TEST(Frames, SensedFrameComesBackWhole) {
  const SensedFrame<2> sent = example_sensed();
  const auto packets = packets_in<kSensedSize<2>>(bytes_of(encode(sent)));
  ASSERT_EQ(packets.size(), 1U);
  SensedFrame<2> got;
  ASSERT_TRUE(decode(packets[0], got));
  EXPECT_EQ(got.sequence, sent.sequence);
  EXPECT_EQ(got.estop, sent.estop);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(got.axis[i].encoder_counts, sent.axis[i].encoder_counts);
    EXPECT_EQ(got.axis[i].current_a, sent.axis[i].current_a);
    EXPECT_EQ(got.axis[i].encoder, sent.axis[i].encoder);
    EXPECT_EQ(got.axis[i].current, sent.axis[i].current);
  }
}

TEST(Frames, DriveFrameComesBackWhole) {
  DriveFrame<1> sent{.sequence = 0xFFFF'FFFF, .kind = DriveKind::kRelease};
  sent.drive.axis[0] = {.current_a = Q24::from_raw(-1), .enabled = true};
  const auto packets = packets_in<kDriveSize<1>>(bytes_of(encode(sent)));
  ASSERT_EQ(packets.size(), 1U);
  DriveFrame<1> got;
  ASSERT_TRUE(decode(packets[0], got));
  EXPECT_EQ(got.sequence, sent.sequence);
  EXPECT_EQ(got.kind, DriveKind::kRelease);
  EXPECT_EQ(got.drive.axis[0].current_a, sent.drive.axis[0].current_a);
  EXPECT_TRUE(got.drive.axis[0].enabled);
}

TEST(Frames, LayoutOnTheLineIsTheDocumentedOne) {
  DriveFrame<1> frame{.sequence = 0x04030201};
  frame.drive.axis[0] = {.current_a = Q24::from_raw(0x08070605), .enabled = true};
  const auto packets = packets_in<kDriveSize<1>>(bytes_of(encode(frame)));
  ASSERT_EQ(packets.size(), 1U);
  EXPECT_EQ(Bytes(packets[0].begin(), packets[0].end() - 2), (Bytes{'D', 1, 1, 0, 1, 2, 3, 4, 5, 6, 7, 8, 1}));
}

TEST(Frames, NoSingleDamagedByteGetsThrough) {
  const Bytes wire = bytes_of(encode(example_sensed()));
  for (std::size_t at = 0; at < wire.size(); ++at) {
    for (int value = 0; value < 256; ++value) {
      Bytes damaged = wire;
      if (damaged[at] == value) {
        continue;
      }
      damaged[at] = static_cast<std::uint8_t>(value);
      for (const Bytes& packet : packets_in<kSensedSize<2>>(damaged)) {
        SensedFrame<2> frame;
        ASSERT_FALSE(decode(packet, frame)) << at << " " << value;
      }
    }
  }
}

TEST(Frames, FramesOfAnotherKindSizeOrVersionAreRefused) {
  const auto two_axes = packets_in<kSensedSize<2>>(bytes_of(encode(example_sensed())));
  SensedFrame<1> one_axis;
  EXPECT_FALSE(decode(two_axes[0], one_axis));
  DriveFrame<2> drive;
  EXPECT_FALSE(decode(two_axes[0], drive));
  Bytes other_version = two_axes[0];
  other_version[1] = kVersion + 1;
  const std::uint16_t crc = crc16(std::span(other_version).first(other_version.size() - 2));
  other_version[other_version.size() - 2] = static_cast<std::uint8_t>(crc & 0xFFU);
  other_version[other_version.size() - 1] = static_cast<std::uint8_t>(crc >> 8U);
  SensedFrame<2> frame;
  EXPECT_FALSE(decode(other_version, frame));
}

TEST(Frames, BridgeGoesOnOnlyIfThatIsPlainlyAskedFor) {
  auto packet = packets_in<kDriveSize<1>>(bytes_of(encode(DriveFrame<1>{}))).at(0);
  const std::size_t enabled_at = packet.size() - kCrcSize - 1;
  for (int value = 0; value < 256; ++value) {
    packet[enabled_at] = static_cast<std::uint8_t>(value);
    const std::uint16_t crc = crc16(std::span(packet).first(packet.size() - kCrcSize));
    packet[packet.size() - 2] = static_cast<std::uint8_t>(crc & 0xFFU);
    packet[packet.size() - 1] = static_cast<std::uint8_t>(crc >> 8U);
    DriveFrame<1> frame;
    ASSERT_TRUE(decode(packet, frame));
    EXPECT_EQ(frame.drive.axis[0].enabled, value == 1) << value;
  }
}

TEST(FrameReader, IsInStepAgainAtTheNextFrameAfterALoss) {
  const Bytes frame = bytes_of(encode(example_sensed()));
  Bytes stream(frame.begin() + 7, frame.end());  // joined in the middle
  stream.insert(stream.end(), frame.begin(), frame.end());
  FrameReader<kSensedSize<2>> reader;
  int sound = 0;
  for (const std::uint8_t byte : stream) {
    SensedFrame<2> got;
    sound += reader.take(byte) && decode(reader.packet(), got) ? 1 : 0;
  }
  EXPECT_EQ(sound, 1);
}

TEST(FrameReader, OverlongRubbishIsOneDamagedFrame) {
  FrameReader<kSensedSize<1>> reader;
  for (int i = 0; i < 10'000; ++i) {
    ASSERT_FALSE(reader.take(7));
  }
  EXPECT_FALSE(reader.take(kFrameEnd));
  EXPECT_EQ(reader.damaged(), 1U);
  EXPECT_FALSE(reader.take(kFrameEnd));
  EXPECT_EQ(reader.damaged(), 1U) << "an end mark alone is no error";
  bool complete = false;
  for (const std::uint8_t byte : bytes_of(encode(SensedFrame<1>{}))) {
    complete = reader.take(byte);
  }
  EXPECT_TRUE(complete) << "the rubbish spoils only itself";
}

}  // namespace
}  // namespace capstan::plant_link
