// SPDX-License-Identifier: Apache-2.0
// How a table beside its print is told: differences, what explains them, and what is no explanation.
#include <gtest/gtest.h>

#include "capstan/tools/thesis/page.hpp"
#include "capstan/tools/thesis/table.hpp"

namespace capstan::tools {
namespace {

auto small_table() -> ThesisTable {
  return {"9.9",
          "a title",
          {"a condition"},
          {{"printed", "km", "KM", "deg", 2},
           {"printed", "pm", "PM", "deg", 2},
           {"simulated", "km", "KM", "deg", 2},
           {"simulated", "pm", "PM", "deg", 2},
           {"good", "km", "KM", "deg", 2},
           {"good", "pm", "PM", "deg", 2},
           {"chance", "km", "KM", "deg", 2},
           {"chance", "pm", "PM", "deg", 2}},
          {{"x", {1.0, 1.0, 1.5, 1.05, 1.08, 1.0, 1.0, 3.0}, {"pm"}}, {"y", {1.0, 1.0, 1.2, 1.0, 1.11, 1.0, 3.0, 1.0}}},
          {{"good", "A", "B", "because so."}, {"chance", "C", "B", "by chance."}}};
}

TEST(ThesisTableText, LargeDifferencesNameTheExperimentThatExplainsThemAndNoLuckyOne) {
  const ThesisTable table = small_table();
  const auto all = differences_of(table);
  ASSERT_EQ(all.size(), 4U);
  EXPECT_TRUE(all[0].large());
  EXPECT_FALSE(all[1].large());
  EXPECT_TRUE(all[1].fitted);
  ASSERT_NE(all[0].cause(), nullptr);
  EXPECT_EQ(all[0].cause()->trial->group, "good") << "`chance` is nearer here and worse over the table";
  EXPECT_NEAR(all[0].cause()->percent, 8.0, 1e-9);
  // x: KM 8 % off for 50, PM 0 for 5; y: KM just beyond 10 % for 20, PM as it was.
  EXPECT_EQ(reason_of(all[0]),
            "explained: because so. Values that it is tried on and nothing is fitted to: 3; within 10 % with this "
            "change alone 2, without it 1.");
  const std::string text = table_text(table);
  for (const char* part : {"Table 9.9  a title", "printed", "1.50", "1.05f", "a condition", "with A instead of B: 1.08",
                           "explained: because so."}) {
    EXPECT_NE(text.find(part), std::string::npos) << part;
  }
}

TEST(ThesisTableText, AChangeThatWasFittedToAValueExplainsOthersButNotThisOne) {
  ThesisTable table = small_table();
  table.trials[0].fitted = {{0, "km"}};
  const auto all = differences_of(table);
  EXPECT_EQ(all[0].cause(), nullptr);
  ASSERT_NE(all[0].fit(), nullptr);
  EXPECT_EQ(all[0].fit()->trial->group, "good");
  EXPECT_EQ(reason_of(all[0]).find("fitted: a number of this change was chosen by this value."), 0U);
  EXPECT_EQ(all[2].fit(), nullptr);
  EXPECT_EQ(reason_of(all[2]).find("in part: because so."), 0U) << "the other row is as before";
  EXPECT_EQ(all[2].nearest()->values, 2) << "what the trial is fitted to proves nothing";
  EXPECT_NE(table_text(table).find("with A instead of B: 1.08f"), std::string::npos);
  EXPECT_EQ(table_json(table)["large_differences"][0]["tested"][0]["fitted"], true);
  EXPECT_EQ(table_json(table)["large_differences"][1]["tested"][0]["fitted"], false);
  const std::string page = thesis_page({table}, {});
  // values, fitted, predicted within 10 %, explained, by a change fitted to it, in part, not.
  std::string cells;
  for (const int count : {4, 1, 1, 0, 1, 1, 0}) {
    cells += "<td class=\"n\">" + std::to_string(count) + "</td>";
  }
  EXPECT_NE(page.find(cells), std::string::npos) << page;
}

TEST(ThesisTableText, JsonAndPageHoldTheSameTable) {
  const ThesisTable table = small_table();
  const nlohmann::json json = table_json(table);
  EXPECT_EQ(json["rows"][0]["printed"]["km"], 1.0);
  EXPECT_EQ(json["units"]["km"], "deg");
  EXPECT_EQ(json["large_differences"].size(), 2U);
  EXPECT_EQ(json["large_differences"][0]["tested"][0]["with"], "A");
  Plot plot;
  plot.title = "a <picture>";
  plot.series = {{"s", "#000", Eigen::VectorXd::LinSpaced(5, 0.0, 1.0), Eigen::VectorXd::LinSpaced(5, 0.0, 2.0)}};
  const std::string page = thesis_page({table}, {{"1.1", "a figure", "a caption", {plot}}});
  for (const char* part : {"<h2>Table 9.9</h2>", "1.05 f", "because so.", "<h2>Figure 1.1</h2>", "<svg",
                           "&lt;picture&gt;", "a caption", "</html>"}) {
    EXPECT_NE(page.find(part), std::string::npos) << part;
  }
  EXPECT_EQ(page.find("src="), std::string::npos) << "self-contained";
}

}  // namespace
}  // namespace capstan::tools
