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
#include "capstan/tests/tools/machines/plain_fits.hpp"
#include "capstan/tools/diagnose/diagnosis.hpp"
#include "capstan/tools/diagnose/free_run.hpp"
#include "capstan/tools/diagnose/preparation.hpp"
#include "capstan/tools/select/choice.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools::machines {
namespace {

constexpr double kDegrees = 57.29577951308232;

/// What of a log is to be explained.
enum class Kind : std::uint8_t { kAngle, kEffort, kGear };
constexpr const char* kKindWords[] = {"angle", "effort", "torque"};

/// A measured joint or axis.
struct Joint {
  std::string name, machine;  ///< machine: logs of one are left out together
  Kind kind = Kind::kAngle;
  AxisLog log;
};

auto first_rows(AxisLog log, Eigen::Index rows) -> AxisLog {
  for_each_signal(log, [rows](Eigen::VectorXd& signal) { signal.conservativeResize(std::min(rows, signal.size())); });
  return log;
}

auto rows_from(AxisLog log, Eigen::Index first) -> AxisLog {
  for_each_signal(log, [first](Eigen::VectorXd& signal) {
    signal = Eigen::VectorXd(signal.tail(std::max<Eigen::Index>(0, signal.size() - first)));
  });
  return log;
}

/// Kind and request of an axis; nothing where it has nothing to explain.
auto request_of(const CsvLog& csv, int axis) -> std::optional<std::pair<Kind, AxisRequest>> {
  const auto has = [&](const char* signal) { return csv.has(axis_column(axis, signal)); };
  const auto target = [&](Kind kind, const char* signal) -> std::pair<Kind, AxisRequest> {
    AxisRequest request;
    request.axis = axis;
    request.target = axis_column(axis, signal);
    request.effort = kind == Kind::kEffort;
    request.force = kind == Kind::kGear;
    return {kind, request};
  };
  if (!has("q1_rad") && !has("q1_m")) {
    return std::nullopt;
  }
  if (has("q2_rad")) {
    return target(Kind::kAngle, "q2_rad");
  }
  if (has("tau_out_Nm")) {
    return target(Kind::kGear, "tau_out_Nm");
  }
  if (has("tau_Nm") || has("tau_N")) {
    return target(Kind::kEffort, has("tau_Nm") ? "tau_Nm" : "tau_N");
  }
  return std::nullopt;
}

auto joints_in(const std::string& folder) -> std::vector<Joint> {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".csv") {
      files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  std::vector<Joint> joints;
  for (const auto& file : files) {
    const CsvLog csv = CsvLog::read(file.string());
    for (int axis = 0; axis < kMostAxes; ++axis) {
      if (const auto wanted = request_of(csv, axis)) {
        const std::string stem = file.stem().string();
        joints.push_back({stem + (axis > 0 ? ":" + std::to_string(axis) : ""), stem.substr(0, stem.find('_')),
                          wanted->first, read_axis(csv, wanted->second)});
      }
    }
  }
  return joints;
}

/// The target as laws are judged by it: an effort through a cubic of 0.12 s.
auto judged(const Joint& joint) -> Eigen::VectorXd {
  return joint.kind == Kind::kEffort ? EffortDesign({joint.log}, usual_view({joint.log})).seen(joint.log.effort)
                                     : joint.log.measured();
}

/// rms on the rows from `begin` to `end`: degrees, or % of the target's rms there.
auto error_on(const Eigen::VectorXd& estimate, const Joint& joint, Eigen::Index begin, Eigen::Index end) -> double {
  const Eigen::VectorXd target = judged(joint).segment(begin, end - begin);
  const double scale = joint.kind == Kind::kAngle ? kDegrees : 100.0 / rms(target);
  return scale * rms(target - estimate.segment(begin, end - begin));
}

auto plain_fits(const Joint& joint) -> std::vector<PlainFit> {
  switch (joint.kind) {
    case Kind::kEffort:
      return plain_effort_fits(joint.log);
    case Kind::kGear:
      return plain_gear_fits(joint.log);
    default:
      return plain_angle_fits(joint.log);
  }
}

struct PlainResult {
  std::string name;
  double affine = 0.0, simple = 0.0;
};

/// The plain fit that does best on the last quarter of A, fitted to the first three; then fitted to all of A.
auto plain_result(const Joint& joint, Eigen::Index rows, Eigen::Index end) -> PlainResult {
  constexpr double kInner = 0.75;
  const auto inner = static_cast<Eigen::Index>(kInner * static_cast<double>(rows));
  const auto fits = plain_fits(joint);
  double least = std::numeric_limits<double>::infinity();
  const PlainFit* best = nullptr;
  for (const auto& fit : fits) {
    if (const double error = error_on(fit.estimate(inner), joint, inner, rows); error < least) {
      least = error;
      best = &fit;
    }
  }
  return {best->name, error_on(fits.front().estimate(rows), joint, rows, end),
          error_on(best->estimate(rows), joint, rows, end)};
}

auto error_of(const JointFile& law, const Joint& joint, Eigen::Index rows, Eigen::Index end) -> double {
  return error_on(simulate({joint.log}, motion_parameters(law)), joint, rows, end);
}

/// What the law that was delivered leaves; the plainest fit's where there is none.
auto error_of(const Diagnosis& d, const Joint& joint, Eigen::Index rows, Eigen::Index end, double plainest) -> double {
  if (joint.kind != Kind::kAngle) {
    return d.effort_law ? error_on(run_effort_law({joint.log}, *d.effort_law), joint, rows, end) : plainest;
  }
  return d.law.terms.empty() ? plainest : error_of(d.law, joint, rows, end);
}

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
    DiagnoseOptions options;
    options.base_model = joint.kind == Kind::kGear ? "pull_push" : "";
    const Diagnosis d = diagnose({first_rows(joint.log, rows)}, options);
    const double ours = error_of(d, joint, rows, end, plain.affine);
    std::string names;
    for (const auto& effect : d.effects) {
      names += (names.empty() ? "" : "+") + effect.name;
    }
    ratios.push_back(ours / plain.simple);
    improvable += plain.simple < 0.8 * plain.affine ? 1 : 0;
    improved += plain.simple < 0.8 * plain.affine && ours < 0.8 * plain.affine ? 1 : 0;
    wrong += d.verdict == Verdict::kNothingMissing && ours > 1.5 * plain.simple ? 1 : 0;
    std::printf("%-22s %-6s plain %8.3f  simple %8.3f (%-21s) capstan %8.3f %-3s  ratio %5.2f  %-12s %-20s %s\n",
                joint.name.c_str(), kKindWords[static_cast<std::size_t>(joint.kind)], plain.affine, plain.simple,
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

}  // namespace
}  // namespace capstan::tools::machines

int main(int argc, char** argv) {
  using namespace capstan::tools;
  CLI::App app("What the diagnosis makes of measured machines, beside plain fits on the same rows.");
  std::string folder;
  double share = 0.6;
  bool leave_out = false;
  app.add_option("folder", folder, "logs by the contract")->required()->check(CLI::ExistingDirectory);
  app.add_option("--share", share, "share of the rows, the first, that the diagnosis and the fits are given")
      ->capture_default_str()
      ->check(CLI::Range(0.2, 0.9));
  app.add_flag("--leave-one-out", leave_out, "other values of the deciding numbers, chosen without the machine judged");
  bool efforts = false;
  app.add_flag("--board-efforts", efforts, "laws of efforts instead, noncausally and as a board runs them");
  std::optional<std::uint64_t> seed;
  app.add_option("--draw", seed, "first write 21 machines by the laws of others into the folder, drawn by this seed");
  CLI11_PARSE(app, argc, argv);
  try {
    if (seed) {
      machines::write_machines(folder, machines::drawn_machines(*seed));
    }
    if (efforts) {
      machines::board_efforts(folder, share);
      return 0;
    }
    const auto joints = machines::joints_in(folder);
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
