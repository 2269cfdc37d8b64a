// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace capstan {

/// Bounded queue of bytes, or of other small items, between exactly one writer and one reader, of which either may be
/// an interrupt. No lock and no interrupt masking: each side stores only its own index, and publishes it after the
/// data.
template <std::size_t Capacity, typename Item = std::uint8_t>
class RingBuffer {
  static_assert(Capacity >= 2 && (Capacity & (Capacity - 1)) == 0, "indices run free and are masked");
  static_assert(std::atomic<std::uint32_t>::is_always_lock_free);

 public:
  static constexpr std::size_t kCapacity = Capacity;

  /// Writer only. False: full, the item was not taken.
  [[nodiscard]] auto push(const Item& item) noexcept -> bool {
    const std::uint32_t head = head_.load(std::memory_order_relaxed);
    if (head - tail_.load(std::memory_order_acquire) == Capacity) {
      return false;
    }
    data_[head & kMask] = item;
    head_.store(head + 1, std::memory_order_release);
    return true;
  }

  /// Reader only. False: empty, `item` is unchanged.
  [[nodiscard]] auto pop(Item& item) noexcept -> bool {
    const std::uint32_t tail = tail_.load(std::memory_order_relaxed);
    if (head_.load(std::memory_order_acquire) == tail) {
      return false;
    }
    item = data_[tail & kMask];
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }

  /// Either side; the other may change it at any moment, but only in the direction that helps the caller.
  [[nodiscard]] auto size() const noexcept -> std::size_t {
    return head_.load(std::memory_order_acquire) - tail_.load(std::memory_order_acquire);
  }
  [[nodiscard]] auto free() const noexcept -> std::size_t { return Capacity - size(); }

 private:
  static constexpr std::uint32_t kMask = Capacity - 1;
  std::array<Item, Capacity> data_{};
  std::atomic<std::uint32_t> head_{0};
  std::atomic<std::uint32_t> tail_{0};
};

}  // namespace capstan
