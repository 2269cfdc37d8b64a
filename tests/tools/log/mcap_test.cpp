// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <sstream>

#include "capstan/tools/log/csv_log.hpp"
#include "capstan/tools/log/mcap_format.hpp"
#include "capstan/tools/log/mcap_log.hpp"
#include "capstan/tools/log/mcap_reader.hpp"
#include "capstan/tools/log/mcap_writer.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

constexpr std::uint64_t kMillisecond = 1'000'000;
constexpr McapCompression kCompressions[] = {McapCompression::kNone, McapCompression::kLz4, McapCompression::kZstd};

/// Motor at 1 kHz, joint at 250 Hz: `rows` milliseconds.
auto two_rates(McapCompression compression, int rows, std::uint64_t start_ns = 0) -> std::string {
  std::ostringstream out;
  McapWriter writer(out, compression);
  const auto motor = writer.add_channel("/axis0", "motor", R"({"type":"object"})");
  const auto joint = writer.add_channel("/camera", "joint", R"({"type":"object"})");
  for (int i = 0; i < rows; ++i) {
    const std::uint64_t time = start_ns + static_cast<std::uint64_t>(i) * kMillisecond;
    writer.add_message(motor, time, "{\"q1_rad\":" + std::to_string(i) + ",\"tau_Nm\":-0.5}");
    if (i % 4 == 0) {
      writer.add_message(joint, time,
                         "{\"pose\":{\"angle\":" + std::to_string(2 * i) + ",\"xyz\":[1,2,3]},\"ok\":true}");
    }
  }
  writer.finish();
  return out.str();
}

TEST(Mcap, WhatIsWrittenIsReadInEveryCompression) {
  for (const auto compression : kCompressions) {
    const CsvLog log = CsvLog::parse(two_rates(compression, 9000), "x.mcap");
    EXPECT_TRUE(log.warnings().empty());
    EXPECT_EQ(log.column_names(),
              (std::vector<std::string>{"time_s", "axis0/q1_rad", "axis0/tau_Nm", "camera/ok", "camera/pose/angle",
                                        "camera/pose/xyz[0]", "camera/pose/xyz[1]", "camera/pose/xyz[2]"}));
    ASSERT_EQ(log.rows(), 9000U);
    EXPECT_EQ(log.column("axis0/q1_rad")[8999], 8999.0);
    EXPECT_DOUBLE_EQ(log.time()[8999], 8.999);
    const Eigen::VectorXd slow = log.column_with_gaps("camera/pose/angle");
    EXPECT_EQ(slow[8], 16.0);
    EXPECT_TRUE(std::isnan(slow[9]));
    EXPECT_THROW(static_cast<void>(log.column("camera/pose/angle")), BadInput);
  }
}

TEST(Mcap, AClockSince1970CountsFromTheFirstMessage) {
  const CsvLog log = CsvLog::parse(two_rates(McapCompression::kZstd, 10, 1'795'000'000'000'000'123), "x.mcap");
  EXPECT_EQ(log.time()[0], 0.0);
  EXPECT_DOUBLE_EQ(log.time()[9], 0.009);
}

TEST(Mcap, ARecordingThatBrokeOffIsReadAsFarAsItGoes) {
  const std::string whole = two_rates(McapCompression::kNone, 9000);
  const CsvLog log = CsvLog::parse(whole.substr(0, whole.size() / 2), "x.mcap");
  EXPECT_GT(log.rows(), 1000U);
  EXPECT_LT(log.rows(), 9000U);
  ASSERT_EQ(log.warnings().size(), 1U);
  EXPECT_NE(log.warnings()[0].find("ends before its footer"), std::string::npos);
}

// 100 bytes a second: by size alone nothing would be there for minutes.
TEST(Mcap, OfASlowRecordingAllButTheLastSecondIsThereBeforeItsEnd) {
  std::ostringstream out;
  McapWriter writer(out);
  const auto motor = writer.add_channel("/axis0", "motor", "{}");
  const auto joint = writer.add_channel("/axis1", "joint", "{}");
  for (std::uint64_t i = 0; i < 50; ++i) {
    writer.add_message(motor, 100 * i * kMillisecond, R"({"q1_rad":1})");
    writer.add_message(joint, 100 * i * kMillisecond, R"({"q1_rad":2})");
  }
  const CsvLog log = CsvLog::parse(out.str(), "x.mcap");
  EXPECT_DOUBLE_EQ(log.time()[log.time().size() - 1], 3.9);
  EXPECT_EQ(log.column("axis0/q1_rad").size(), log.column("axis1/q1_rad").size()) << "messages of a time stay together";
}

TEST(Mcap, EveryBitThatFlipsInTheDataIsNoticed) {
  for (const auto compression : kCompressions) {
    const std::string whole = two_rates(compression, 40);
    const auto rows = [](const std::string& bytes) {
      std::vector<std::string> warnings;
      return csv_of_mcap(bytes, "x.mcap", warnings);
    };
    const std::string right = rows(whole);
    for (std::size_t at = mcap::kMagic.size(); at + mcap::kMagic.size() < whole.size(); ++at) {
      std::string flipped = whole;
      flipped[at] = static_cast<char>(flipped[at] ^ 0x10);
      std::vector<std::string> warnings;
      try {
        const std::string read = csv_of_mcap(flipped, "x.mcap", warnings);
        EXPECT_TRUE(!warnings.empty() || read == right) << "byte " << at;
      } catch (const BadInput&) {
      }
    }
  }
}

