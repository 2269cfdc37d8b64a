// SPDX-License-Identifier: Apache-2.0
// Prints docs/reference.md from the tables that the programs themselves work with. tools/reference puts it there.
#include <iostream>
#include <set>
#include <sstream>
#include <string>

#include "capstan/boards/stm32f405/can_protocol.hpp"
#include "capstan/firmware/console/shell_commands.hpp"
#include "capstan/firmware/parameters/parameter_text.hpp"
#include "capstan/firmware/safety/faults.hpp"
#include "capstan/firmware/safety/warnings.hpp"
#include "capstan/firmware/telemetry/signals.hpp"
#include "capstan/tests/docs/json_text.hpp"
#include "capstan/tests/firmware/support.hpp"
#include "capstan/tools/dbc/dbc.hpp"
#include "capstan/tools/identify/term_catalogue.hpp"

namespace capstan {
namespace {

/// For a cell of a table: a bar would end it.
auto cell(std::string_view text) -> std::string {
  std::string result;
  for (const char c : text) {
    result += c == '|' ? std::string("\\|") : std::string(1, c);
  }
  return result;
}

auto unit_of(std::string_view unit) -> std::string {
  return unit == "1" ? std::string() : std::string(unit);
}

void heading(const char* title, const char* text) {
  std::cout << "\n## " << title << "\n\n" << text << "\n";
}

void print_commands() {
  heading("Shell", "At the board's prompt; `help` prints the same.");
  std::cout << "\n| command | what it does |\n|---|---|\n";
  for (const ShellCommand& command : shell_commands()) {
    std::cout << "| `" << command.name << "`";
    if (command.arguments[0] != '\0') {
      std::cout << " `" << cell(command.arguments) << '`';
    }
    std::cout << " | " << cell(command.help) << " |\n";
  }
}

auto change_word(ParameterChange change) -> const char* {
  switch (change) {
    case ParameterChange::kAnyTime:
      return "any time";
    case ParameterChange::kDisarmed:
      return "disarmed";
    case ParameterChange::kMaintenance:
      return "in maintenance";
  }
  return "";
}

/// Of names that differ by a number at their ends, the first stands for all.
class FirstOfMany {
 public:
  auto is_next(const std::string& name) -> bool {
    const std::size_t end = name.find_last_not_of("0123456789") + 1;
    return end < name.size() && !stems_.insert(name.substr(0, end)).second;
  }

