// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/log/mcap_format.hpp"

#include <zlib.h>

namespace capstan::tools::mcap {

auto crc32(std::string_view bytes, std::uint32_t before) -> std::uint32_t {
  return static_cast<std::uint32_t>(::crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

auto record(Opcode opcode, const FieldWriter& fields) -> std::string {
  return FieldWriter()
      .u8(static_cast<std::uint8_t>(opcode))
      .u64(fields.fields().size())
      .bytes(fields.fields())
      .fields();
}

}  // namespace capstan::tools::mcap
