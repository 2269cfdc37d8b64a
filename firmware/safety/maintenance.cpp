// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/safety/maintenance.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <span>

namespace capstan {
namespace {

// FIPS 180-4, 4.2.2 and 5.3.3: the first 32 bits of the fractions of cube and square roots of the first primes.
constexpr std::array<std::uint32_t, 64> kRoundConstants = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};
constexpr std::array<std::uint32_t, 8> kInitialHash = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                                       0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
constexpr std::size_t kBlockBytes = 64;

/// Byte by byte, so that no copy of a secret is left in a second buffer.
class Sha256 {
 public:
  void add(std::string_view text) {
    for (const char c : text) {
      add_byte(static_cast<std::uint8_t>(c));
    }
  }
  /// The object is used up.
  auto finish() -> std::array<std::uint32_t, 8> {
    const std::uint32_t bits = bytes_ * 8;  // of less than 2^29 bytes
    add_byte(0x80);
    while (bytes_ % kBlockBytes != kBlockBytes - 8) {
      add_byte(0);
    }
    for (int shift = 56; shift >= 0; shift -= 8) {
      add_byte(shift >= 32 ? std::uint8_t{0} : static_cast<std::uint8_t>(bits >> shift));
    }
    return hash_;
  }

 private:
  void add_byte(std::uint8_t byte) {
    std::uint32_t& word = block_[bytes_ % kBlockBytes / 4];
    word = (word << 8) | byte;
    if (++bytes_ % kBlockBytes == 0) {
      compress();
    }
  }

  /// FIPS 180-4, 6.2.2. The message schedule is kept as its last 16 words.
  void compress() {
    std::array<std::uint32_t, 8> v = hash_;
    for (std::size_t t = 0; t < kRoundConstants.size(); ++t) {
      std::uint32_t& w = block_[t % 16];
      if (t >= 16) {
        const std::uint32_t w2 = block_[(t - 2) % 16];
        const std::uint32_t w15 = block_[(t - 15) % 16];
        w += (std::rotr(w2, 17) ^ std::rotr(w2, 19) ^ (w2 >> 10)) + block_[(t - 7) % 16] +
             (std::rotr(w15, 7) ^ std::rotr(w15, 18) ^ (w15 >> 3));
      }
      const std::uint32_t big1 = std::rotr(v[4], 6) ^ std::rotr(v[4], 11) ^ std::rotr(v[4], 25);
      const std::uint32_t big0 = std::rotr(v[0], 2) ^ std::rotr(v[0], 13) ^ std::rotr(v[0], 22);
      const std::uint32_t t1 = v[7] + big1 + ((v[4] & v[5]) ^ (~v[4] & v[6])) + kRoundConstants[t] + w;
      const std::uint32_t t2 = big0 + ((v[0] & v[1]) ^ (v[0] & v[2]) ^ (v[1] & v[2]));
      v = {t1 + t2, v[0], v[1], v[2], v[3] + t1, v[4], v[5], v[6]};
    }
    for (std::size_t i = 0; i < hash_.size(); ++i) {
      hash_[i] += v[i];
    }
  }

  std::array<std::uint32_t, 8> hash_ = kInitialHash;
  std::array<std::uint32_t, 16> block_{};
  std::uint32_t bytes_ = 0;
};

}  // namespace

auto sha256(std::string_view text) -> std::array<std::uint32_t, 8> {
  Sha256 hash;
  hash.add(text);
  return hash.finish();
}

auto digest_of(std::string_view key) -> KeyDigest {
  Sha256 hash;
  hash.add("capstan maintenance ");
  hash.add(key);
  const auto whole = hash.finish();
  KeyDigest digest;
  std::copy_n(whole.begin(), digest.words.size(), digest.words.begin());
  return digest;
}

auto Maintenance::open(std::string_view key, const KeyDigest& stored, std::uint32_t now_ms) -> Attempt {
  if (stored.is_set()) {
    if (waits_ && now_ms - wrong_ms_ < kWaitMs) {
      return Attempt::kTooSoon;
    }
    const KeyDigest given = digest_of(key);
    std::uint32_t differs = 0;
    for (std::size_t i = 0; i < given.words.size(); ++i) {
      differs |= given.words[i] ^ stored.words[i];  // all of them: the time it takes tells nothing
    }
    waits_ = differs != 0;
    if (waits_) {
      wrong_ms_ = now_ms;
      return Attempt::kWrong;
    }
  }
  open_ = true;
  since_ms_ = now_ms;
  return Attempt::kOpened;
}

auto Maintenance::is_open(std::uint32_t now_ms) -> bool {
  open_ = open_ && now_ms - since_ms_ < kOpenMs;
  return open_;
}

}  // namespace capstan
