// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/console_server/door.hpp"

#include <sys/random.h>

#include <array>
#include <stdexcept>

namespace capstan::tools {
namespace {

/// Takes as long whatever differs.
auto same(std::string_view a, std::string_view b) -> bool {
  if (a.size() != b.size()) {
    return false;
  }
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  }
  return difference == 0;
}

}  // namespace

auto random_token() -> std::string {
  std::array<unsigned char, 16> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
    throw std::runtime_error("the operating system gave no random numbers; try again");
  }
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string token;
  for (const unsigned char byte : bytes) {
    token += kDigits[byte >> 4U];
    token += kDigits[byte & 15U];
  }
  return token;
}

auto Door::own_host(std::string_view host) const -> bool {
  const std::string port = ":" + std::to_string(port_);
  return host == "127.0.0.1" + port || host == "localhost" + port;
}

auto Door::own_origin(const Caller& caller) const -> bool {
  return *caller.origin == "http://" + std::string(caller.host);
}

auto Door::for_reading(const Caller& caller) const -> Entry {
  if (!own_host(caller.host)) {
    return Entry::kForeignHost;
  }
  if (caller.origin && !own_origin(caller)) {
    return Entry::kForeignOrigin;
  }
  return behind_token(caller.target) ? Entry::kComeIn : Entry::kNoToken;
}

auto Door::for_acting(const Caller& caller) const -> Entry {
  const Entry entry = for_reading(caller);
  return entry == Entry::kComeIn && !caller.origin ? Entry::kForeignOrigin : entry;
}

auto Door::for_looking(const Caller& caller, std::string_view guest) const -> Entry {
  if (caller.origin == guest) {
    return for_reading({caller.host, std::nullopt, caller.target});
  }
  return for_reading(caller);
}

auto Door::behind_token(std::string_view target) const -> std::optional<std::string_view> {
  target = target.substr(0, target.find('?'));
  const std::size_t end = 1 + token_.size();
  if (target.size() <= end || target.front() != '/' || target[end] != '/' || !same(target.substr(1, end - 1), token_)) {
    return std::nullopt;
  }
  return target.substr(end + 1);
}

auto Door::address() const -> std::string {
  return "http://127.0.0.1:" + std::to_string(port_) + "/" + token_ + "/";
}

auto sentence(Entry entry) -> std::string_view {
  switch (entry) {
    case Entry::kComeIn:
      return "";
    case Entry::kForeignHost:
      return "this console is only known as 127.0.0.1 or localhost; open the address that 'capstan console' printed\n";
    case Entry::kForeignOrigin:
      return "another page may not reach this console; open the address that 'capstan console' printed\n";
    case Entry::kNoToken:
      return "the address lacks its token; open the whole address that 'capstan console' printed\n";
  }
  return "";
}

}  // namespace capstan::tools
