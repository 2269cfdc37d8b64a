// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/preparation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/log/axis_log.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

/// A joint that follows its motor, at 1 kHz.
auto log_of(Eigen::Index rows, const std::string& name) -> AxisLog {
  AxisLog log;
  log.name = name;
  log.period_s = 0.001;
  log.time_s = Eigen::VectorXd::LinSpaced(rows, 0.0, 0.001 * static_cast<double>(rows - 1));
  log.q1_rad = log.time_s.unaryExpr([](double t) { return std::sin(2.0 * t) + 0.3 * std::sin(5.1 * t); });
  log.tau_nm = Eigen::VectorXd::Zero(rows);
  log.q2_rad = 0.5 * log.q1_rad;
  return log;
}

TEST(Prepare, ALogOfAFewRowsBesideALongOneIsRefusedByItsName) {
  const std::vector<AxisLog> logs = {log_of(40000, "long.csv"), log_of(4, "short.csv")};
  try {
    prepare(logs, form_of_model("kinematic", logs));
    FAIL() << "a log of less than a coarse row was taken";
  } catch (const BadInput& refused) {
    const std::string sentence = refused.what();
    EXPECT_NE(sentence.find("short.csv: the log has 4 rows"), std::string::npos) << sentence;
    EXPECT_NE(sentence.find("leave it out"), std::string::npos) << sentence;
  }
  const std::vector<AxisLog> longer = {log_of(40000, "long.csv"), log_of(2000, "short.csv")};
  EXPECT_EQ(prepare(longer, form_of_model("kinematic", longer)).logs.size(), 2U);
}

}  // namespace
}  // namespace capstan::tools
