// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/mcap_reader.hpp"

#include "capstan/tools/log/compression.hpp"
#include "capstan/tools/log/mcap_format.hpp"

namespace capstan::tools {
namespace {

using mcap::FieldReader;
using mcap::Opcode;

/// Chunks of a few megabytes are usual.
constexpr std::uint64_t kMostChunkBytes = std::uint64_t{1} << 30U;

class Reader {
 public:
  Reader(std::string_view bytes, const std::function<void(const McapMessage&)>& visit) : bytes_(bytes), visit_(visit) {}

  auto read() -> bool {
    std::size_t at = mcap::kMagic.size();
    while (true) {
      FieldReader head(bytes_.substr(at));
      const auto opcode = head.u8();
      const auto size = head.u64();
      const auto fields = size ? head.bytes(*size) : std::nullopt;
      if (!fields) {
        return false;
      }
      const std::size_t begin = at;
      at += mcap::kRecordHeadBytes + fields->size();
      switch (static_cast<Opcode>(*opcode)) {
        case Opcode::kChunk:
          take_chunk(*fields);
          break;
        case Opcode::kDataEnd:
          check_data(*fields, begin);
          break;
        case Opcode::kFooter:
          check_summary(*fields, begin);
          return bytes_.substr(at).starts_with(mcap::kMagic);
        default:
          take(static_cast<Opcode>(*opcode), *fields);
      }
    }
  }

 private:
  void take(Opcode opcode, std::string_view fields) {
    if (opcode == Opcode::kChannel) {
      take_channel(fields);
    } else if (opcode == Opcode::kMessage) {
      take_message(fields);
    }
  }

  void take_channel(std::string_view text) {
    FieldReader fields(text);
    const auto id = fields.u16();
    const auto schema = fields.u16();
    const auto topic = fields.text();
    const auto encoding = fields.text();
    if (!id || !schema || !topic || !encoding) {
      throw McapDamaged("the description of a channel is too short");
    }
    channels_.insert({*id, {*id, std::string(*topic), std::string(*encoding)}});  // repeated in the summary
  }

  void take_message(std::string_view text) {
    FieldReader fields(text);
    const auto id = fields.u16();
    const auto sequence = fields.u32();
    const auto logged = fields.u64();
    const auto published = fields.u64();
    if (!id || !sequence || !logged || !published) {
      throw McapDamaged("a message is too short");
    }
    const auto channel = channels_.find(*id);
    if (channel == channels_.end()) {
      throw McapDamaged("a message is of channel " + std::to_string(*id) + ", which is described nowhere before it");
    }
    visit_({channel->second, *logged, fields.left()});
  }

  void take_chunk(std::string_view text) {
    FieldReader fields(text);
    static_cast<void>(fields.bytes(16));  // first and last time
    const auto size = fields.u64();
    const auto crc = fields.u32();
    const auto compression = fields.text();
    const auto length = fields.u64();
    const auto content = length ? fields.bytes(*length) : std::nullopt;
    if (!size || !crc || !compression || !content) {
      throw McapDamaged("a chunk is shorter than it says");
    }
    if (*size > kMostChunkBytes) {
      throw McapDamaged("a chunk claims to unpack to " + std::to_string(*size) + " bytes");
    }
    const std::string plain = unpacked_chunk(*compression, *content, static_cast<std::size_t>(*size));
    if (plain.size() != *size || (*crc != 0 && mcap::crc32(plain) != *crc)) {
      throw McapDamaged("the checksum of a chunk is wrong");
    }
    for (std::string_view left = plain; !left.empty();) {
      FieldReader head(left);
      const auto opcode = head.u8();
      const auto bytes = head.u64();
      const auto record = bytes ? head.bytes(*bytes) : std::nullopt;
      if (!record) {
        throw McapDamaged("a record reaches beyond its chunk");
      }
      take(static_cast<Opcode>(*opcode), *record);
      left.remove_prefix(mcap::kRecordHeadBytes + record->size());
    }
  }

  static auto unpacked_chunk(std::string_view compression, std::string_view content, std::size_t size) -> std::string {
    if (compression.empty()) {
      return std::string(content);
    }
    if (compression != "lz4" && compression != "zstd") {
      throw McapForeign("a chunk is packed with '" + std::string(compression) +
                        "', which is neither lz4 nor zstd; record it with one of these, or without compression");
    }
    try {
      return unpacked(compression == "lz4" ? Codec::kLz4 : Codec::kZstd, content, size);
    } catch (const Unpackable& why) {
      throw McapDamaged(std::string("a chunk can not be unpacked: ") + why.what());
    }
  }

  void check_data(std::string_view text, std::size_t begin) const {
    const auto crc = FieldReader(text).u32();
    if (!crc || (*crc != 0 && mcap::crc32(bytes_.substr(0, begin)) != *crc)) {
      throw McapDamaged("the checksum of the data is wrong");
    }
  }

  void check_summary(std::string_view text, std::size_t begin) const {
    FieldReader fields(text);
    const auto summary = fields.u64();
    const auto offsets = fields.u64();
    const auto crc = fields.u32();
    if (!summary || !offsets || !crc || *summary > begin) {
      throw McapDamaged("the footer makes no sense");
    }
    const std::size_t first = *summary == 0 ? begin : static_cast<std::size_t>(*summary);
    const std::size_t end = begin + mcap::kRecordHeadBytes + 2 * sizeof(std::uint64_t);
    if (*crc != 0 && mcap::crc32(bytes_.substr(first, end - first)) != *crc) {
      throw McapDamaged("the checksum of the summary is wrong");
    }
  }

  std::string_view bytes_;
  const std::function<void(const McapMessage&)>& visit_;
  std::map<std::uint16_t, McapChannel> channels_;
};

}  // namespace

auto read_mcap(std::string_view bytes, const std::function<void(const McapMessage&)>& visit) -> bool {
  return Reader(bytes, visit).read();
}

}  // namespace capstan::tools
