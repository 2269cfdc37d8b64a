// SPDX-License-Identifier: Apache-2.0
// Our MCAP reader and writer as a program, for mcap_core_test.mjs: `write COMPRESSION FILE` writes 6000 rows of two
// topics, `read FILE` prints the log that capstan makes of a file.
#include <fstream>
#include <iostream>

#include "capstan/tools/log/mcap_log.hpp"
#include "capstan/tools/log/mcap_writer.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace {

using namespace capstan::tools;

void write(const std::string& compression, const std::string& path) {
  std::ofstream out(path, std::ios::binary);
  McapWriter writer(out, compression == "zstd"  ? McapCompression::kZstd
                         : compression == "lz4" ? McapCompression::kLz4
                                                : McapCompression::kNone);
  const auto motor = writer.add_channel("axis0", "motor", R"({"type":"object"})");
  const auto joint = writer.add_channel("camera", "joint", R"({"type":"object"})");
  constexpr int kRows = 6000;
  constexpr std::uint64_t kMillisecond = 1'000'000;
  for (int i = 0; i < kRows; ++i) {
    const std::uint64_t time = static_cast<std::uint64_t>(i) * kMillisecond;
    writer.add_message(motor, time, "{\"q1_rad\":" + exact(0.001 * i) + "}");
    if (i % 3 == 0) {
      writer.add_message(joint, time, "{\"angle\":" + exact(-0.5 * i) + "}");
    }
  }
  writer.finish();
}

}  // namespace

auto main(int argc, char** argv) -> int {
  const std::vector<std::string> words(argv + 1, argv + argc);
  try {
    if (words.size() == 3 && words[0] == "write") {
      write(words[1], words[2]);
      return kExitDone;
    }
    if (words.size() == 2 && words[0] == "read") {
      std::vector<std::string> warnings;
      std::cout << csv_of_mcap(read_text_file(words[1]), words[1], warnings);
      std::cerr << joined(warnings, "\n");
      return kExitDone;
    }
  } catch (const BadInput& refusal) {
    std::cerr << refusal.what() << "\n";
  }
  return kExitBadInput;
}
