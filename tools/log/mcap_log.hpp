// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace capstan::tools {

/// Whether the bytes begin as an MCAP file does.
auto is_mcap(std::string_view bytes) -> bool;

/// The JSON messages of an MCAP file as a log by the contract. Each number of a message is a column "topic/field" (a
/// member of an object "topic/object/field", of an array "topic/array[0]"), and has the contract's name alone where the
/// rest of the path is that. time_s is the message's log time, since the first one unless it starts near zero. Messages
/// of one log time share a row; topics of other rates leave cells empty.
/// A file that was cut off is read as far as it goes, with a warning. Throws BadInput: damaged, or nothing in JSON.
auto csv_of_mcap(std::string_view bytes, const std::string& name, std::vector<std::string>& warnings) -> std::string;

}  // namespace capstan::tools
