// SPDX-License-Identifier: Apache-2.0
// Who is let in: the page itself with its token, and nobody else.
#include "capstan/tools/console_server/door.hpp"

#include <gtest/gtest.h>

#include <set>

namespace capstan::tools {
namespace {

const Door door(8080, "0123456789abcdef0123456789abcdef");
const std::string base = "/0123456789abcdef0123456789abcdef/";

TEST(Door, LetsInThePageByBothNamesOfTheLoopback) {
  EXPECT_EQ(door.for_reading({"127.0.0.1:8080", std::nullopt, base}), Entry::kComeIn);
  EXPECT_EQ(door.for_reading({"localhost:8080", "http://localhost:8080", base + "console.js"}), Entry::kComeIn);
  EXPECT_EQ(door.for_acting({"127.0.0.1:8080", "http://127.0.0.1:8080", base + "board"}), Entry::kComeIn);
}

TEST(Door, TurnsAwayANameThatSomebodyElseMadeLeadHere) {
  for (const char* host :
       {"evil.example:8080", "127.0.0.1", "127.0.0.1:80", "127.0.0.1:8080.evil.example", "", "[::1]:8080"}) {
    EXPECT_EQ(door.for_reading({host, std::nullopt, base}), Entry::kForeignHost) << host;
    EXPECT_EQ(door.for_acting({host, "http://" + std::string(host), base}), Entry::kForeignHost) << host;
  }
}

TEST(Door, TurnsAwayPagesOfOthersAndWhoHidesHisName) {
  for (const char* origin : {"http://evil.example", "null", "", "https://127.0.0.1:8080", "http://127.0.0.1:8081",
                             "http://localhost:8080", "http://127.0.0.1:8080.evil.example"}) {
    EXPECT_EQ(door.for_acting({"127.0.0.1:8080", origin, base}), Entry::kForeignOrigin) << origin;
    EXPECT_EQ(door.for_reading({"127.0.0.1:8080", origin, base}), Entry::kForeignOrigin) << origin;
  }
  EXPECT_EQ(door.for_acting({"127.0.0.1:8080", std::nullopt, base}), Entry::kForeignOrigin);
}

TEST(Door, TurnsAwayWhoLacksTheToken) {
  for (const char* target : {"/", "", "/console.js", "/0123456789abcdef0123456789abcdef",
                             "/0123456789abcdef0123456789abcdee/", "//0123456789abcdef0123456789abcdef/",
                             "/0123456789ABCDEF0123456789abcdef/", "/?0123456789abcdef0123456789abcdef/"}) {
    EXPECT_EQ(door.for_reading({"127.0.0.1:8080", std::nullopt, target}), Entry::kNoToken) << target;
  }
}

TEST(Door, AProgramThatLooksNeedsTheTokenButNoName) {
  const std::string guest = "https://app.example";
  EXPECT_EQ(door.for_looking({"127.0.0.1:8080", std::nullopt, base}, guest), Entry::kComeIn);
  EXPECT_EQ(door.for_looking({"127.0.0.1:8080", guest, base}, guest), Entry::kComeIn);
  EXPECT_EQ(door.for_looking({"127.0.0.1:8080", guest, "/"}, guest), Entry::kNoToken);
  EXPECT_EQ(door.for_looking({"127.0.0.1:8080", "https://evil.example", base}, guest), Entry::kForeignOrigin);
  EXPECT_EQ(door.for_looking({"evil.example:8080", guest, base}, guest), Entry::kForeignHost);
}

TEST(Door, WhatIsBehindTheTokenIsReadWithoutItsQuestion) {
  EXPECT_EQ(door.behind_token(base + "console.js?x=1"), "console.js");
  EXPECT_EQ(door.behind_token(base), "");
  EXPECT_EQ(door.address(), "http://127.0.0.1:8080" + base);
}

TEST(Door, TokensAreLongAndNeverTheSame) {
  std::set<std::string> tokens;
  for (int i = 0; i < 1000; ++i) {
    tokens.insert(random_token());
  }
  EXPECT_EQ(tokens.size(), 1000U);
  for (const std::string& token : tokens) {
    EXPECT_EQ(token.size(), 32U);
    EXPECT_EQ(token.find_first_not_of("0123456789abcdef"), std::string::npos);
  }
}

}  // namespace
}  // namespace capstan::tools
