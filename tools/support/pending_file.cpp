// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/support/pending_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {

namespace fs = std::filesystem;

PendingFile::PendingFile(const std::string& path) : path_(path), name_(path) {
  std::error_code error;
  if (fs::is_symlink(path, error)) {
    path_ = name_ = fs::weakly_canonical(path, error).string();
  }
  const fs::file_status before = fs::status(path_, error);
  if (fs::exists(before) && !fs::is_regular_file(before)) {
    return;  // a file that is renamed to it would stand in its place
  }
  int made = -1;
  for (int number = 0; made < 0; ++number) {
    name_ = path_ + "." + std::to_string(::getpid()) + (number == 0 ? "" : "_" + std::to_string(number)) + ".part";
    made = ::open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (made < 0 && errno != EEXIST) {
      throw BadInput(path + ": the file can not be written; check that the folder exists and has room");
    }
  }
  ::close(made);
  if (fs::exists(before)) {
    fs::permissions(name_, before.permissions(), error);  // where that is not allowed, those of a new file
  }
}

PendingFile::~PendingFile() {
  std::error_code error;
  if (name_ != path_) {
    fs::remove(name_, error);
  }
}

void PendingFile::keep() {
  std::error_code error;
  fs::rename(name_, path_, error);
  if (error) {
    throw BadInput(path_ + ": the file can not be written (" + error.message() + "); choose another name");
  }
  name_ = path_;
}

}  // namespace capstan::tools
