// SPDX-License-Identifier: Apache-2.0
// Any text as a joint file: it is refused with a sentence, or all its numbers are finite and it reads back the same
// after it was written.
#include <cmath>
#include <cstdlib>

#include "capstan/tools/joint_file/joint_file.hpp"
#include "capstan/tools/support/errors.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace capstan::tools;
  const auto require = [](bool holds) {
    if (!holds) {
      std::abort();
    }
  };
  constexpr std::size_t kLongest = 16 * 1024;
  const std::string text(reinterpret_cast<const char*>(data), std::min(size, kLongest));
  try {
    const JointFile joint = parse_joint_file(text, "fuzz.toml");
    for (const double value : joint.parameters.coefficients) {
      require(std::isfinite(value));
    }
    const JointFile again = parse_joint_file(joint_file_text(joint), "again.toml");
    require(again.terms == joint.terms && again.parameters.coefficients == joint.parameters.coefficients);
  } catch (const BadInput& refusal) {
    require(!std::string(refusal.what()).empty());
  }
  return 0;
}
