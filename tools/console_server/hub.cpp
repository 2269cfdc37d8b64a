// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/console_server/hub.hpp"

#include <algorithm>
#include <stdexcept>

namespace capstan::tools {
namespace {

constexpr std::string_view kAnew = "anew";

}  // namespace

void BoardLine::start_anew(std::string_view /*effect*/) {
  throw std::runtime_error("only a simulator of capstan console restarts; end this board's program and start it again");
}

Hub::Hub(Open open) : open_(std::move(open)) {
  open_line();
}

void Hub::open_line() {
  line_ = open_({[this](std::string_view bytes) {
                   for (Guest* guest : guests_) {
                     guest->bytes(bytes);
                   }
                   if (overhear) {
                     overhear(bytes);
                   }
                 },
                 [this](const std::string& why) { lost(why); },
                 [this] { return std::ranges::any_of(guests_, [](const Guest* guest) { return guest->behind(); }); }});
}

void Hub::everyone(std::string_view words) {
  for (Guest* guest : guests_) {
    guest->say(words);
  }
}

void Hub::lost(const std::string& why) {
  broken_ = std::move(line_);
  commander_ = nullptr;
  why_lost_ = "lost " + why;
  everyone(why_lost_);
}

void Hub::join(Guest& guest, Clock::time_point now) {
  broken_.reset();
  if (!line_) {
    try {
      open_line();
    } catch (const std::exception& problem) {
      why_lost_ = std::string("lost ") + problem.what();
    }
  }
  guests_.push_back(&guest);
  if (!line_) {
    guest.say(why_lost_);
  } else if (commander_ == nullptr) {
    command(guests_.front(), now);
  } else {
    guest.say(role_of(guest));
  }
}

void Hub::command(Guest* guest, Clock::time_point now) {
  commander_ = guest;
  attended_ = true;
  alive_ = now;
  for (Guest* one : guests_) {
    one->say(role_of(*one));
  }
}

auto Hub::role_of(const Guest& guest) const -> std::string {
  return (commands(guest) ? "command " : "look ") + std::to_string(line_->every_ms()) +
         (line_->starts_anew() ? " " + std::string(kAnew) : "");
}

void Hub::start_anew(Guest& guest, std::string_view effect, Clock::time_point now) {
  std::string why = "another page commands this board; take the command first";
  if (commands(guest)) {
    try {
      line_->start_anew(effect);
      why.clear();
      command(&guest, now);
    } catch (const std::exception& problem) {
      why = problem.what();
    }
  }
  guest.say(std::string(kAnew) + " " + why);
}

void Hub::leave(Guest& guest) {
  std::erase(guests_, &guest);
  if (commander_ != &guest) {
    return;
  }
  commander_ = nullptr;
  if (line_) {
    line_->peer_left();
    if (!guests_.empty()) {
      command(guests_.front(), Clock::now());
    }
  }
}

void Hub::bytes(Guest& guest, std::string_view bytes) {
  if (line_ && commander_ == &guest) {
    line_->send(bytes);
  }
}

void Hub::word(Guest& guest, std::string_view word, Clock::time_point now) {
  if (!line_) {
    return;
  }
  if (word == "alive" && commander_ == &guest) {
    alive_ = now;
    attended_ = true;
  } else if (word == "leave" && commander_ == &guest) {
    line_->peer_left();
  } else if (word == "disarm") {
    line_->disarm();
    if (commander_ != nullptr && commander_ != &guest) {
      commander_->say("cancel");  // the answer that it waits for may never come
      commander_->say("remark # another page took the torque away");
    }
  } else if (word.starts_with(kAnew)) {
    start_anew(guest, word.substr(std::min(word.size(), kAnew.size() + 1)), now);
  } else if (word == "take" && commander_ != &guest) {
    line_->peer_left();
    command(&guest, now);
  }
}

void Hub::look(Clock::time_point now) {
  broken_.reset();
  if (line_ && commander_ != nullptr && attended_ && now - alive_ > kAliveWithin) {
    attended_ = false;
    line_->peer_left();
    everyone("remark # no page answered for a second: the connection counts as lost, and the torque is off");
    commander_->say("cancel");
  }
}

void Hub::close() {
  if (line_) {
    line_->peer_left();
  }
  line_.reset();
  broken_.reset();
}

void Hub::send_unattended(std::string_view line) {
  if (line_ && commander_ == nullptr) {
    line_->send(line);
  }
}

}  // namespace capstan::tools
