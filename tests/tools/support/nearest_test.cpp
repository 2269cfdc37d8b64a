// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/support/nearest.hpp"

#include <gtest/gtest.h>

namespace capstan::tools {
namespace {

const std::vector<std::string> kWords = {"diagnose", "identify", "run", "tune", "apply"};

TEST(Nearest, FindsAWordWithALetterTooManyTooFewOrAnother) {
  EXPECT_EQ(nearest("diagnos", kWords), "diagnose");
  EXPECT_EQ(nearest("diagnosse", kWords), "diagnose");
  EXPECT_EQ(nearest("identifi", kWords), "identify");
  EXPECT_EQ(nearest("rnu", {"run"}), std::nullopt) << "two of three letters";
  EXPECT_EQ(nearest("tume", kWords), "tune");
  EXPECT_EQ(nearest("tune", kWords), "tune");
}

TEST(Nearest, SaysNothingOfAWordThatIsLikeNone) {
  EXPECT_EQ(nearest("banana", kWords), std::nullopt);
  EXPECT_EQ(nearest("", kWords), std::nullopt);
  EXPECT_EQ(nearest("run", {}), std::nullopt);
}

}  // namespace
}  // namespace capstan::tools
