// SPDX-License-Identifier: Apache-2.0
// Palpation from the firmware's command to the map: the board presses, its log goes through the host's command.
#include "capstan/tools/identify/palpation_log.hpp"
#include "capstan/tools/report/palpation_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "capstan/boards/common/file_banks.hpp"
#include "capstan/boards/sim/sim_board.hpp"
#include "capstan/tests/tools/run/by_hand.hpp"
#include "capstan/tools/apply/force_lines.hpp"
#include "capstan/tools/identify/force_section.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

class StringSink final : public TextSink {
 public:
  std::string text;

 private:
  void do_write(std::string_view more) override { text.append(more); }
};

auto plant_on(double stiffness) -> sim::PlantParameters {
  sim::PlantParameters plant;
  plant.pretension_n = 27.6984;
  plant.environment = {.kind = sim::EnvironmentKind::kSpring, .stiffness = stiffness};
  return plant;
}

/// What the board answers to the lines, without its "ok"s.
auto log_of(const sim::PlantParameters& plant, const std::vector<std::string>& lines) -> std::string {
  sim::Scenario scenario;
  scenario.plant = plant;
  FileBanks banks = FileBanks::temporary();
  StringSink sink;
  SimBoard board(scenario, banks, sink, false);
  board.tick();
  for (const std::string& line : lines) {
    sink.text.clear();
    for (const char c : line + "\n") {
      board.shell().receive(c);
    }
    const int rests = line.starts_with("move") ? 3000 : 0;  // until it stands
    for (int i = 0; i < 200'000 && (i < rests || board.shell().busy()); ++i) {
      board.tick();
      board.shell().poll();
    }
    EXPECT_TRUE(sink.text.ends_with("ok\r\n"))
        << line << ": " << sink.text.substr(sink.text.size() > 300 ? sink.text.size() - 300 : 0);
  }
  std::string log = sink.text.substr(0, sink.text.size() - 4);
  std::erase(log, '\r');
  return log;
}

auto nameplate(const sim::PlantParameters& plant) -> std::vector<std::string> {
  return {"set joint0.motor.encoder_counts " + std::to_string(std::lround(plant.encoder_counts_per_turn)),
          "set joint0.motor.torque_per_current " + std::to_string(plant.torque_constant_nm_per_a)};
}

auto map_of(const std::string& text, const TensionStateParameters<double>& parameters) -> std::vector<MapRow> {
  const CsvLog log = CsvLog::parse(text, "board");
  return map_sites(sites_of(log, 0.0), {read_palpation_log(log, 0), parameters});
}

auto parameters_of_the_instrument() -> TensionStateParameters<double> {
  sim::PlantParameters locked = plant_on(0.0);
  locked.environment = {.kind = sim::EnvironmentKind::kLocked};
  return tension_state_of(fit_pull_push({test::turn_by_hand(locked, 60.0, test::triangle(0.25, 0.05))}));
}

TEST(PalpationLog, TheBoardsTorqueTrianglesGiveTheStiffnessThatTheTipTouched) {
  const auto parameters = parameters_of_the_instrument();
  for (const double stiffness : {0.05, 0.2}) {
    const sim::PlantParameters plant = plant_on(stiffness);
    auto lines = nameplate(plant);
    lines.insert(lines.end(), {"arm", "palpate joint0 site=4 amplitude=0.15 rates=0.05 cycles=2 every=10"});
    const auto rows = map_of(log_of(plant, lines), parameters);
    ASSERT_EQ(rows.size(), 1U);
    EXPECT_EQ(rows[0].site, 4);
    ASSERT_TRUE(rows[0].stiffness.combined.has_value());
    std::printf("K_env %.3f N m/rad: %.4f +- %.4f\n", stiffness, rows[0].stiffness.combined->value,
                rows[0].stiffness.combined->half_interval);
    EXPECT_NEAR(rows[0].stiffness.combined->value, stiffness, 0.1 * stiffness);
  }
}

