// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/console_server/serve.hpp"

#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <csignal>

#include "capstan/tools/console_server/commission_talk.hpp"
#include "capstan/tools/console_server/lines.hpp"
#include "capstan/tools/console_server/log_job.hpp"
#include "capstan/tools/console_server/web_server.hpp"

namespace capstan::tools {
namespace {

namespace asio = boost::asio;

/// Lets all look again and again.
void keep_looking(asio::steady_timer& timer, CommissionTalk& commissioning, Hub& hub, FoxgloveFeed& feed) {
  timer.expires_after(Hub::kAliveWithin / 10);
  timer.async_wait([&](const boost::system::error_code& error) {
    if (!error) {
      commissioning.look(Hub::Clock::now());
      hub.look(Hub::Clock::now());
      feed.look(Hub::Clock::now());
      keep_looking(timer, commissioning, hub, feed);
    }
  });
}

}  // namespace

void serve_console(const ConsoleOptions& options,
                   const std::function<void(const std::string&, const std::string&)>& ready) {
  static_cast<void>(std::signal(SIGPIPE, SIG_IGN));  // a board or a page that leaves is told by the write itself
  asio::io_context io(1);
  PageFiles files = read_page_files(options.page);
  Hub hub([&](Hub::Listener listener) {
    return options.port.empty() ? open_simulated_line(io, options.scenario, std::move(listener))
                                : open_port_line(io, options.port, std::move(listener));
  });
  LogJob job(io);
  CommissionTalk commissioning(io, hub);
  WebServer server(io, options.listen, std::move(files), commissioning, job, [&](std::string_view place) {
    return place == "report" ? job.report() : commissioning.report(place);
  });
  FoxgloveFeed feed(hub);
  asio::steady_timer timer(io);
  keep_looking(timer, commissioning, hub, feed);
  asio::signal_set signals(io, SIGINT, SIGTERM);
  signals.async_wait([&](const boost::system::error_code&, int) {
    hub.close();
    io.stop();
  });
  ready(server.address(), options.foxglove ? server.show_signals(feed) : "");
  try {
    io.run();
  } catch (...) {
    hub.close();  // whatever ends the console takes torque away
    throw;
  }
}

}  // namespace capstan::tools
