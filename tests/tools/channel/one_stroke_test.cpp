// SPDX-License-Identifier: Apache-2.0
// Motions in which every stroke is like the last say nothing certain of a delay.
#include <gtest/gtest.h>

#include "capstan/tests/tools/channel/faulty_log.hpp"

namespace capstan::tools::test {
namespace {

// Drawn logs of one sine whose laws lack something in every part alike; each was said to have a late channel.
TEST(OneStroke, ACleanLogOfOneSineIsNotAccused) {
  for (const std::uint64_t seed : {104131, 104206, 104277, 104345, 104368, 104407, 104483}) {
    for (const auto& finding : judged(clean_log(seed)).findings) {
      ADD_FAILURE() << seed << ": " << finding.channel << ' ' << finding.what;
    }
  }
}

}  // namespace
}  // namespace capstan::tools::test
