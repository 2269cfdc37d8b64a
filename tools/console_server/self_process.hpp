// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/io_context.hpp>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace capstan::tools {

/// A folder for what programs leave, which goes with this object.
class TemporaryFolder {
 public:
  /// Throws BadInput.
  TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  auto operator=(const TemporaryFolder&) -> TemporaryFolder& = delete;
  ~TemporaryFolder();

  [[nodiscard]] auto path() const -> const std::filesystem::path& { return path_; }
  [[nodiscard]] auto file(const char* name) const -> std::string { return (path_ / name).string(); }
  /// Nothing if there is no such file.
  [[nodiscard]] auto text(const std::filesystem::path& name) const -> std::optional<std::string>;
  /// Takes this folder's path out of what a program said: a page's user knows no such folder.
  [[nodiscard]] auto without_path(std::string said) const -> std::string;

 private:
  std::filesystem::path path_;
};

/// This program once more, as a process of its own: a page that waits keeps its board.
class SelfProcess {
 public:
  struct Streams {
    int in = -1, out = -1, err = -1;
  };

  explicit SelfProcess(boost::asio::io_context& io) : io_(io) {}
  SelfProcess(const SelfProcess&) = delete;
  auto operator=(const SelfProcess&) -> SelfProcess& = delete;
  /// Kills it.
  ~SelfProcess();

  /// @param words  "capstan" and what follows   @param ended  is told the exit status, by `io`
  /// False if it does not start. @pre it is not running
  auto start(std::vector<std::string> words, const Streams& streams, std::function<void(int)> ended) -> bool;
  void signal(int number) const;
  [[nodiscard]] auto running() const -> bool { return process_ != 0; }

 private:
  boost::asio::io_context& io_;
  std::thread waiting_;
  int process_ = 0;  // 0: none
};

}  // namespace capstan::tools
