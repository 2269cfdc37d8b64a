// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "capstan/tools/log/mcap_format.hpp"

namespace capstan::tools {

enum class McapCompression { kNone, kLz4, kZstd };

/// Writes JSON messages as an MCAP file with chunks, indices, statistics and checksums, so that readers may seek. What
/// has been written before finish() can be read without the indices, should the recording break off: all but the last
/// second.
class McapWriter {
 public:
  /// @param out  binary, outlives this object
  explicit McapWriter(std::ostream& out, McapCompression compression = McapCompression::kZstd);

  /// @param schema  JSON schema of the messages, of type object
  auto add_channel(const std::string& topic, const std::string& schema_name, const std::string& schema)
      -> std::uint16_t;
  /// @param json  one object. Times need not be in order.
  void add_message(std::uint16_t channel, std::uint64_t time_ns, std::string_view json);
  /// Writes what is left, the summary and the footer. Nothing may follow.
  void finish();

 private:
  struct Channel {
    std::string topic, schema_name, schema;
    std::uint64_t messages = 0;
  };
  struct Span {
    std::uint64_t first_ns = 0, last_ns = 0;
    std::uint64_t messages = 0;
    void include(std::uint64_t time_ns);
  };
  struct ChunkPlace {
    Span span;
    std::uint64_t at = 0, bytes = 0, index_bytes = 0, packed_bytes = 0, plain_bytes = 0;
    std::map<std::uint16_t, std::uint64_t> indices;  // where each channel's message index begins
  };

  void write(std::string_view bytes);
  void end_chunk();
  [[nodiscard]] auto compression_name() const -> std::string_view;
  /// Schema and channel.
  [[nodiscard]] auto records_of(std::size_t index) const -> std::array<std::string, 2>;
  [[nodiscard]] auto statistics() const -> std::string;
  [[nodiscard]] auto chunk_indices() const -> std::string;

  std::ostream& out_;
  McapCompression compression_;
  std::uint64_t at_ = 0;
  std::uint32_t crc_ = 0;
  std::vector<Channel> channels_;
  std::string chunk_;
  Span chunk_span_, span_;
  std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> chunk_index_;  // time, place in chunk
  std::vector<ChunkPlace> chunks_;
};

}  // namespace capstan::tools