// What tissue does: it holds one way only, so triangles of torque have to stay on the side on which the tip presses.
// The lower end is below zero because the tendons' friction holds the tip in long after the motor has let go.
TEST(PalpationLog, TheBoardTellsTheStiffnessOfTissueThatHoldsOneWayOnly) {
  sim::PlantParameters locked = plant_on(0.0);
  locked.environment = {.kind = sim::EnvironmentKind::kLocked};
  const PullPushFit fit = fit_pull_push({test::turn_by_hand(locked, 60.0, test::triangle(0.25, 0.05))});
  const std::vector<std::string> law = force_lines(with_force_section("", force_section(fit)), "joint.toml", 0);
  for (const double deep : {0.06, 0.1, 0.2}) {
    sim::PlantParameters plant = plant_on(0.0);
    plant.environment = {.kind = sim::EnvironmentKind::kLayered,
                         .stiffness = 0.03,
                         .damping = 0.05,
                         .angle_rad = 0.05,
                         .layer_depth_rad = 0.08,
                         .deep_stiffness = deep};
    auto lines = nameplate(plant);
    lines.insert(lines.end(), law.begin(), law.end());
    lines.insert(lines.end(), {"arm", "move joint0 0.25",
                               "palpate joint0 site=2 offset=0.04Nm amplitude=0.11Nm rates=0.05 cycles=2 every=10"});
    const std::string log = log_of(plant, lines);
    const auto line = log.find("# site 2 stiffness ");
    ASSERT_NE(line, std::string::npos) << deep << ": " << log.substr(log.size() > 300 ? log.size() - 300 : 0);
    double value = 0.0;
    double half = 0.0;
    ASSERT_EQ(std::sscanf(log.c_str() + line, "# site 2 stiffness %lf +- %lf", &value, &half), 2);
    const auto rows = map_of(log, tension_state_of(fit));
    ASSERT_TRUE(rows.at(0).stiffness.combined.has_value());
    const Stiffness& host = *rows[0].stiffness.combined;
    std::printf("deep %.3f N m/rad: board %.4f +- %.4f, host %.4f +- %.4f\n", deep, value, half, host.value,
                host.half_interval);
    EXPECT_NEAR(value, deep, std::max(half, 0.03 * deep));
    EXPECT_LT(half, 0.03 * deep);
    EXPECT_NEAR(host.value, deep, 0.1 * deep) << "from every tenth row alone, with its noise";
  }
}

TEST(PalpationLog, SitesComeFromTheirColumnOrFromThePeriod) {
  std::string text = "time_s,site,axis0/q1_rad,axis0/tau_Nm\n";
  for (int i = 0; i < 300; ++i) {
    text += std::to_string(0.01 * i) + "," + std::to_string(i < 100 ? 3 : 8) + ",0.1," + std::to_string(i % 7) + "\n";
  }
  const auto sites = sites_of(CsvLog::parse(text, "two"), 0.0);
  ASSERT_EQ(sites.size(), 2U);
  EXPECT_EQ(sites[0].number, 3);
  EXPECT_EQ(sites[1].number, 8);
  EXPECT_NEAR(sites[0].span.end_s, 1.0, 1e-9);
  EXPECT_NEAR(sites[1].span.begin_s, 1.0, 1e-9);
  std::string plain = "time_s,axis0/q1_rad,axis0/tau_Nm\n";
  for (int i = 0; i < 300; ++i) {
    plain += std::to_string(0.01 * i) + ",0.1," + std::to_string(i % 7) + "\n";
  }
  EXPECT_EQ(sites_of(CsvLog::parse(plain, "three"), 1.0).size(), 3U);
  EXPECT_EQ(sites_of(CsvLog::parse(plain, "one"), 0.0).size(), 1U);
  EXPECT_THROW(static_cast<void>(sites_of(CsvLog::parse("time_s,site\n0,1.5\n", "half"), 0.0)), BadInput);
}

TEST(PalpationLog, ALogInWhichNothingWasPressedIsRefused) {
  std::string text = "time_s,axis0/q1_rad,axis0/tau_Nm\n";
  for (int i = 0; i < 300; ++i) {
    text += std::to_string(0.01 * i) + ",0.1,0.2\n";
  }
  EXPECT_THROW(static_cast<void>(read_palpation_log(CsvLog::parse(text, "still"), 0)), BadInput);
  EXPECT_THROW(static_cast<void>(read_palpation_log(CsvLog::parse("time_s,axis0/q1_rad\n0,1\n1,2\n", "x"), 0)),
               BadInput);
}

TEST(PalpationLog, AChannelThatCanNotBeWhatItClaimsIsNamedAndEverySiteKeepsItsRows) {
  AxisLog pressed = test::turn_by_hand(plant_on(0.2), 30.0, test::triangle(0.25, 0.05));
  EXPECT_TRUE(read_palpation_log(CsvLog::parse(test::csv_of(pressed), "log.csv"), 0).warnings.empty());
  AxisLog held = pressed;
  test::make_wild(pressed.tau_nm);
  test::hold(held.tau_nm);
  for (const auto& [log, words] : {std::pair{&pressed, "axis0/tau_Nm stands out from both neighbours"},
                                   std::pair{&held, "axis0/tau_Nm has a new value only every 10"}}) {
    const AxisLog read = read_palpation_log(CsvLog::parse(test::csv_of(*log), "log.csv"), 0);
    EXPECT_NE(joined(read.warnings).find(words), std::string::npos) << joined(read.warnings);
    EXPECT_EQ(read.samples(), log->samples());
  }
}

