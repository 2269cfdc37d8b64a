// SPDX-License-Identifier: Apache-2.0
// What the diagnosis makes of measured machines, beside plain fits on the same rows: see tools/machine_benchmark.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <limits>
#include <map>
#include <optional>
#include <span>

#include "capstan/tests/tools/machines/board_efforts.hpp"
#include "capstan/tests/tools/machines/drawn_machines.hpp"
#include "capstan/tests/tools/machines/machine_joint.hpp"
#include "capstan/tests/tools/machines/recorded_otherwise.hpp"
#include "capstan/tools/diagnose/free_run.hpp"
#include "capstan/tools/diagnose/preparation.hpp"
#include "capstan/tools/select/choice.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools::machines {
namespace {

constexpr const char* kKindWords[] = {"angle", "effort", "torque"};

/// The scoreboard: one line per joint. True if it meets what is wanted.
auto scoreboard(const std::vector<Joint>& joints, double share) -> bool {
  std::vector<double> ratios;
  int improvable = 0;
  int improved = 0;
  int wrong = 0;
  for (const auto& joint : joints) {
    const Eigen::Index end = joint.log.samples();
    const auto rows = static_cast<Eigen::Index>(share * static_cast<double>(end));
    const PlainResult plain = plain_result(joint, rows, end);
    const Diagnosis d = diagnosis_of(joint, rows);
    const double ours = error_of(d, joint, rows, end, plain.plainest);
    std::string names;
    for (const auto& effect : d.effects) {
      names += (names.empty() ? "" : "+") + effect.name;
    }
    ratios.push_back(ours / plain.simple);
    improvable += plain.simple < 0.8 * plain.plainest ? 1 : 0;
    improved += plain.simple < 0.8 * plain.plainest && ours < 0.8 * plain.plainest ? 1 : 0;
    wrong += d.verdict == Verdict::kNothingMissing && ours > 1.5 * plain.simple ? 1 : 0;
    std::printf("%-22s %-6s plain %8.3f  simple %8.3f (%-21s) capstan %8.3f %-3s  ratio %5.2f  %-12s %-20s %s\n",
                joint.name.c_str(), kKindWords[static_cast<std::size_t>(joint.kind)], plain.plainest, plain.simple,
                plain.name.c_str(), ours, joint.kind == Kind::kAngle ? "deg" : "%", ratios.back(),
                word_of(d.law.status), verdict_word(d.verdict), names.c_str());
    std::fflush(stdout);
  }
  const Eigen::VectorXd all = Eigen::Map<Eigen::VectorXd>(ratios.data(), std::ssize(ratios));
  const double within = (all.array() <= 1.1).cast<double>().mean();
  std::printf(
      "%zu joints: capstan over simple median %.2f, at most 1.10 in %.0f %%; of %d that plain fits improve, "
      "improved %d; nothing_missing said wrongly %d\n",
      ratios.size(), median(all), 100.0 * within, improvable, improved, wrong);
  return within >= 0.9 && wrong == 0;
}

struct Variant {
  std::string name;
  DecidingNumbers numbers;
};

auto variants() -> std::vector<Variant> {
  std::vector<Variant> all = {{"as chosen", {}}};
  const auto add = [&](const char* name, auto change) {
    all.push_back({name, {}});
    change(all.back().numbers);
  };
  add("6 parts", [](auto& n) { n.parts = 6, n.first_judged_part = 3; });
  add("10 parts", [](auto& n) { n.parts = 10, n.first_judged_part = 5; });
  add("no settling", [](auto& n) { n.settling.most_share_of_rows = 0.0; });
  add("any play", [](auto& n) { n.fewest_turns_of_play = 0; });
  add("2 turns", [](auto& n) { n.fewest_turns_of_play = 2; });
  add("base if in set", [](auto& n) { n.worth_a_law = 1e9; });
  add("base at 1.05", [](auto& n) { n.worth_a_law = 1.05; });
  add("step 0.99", [](auto& n) { n.growth.worth_a_step = 0.99; });
  add("step 0.94", [](auto& n) { n.growth.worth_a_step = 0.94; });
  add("step 0.90", [](auto& n) { n.growth.worth_a_step = 0.90; });
  add("ridge 1e-4", [](auto& n) { n.ridge = 1e-4; });
  add("2 plays", [](auto& n) { n.most_plays = 2; });
  add("1 part left out", [](auto& n) { n.parts_left_out = 1; });
  add("2 parts left out", [](auto& n) { n.parts_left_out = 2; });
  return all;
}

/// The law alone, chosen by given numbers, on B. The found law takes no part: these numbers decide what is grown.
auto error_by(const DecidingNumbers& numbers, const Preparation& p, const JointFile& base, const Joint& joint,
              Eigen::Index rows, Eigen::Index end) -> double {
  const LawChoice choice = choose_law(p, base, std::nullopt, Lacking::kNothing, numbers);
  if (std::getenv("CAPSTAN_SHOW_LAWS") != nullptr) {
    std::printf(" [%s]", joined(choice.law.terms, " ").c_str());
  }
  return error_of(choice.law, joint, rows, end);
}

/// Shares of a log's rows: where it begins, where what is learned from ends, where what is judged on does.
struct Window {
  double begin, cut, end;
};
/// None is the scoreboard's.
constexpr Window kWindows[] = {{0.0, 0.5, 0.85}, {0.0, 0.55, 1.0}, {0.0, 0.65, 1.0}, {0.0, 0.7, 1.0},
                               {0.2, 0.7, 1.0},  {0.3, 0.8, 1.0},  {0.1, 0.5, 0.9},  {0.4, 0.8, 1.0}};

/// Ratio to the simple fit, by joint and window (rows) and by variant (columns).
struct VariantTable {
  std::vector<std::string> rows, machines;
  Eigen::MatrixXd ratios;
};

auto percent(double share) -> std::string {
  return std::to_string(std::lround(100.0 * share));
}

auto variant_table(const std::vector<Joint>& joints, const std::vector<Variant>& all) -> VariantTable {
  VariantTable table;
  table.ratios.resize(0, static_cast<Eigen::Index>(all.size()));
  for (const auto& joint : joints) {
    for (const auto& window : joint.kind == Kind::kAngle ? std::span(kWindows) : std::span<const Window>()) {
      const auto row_at = [&](double share) {
        return static_cast<Eigen::Index>(share * static_cast<double>(joint.log.samples()));
      };
      Joint cut = joint;
      cut.log = rows_from(joint.log, row_at(window.begin));
      const Eigen::Index rows = row_at(window.cut) - row_at(window.begin);
      const Eigen::Index end = row_at(window.end) - row_at(window.begin);
      const AxisLog seen = first_rows(cut.log, rows);
      const PlainResult plain = plain_result(cut, rows, end);
      const LawForm form = form_of_model(seen.has_torque ? kDefaultModel : "kinematic", {seen});
      const Preparation p = prepare({seen}, form);
      const JointFile base = causal_law(p, form);
      table.rows.push_back(joint.name + " (" + percent(window.begin) + " to " + percent(window.cut) + " %)");
      table.machines.push_back(joint.machine);
      table.ratios.conservativeResize(table.ratios.rows() + 1, Eigen::NoChange);
      std::printf("%-32s", table.rows.back().c_str());
      for (std::size_t i = 0; i < all.size(); ++i) {
        const double ratio = error_by(all[i].numbers, p, base, cut, rows, end) / plain.simple;
        table.ratios(table.ratios.rows() - 1, static_cast<Eigen::Index>(i)) = ratio;
        std::printf(" %6.2f", ratio);
        std::fflush(stdout);
      }
      std::printf("\n");
    }
  }
  return table;
}

/// Every machine with the numbers that serve the others best (geometric mean of the ratios).
void leave_one_out(const VariantTable& table, const std::vector<Variant>& all) {
  std::printf("\nleave one machine out: numbers chosen on the others, ratio on this one\n");
  std::map<std::string, Eigen::Index> chosen;
  std::vector<double> ratios;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    const std::string& machine = table.machines[row];
    if (!chosen.contains(machine)) {
      Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(table.ratios.cols());
      for (std::size_t other = 0; other < table.rows.size(); ++other) {
        if (table.machines[other] != machine) {
          sum += table.ratios.row(static_cast<Eigen::Index>(other)).array().log().matrix();
        }
      }
      sum.minCoeff(&chosen[machine]);
    }
    const Eigen::Index variant = chosen[machine];
    ratios.push_back(table.ratios(static_cast<Eigen::Index>(row), variant));
    std::printf("%-32s %-16s %5.2f\n", table.rows[row].c_str(), all[static_cast<std::size_t>(variant)].name.c_str(),
                ratios.back());
  }
  const Eigen::VectorXd values = Eigen::Map<Eigen::VectorXd>(ratios.data(), std::ssize(ratios));
  std::printf("median %.2f, at most 1.10 in %.0f %%\n", median(values),
              100.0 * (values.array() <= 1.1).cast<double>().mean());
}

