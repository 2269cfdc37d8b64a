// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <new>
#include <type_traits>

namespace capstan {

class Session;

/// An answer that takes more than one call: a log, an experiment, or the cycle's consent to a request. The console has
/// one at a time and calls it from the background loop.
class Stream {
 public:
  /// Goes on by a bounded piece, without waiting. What ends the answer (Session::ok, error, refused) ends the stream.
  virtual void step(Session& session) = 0;
  /// Ctrl-C, or a `disarm` that overtakes: the answer is to end, here or in one of the next steps.
  virtual void cancel(Session& session) = 0;
  enum class Manner : std::uint8_t {
    kGoesOn,  ///< until it is done or cancelled; a line that comes meanwhile is refused
    kYields,  ///< as well, but the next line ends it
    kWaits,   ///< for the cycle, which settles it within a few milliseconds, or as soon as its drives follow
  };
  [[nodiscard]] virtual auto manner() const -> Manner { return Manner::kGoesOn; }

 protected:
  ~Stream() = default;  // never owned through this face: a virtual one would need operator delete
};

/// The answer to a request that the cycle was handed.
class ConsentStream : public Stream {
 public:
  void cancel(Session& /*session*/) final {}
  [[nodiscard]] auto manner() const -> Manner final { return Manner::kWaits; }

 protected:
  ~ConsentStream() = default;
};

/// Where one stream lives: made in place, and gone when the next one is made.
template <std::size_t Bytes>
class StreamRoom {
 public:
  template <typename T>
  auto make() -> T& {
    static_assert(std::is_base_of_v<Stream, T>);
    static_assert(std::is_trivially_destructible_v<T>, "nobody destroys it");
    static_assert(sizeof(T) <= Bytes, "give the session's room more bytes");
    return *new (bytes_.data()) T{};
  }

 private:
  alignas(std::max_align_t) std::array<std::byte, Bytes> bytes_{};
};

}  // namespace capstan
