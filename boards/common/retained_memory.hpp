// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace capstan {

/// Memory that outlives the firmware, as the retained RAM of a microcontroller outlives its reset: it stays while the
/// firmware starts anew in the same program and, where it has a file, also when the program ends, however it does. All
/// zero at first. The memory itself is plain: a real-time thread writes it and never meets the file, which whoever has
/// time brings up to date.
class RetainedMemory {
 public:
  /// Under torque the file is at most this old: what the end of the program costs.
  static constexpr std::chrono::milliseconds kOldest{500};

  /// Gone with the program.
  explicit RetainedMemory(std::size_t words) : words_(words) {}
  /// With a file, made if it is not there. What is torn, damaged or of another layout is said in remark() and is as if
  /// it was not there. Throws std::runtime_error with "sentence; cure" if it can not be written.
  RetainedMemory(std::string path, std::size_t words);
  RetainedMemory(const RetainedMemory&) = delete;
  auto operator=(const RetainedMemory&) -> RetainedMemory& = delete;
  ~RetainedMemory() = default;

  [[nodiscard]] auto words() -> std::span<std::uint32_t> { return words_; }
  /// What was wrong with the file, or nothing.
  [[nodiscard]] auto remark() const -> const std::string& { return remark_; }

  /// Brings the file up to date if it has to be: at rest whenever something changed, to the disk itself, for that is
  /// the end of a fault; under torque every kOldest, and not as far as the disk, for that may take long. Replaces the
  /// file whole, so that one which is torn is never met. Call it often, never in a real-time thread. What goes wrong is
  /// a sentence, once.
  [[nodiscard]] auto keep(bool torque) -> std::string;

 private:
  using Clock = std::chrono::steady_clock;
  /// With magic number and CRC.
  [[nodiscard]] auto file_content() const -> std::vector<std::uint32_t>;
  [[nodiscard]] auto read() -> bool;
  [[nodiscard]] auto write(const std::vector<std::uint32_t>& content, bool to_disk) const -> bool;

  std::vector<std::uint32_t> words_;
  std::vector<std::uint32_t> written_;
  Clock::time_point written_at_{};
  std::string path_;
  std::string remark_;
  bool had_torque_ = false;
  bool failed_ = false;
};

}  // namespace capstan
