// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace capstan {

// The three ways between the cycle and slow code. The cycle's side never waits in any of them.

/// Slow code to cycle: one value at a time. The writer may try again when the last one was taken.
template <typename T>
class Mailbox {
 public:
  auto offer(const T& value) -> bool {
    if (full_.load(std::memory_order_acquire)) {
      return false;
    }
    value_ = value;
    full_.store(true, std::memory_order_release);
    return true;
  }
  /// nullptr if there is nothing. The value stays valid until rt_taken().
  [[nodiscard]] auto rt_peek() const -> const T* { return full_.load(std::memory_order_acquire) ? &value_ : nullptr; }
  void rt_taken() { full_.store(false, std::memory_order_release); }
  [[nodiscard]] auto empty() const -> bool { return !full_.load(std::memory_order_acquire); }

 private:
  T value_{};
  std::atomic<bool> full_ = false;
};

/// Cycle to slow code: the newest value, read whole. The reader retries if the cycle wrote meanwhile; it can lose that
/// race at most once a cycle.
template <typename T>
class Published {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  /// Inlined, or its copy would lie on the cycle's stack beside the caller's.
  [[gnu::always_inline]] void rt_publish(const T& value) {
    std::array<std::uint32_t, kWords> words{};
    std::memcpy(words.data(), &value, sizeof value);
    const std::uint32_t sequence = sequence_.load(std::memory_order_relaxed);
    sequence_.store(sequence + 1, std::memory_order_relaxed);
    std::atomic_thread_fence(std::memory_order_release);
    for (std::size_t i = 0; i < kWords; ++i) {
      words_[i].store(words[i], std::memory_order_relaxed);
    }
    sequence_.store(sequence + 2, std::memory_order_release);
  }

  [[nodiscard]] auto read() const -> T {
    std::array<std::uint32_t, kWords> words{};
    std::uint32_t before = 0;
    std::uint32_t after = 1;
    while (before != after || (before & 1U) != 0) {
      before = sequence_.load(std::memory_order_acquire);
      for (std::size_t i = 0; i < kWords; ++i) {
        words[i] = words_[i].load(std::memory_order_relaxed);
      }
      std::atomic_thread_fence(std::memory_order_acquire);
      after = sequence_.load(std::memory_order_relaxed);
    }
    T value;
    std::memcpy(static_cast<void*>(&value), words.data(), sizeof value);
    return value;
  }

 private:
  static constexpr std::size_t kWords = (sizeof(T) + 3) / 4;
  std::array<std::atomic<std::uint32_t>, kWords> words_{};
  std::atomic<std::uint32_t> sequence_ = 0;
};

/// Cycle to slow code: every value in order, as long as the reader keeps up; what finds no room is dropped and counted.
template <typename T, std::size_t Capacity>
class SpscRing {
  static_assert((Capacity & (Capacity - 1)) == 0, "a power of two, so that indices may wrap");

 public:
  void rt_push(const T& value) {
    const std::uint32_t head = head_.load(std::memory_order_relaxed);
    if (head - tail_.load(std::memory_order_acquire) >= Capacity) {
      dropped_.store(dropped_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
      return;
    }
    items_[head % Capacity] = value;
    head_.store(head + 1, std::memory_order_release);
  }
  auto pop(T& value) -> bool {
    const std::uint32_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == head_.load(std::memory_order_acquire)) {
      return false;
    }
    value = items_[tail % Capacity];
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }
  [[nodiscard]] auto dropped() const -> std::uint32_t { return dropped_.load(std::memory_order_relaxed); }

 private:
  std::array<T, Capacity> items_{};
  std::atomic<std::uint32_t> head_ = 0;
  std::atomic<std::uint32_t> tail_ = 0;
  std::atomic<std::uint32_t> dropped_ = 0;
};

}  // namespace capstan
