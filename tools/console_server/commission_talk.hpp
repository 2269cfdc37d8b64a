// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/io_context.hpp>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "capstan/tools/console_server/hub.hpp"

namespace capstan::tools {

/// What pages say to the hub, and `capstan commission` on the hub's board for the page that asked for it. The program
/// talks over a pseudo-terminal of its own and commands the board meanwhile; all pages look. It is stopped, without
/// torque, when its page stops it, leaves, loses focus or says nothing for a second, and when any page disarms.
///
/// A page says "commission start {...}", "commission answer yes|no", "commission stop"; it is told
/// "commission said LINE", "commission asks QUESTION" and at last "commission ended {"status": 0, ...}".
class CommissionTalk final : public Talk {
 public:
  /// Makes a folder for progress and report, which goes with this object. Throws std::exception. @param hub outlives it
  CommissionTalk(boost::asio::io_context& io, Hub& hub);
  ~CommissionTalk() override;

  void join(Guest& guest, Clock::time_point now) override;
  void leave(Guest& guest) override;
  void bytes(Guest& guest, std::string_view bytes) override;
  void word(Guest& guest, std::string_view word, Clock::time_point now) override;
  /// To be called several times a second.
  void look(Clock::time_point now);
  /// The last report ("commission_report") or the frequency response that it links to ("response/index.html"), pages of
  /// their own; nothing if there is none of that name.
  [[nodiscard]] auto report(std::string_view name) const -> std::optional<std::string>;

 private:
  class Job;
  std::unique_ptr<Job> job_;
  Hub& hub_;
};

}  // namespace capstan::tools
