// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/console/session.hpp"

#include <algorithm>

namespace capstan {
namespace {

class SettledStream final : public ConsentStream {
 public:
  void step(Session& session) override {
    if (session.machine().requests_taken()) {
      session.ok();
    }
  }
};

}  // namespace

void PartsStream::step(Session& session) {
  const StepTime time(session.machine());
  while (print(session, next_++) && time.left()) {
  }
}

void PartsStream::cancel(Session& session) {
  session.ok();
}

void Session::ok() {
  out_ << "ok\r\n";
  refused();
}

void Session::error(const char* name, const char* sentence, const char* cure) {
  out_ << "error " << name << ": " << sentence << "; " << cure << "\r\n";
  refused();
}

void Session::refused() {
  stream_ = nullptr;
  editor_.prompt();
}

void Session::busy_cycle() {
  error("busy", "the cycle has not taken the last request yet", "send the line again");
}

void Session::answer_when_taken() {
  stream_ = nullptr;
  begin(make<SettledStream>());
}

void Session::end_beside() {
  if (beside_ != nullptr) {
    beside_->cancel(*this);
    beside_ = nullptr;
  }
}

auto Session::parse_axis(std::string_view& text, std::size_t& axis) -> bool {
  constexpr std::string_view kPrefix = "joint";
  if (text.size() <= kPrefix.size() || std::string_view(text.data(), kPrefix.size()) != kPrefix) {
    return false;
  }
  const char digit = text[kPrefix.size()];
  if (digit < '0' || digit > '9') {
    return false;
  }
  axis = static_cast<std::size_t>(digit - '0');
  text.remove_prefix(kPrefix.size() + 1);
  return axis < machine_.axes();
}

auto Session::parse_name(std::string_view text, Name& name) -> bool {
  if (!parse_axis(text, name.axis) || text.empty() || text.front() != '.') {
    return false;
  }
  text.remove_prefix(1);
  name.parameter = find_parameter(text);
  return name.parameter != nullptr;
}

auto Session::take_staging_room() -> bool {
  staged_ = machine_.staging(this);
  if (staged_.empty()) {
    error("staging", "another console is staging parameters, and nothing was changed",
          "'commit' or 'abandon' it there");
    return false;
  }
  std::copy(machine_.config().begin(), machine_.config().end(), staged_.begin());
  return true;
}

void Session::abandon() {
  staging_ = false;
  staged_ = {};
  machine_.end_staging(this);
}

}  // namespace capstan