TEST(Mcap, ADamagedFileIsRefusedWithTheCause) {
  std::string bytes = two_rates(McapCompression::kNone, 40);
  bytes[bytes.find("q1_rad\":7") + 8] = '8';
  try {
    CsvLog::parse(bytes, "x.mcap");
    FAIL();
  } catch (const BadInput& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("the checksum of a chunk is wrong; repair it with `mcap recover x.mcap"),
              std::string::npos)
        << refusal.what();
  }
}

TEST(Mcap, MessagesInOtherEncodingsAreNamed) {
  using mcap::FieldWriter;
  using mcap::Opcode;
  const std::string bytes =
      std::string(mcap::kMagic) + mcap::record(Opcode::kHeader, FieldWriter().text("ros2").text("x")) +
      mcap::record(Opcode::kChannel, FieldWriter().u16(3).u16(0).text("/joint_states").text("cdr").text("")) +
      mcap::record(Opcode::kMessage, FieldWriter().u16(3).u32(0).u64(0).u64(0).bytes("1234")) +
      mcap::record(Opcode::kDataEnd, FieldWriter().u32(0)) +
      mcap::record(Opcode::kFooter, FieldWriter().u64(0).u64(0).u32(0)) + std::string(mcap::kMagic);
  try {
    CsvLog::parse(bytes, "x.mcap");
    FAIL();
  } catch (const BadInput& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("only /joint_states (cdr); record the topics as JSON"),
              std::string::npos)
        << refusal.what();
  }
}

/// What is said of bytes that are refused.
auto refusal_of(const std::string& bytes) -> std::string {
  try {
    static_cast<void>(CsvLog::parse(bytes, "x.mcap"));
  } catch (const BadInput& refusal) {
    return refusal.what();
  }
  return "taken";
}

TEST(Mcap, AFileThatEndsInItsFirstChunkIsSaidToEndThere) {
  const std::string whole = two_rates(McapCompression::kNone, 40);
  for (const std::size_t size : {mcap::kMagic.size(), whole.size() / 3}) {
    const std::string said = refusal_of(whole.substr(0, size));
    EXPECT_NE(said.find("ends before its first messages are whole"), std::string::npos) << said;
    EXPECT_NE(said.find("mcap recover x.mcap"), std::string::npos) << said;
  }
}

TEST(Mcap, AChunkInAnotherCompressionIsNoDamage) {
  const std::string said =
      refusal_of(std::string(mcap::kMagic) +
                 mcap::record(mcap::Opcode::kChunk,
                              mcap::FieldWriter().u64(0).u64(0).u64(4).u32(0).text("brotli").u64(4).bytes("1234")));
  EXPECT_NE(said.find("packed with 'brotli', which is neither lz4 nor zstd; record it with"), std::string::npos)
      << said;
  EXPECT_EQ(said.find("damaged"), std::string::npos) << said;
}

TEST(Mcap, TwoMessagesOfOneTimeAreSaidWithTopicAndChannels) {
  const auto file = [](bool two_channels, std::uint64_t later) {
    std::ostringstream out;
    McapWriter writer(out);
    const auto one = writer.add_channel("/axis0", "motor", "{}");
    const auto other = two_channels ? writer.add_channel("/axis0", "motor", "{}") : one;
    for (std::uint64_t i = 0; i < 5; ++i) {
      writer.add_message(one, i * kMillisecond, R"({"q1_rad":1})");
      writer.add_message(other, i * kMillisecond + later, R"({"q1_rad":2})");
    }
    writer.finish();
    return out.str();
  };
  const std::string two = refusal_of(file(true, 0));
  EXPECT_NE(two.find("the topic /axis0 comes on several channels (0 and 1)"), std::string::npos) << two;
  const std::string one = refusal_of(file(false, 0));
  EXPECT_NE(one.find("the topic /axis0 has two messages of one time, 0.000000000 s"), std::string::npos) << one;
  EXPECT_EQ(CsvLog::parse(file(true, 1), "x.mcap").rows(), 10U) << "a recorder that began anew";
}

TEST(Mcap, AMessageOfAnUnknownChannelIsRefused) {
  using mcap::FieldWriter;
  const std::string bytes =
      std::string(mcap::kMagic) + mcap::record(mcap::Opcode::kMessage, FieldWriter().u16(9).u32(0).u64(0).u64(0));
  EXPECT_THROW(read_mcap(bytes, [](const McapMessage&) {}), McapDamaged);
}

TEST(Mcap, TheContractsNamesAreFoundWithinATopic) {
  std::ostringstream out;
  McapWriter writer(out);
  const auto topic = writer.add_channel("/bench", "any", "{}");
  writer.add_message(topic, 0, R"({"axis1/q1_rad": 1, "temperature_C": 20, "deep": {"axis1/q2_rad": 4}, "s": "no"})");
  writer.add_message(topic, kMillisecond, "not json");
  writer.finish();
  const CsvLog log = CsvLog::parse(out.str(), "x.mcap");
  EXPECT_EQ(log.column_names(), (std::vector<std::string>{"time_s", "axis1/q1_rad", "axis1/q2_rad", "temperature_C"}));
  ASSERT_EQ(log.warnings().size(), 1U);
  EXPECT_NE(log.warnings()[0].find("1 messages are no JSON"), std::string::npos);
}

}  // namespace
}  // namespace capstan::tools
