// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "capstan/tools/console_server/backlog.hpp"

namespace capstan::tools {

/// One end of a pipe or pseudo-terminal whose other end a program has: hands on what comes, and sends without waiting.
class ProgramLine : public std::enable_shared_from_this<ProgramLine> {
 public:
  /// @param descriptor  belongs to this object from now on; -1 never says anything
  /// @param heard  is told what comes, and "" at its end
  ProgramLine(boost::asio::io_context& io, int descriptor, std::function<void(std::string_view)> heard);

  void read();
  void send(std::string_view bytes);
  [[nodiscard]] auto behind() const -> bool { return backlog_.behind(Backlog::Clock::now()); }
  /// Nobody is told anything any more.
  void close();

 private:
  void write();

  boost::asio::posix::stream_descriptor line_;
  std::function<void(std::string_view)> heard_;
  std::array<char, 4096> in_{};
  std::string waiting_, going_;
  Backlog backlog_;
};

}  // namespace capstan::tools
