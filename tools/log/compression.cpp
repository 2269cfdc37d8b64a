// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/compression.hpp"

#include <lz4frame.h>
#include <zlib.h>
#include <zstd.h>

#include <array>
#include <limits>
#include <memory>

namespace capstan::tools {
namespace {

constexpr std::size_t kBufferBytes = 1U << 16U;
using Buffer = std::array<char, kBufferBytes>;

void append(std::string& result, const Buffer& buffer, std::size_t count, std::size_t most) {
  if (count > most - result.size()) {
    throw Unpackable("it unpacks to more than " + std::to_string(most) + " bytes");
  }
  result.append(buffer.data(), count);
}

auto gunzipped(std::string_view bytes, std::size_t most) -> std::string {
  z_stream stream{};
  constexpr int kGzipOnly = 16 + MAX_WBITS;
  if (inflateInit2(&stream, kGzipOnly) != Z_OK) {
    throw Unpackable("there is no memory left");
  }
  const std::unique_ptr<z_stream, int (*)(z_stream*)> cleanup(&stream, inflateEnd);
  std::string result;
  Buffer buffer{};
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));  // zlib does not write there
  std::size_t left = bytes.size();
  int status = Z_OK;
  while (left > 0 || status != Z_STREAM_END) {
    const auto portion = static_cast<uInt>(std::min<std::size_t>(left, std::numeric_limits<uInt>::max()));
    stream.avail_in = portion;
    stream.next_out = reinterpret_cast<Bytef*>(buffer.data());
    stream.avail_out = static_cast<uInt>(buffer.size());
    status = inflate(&stream, Z_NO_FLUSH);
    left -= portion - stream.avail_in;
    append(result, buffer, buffer.size() - stream.avail_out, most);
    if (status == Z_STREAM_END && left > 0) {
      inflateReset(&stream);  // another member follows
    } else if (status == Z_BUF_ERROR || (status == Z_OK && left == 0 && stream.avail_out > 0)) {
      throw Unpackable("it ends in the middle");
    } else if (status != Z_OK && status != Z_STREAM_END) {
      throw Unpackable("it is damaged");
    }
  }
  return result;
}

auto unpacked_zstd(std::string_view bytes, std::size_t most) -> std::string {
  const std::unique_ptr<ZSTD_DCtx, std::size_t (*)(ZSTD_DCtx*)> context(ZSTD_createDCtx(), ZSTD_freeDCtx);
  std::string result;
  Buffer buffer{};
  ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
  std::size_t status = 0;
  bool full = false;
  while (in.pos < in.size || full) {
    ZSTD_outBuffer out{buffer.data(), buffer.size(), 0};
    status = ZSTD_decompressStream(context.get(), &out, &in);
    if (ZSTD_isError(status) != 0) {
      throw Unpackable("it is damaged");
    }
    full = out.pos == out.size && status != 0;
    append(result, buffer, out.pos, most);
  }
  if (status != 0) {
    throw Unpackable("it ends in the middle");
  }
  return result;
}

auto unpacked_lz4(std::string_view bytes, std::size_t most) -> std::string {
  LZ4F_dctx* raw = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION)) != 0) {
    throw Unpackable("there is no memory left");
  }
  const std::unique_ptr<LZ4F_dctx, LZ4F_errorCode_t (*)(LZ4F_dctx*)> context(raw, LZ4F_freeDecompressionContext);
  std::string result;
  Buffer buffer{};
  std::size_t at = 0;
  std::size_t hint = 0;
  bool full = false;
  while (at < bytes.size() || full) {
    std::size_t out = buffer.size();
    std::size_t in = bytes.size() - at;
    hint = LZ4F_decompress(context.get(), buffer.data(), &out, bytes.data() + at, &in, nullptr);
    if (LZ4F_isError(hint) != 0) {
      throw Unpackable("it is damaged");
    }
    if (in == 0 && out == 0) {
      break;
    }
    at += in;
    full = out == buffer.size() && hint != 0;
    append(result, buffer, out, most);
  }
  if (hint != 0 || at < bytes.size()) {
    throw Unpackable("it ends in the middle");
  }
  return result;
}

}  // namespace

auto unpacked(Codec codec, std::string_view bytes, std::size_t most) -> std::string {
  switch (codec) {
    case Codec::kGzip:
      return gunzipped(bytes, most);
    case Codec::kZstd:
      return unpacked_zstd(bytes, most);
    case Codec::kLz4:
      break;
  }
  return unpacked_lz4(bytes, most);
}

auto packed(Codec codec, std::string_view bytes) -> std::string {
  const bool zstd = codec == Codec::kZstd;
  std::string result(zstd ? ZSTD_compressBound(bytes.size()) : LZ4F_compressFrameBound(bytes.size(), nullptr), '\0');
  const std::size_t size =
      zstd ? ZSTD_compress(result.data(), result.size(), bytes.data(), bytes.size(), ZSTD_CLEVEL_DEFAULT)
           : LZ4F_compressFrame(result.data(), result.size(), bytes.data(), bytes.size(), nullptr);
  if (zstd ? ZSTD_isError(size) != 0 : LZ4F_isError(size) != 0) {
    throw Unpackable("there is no memory left");
  }
  result.resize(size);
  return result;
}

}  // namespace capstan::tools
