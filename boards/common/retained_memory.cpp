// SPDX-License-Identifier: Apache-2.0
#include "boards/common/retained_memory.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "hal/linux/file_descriptor.hpp"

namespace capstan {

void RetainedMemory::map(int fd, int flags, std::size_t words) {
  void* memory = ::mmap(nullptr, words * sizeof(std::uint32_t), PROT_READ | PROT_WRITE, flags, fd, 0);
  if (memory == MAP_FAILED) {
    throw std::runtime_error(std::string("memory for the fault log can not be had (") + std::strerror(errno) +
                             "); end other programs and try again");
  }
  words_ = {static_cast<std::uint32_t*>(memory), words};
}

RetainedMemory::RetainedMemory(std::size_t words) {
  map(-1, MAP_PRIVATE | MAP_ANONYMOUS, words);
}

RetainedMemory::RetainedMemory(const std::string& path, std::size_t words) {
  const FileDescriptor file(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644));
  if (!file || ::ftruncate(file.get(), static_cast<off_t>(words * sizeof(std::uint32_t))) != 0) {
    throw std::runtime_error(path + ": the fault log can not be written (" + std::strerror(errno) +
                             "); give a path in a folder that you may write to");
  }
  map(file.get(), MAP_SHARED, words);
}

RetainedMemory::~RetainedMemory() {
  static_cast<void>(::munmap(words_.data(), words_.size_bytes()));
}

}  // namespace capstan
