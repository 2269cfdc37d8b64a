// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace capstan::tools {

/// Room for a file beside the one that it will replace, so that what fails or is stopped leaves the older one. It goes
/// with this object unless kept. A link stays one, and what it points to is replaced; a device or a pipe is written to
/// as it is.
class PendingFile {
 public:
  /// Throws BadInput.
  explicit PendingFile(const std::string& path);
  PendingFile(const PendingFile&) = delete;
  auto operator=(const PendingFile&) -> PendingFile& = delete;
  ~PendingFile();
  /// Where to write.
  [[nodiscard]] auto name() const -> const std::string& { return name_; }
  /// Puts what was written in its place. Throws BadInput.
  void keep();

 private:
  std::string path_;  // links followed
  std::string name_;
};

}  // namespace capstan::tools