TEST(PalpationLog, TheMapShowsValuesIntervalsAndWhatStandsOut) {
  std::vector<MapRow> rows;
  for (const double value : {0.05, 0.06, 0.15, 0.05}) {
    SiteStiffness site;
    site.combined = Stiffness{value, 0.002};
    rows.push_back({"log", static_cast<int>(rows.size()) + 1, site});
  }
  rows.push_back({"log", 5, {}});
  const std::string text = map_text(rows);
  EXPECT_NE(text.find("*    3   0.1500 +- 0.0020"), std::string::npos) << text;
  EXPECT_NE(text.find("     1   0.0500 +- 0.0020"), std::string::npos) << text;
  EXPECT_NE(map_text(rows, 2.4).find("*    3"), std::string::npos) << "0.148 is more than 2.4 times 0.06";
  EXPECT_EQ(map_text(rows, 2.5).find('*'), std::string::npos) << "the whole interval counts";
  EXPECT_NE(text.find("not pressed far enough"), std::string::npos) << text;
  EXPECT_EQ(map_csv(rows).substr(0, map_csv(rows).find('\n')), "site,stiffness_Nm_per_rad,ci95_half_Nm_per_rad");
  EXPECT_TRUE(map_csv(rows).ends_with("5,,\n"));
}

TEST(PalpationLog, ThePictureOfTheMapHasABarForEachSiteAndMarksWhatStandsOut) {
  std::vector<MapRow> rows;
  for (const double value : {0.05, 0.06, 0.15, 0.05, 0.055}) {
    SiteStiffness site;
    site.combined = Stiffness{value, 0.002};
    rows.push_back({"log", 2 * static_cast<int>(rows.size()) + 1, site});
  }
  rows.push_back({"log", 11, {}});
  Plot plot = palpation_map(rows);
  ASSERT_EQ(plot.series.size(), 6U) << "five bars, and the limit; nothing where nothing was felt";
  EXPECT_NEAR(plot.series[1].x.mean(), 3.0, 0.1) << "by the sites' numbers";
  EXPECT_EQ(plot.series[0].y.minCoeff(), 0.0);
  EXPECT_NEAR(plot.series[0].y.maxCoeff(), 0.052, 1e-12);
  EXPECT_EQ(plot.series[0].colour, plot.series[3].colour);
  EXPECT_NE(plot.series[0].colour, plot.series[2].colour);
  EXPECT_EQ(plot.series[2].label, "stiffer than the rest");
  EXPECT_NEAR(plot.series[5].y[0], 1.2 * 0.055, 1e-12);
  const Plot by_more = palpation_map(rows, 3.0);
  EXPECT_NEAR(by_more.series[5].y[0], 3.0 * 0.055, 1e-12);
  EXPECT_EQ(by_more.series[5].label, "3 times the median");
  EXPECT_EQ(by_more.series[2].colour, by_more.series[0].colour) << "0.15 is less than three times 0.055";
  EXPECT_NE(svg_of(plot).find("<svg"), std::string::npos);
  rows[1].site = 1;
  plot = palpation_map(rows);
  EXPECT_NEAR(plot.series[1].x.mean(), 2.0, 0.1) << "numbers repeat: by order";
  EXPECT_TRUE(palpation_map({}).series.empty());
}

TEST(PalpationLog, TheForceSectionReadsBackAndWhatIsMissingIsSaid) {
  sim::PlantParameters locked = plant_on(0.0);
  locked.environment = {.kind = sim::EnvironmentKind::kLocked};
  const PullPushFit fit = fit_pull_push({test::turn_by_hand(locked, 60.0, test::triangle(0.25, 0.05))});
  const std::string text = with_force_section("", force_section(fit));
  const auto wanted = tension_state_of(fit);
  const auto read = tension_state_of(read_pull_push(text, "joint.toml"));
  EXPECT_EQ(read.eta_top, wanted.eta_top);
  EXPECT_EQ(read.eta_bottom, wanted.eta_bottom);
  EXPECT_EQ(read.pretension_nm, wanted.pretension_nm);
  EXPECT_EQ(read.compliance_top, wanted.compliance_top);
  EXPECT_EQ(read.compliance_bottom, wanted.compliance_bottom);
  EXPECT_EQ(read.beta, wanted.beta);
  EXPECT_EQ(read.friction_nm, wanted.friction_nm);
  for (const std::string& bad :
       {std::string("schema = \"capstan.joint/1\"\n"), std::string("[force]\nmodel = \"preisach\"\n"),
        std::string("[force]\nmodel = \"pull_push\"\neta_top = 1\n"), std::string("[force\n")}) {
    EXPECT_THROW(static_cast<void>(read_pull_push(bad, "joint.toml")), BadInput) << bad;
  }
}

}  // namespace
}  // namespace capstan::tools
