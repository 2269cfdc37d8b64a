// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "capstan/firmware/parameters/storage.hpp"
#include "capstan/hal/linux/file_descriptor.hpp"

namespace capstan {

/// Two banks of 16 KB in one file, with the manners of flash: erasing sets every bit, writing can only clear bits, so
/// code that forgets to erase fails here as it would on the target. A write at a bank's beginning, where a set becomes
/// valid, reaches the disk after everything written before it.
class FileBanks final : public Banks {
 public:
  static constexpr std::size_t kBankBytes = std::size_t{16} * 1024;

  /// Opens the file, or makes it with both banks erased. It stays locked against other programs.
  /// Throws std::runtime_error with "sentence; cure".
  explicit FileBanks(const std::string& path);
  /// Banks that are gone when the program ends, with the same manners: for runs that shall leave nothing behind.
  static auto temporary() -> FileBanks;

 private:
  FileBanks(FileDescriptor file, const std::string& name);
  auto do_erase(int bank) -> bool override;
  auto do_write(int bank, std::size_t offset, std::span<const std::uint8_t> bytes) -> bool override;
  auto do_read(int bank, std::size_t offset, std::span<std::uint8_t> bytes) -> bool override;

  FileDescriptor file_;
};

}  // namespace capstan
