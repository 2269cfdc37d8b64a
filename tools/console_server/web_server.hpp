// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/io_context.hpp>
#include <functional>
#include <memory>
#include <optional>

#include "capstan/tools/console_server/door.hpp"
#include "capstan/tools/console_server/foxglove.hpp"
#include "capstan/tools/console_server/hub.hpp"
#include "capstan/tools/console_server/log_job.hpp"
#include "capstan/tools/console_server/page_files.hpp"

namespace capstan::tools {

/// Serves the page to this machine alone, and joins it with the hub over a WebSocket. Binary messages are the board's
/// bytes, text messages are the words of hub.hpp.
class WebServer {
 public:
  /// What host programs left, a page of its own, by the name under which it is asked for; nothing if there is none.
  using Reports = std::function<std::optional<std::string>(std::string_view)>;

  /// @param port  of 127.0.0.1; 0: any free one   @param board, job  outlive `io`'s run
  /// Throws BadInput with a sentence if the port is taken.
  WebServer(boost::asio::io_context& io, std::uint16_t port, PageFiles files, Talk& board, LogJob& job,
            Reports reports);
  ~WebServer();

  /// From now on also to Foxglove, at the address that it returns. @param feed  outlives `io`'s run
  auto show_signals(FoxgloveFeed& feed) -> std::string;
  [[nodiscard]] auto address() const -> std::string;

 private:
  struct Shop;
  std::shared_ptr<Shop> shop_;
};

}  // namespace capstan::tools
