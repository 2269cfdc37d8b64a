// SPDX-License-Identifier: Apache-2.0
// Replaces the allocation functions of a whole program: every call is counted while a watch is on. For one source of a
// program only.
#pragma once

#include <atomic>
#include <cstddef>

namespace {
std::atomic<bool> watching = false;
std::atomic<long> allocations = 0;

void count_one() {
  if (watching.load(std::memory_order_relaxed)) {
    allocations.fetch_add(1, std::memory_order_relaxed);
  }
}
}  // namespace

#if defined(__SANITIZE_ADDRESS__)
// The sanitizer owns malloc; it tells of every call, those of operator new among them. Its header is not always
// installed.
extern "C" auto __sanitizer_install_malloc_and_free_hooks(void (*on_allocation)(const volatile void*,
                                                                                std::size_t),  // NOLINT
                                                          void (*on_release)(const volatile void*)) -> int;
namespace {
void on_allocation(const volatile void* /*memory*/, std::size_t /*size*/) {
  count_one();
}
void on_release(const volatile void* /*memory*/) {}
const bool kHooked = __sanitizer_install_malloc_and_free_hooks(on_allocation, on_release) != 0;
}  // namespace
#else
extern "C" {
auto __libc_malloc(std::size_t size) -> void*;                     // NOLINT: glibc's name
auto __libc_calloc(std::size_t count, std::size_t size) -> void*;  // NOLINT
auto __libc_realloc(void* memory, std::size_t size) -> void*;      // NOLINT

auto malloc(std::size_t size) noexcept -> void* {
  count_one();
  return __libc_malloc(size);
}
auto calloc(std::size_t count, std::size_t size) noexcept -> void* {
  count_one();
  return __libc_calloc(count, size);
}
auto realloc(void* memory, std::size_t size) noexcept -> void* {
  count_one();
  return __libc_realloc(memory, size);
}
}
namespace {
[[maybe_unused]] const bool kHooked = true;
}  // namespace
#endif

namespace capstan::test {

/// Counts the allocations of its lifetime, in all threads.
class Watch {
 public:
  Watch() {
    allocations = 0;
    watching = true;
  }
  ~Watch() { watching = false; }
  Watch(const Watch&) = delete;
  auto operator=(const Watch&) -> Watch& = delete;
  [[nodiscard]] auto count() const -> long { return allocations.load(); }
};

}  // namespace capstan::test
