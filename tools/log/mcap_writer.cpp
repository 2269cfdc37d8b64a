// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/mcap_writer.hpp"

#include <algorithm>

#include "capstan/tools/log/compression.hpp"

namespace capstan::tools {
namespace {

using mcap::FieldWriter;
using mcap::Opcode;
using mcap::record;

/// Large enough to pack well.
constexpr std::size_t kChunkBytes = 256U << 10U;
/// A chunk spans less, so that a recording that breaks off has lost no more, however slowly its messages come.
constexpr std::uint64_t kChunkNs = 1'000'000'000;
constexpr std::string_view kLibrary = "capstan";

/// Schema ids count from 1; 0 means none.
auto schema_id(std::size_t channel) -> std::uint16_t {
  return static_cast<std::uint16_t>(channel + 1);
}

}  // namespace

void McapWriter::Span::include(std::uint64_t time_ns) {
  first_ns = messages == 0 ? time_ns : std::min(first_ns, time_ns);
  last_ns = messages == 0 ? time_ns : std::max(last_ns, time_ns);
  ++messages;
}

McapWriter::McapWriter(std::ostream& out, McapCompression compression) : out_(out), compression_(compression) {
  write(mcap::kMagic);
  write(record(Opcode::kHeader, FieldWriter().text("").text(kLibrary)));
}

void McapWriter::write(std::string_view bytes) {
  out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  crc_ = mcap::crc32(bytes, crc_);
  at_ += bytes.size();
}

auto McapWriter::compression_name() const -> std::string_view {
  return compression_ == McapCompression::kNone ? "" : compression_ == McapCompression::kLz4 ? "lz4" : "zstd";
}

auto McapWriter::add_channel(const std::string& topic, const std::string& schema_name, const std::string& schema)
    -> std::uint16_t {
  const std::size_t index = channels_.size();
  channels_.push_back({topic, schema_name, schema});
  // In the chunk, so that its messages have their channel before them; repeated in the summary.
  for (const auto& text : records_of(index)) {
    chunk_ += text;
  }
  return static_cast<std::uint16_t>(index);
}

void McapWriter::add_message(std::uint16_t channel, std::uint64_t time_ns, std::string_view json) {
  // Before the message, so that those of one time stay together.
  if (chunk_span_.messages > 0 && time_ns >= chunk_span_.first_ns + kChunkNs) {
    end_chunk();
  }
  chunk_index_[channel].emplace_back(time_ns, chunk_.size());
  const auto sequence = static_cast<std::uint32_t>(channels_[channel].messages++);
  chunk_ += record(Opcode::kMessage, FieldWriter().u16(channel).u32(sequence).u64(time_ns).u64(time_ns).bytes(json));
  chunk_span_.include(time_ns);
  span_.include(time_ns);
  if (chunk_.size() >= kChunkBytes) {
    end_chunk();
  }
}

void McapWriter::end_chunk() {
  if (chunk_.empty()) {
    return;
  }
  const std::string content = compression_ == McapCompression::kNone
                                  ? chunk_
                                  : packed(compression_ == McapCompression::kLz4 ? Codec::kLz4 : Codec::kZstd, chunk_);
  ChunkPlace place{chunk_span_, at_, 0, 0, content.size(), chunk_.size(), {}};
  const std::string whole = record(Opcode::kChunk, FieldWriter()
                                                       .u64(chunk_span_.first_ns)
                                                       .u64(chunk_span_.last_ns)
                                                       .u64(chunk_.size())
                                                       .u32(mcap::crc32(chunk_))
                                                       .text(compression_name())
                                                       .u64(content.size())
                                                       .bytes(content));
  place.bytes = whole.size();
  write(whole);
  for (auto& [channel, entries] : chunk_index_) {
    std::stable_sort(entries.begin(), entries.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    FieldWriter list;
    for (const auto& [time_ns, offset] : entries) {
      list.u64(time_ns).u64(offset);
    }
    place.indices[channel] = at_;
    write(record(Opcode::kMessageIndex, FieldWriter().u16(channel).text(list.fields())));
  }
  place.index_bytes = at_ - place.at - place.bytes;
  chunks_.push_back(std::move(place));
  out_.flush();
  chunk_.clear();
  chunk_index_.clear();
  chunk_span_ = {};
}

auto McapWriter::records_of(std::size_t index) const -> std::array<std::string, 2> {
  const Channel& channel = channels_[index];
  return {record(Opcode::kSchema,
                 FieldWriter().u16(schema_id(index)).text(channel.schema_name).text("jsonschema").text(channel.schema)),
          record(Opcode::kChannel, FieldWriter()
                                       .u16(static_cast<std::uint16_t>(index))
                                       .u16(schema_id(index))
                                       .text(channel.topic)
                                       .text("json")
                                       .text(""))};
}

auto McapWriter::statistics() const -> std::string {
  FieldWriter counts;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    counts.u16(static_cast<std::uint16_t>(i)).u64(channels_[i].messages);
  }
  const auto channels = static_cast<std::uint32_t>(channels_.size());
  return record(Opcode::kStatistics, FieldWriter()
                                         .u64(span_.messages)
                                         .u16(static_cast<std::uint16_t>(channels))
                                         .u32(channels)
                                         .u32(0)  // attachments
                                         .u32(0)  // metadata
                                         .u32(static_cast<std::uint32_t>(chunks_.size()))
                                         .u64(span_.first_ns)
                                         .u64(span_.last_ns)
                                         .text(counts.fields()));
}

auto McapWriter::chunk_indices() const -> std::string {
  std::string records;
  for (const ChunkPlace& chunk : chunks_) {
    FieldWriter indices;
    for (const auto& [channel, at] : chunk.indices) {
      indices.u16(channel).u64(at);
    }
    records += record(Opcode::kChunkIndex, FieldWriter()
                                               .u64(chunk.span.first_ns)
                                               .u64(chunk.span.last_ns)
                                               .u64(chunk.at)
                                               .u64(chunk.bytes)
                                               .text(indices.fields())
                                               .u64(chunk.index_bytes)
                                               .text(compression_name())
                                               .u64(chunk.packed_bytes)
                                               .u64(chunk.plain_bytes));
  }
  return records;
}

void McapWriter::finish() {
  end_chunk();
  write(record(Opcode::kDataEnd, FieldWriter().u32(crc_)));
  const std::uint64_t summary = at_;
  crc_ = 0;
  std::string schemas;
  std::string channels;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    const auto both = records_of(i);
    schemas += both[0];
    channels += both[1];
  }
  FieldWriter offsets;
  for (const auto& [opcode, group] :
       {std::pair{Opcode::kSchema, schemas}, std::pair{Opcode::kChannel, channels},
        std::pair{Opcode::kStatistics, statistics()}, std::pair{Opcode::kChunkIndex, chunk_indices()}}) {
    if (!group.empty()) {
      offsets.bytes(record(Opcode::kSummaryOffset,
                           FieldWriter().u8(static_cast<std::uint8_t>(opcode)).u64(at_).u64(group.size())));
      write(group);
    }
  }
  const std::uint64_t summary_offsets = at_;
  write(offsets.fields());
  // The checksum covers the summary and the footer up to itself.
  constexpr std::uint64_t kFooterBytes = 20;
  write(FieldWriter()
            .u8(static_cast<std::uint8_t>(Opcode::kFooter))
            .u64(kFooterBytes)
            .u64(summary)
            .u64(summary_offsets)
            .fields());
  write(FieldWriter().u32(crc_).fields());
  write(mcap::kMagic);
  out_.flush();
}

}  // namespace capstan::tools
