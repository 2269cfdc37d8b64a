// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>

namespace capstan::tools {

/// The file contradicts itself. The message says how, without file or cure.
class McapDamaged : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The file is sound and holds what is not read here. The message says what, and what to do.
class McapForeign : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct McapChannel {
  std::uint16_t id;
  std::string topic, encoding;
};

struct McapMessage {
  const McapChannel& channel;
  std::uint64_t time_ns;
  std::string_view data;
};

/// Calls visit for every message in the order of the file, and checks lengths and checksums on the way. Indices are not
/// needed: the data section alone says everything. Returns false if the file ends before its footer.
/// Throws McapDamaged and McapForeign.
auto read_mcap(std::string_view bytes, const std::function<void(const McapMessage&)>& visit) -> bool;

}  // namespace capstan::tools
