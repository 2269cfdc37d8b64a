// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/dbc/dbc.hpp"

#include "capstan/boards/stm32f405/can_messages.hpp"
#include "capstan/firmware/control/modes.hpp"
#include "capstan/firmware/safety/faults.hpp"
#include "capstan/firmware/safety/supervisor.hpp"
#include "capstan/firmware/safety/warnings.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

using namespace stm32f405;

struct Named {
  unsigned number;
  std::string name;
  std::string comment;
};

/// The bits of a field that is a set, by number; none for every other field.
auto flags_of(CanMeaning meaning) -> std::vector<Named> {
  std::vector<Named> flags;
  if (meaning == CanMeaning::kFaultFlags) {
    for (std::size_t i = 1; i < kFaultTable.size(); ++i) {
      flags.push_back({static_cast<unsigned>(i), kFaultTable[i].name, kFaultTable[i].cause});
    }
  } else if (meaning == CanMeaning::kWarningFlags) {
    for (std::size_t i = 0; i < kWarningTable.size(); ++i) {
      flags.push_back({static_cast<unsigned>(i), kWarningTable[i].name, kWarningTable[i].cause});
    }
  } else if (meaning == CanMeaning::kLimitFlags) {
    for (std::size_t i = 0; i < kLimitTable.size(); ++i) {
      flags.push_back({static_cast<unsigned>(i), kLimitTable[i].name, "this limit was met"});
    }
  }
  return flags;
}

/// The words for the numbers of a field; none for a plain number.
auto words_of(CanMeaning meaning) -> std::vector<Named> {
  std::vector<Named> words;
  if (meaning == CanMeaning::kState) {
    for (std::size_t i = 0; i < kStateNames.size(); ++i) {
      words.push_back({static_cast<unsigned>(i), kStateNames[i], ""});
    }
  } else if (meaning == CanMeaning::kFault) {
    for (const FaultInfo& fault : kFaultTable) {
      words.push_back({static_cast<unsigned>(fault.code), fault.name, ""});
    }
  } else if (meaning == CanMeaning::kSetpointKind) {
    words.push_back({kFollowAngle, "joint_angle", ""});
  }
  return words;
}

/// Comments and words stand behind all frames in a DBC file, so the three are gathered side by side.
struct Sections {
  std::string frames, comments, periods, words;
};

void add_signal(const CanField& field, const std::string& id, const std::string& receiver, Sections& to) {
  const auto add = [&](const std::string& name, unsigned first_bit, unsigned bits, const std::string& comment) {
    to.frames += " SG_ " + name + " : " + std::to_string(first_bit) + "|" + std::to_string(bits) + "@1" +
                 (field.has_sign ? "-" : "+") + " (" + exact(1.0 / field.parts) + ",0) ";
    const double steps = static_cast<double>(std::uint64_t{1} << (bits - (field.has_sign ? 1U : 0U)));
    to.frames += "[" + exact(field.has_sign ? -steps / field.parts : 0.0) + "|" + exact((steps - 1) / field.parts) +
                 "] \"" + field.unit + "\" " + receiver + "\n";
    to.comments += "CM_ SG_ " + id + " " + name + " \"" + comment + "\";\n";
  };
  const auto flags = flags_of(field.meaning);
  for (const Named& flag : flags) {
    add(std::string(field.name) + "_" + flag.name, field.first_bit + flag.number, 1, flag.comment);
  }
  if (flags.empty()) {
    add(field.name, field.first_bit, field.bits, field.comment);
  }
  if (const auto words = words_of(field.meaning); !words.empty()) {
    to.words += "VAL_ " + id + " " + field.name;
    for (const Named& word : words) {
      to.words += " " + std::to_string(word.number) + " \"" + word.name + "\"";
    }
    to.words += " ;\n";
  }
}

void add_message(const CanMessage& message, std::uint8_t node, std::size_t axis, Sections& to) {
  const std::string board = "capstan" + std::to_string(node);
  const std::string id = std::to_string(identifier(message, node, axis));
  to.frames += "BO_ " + id + " " + board + "_" + message.name +
               (message.of_each_axis ? "_axis" + std::to_string(axis) : "") + ": 8 " +
               (message.from_board ? board : "host") + "\n";
  to.comments += "CM_ BO_ " + id + " \"" + message.comment + "\";\n";
  if (message.period_ms > 0) {
    to.periods += "BA_ \"GenMsgCycleTime\" BO_ " + id + " " + std::to_string(message.period_ms) + ";\n";
  }
  for (const CanField* field : message.fields) {
    add_signal(*field, id, message.from_board ? "host" : board, to);
  }
  to.frames += "\n";
}

}  // namespace

auto dbc_text(const DbcRequest& request) -> std::string {
  std::string boards;
  Sections sections;
  for (const std::uint8_t node : request.nodes) {
    boards += " capstan" + std::to_string(node);
    for (const CanMessage* message : kCanMessages) {
      for (std::size_t axis = 0; axis < (message->of_each_axis ? request.axes : 1); ++axis) {
        add_message(*message, node, axis, sections);
      }
    }
  }
  return "VERSION \"capstan " + request.version + "\"\n\nNS_ :\n\nBS_:\n\nBU_: host" + boards + "\n\n" +
         sections.frames + sections.comments +
         "BA_DEF_ BO_ \"GenMsgCycleTime\" INT 0 65535;\nBA_DEF_DEF_ \"GenMsgCycleTime\" 0;\n" + sections.periods +
         sections.words;
}

}  // namespace capstan::tools
