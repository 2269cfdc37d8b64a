// SPDX-License-Identifier: Apache-2.0
#include "capstan/boards/common/retained_memory.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include "capstan/firmware/parameters/crc32.hpp"
#include "capstan/hal/linux/file_descriptor.hpp"

namespace capstan {
namespace {

constexpr std::uint32_t kMagic = 0x31464D52;  // "RMF1"

auto bytes_of(std::span<const std::uint32_t> words) -> std::span<const std::uint8_t> {
  return {reinterpret_cast<const std::uint8_t*>(words.data()), words.size_bytes()};
}

auto crc_of(std::span<const std::uint32_t> words) -> std::uint32_t {
  Crc32 crc;
  crc.add(bytes_of(words));
  return crc.value();
}

/// Whether a file begins as no fault log does, however torn or damaged: not with its mark or zeros, but for a few bits.
auto is_of_somebody_else(const std::string& path) -> bool {
  constexpr int kDamagedBits = 4;
  const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  std::uint32_t begin = 0;
  const auto count = file ? ::read(file.get(), &begin, sizeof(begin)) : -1;
  const std::uint32_t seen =
      count <= 0 ? 0 : ~std::uint32_t{0} >> (8 * (sizeof(begin) - static_cast<std::size_t>(count)));
  return std::popcount((begin ^ kMagic) & seen) > kDamagedBits && std::popcount(begin & seen) > kDamagedBits;
}

}  // namespace

RetainedMemory::RetainedMemory(std::string path, std::size_t words) : words_(words), path_(std::move(path)) {
  struct stat info {};
  const bool is_there = ::stat(path_.c_str(), &info) == 0;
  if (is_there && (!S_ISREG(info.st_mode) || is_of_somebody_else(path_))) {
    throw std::runtime_error(path_ + " is something else than a fault log; move it, or give --storage another name");
  }
  if (is_there && !read()) {
    remark_ = path_ + " is torn, damaged or of another layout, so the faults in it are lost and a new log begins";
  }
  written_ = file_content();
  if (!write(written_, true)) {
    throw std::runtime_error(path_ + ": the fault log can not be written (" + std::strerror(errno) +
                             "); give a path in a folder that you may write to");
  }
}

auto RetainedMemory::file_content() const -> std::vector<std::uint32_t> {
  std::vector<std::uint32_t> content{kMagic};
  content.reserve(words_.size() + 2);
  for (const std::uint32_t& word : words_) {
    // Word by word, as the cycle may be writing: a sample that is half new is no worse than one that is missing.
    content.push_back(std::atomic_ref(const_cast<std::uint32_t&>(word)).load(std::memory_order_relaxed));
  }
  content.push_back(crc_of(content));
  return content;
}

auto RetainedMemory::read() -> bool {
  const FileDescriptor file(::open(path_.c_str(), O_RDONLY | O_CLOEXEC));
  std::vector<std::uint32_t> content(words_.size() + 3);  // one more, to see a file that is too long
  const auto count = file ? ::read(file.get(), content.data(), content.size() * sizeof(std::uint32_t)) : -1;
  const std::size_t wanted = (words_.size() + 2) * sizeof(std::uint32_t);
  content.resize(words_.size() + 2);
  if (count != static_cast<ssize_t>(wanted) || content.front() != kMagic ||
      content.back() != crc_of(std::span(content).first(content.size() - 1))) {
    return false;
  }
  words_.assign(content.begin() + 1, content.end() - 1);
  return true;
}

auto RetainedMemory::write(const std::vector<std::uint32_t>& content, bool to_disk) const -> bool {
  const std::string fresh = path_ + ".new";
  {
    const FileDescriptor file(::open(fresh.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644));
    const auto size = static_cast<ssize_t>(content.size() * sizeof(std::uint32_t));
    if (!file || ::write(file.get(), content.data(), static_cast<std::size_t>(size)) != size ||
        (to_disk && ::fdatasync(file.get()) != 0)) {
      return false;
    }
  }
  return std::rename(fresh.c_str(), path_.c_str()) == 0;
}

auto RetainedMemory::keep(bool torque) -> std::string {
  const auto now = Clock::now();
  const bool soon_enough = torque && had_torque_ && now - written_at_ < kOldest;
  had_torque_ = torque;
  if (path_.empty() || soon_enough) {
    return {};
  }
  std::vector<std::uint32_t> content = file_content();
  if (content == written_) {
    return {};
  }
  written_at_ = now;
  if (!write(content, !torque)) {
    return std::exchange(failed_, true) ? std::string{}
                                        : path_ + ": the fault log can not be written (" + std::strerror(errno) +
                                              "); make room on the disk, or the log is lost with the program";
  }
  failed_ = false;
  written_ = std::move(content);
  return {};
}

}  // namespace capstan
