// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <sstream>
#include <thread>

#include "capstan/firmware/safety/supervisor.hpp"
#include "capstan/tools/apply/shell_client.hpp"
#include "capstan/tools/capstan/commands.hpp"
#include "capstan/tools/flash/image_file.hpp"
#include "capstan/tools/flash/programmer.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

namespace fs = std::filesystem;

struct FlashOptions {
  std::string board;
  std::string image;
  std::string tool;
  std::string port;
  std::string boot_port;
  bool dry_run = false;
};

/// A folder for the two pieces, gone at the end.
class PieceFolder {
 public:
  PieceFolder() {
    std::string name = (fs::temp_directory_path() / "capstan_flash_XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
      throw BadInput("no temporary folder can be made; free some space, or set TMPDIR to a folder you may write to");
    }
    path_ = name;
  }
  PieceFolder(const PieceFolder&) = delete;
  auto operator=(const PieceFolder&) -> PieceFolder& = delete;
  ~PieceFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  [[nodiscard]] auto write(const std::string& name, const std::vector<std::uint8_t>& bytes) const -> std::string {
    const fs::path file = path_ / name;
    std::ofstream out(file, std::ios::binary);
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (!out.flush()) {
      throw BadInput(file.string() + " cannot be written; free some space there");
    }
    return file.string();
  }

 private:
  fs::path path_;
};

auto seal_text(std::uint32_t seal) -> std::string {
  std::array<char, 9> text{};
  std::snprintf(text.data(), text.size(), "%08x", seal);
  return text.data();
}

/// The word behind `key` in a line of words; empty if there is none.
auto word_after(const std::string& line, const std::string& key) -> std::string {
  std::istringstream words(line);
  std::string word;
  while (words >> word) {
    if (word == key) {
      words >> word;
      return words ? word : "";
    }
  }
  return "";
}

/// The line of the board's `version`; empty if no board answers.
auto version_of(const std::string& port) -> std::string {
  try {
    ShellClient shell(port);
    for (const std::string& line : shell.ask("version")) {
      if (line.starts_with("capstan ")) {
        return line;
      }
    }
  } catch (const Refusal&) {  // no answer
  }
  return "";
}

/// The board that is there now must be of the same kind, and at rest: the restart at the end takes torque away.
void check_board(const FlashOptions& options) {
  const std::string line = version_of(options.port);
  if (line.empty()) {
    std::cerr << "no Capstan firmware answers at " << options.port << " yet, as on an empty board; going on\n";
    return;
  }
  if (const std::string board = word_after(line, "board"); board != options.board) {
    throw Refusal("the board at " + options.port + " is '" + board + "' and the image is for '" + options.board +
                  "'; connect the right board, or choose its image");
  }
  ShellClient shell(options.port);
  for (const std::string& status : shell.ask("status")) {
    const auto named = std::find(kStateNames.begin(), kStateNames.end(), word_after(status, "state"));
    if (named != kStateNames.end() && energised(static_cast<State>(named - kStateNames.begin()))) {
      throw Refusal("the board at " + options.port + " has torque on; bring its joints to rest and 'disarm' first");
    }
  }
}

/// Waits for the restarted board and compares what it says with what was written.
void read_back(const FlashOptions& options, const FlashImage& image) {
  std::string line;
  for (int attempt = 0; attempt < 3 && line.empty(); ++attempt) {
    line = version_of(options.port);
  }
  if (line.empty()) {
    throw Refusal("the image was written, but nothing answers at " + options.port +
                  "; press the board's reset, check the cable of its console, then ask it for its 'version'");
  }
  if (word_after(line, "image") != seal_text(image.seal) || word_after(line, "capstan") != image.version) {
    throw Refusal("the board answers '" + line + "' but " + image.version + " image " + seal_text(image.seal) +
                  " was written; press its reset and ask for 'version', and if that says the same flash again");
  }
  std::cout << "board answers: " << line << "\n";
}

/// Beside this program, as a build or a package puts them; HEX first.
auto default_image(const std::string& board) -> std::string {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const char* folder : {"../../stm32f405/bin", "../share/capstan/firmware"}) {
    for (const char* ending : {".hex", ".elf"}) {
      const fs::path file = (program / folder / ("capstan_" + board + ending)).lexically_normal();
      if (fs::exists(file, error)) {
        return file.string();
      }
    }
  }
  throw BadInput("no image for " + board +
                 " is there; install the package capstan-firmware, build one with 'cmake --workflow --preset "
                 "stm32f405', or name a file");
}

/// Writes both pieces. Throws Refusal where that did not come to its end.
void write_image(const std::string& programmer, const std::vector<CommandLine>& commands, HeldStops& stops) {
  for (const CommandLine& command : commands) {
    const int status = stops.came(std::chrono::milliseconds(0)) ? 0 : run_program(command, stops);
    if (stops.came()) {
      throw Refusal("stopped, and " + programmer +
                    " with it; the board may hold half an image, so flash it again before it is used");
    }
    if (status != 0) {
      throw Refusal(programmer + " failed with status " + std::to_string(status) +
                    "; its messages are above. Check cable and supply (for dfu-util and stm32flash also that the board "
                    "started with BOOT0 high), then flash again: the board may hold half an image");
    }
  }
}

auto flash(const FlashOptions& options) -> int {
  if (options.board != "stm32f405") {
    throw BadInput("'" + options.board + "' is not a board that can be flashed; write stm32f405");
  }
  const std::string file = options.image.empty() ? default_image(options.board) : options.image;
  const FlashImage image = read_flash_image(file);
  if (image.board != options.board) {
    throw Refusal(file + ": the image is for '" + image.board + "', not for '" + options.board + "'; choose the other");
  }
  std::cout << file << ": " << image.board << " " << image.version << " image " << seal_text(image.seal) << ", "
            << image.sector0.size() + image.code.size() << " bytes; the parameter banks stay as they are\n";
  const std::string programmer = choose_programmer(options.tool, options.boot_port);
  if (!options.dry_run && !options.port.empty()) {
    check_board(options);
  }
  {
    HeldStops stops;  // outlives the folder
    const PieceFolder folder;
    const FlashJob job{folder.write("sector0.bin", image.sector0), folder.write("code.bin", image.code),
                       options.boot_port, image.sector0.size(), image.code.size()};
    const auto commands = programming_commands(programmer, job);
    if (options.dry_run) {
      for (const CommandLine& command : commands) {
        std::cout << joined(command, " ") << "\n";
      }
      return kExitDone;
    }
    write_image(programmer, commands, stops);
  }
  if (options.port.empty()) {
    std::cout << "written by " << programmer << ", not verified; give --port to ask the board for its version\n";
    return kExitDone;
  }
  read_back(options, image);
  return kExitDone;
}

}  // namespace

void add_flash(CLI::App& app, int& exit_status) {
  auto options = std::make_shared<FlashOptions>();
  CLI::App* command = app.add_subcommand("flash", "write an image to a board and verify that the board runs it");
  command->add_option("board", options->board, "stm32f405")->required();
  command->add_option("image", options->image,
                      "ELF, HEX or BIN; without it the one built or installed beside this program");
  command->add_option("--tool", options->tool,
                      "openocd, st-flash, dfu-util or stm32flash; without it whichever is installed");
  command->add_option("--port", options->port, "serial device of the board's shell, which is asked before and after");
  command->add_option("--boot-port", options->boot_port, "serial device of the chip's boot loader, for stm32flash");
  command->add_flag("--dry-run", options->dry_run, "only check the image and print the commands");
  command->callback([options, &exit_status] { exit_status = flash(*options); });
}

}  // namespace capstan::tools
