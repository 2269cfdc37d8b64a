// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace capstan::tools {

enum class Codec { kGzip, kZstd, kLz4 };

/// The bytes do not unpack. The message says why, without file or cure.
class Unpackable : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Most bytes that a log may unpack to: an hour of 60 columns at 1 kHz. A small file that claims more is broken, or
/// made to fill the memory.
inline constexpr std::size_t kMostUnpackedBytes = std::size_t{4} << 30U;

/// Unpacks whole frames, one after the other, as the usual programs write them (gzip members, Zstandard and LZ4
/// frames).
/// @param most  bytes; Unpackable if there are more
auto unpacked(Codec codec, std::string_view bytes, std::size_t most = kMostUnpackedBytes) -> std::string;

/// One frame. @pre codec is kZstd or kLz4
auto packed(Codec codec, std::string_view bytes) -> std::string;

}  // namespace capstan::tools
