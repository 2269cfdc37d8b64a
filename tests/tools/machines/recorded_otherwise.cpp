// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/machines/recorded_otherwise.hpp"

#include <algorithm>
#include <filesystem>
#include <random>

#include "capstan/tools/log/csv_log.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools::machines {
namespace {

using Eigen::Index;

constexpr std::uint64_t kSeed = 7;

auto is_angle(const std::string& column) -> bool {
  return column.find("/q1_") != std::string::npos || column.find("/q2_") != std::string::npos;
}

/// Columns that a law is to explain: joint angles, or where there are none the torques.
auto targets_of(const DrawnMachine& log) -> std::vector<Index> {
  for (const char* quantity : {"/q2_", "/tau"}) {
    std::vector<Index> found;
    for (std::size_t i = 0; i < log.columns.size(); ++i) {
      if (log.columns[i].find(quantity) != std::string::npos) {
        found.push_back(static_cast<Index>(i));
      }
    }
    if (!found.empty()) {
      return found;
    }
  }
  return {};
}

auto as_it_is(DrawnMachine log) -> DrawnMachine {
  return log;
}

/// Some row, noise of the targets beside it, once more for three tenths of the log's length.
auto with_a_rest(DrawnMachine log, Index before) -> DrawnMachine {
  const Index rest = 3 * log.rows.rows() / 10;
  const double period = (log.rows(log.rows.rows() - 1, 0) - log.rows(0, 0)) / static_cast<double>(log.rows.rows() - 1);
  Eigen::MatrixXd rows(rest + log.rows.rows(), log.rows.cols());
  rows << log.rows.topRows(before), log.rows.row(before).replicate(rest, 1),
      log.rows.bottomRows(log.rows.rows() - before);
  std::mt19937_64 draw(kSeed);
  for (const Index target : targets_of(log)) {
    std::normal_distribution<double> noise(0.0, white_noise_level(log.rows.col(target)));
    for (double& value : rows.col(target).segment(before, rest)) {
      value += noise(draw);
    }
  }
  rows.col(0) = Eigen::VectorXd::LinSpaced(rows.rows(), 0.0, period * static_cast<double>(rows.rows() - 1));
  log.rows = std::move(rows);
  return log;
}

auto behind_a_rest(DrawnMachine log) -> DrawnMachine {
  return with_a_rest(std::move(log), 0);
}

auto with_a_rest_within(DrawnMachine log) -> DrawnMachine {
  const Index third = log.rows.rows() / 3;
  return with_a_rest(std::move(log), third);
}

auto from_other_zeros(DrawnMachine log) -> DrawnMachine {
  for (std::size_t i = 0; i < log.columns.size(); ++i) {
    log.rows.col(static_cast<Index>(i)).array() += is_angle(log.columns[i]) ? 5.0 : 0.0;
  }
  return log;
}

template <typename Keep>
auto rows_where(DrawnMachine log, Keep keep) -> DrawnMachine {
  Index kept = 0;
  for (Index i = 0; i < log.rows.rows(); ++i) {
    if (keep(i)) {
      log.rows.row(kept++) = log.rows.row(i).eval();
    }
  }
  log.rows.conservativeResize(kept, Eigen::NoChange);
  return log;
}

auto half_of_the_rows(DrawnMachine log) -> DrawnMachine {
  return rows_where(std::move(log), [](Index i) { return i % 2 == 0; });
}

auto one_in_twenty_lost(DrawnMachine log) -> DrawnMachine {
  std::mt19937_64 draw(kSeed);
  return rows_where(std::move(log), [&](Index) { return draw() % 20 != 0; });
}

auto twice_the_rows(DrawnMachine log) -> DrawnMachine {
  Eigen::MatrixXd rows(2 * log.rows.rows() - 1, log.rows.cols());
  for (Index i = 0; i < rows.rows(); ++i) {
    rows.row(i) = 0.5 * (log.rows.row(i / 2) + log.rows.row((i + 1) / 2));
  }
  log.rows = std::move(rows);
  return log;
}

auto with_trembling_times(DrawnMachine log) -> DrawnMachine {
  std::mt19937_64 draw(kSeed);
  std::uniform_real_distribution<double> early_or_late(-0.3, 0.3);
  const double period = (log.rows(log.rows.rows() - 1, 0) - log.rows(0, 0)) / static_cast<double>(log.rows.rows() - 1);
  for (double& time : log.rows.col(0)) {
    time += period * early_or_late(draw);
  }
  return log;
}

auto with_noise(DrawnMachine log) -> DrawnMachine {
  std::mt19937_64 draw(kSeed);
  for (const Index target : targets_of(log)) {
    std::normal_distribution<double> noise(0.0, 0.02 * rms_about_mean(log.rows.col(target)));
    for (double& value : log.rows.col(target)) {
      value += noise(draw);
    }
  }
  return log;
}

auto in_coarse_steps(DrawnMachine log) -> DrawnMachine {
  for (const Index target : targets_of(log)) {
    const double step = (log.rows.col(target).maxCoeff() - log.rows.col(target).minCoeff()) / 200.0;
    log.rows.col(target) = step * (log.rows.col(target) / step).array().round().matrix();
  }
  return log;
}

/// One in two hundred and fifty.
auto with_wild_values(DrawnMachine log) -> DrawnMachine {
  std::mt19937_64 draw(kSeed);
  for (const Index target : targets_of(log)) {
    const double far = 10.0 * rms_about_mean(log.rows.col(target));
    for (Index i = 1; i + 1 < log.rows.rows(); ++i) {
      log.rows(i, target) += draw() % 250 == 0 ? (draw() % 2 == 0 ? far : -far) : 0.0;
    }
  }
  return log;
}

}  // namespace

auto ways() -> std::vector<Way> {
  return {{"as it is", as_it_is},
          {"behind a rest", behind_a_rest},
          {"a rest within", with_a_rest_within},
          {"other zeros", from_other_zeros},
          {"half of the rows", half_of_the_rows},
          {"twice the rows", twice_the_rows},
          {"one row in 20 lost", one_in_twenty_lost},
          {"trembling times", with_trembling_times},
          {"2 % of noise", with_noise},
          {"200 steps", in_coarse_steps},
          {"wild values", with_wild_values}};
}

auto read_machines(const std::string& folder) -> std::vector<DrawnMachine> {
  std::vector<DrawnMachine> machines;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".csv") {
      continue;
    }
    const CsvLog csv = CsvLog::read(entry.path().string());
    DrawnMachine machine{entry.path().stem().string(), csv.column_names(), {}};
    machine.rows.resize(static_cast<Index>(csv.rows()), static_cast<Index>(machine.columns.size()));
    for (std::size_t i = 0; i < machine.columns.size(); ++i) {
      machine.rows.col(static_cast<Index>(i)) = csv.column(machine.columns[i]);
    }
    machines.push_back(std::move(machine));
  }
  return machines;
}

}  // namespace capstan::tools::machines
