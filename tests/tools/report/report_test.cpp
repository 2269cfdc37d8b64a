// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/report/report.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "capstan/tests/tools/synthetic_joint.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

class Report : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              ("capstan_report_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::remove_all(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  auto page_of(test::Truth truth) -> std::string {
    test::SyntheticRequest request;
    request.truth = truth;
    request.rate_hz = 100.0;
    request.cycle_s = 25.0;
    return read_text_file(write_report(folder_.string(), diagnose({test::synthetic_log(request)}, {})));
  }
  auto exists(const std::string& name) const -> bool { return std::filesystem::exists(folder_ / name); }

  std::filesystem::path folder_;
};

TEST_F(Report, IsOnePageThatNeedsNoNetworkWithPicturesBeforeAndAfter) {
  const std::string page = page_of(test::Truth::kPlay);
  for (const char* name :
       {"index.html", "loop_before.svg", "loop_after.svg", "residual_before.svg", "residual_after.svg"}) {
    EXPECT_TRUE(exists(name)) << name;
  }
  std::string without_namespace = page;
  for (std::size_t at = 0; (at = without_namespace.find("http://www.w3.org/2000/svg", at)) != std::string::npos;) {
    without_namespace.erase(at, 26);
  }
  for (const char* outside : {"http://", "https://", "<script", "<link", "<img", "@import", "url("}) {
    EXPECT_EQ(without_namespace.find(outside), std::string::npos) << outside;
  }
  for (const char* part : {"play", "before", "after", "half_width", "rad", "Loop before", "Residual after", "ruled out",
                           "What would change the verdict", "95 % interval"}) {
    EXPECT_NE(page.find(part), std::string::npos) << part;
  }
}

TEST_F(Report, OfAnUnknownEffectShowsTheRankingAndWhatTheLawDoes) {
  const std::string page = page_of(test::Truth::kStickySpot);
  EXPECT_NE(page.find("<b>unknown</b>"), std::string::npos);
  EXPECT_TRUE(exists("map_angle.svg"));
  EXPECT_TRUE(exists("map_time_since_reversal.svg"));
  EXPECT_NE(page.find("What the base law leaves depends on"), std::string::npos);
  EXPECT_NE(page.find("Where the residual lies"), std::string::npos);
  EXPECT_TRUE(exists("residual_before.svg"));
  EXPECT_TRUE(exists("residual_after.svg"));
}

TEST_F(Report, OfAnUnfitLogSaysWhatToRecord) {
  Diagnosis d;
  d.reason = "The log is not fit for a diagnosis: too <short>.";
  d.next_experiment = "record more";
  const std::string page = read_text_file(write_report(folder_.string(), d));
  EXPECT_NE(page.find("data_unfit"), std::string::npos);
  EXPECT_NE(page.find("too &lt;short&gt;"), std::string::npos);
  EXPECT_NE(page.find("record more"), std::string::npos);
}

TEST_F(Report, AFolderThatCanNotBeMadeIsBadInput) {
  write_text_file(folder_.string(), "a file is in the way");
  EXPECT_THROW(write_report(folder_.string(), Diagnosis{}), BadInput);
}

}  // namespace
}  // namespace capstan::tools
