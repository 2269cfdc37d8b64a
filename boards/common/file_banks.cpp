// SPDX-License-Identifier: Apache-2.0
#include "capstan/boards/common/file_banks.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <vector>

namespace capstan {
namespace {

auto inside(int bank, std::size_t offset, std::size_t size) -> bool {
  return bank >= 0 && bank < Banks::kBanks && offset <= FileBanks::kBankBytes && size <= FileBanks::kBankBytes - offset;
}

auto position(int bank, std::size_t offset) -> off_t {
  return static_cast<off_t>(static_cast<std::size_t>(bank) * FileBanks::kBankBytes + offset);
}

/// pwrite() or pread() until all bytes have gone, whatever interrupts it.
template <typename Byte, typename Call>
auto transfer_all(Call&& call, int fd, std::span<Byte> bytes, off_t at) -> bool {
  while (!bytes.empty()) {
    const auto count = call(fd, bytes.data(), bytes.size(), at);
    if (count < 0 && errno == EINTR) {
      continue;
    }
    if (count <= 0) {
      return false;
    }
    bytes = bytes.subspan(static_cast<std::size_t>(count));
    at += count;
  }
  return true;
}

auto write_all(int fd, std::span<const std::uint8_t> bytes, off_t at) -> bool {
  return transfer_all(pwrite, fd, bytes, at);
}

auto read_all(int fd, std::span<std::uint8_t> bytes, off_t at) -> bool {
  return transfer_all(pread, fd, bytes, at);
}

/// What the first erasing leaves of a store when it is cut short, and nothing else does.
auto holds_erased(int fd, std::size_t size) -> bool {
  std::vector<std::uint8_t> bytes(size);
  return read_all(fd, bytes, 0) && std::all_of(bytes.begin(), bytes.end(), [](auto byte) { return byte == 0xFF; });
}

}  // namespace

FileBanks::FileBanks(const std::string& path)
    : FileBanks(FileDescriptor(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)), path) {}

auto FileBanks::temporary() -> FileBanks {
  return FileBanks(FileDescriptor(memfd_create("capstan_banks", MFD_CLOEXEC)), "in memory");
}

FileBanks::FileBanks(FileDescriptor file, const std::string& name) : file_(std::move(file)) {
  const auto fail = [&name](const std::string& problem) {
    throw std::runtime_error("The parameter store " + name + problem);
  };
  if (!file_) {
    fail(" cannot be opened (" + std::string(std::strerror(errno)) + "); check the folder and its permissions");
  }
  if (flock(file_.get(), LOCK_EX | LOCK_NB) != 0) {
    fail(" is in use by another program; end it or give another file");
  }
  struct stat info {};
  if (fstat(file_.get(), &info) != 0 || !S_ISREG(info.st_mode) || info.st_size > position(kBanks, 0) ||
      (info.st_size < position(kBanks, 0) && !holds_erased(file_.get(), static_cast<std::size_t>(info.st_size)))) {
    fail(" is something else: a store is a file of 32768 bytes; give another name");
  }
  if (info.st_size < position(kBanks, 0) && !(do_erase(0) && do_erase(1))) {
    fail(" cannot be written (" + std::string(std::strerror(errno)) + "); check that the disk has room");
  }
}

auto FileBanks::do_erase(int bank) -> bool {
  const std::vector<std::uint8_t> erased(kBankBytes, 0xFF);
  return inside(bank, 0, kBankBytes) && write_all(file_.get(), erased, position(bank, 0)) && fsync(file_.get()) == 0;
}

auto FileBanks::do_write(int bank, std::size_t offset, std::span<const std::uint8_t> bytes) -> bool {
  std::vector<std::uint8_t> cells(bytes.size());
  if (!inside(bank, offset, bytes.size()) || !read_all(file_.get(), cells, position(bank, offset))) {
    return false;
  }
  for (std::size_t i = 0; i < cells.size(); ++i) {
    cells[i] &= bytes[i];
  }
  const bool seals = offset == 0;
  return (!seals || fdatasync(file_.get()) == 0) && write_all(file_.get(), cells, position(bank, offset)) &&
         (!seals || fdatasync(file_.get()) == 0);
}

auto FileBanks::do_read(int bank, std::size_t offset, std::span<std::uint8_t> bytes) -> bool {
  return inside(bank, offset, bytes.size()) && read_all(file_.get(), bytes, position(bank, offset));
}

}  // namespace capstan
