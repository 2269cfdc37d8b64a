// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/split.hpp"

#include <gtest/gtest.h>

namespace capstan::tools {
namespace {

void expect_gaps(const Split& split, Eigen::Index gap) {
  for (std::size_t i = 1; i < split.blocks.size(); ++i) {
    const auto& before = split.blocks[i - 1];
    const auto& block = split.blocks[i];
    EXPECT_GE(block.rows.begin, before.rows.end);
    if (block.role != before.role) {
      EXPECT_GE(block.rows.begin - before.rows.end, gap);
    }
  }
}

TEST(Split, WithoutRepeatsEveryRoleHasItsShareAllAlongTheLog) {
  const Split split = split_rows({{{0, 8000}}, std::nullopt, 10});
  expect_gaps(split, 10);
  EXPECT_NEAR(static_cast<double>(rows_in(split.of(Role::kFit))), 4000.0, 500.0);
  EXPECT_NEAR(static_cast<double>(rows_in(split.of(Role::kChoose))), 1600.0, 300.0);
  EXPECT_NEAR(static_cast<double>(rows_in(split.of(Role::kReport))), 2400.0, 400.0);
  EXPECT_LT(split.of(Role::kReport).front().begin, 1000);
  EXPECT_GT(split.of(Role::kReport).back().end, 7000);
}

TEST(Split, WithRepeatsRolesGoByWholeCycles) {
  const Repeats repeats{100, 1500, 4};
  const Split split = split_rows({{{0, 6100}}, repeats, 10});
  expect_gaps(split, 10);
  for (const auto& block : split.blocks) {
    const Eigen::Index cycle = (block.rows.begin - 100) / 1500;
    EXPECT_EQ(block.role, cycle < 2 ? Role::kFit : cycle == 2 ? Role::kChoose : Role::kReport);
    EXPECT_LE(block.rows.end, 100 + (cycle + 1) * 1500);
  }
}

TEST(Split, BlocksOfRowsThatBelongToNoPieceAreLeftOut) {
  const Split split = split_rows({{{400, 6000}}, Repeats{0, 1500, 4}, 10});
  for (const auto& block : split.blocks) {
    EXPECT_GE(block.rows.begin, 400);
    EXPECT_LT(block.rows.begin, block.rows.end);
  }
  EXPECT_EQ(split.blocks.front().rows.begin, 400);
}

TEST(Split, LearnedRowsAndReportedRowsNeverMeet) {
  const Split split = split_rows({{{0, 900}, {900, 2501}}, std::nullopt, 20});
  for (const auto& learned : split.learned()) {
    for (const auto& reported : split.of(Role::kReport)) {
      EXPECT_TRUE(learned.end <= reported.begin || reported.end <= learned.begin);
    }
  }
}

TEST(Split, TheFinerGridHasTheSameRoles) {
  const Split coarse = split_rows({{{0, 1000}}, std::nullopt, 5});
  const Split fine = refined(coarse, 4);
  ASSERT_EQ(fine.blocks.size(), coarse.blocks.size());
  for (std::size_t i = 0; i < fine.blocks.size(); ++i) {
    EXPECT_EQ(fine.blocks[i].rows.begin, 4 * coarse.blocks[i].rows.begin);
    EXPECT_EQ(fine.blocks[i].rows.end, 4 * coarse.blocks[i].rows.end);
    EXPECT_EQ(fine.blocks[i].role, coarse.blocks[i].role);
  }
}

}  // namespace
}  // namespace capstan::tools