 private:
  std::set<std::string> stems_;
};

void print_parameters() {
  heading(
      "Parameters",
      "Of each joint, as `joint0.motor.encoder_counts`. Of parameters that differ by a number at their end the first "
      "stands for all.\nIn maintenance: without torque, and over the shell after `maintenance open`.");
  std::cout << "\n| parameter | default | range | changes | meaning |\n|---|---|---|---|---|\n";
  const AxisConfig defaults;
  FirstOfMany many;
  for (const ParameterInfo& parameter : parameters()) {
    if (many.is_next(std::string(parameter.group) + '.' + parameter.name)) {
      continue;
    }
    test::StringSink value;
    test::StringSink range;
    Print to_value(value);
    Print to_range(range);
    print_value(to_value, parameter, raw_value(defaults, parameter));
    print_range(to_range, parameter);
    std::cout << "| `" << parameter.group << '.' << parameter.name << "` | " << value.text() << " | " << range.text()
              << " | " << change_word(parameter.change) << " | " << cell(parameter.doc) << " |\n";
  }
}

void print_signals() {
  heading("Signals", "For `watch`, `scope`, `frames` and `capstan record`.");
  std::cout << "\n| signal | unit | column of a log | meaning |\n|---|---|---|---|\n";
  for (const SignalInfo& signal : joint_signals()) {
    std::cout << "| `jointN." << signal.name << "` | " << unit_of(signal.unit) << " | `axisN/" << signal.column
              << "` | " << cell(signal.doc) << " |\n";
  }
  for (const SignalInfo& signal : machine_signals()) {
    std::cout << "| `machine." << signal.name << "` | " << unit_of(signal.unit) << " | `" << signal.column << "` | "
              << cell(signal.doc) << " |\n";
  }
}

template <typename Table>
void print_causes(const Table& table) {
  std::cout << "\n| name | cause | cure |\n|---|---|---|\n";
  for (const auto& row : table) {
    std::cout << "| `" << row.name << "` | " << cell(row.cause) << " | " << cell(row.cure) << " |\n";
  }
}

void print_faults() {
  heading("Faults",
          "What takes the torque away. The first one is kept until `disarm`. A fault's number is its row, from 0.");
  print_causes(kFaultTable);
  heading("Warnings", "Conditions to look at; none of them stops anything.");
  print_causes(kWarningTable);
}

/// The lines of the DBC file that say what is in a frame: "BO_ 385 name: 8 sender", " SG_ name : 0|32@1- (f,o) [..]
/// ...".
void print_frames() {
  heading("CAN of the motor board",
          "Frames of node 1 with one axis, from `capstan dbc`, which writes them for other programs. Bits from the "
          "least, numbers little-endian.");
  std::cout
      << "\n| frame | identifier | signal | first bit | bits | one step is | unit |\n|---|---|---|---|---|---|---|\n";
  std::istringstream lines(tools::dbc_text({.nodes = {1}, .axes = 1, .version = {}}));
  std::string frame;
  std::string identifier;
  FirstOfMany many;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string kind;
    std::string name;
    words >> kind;
    if (kind == "BO_") {
      words >> identifier >> frame;
      frame.pop_back();
    } else if (kind == "SG_") {
      std::string place;
      std::string scale;
      std::string unit;
      words >> name;
      if (many.is_next(frame + '.' + name)) {
        continue;
      }
      words.ignore(line.size(), ':');
      words >> place >> scale;
      unit = line.substr(line.find('"') + 1);
      unit.resize(unit.find('"'));
      std::cout << "| `" << frame << "` | " << identifier << " | `" << name << "` | "
                << place.substr(0, place.find('|')) << " | "
                << place.substr(place.find('|') + 1, place.find('@') - place.find('|') - 1) << " | "
                << scale.substr(1, scale.find(',') - 1) << " | " << unit << " |\n";
    }
  }
  std::cout << "\nWhat can go wrong there; the board's prompt prints each that was seen.\n";
  print_causes(stm32f405::kCanTroubles);
}

void print_terms(const char* title, const char* text, const tools::Catalogue& catalogue) {
  heading(title, text);
  std::cout
      << "\n| effect | what it adds | coefficients | nonlinear parameters | confusable with |\n|---|---|---|---|---|\n";
  for (const tools::CatalogueTerm& term : catalogue) {
    std::cout << "| `" << term.name << "` | " << cell(term.equation) << " | ";
    FirstOfMany many;
    for (const auto& coefficient : term.coefficients) {
      if (!many.is_next(coefficient.name)) {
        std::cout << '`' << coefficient.name << "` " << unit_of(coefficient.unit) << "<br>";
      }
    }
    std::cout << " | ";
    for (const auto& shape : term.shapes) {
      if (!many.is_next(shape.name)) {
        std::cout << '`' << shape.name << "` " << shape.minimum << " to " << shape.maximum << ' ' << unit_of(shape.unit)
                  << "<br>";
      }
    }
    std::cout << " | " << cell(term.confusable_with) << " |\n";
  }
}

void print_json() {
  heading("JSON",
          "What the tools write for programs. The schemas are in `docs/schema/` and, installed, in "
          "`share/capstan/schema`; a test holds what the tools write against them.");
  for (const char* name : {"diagnosis", "comparison", "routing", "thesis"}) {
    std::cout << json_table(std::string(CAPSTAN_SOURCE_DIR "/docs/schema/") + name + ".schema.json");
  }
}

void print_reference() {
  std::cout
      << "# Reference\n\nMade by `tools/reference --write` from the tables that the programs work with, and compared "
         "with them by a test.\n";
  print_commands();
  print_parameters();
  print_signals();
  print_faults();
  print_frames();
  print_terms("Effects of a joint's angle",
              "Sections `[name]` of `joint.toml`, with coefficients and nonlinear parameters under these names, and "
              "groups of parameters "
              "on a board.",
              tools::term_catalogue());
  print_terms(
      "Effects of a driven axis's effort",
      "Of a rotary axis; a linear one has N and m for Nm and rad. Sections of the file that `diagnose -o` writes "
      "of an effort.",
      tools::effort_catalogue(tools::AxisKind::kRotary));
  print_json();
}

}  // namespace
}  // namespace capstan

auto main() -> int {
  capstan::print_reference();
  return 0;
}