void leave_one_out(const std::vector<Joint>& joints) {
  const auto all = variants();
  std::printf("capstan over simple, law alone\n%-32s", "");
  for (const auto& variant : all) {
    std::printf(" %s |", variant.name.c_str());
  }
  std::printf("\n");
  leave_one_out(variant_table(joints, all), all);
}

/// The scoreboard of the same machines, recorded in each way.
void recorded_otherwise(const std::string& folder, const std::string& into, double share) {
  const auto as_logged = read_machines(folder);
  for (const auto& way : ways()) {
    const std::string here = into + "/" + way.name;
    std::filesystem::create_directories(here);
    std::vector<DrawnMachine> machines;
    std::transform(as_logged.begin(), as_logged.end(), std::back_inserter(machines), way.record);
    constexpr int kDigits = 12;
    write_machines(here, machines, kDigits);
    std::printf("%s\n", way.name.c_str());
    scoreboard(joints_in(here), share);
  }
}

}  // namespace
}  // namespace capstan::tools::machines

int main(int argc, char** argv) {
  using namespace capstan::tools;
  CLI::App app("What the diagnosis makes of measured machines, beside plain fits on the same rows.");
  std::string folder;
  double share = 0.6;
  bool leave_out = false;
  app.add_option("folder", folder, "logs by the contract")->required();
  app.add_option("--share", share, "share of the rows, the first, that the diagnosis and the fits are given")
      ->capture_default_str()
      ->check(CLI::Range(0.2, 0.9));
  app.add_flag("--leave-one-out", leave_out, "other values of the deciding numbers, chosen without the machine judged");
  bool efforts = false;
  app.add_flag("--board-efforts", efforts, "laws of efforts instead, noncausally and as a board runs them");
  std::optional<std::uint64_t> seed;
  app.add_option("--draw", seed, "first write 29 machines by the laws of others into the folder, drawn by this seed");
  std::string into;
  app.add_option("--otherwise", into,
                 "the same machines as others might have recorded them (a rest before, other zeros, rows lost, noise "
                 "...), written into this folder");
  CLI11_PARSE(app, argc, argv);
  try {
    if (seed) {
      std::filesystem::create_directories(folder);
      machines::write_machines(folder, machines::drawn_machines(*seed));
    }
    if (!std::filesystem::is_directory(folder)) {
      throw BadInput(folder + " is no folder; name one with logs, or have logs drawn into it with --draw SEED");
    }
    if (!into.empty()) {
      machines::recorded_otherwise(folder, into, share);
      return 0;
    }
    const auto joints = machines::joints_in(folder);
    if (efforts) {
      machines::board_efforts(joints, share);
      return 0;
    }
    if (leave_out) {
      machines::leave_one_out(joints);
      return 0;
    }
    return machines::scoreboard(joints, share) ? 0 : 1;
  } catch (const BadInput& error) {
    std::cerr << "machine_benchmark: " << error.what() << "\n";
    return 2;
  }
}
