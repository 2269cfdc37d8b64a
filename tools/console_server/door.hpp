// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace capstan::tools {

/// 128 bits of the operating system's, as 32 hexadecimal digits. Throws std::runtime_error if it has none.
auto random_token() -> std::string;

/// What a request says of where it comes from.
struct Caller {
  std::string_view host;                   ///< the header Host
  std::optional<std::string_view> origin;  ///< the header Origin, if there is one
  std::string_view target;                 ///< "/TOKEN/console.js"
};

enum class Entry : std::uint8_t {
  kComeIn,
  kForeignHost,    ///< a name that somebody else made lead here (DNS rebinding)
  kForeignOrigin,  ///< a page of somebody else's
  kNoToken,
};

/// Lets in who knows the token and comes from the page itself. Everything that is served is below the token.
class Door {
 public:
  Door(std::uint16_t port, std::string token) : port_(port), token_(std::move(token)) {}

  /// For what a page reads. A page of somebody else's that names itself is turned away here too.
  [[nodiscard]] auto for_reading(const Caller& caller) const -> Entry;
  /// For what does something, or goes on talking: the page has to name itself.
  [[nodiscard]] auto for_acting(const Caller& caller) const -> Entry;
  /// For programs that only look and have the token: they need not name themselves, or name `guest`.
  [[nodiscard]] auto for_looking(const Caller& caller, std::string_view guest) const -> Entry;

  /// What stands behind the token, without what is asked behind '?'; nothing where the token is not the first part.
  [[nodiscard]] auto behind_token(std::string_view target) const -> std::optional<std::string_view>;
  /// "http://127.0.0.1:PORT/TOKEN/"
  [[nodiscard]] auto address() const -> std::string;

 private:
  [[nodiscard]] auto own_host(std::string_view host) const -> bool;
  [[nodiscard]] auto own_origin(const Caller& caller) const -> bool;

  std::uint16_t port_;
  std::string token_;
};

/// Why somebody is not let in, with the cure.
auto sentence(Entry entry) -> std::string_view;

}  // namespace capstan::tools
