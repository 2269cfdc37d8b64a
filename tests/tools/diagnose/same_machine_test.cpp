// SPDX-License-Identifier: Apache-2.0
// One machine gives one answer, also with a millionth more on a channel, which is beyond any sensor. Logs of measured
// machines, where they are.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "capstan/tools/diagnose/diagnosis.hpp"
#include "capstan/tools/identify/law_fit.hpp"
#include "capstan/tools/log/axis_log.hpp"
#include "capstan/tools/log/csv_log.hpp"
#include "capstan/tools/select/effort_law.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

/// A part of a log, as shares of its rows.
struct Cut {
  std::string machine;
  double from = 0.0, to = 1.0;
};

auto whole_log(const std::string& machine) -> std::optional<AxisLog> {
  const char* given = std::getenv("CAPSTAN_DATA");
  const std::filesystem::path data = given != nullptr
                                         ? std::filesystem::path(given)
                                         : std::filesystem::path(CAPSTAN_SOURCE_DIR).parent_path() / "shared" / "data";
  const std::filesystem::path file = data / "machines" / (machine + ".csv");
  if (!std::filesystem::exists(file)) {
    return std::nullopt;
  }
  const CsvLog csv = CsvLog::read(file.string(), {});
  AxisRequest request;
  request.effort = !csv.has("axis0/q2_rad");
  return read_axis(csv, request);
}

auto part_of(const AxisLog& log, const Cut& cut) -> AxisLog {
  const auto row = [&](double share) { return static_cast<Eigen::Index>(share * static_cast<double>(log.samples())); };
  return rows_from(first_rows(log, row(cut.to)), row(cut.from));
}

struct LawOfPart {
  Diagnosis d;
  double left = 0.0;  ///< of the whole log, rms
};

auto law_of_part(const AxisLog& whole, const Cut& cut) -> LawOfPart {
  LawOfPart answer{diagnose({part_of(whole, cut)}, {}), 0.0};
  const Eigen::VectorXd estimate = answer.d.effort_law ? run_effort_law({whole}, *answer.d.effort_law)
                                                       : simulate({whole}, motion_parameters(answer.d.law));
  answer.left = rms(whole.measured() - estimate);
  return answer;
}

auto names_of(const Diagnosis& d) -> std::vector<std::string> {
  std::vector<std::string> names;
  std::transform(d.effects.begin(), d.effects.end(), std::back_inserter(names),
                 [](const auto& one) { return one.name; });
  return names;
}

class LastDecimals : public testing::TestWithParam<Cut> {};

TEST_P(LastDecimals, DecideNothing) {
  const auto plain = whole_log(GetParam().machine);
  if (!plain) {
    GTEST_SKIP() << "no log of " << GetParam().machine << "; set CAPSTAN_DATA to the folder of measured logs";
  }
  const LawOfPart answer = law_of_part(*plain, GetParam());
  for (const double change : {-1e-6, 1e-6}) {
    for (Eigen::VectorXd AxisLog::*channel : {&AxisLog::q1_rad, &AxisLog::tau_nm}) {
      AxisLog log = *plain;
      log.*channel *= 1.0 + change;
      if (channel == &AxisLog::tau_nm && log.effort.size() > 0) {
        log.effort *= 1.0 + change;
      }
      const LawOfPart other = law_of_part(log, GetParam());
      SCOPED_TRACE((channel == &AxisLog::q1_rad ? "q1 by " : "torque by ") + std::to_string(1e6 * change) +
                   " millionths");
      EXPECT_EQ(other.d.verdict, answer.d.verdict) << other.d.reason << " / " << answer.d.reason;
      EXPECT_EQ(names_of(other.d), names_of(answer.d));
      EXPECT_NEAR(other.d.after.rmse, answer.d.after.rmse, 0.02 * answer.d.after.rmse);
      EXPECT_NEAR(other.left, answer.left, 0.02 * answer.left);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Machines, LastDecimals,
                         testing::Values(Cut{"ur10e_joint1", 0.6, 1.0}, Cut{"ur10e_joint2", 0.0, 0.6},
                                         Cut{"ur10e_joint5", 0.0, 0.6}, Cut{"tx40_axis3"}),
                         [](const auto& test) { return test.param.machine; });

}  // namespace
}  // namespace capstan::tools
