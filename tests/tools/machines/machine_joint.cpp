// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/machines/machine_joint.hpp"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <optional>
#include <utility>

#include "capstan/tests/tools/machines/plain_fits.hpp"
#include "capstan/tools/diagnose/free_run.hpp"
#include "capstan/tools/log/recordings.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools::machines {
namespace {

constexpr double kDegrees = 57.29577951308232;

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

/// The target as laws are judged by it: an effort through a cubic of 0.12 s.
auto judged(const Joint& joint) -> Eigen::VectorXd {
  return joint.kind == Kind::kEffort ? EffortDesign({joint.log}, usual_view({joint.log})).seen(joint.log.effort)
                                     : joint.log.measured();
}

/// rms on the rows from `begin` to `end` of the judged target: degrees, or % of its rms there.
auto error_on(const Eigen::VectorXd& estimate, const Eigen::VectorXd& target, Kind kind, Eigen::Index begin,
              Eigen::Index end) -> double {
  const double scale = kind == Kind::kAngle ? kDegrees : 100.0 / rms(target.segment(begin, end - begin));
  return scale * rms((target - estimate).segment(begin, end - begin));
}
auto error_on(const Eigen::VectorXd& estimate, const Joint& joint, Eigen::Index begin, Eigen::Index end) -> double {
  return error_on(estimate, judged(joint), joint.kind, begin, end);
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

}  // namespace

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
  if (joints.empty()) {
    throw BadInput(folder +
                   " holds no log to score: files that end in .csv, with a motor angle (axis0/q1_rad) and a "
                   "joint angle, an effort or a torque behind a gear");
  }
  return joints;
}

auto plain_result(const Joint& joint, Eigen::Index rows, Eigen::Index end) -> PlainResult {
  constexpr double kInner = 0.75;
  const auto inner = static_cast<Eigen::Index>(kInner * static_cast<double>(rows));
  const auto fits = plain_fits(joint);
  const Eigen::VectorXd target = judged(joint);
  const auto error = [&](const PlainFit& fit, Eigen::Index fitted, Eigen::Index begin, Eigen::Index until) {
    return error_on(fit.estimate(fitted), target, joint.kind, begin, until);
  };
  double least = std::numeric_limits<double>::infinity();
  const PlainFit* best = &fits.front();
  for (const auto& fit : fits) {
    if (const double left = error(fit, inner, inner, rows); left < least) {
      least = left;
      best = &fit;
    }
  }
  return {best->name, error(fits.front(), rows, rows, end), error(*best, rows, rows, end)};
}

auto error_of(const JointFile& law, const Joint& joint, Eigen::Index rows, Eigen::Index end) -> double {
  return error_on(simulate({joint.log}, motion_parameters(law)), joint, rows, end);
}

auto error_of(const Diagnosis& d, const Joint& joint, Eigen::Index rows, Eigen::Index end, double plainest) -> double {
  if (joint.kind != Kind::kAngle) {
    if (!d.effort_law && d.pull_push) {
      return error_on(joint_torque_by(*d.pull_push, joint.log.tau_nm), joint, rows, end);
    }
    return d.effort_law ? error_on(run_effort_law({joint.log}, *d.effort_law), joint, rows, end) : plainest;
  }
  return d.law.terms.empty() ? plainest : error_of(d.law, joint, rows, end);
}

auto diagnosis_of(const Joint& joint, Eigen::Index rows) -> Diagnosis {
  DiagnoseOptions options;
  options.base_model = joint.kind == Kind::kGear ? "pull_push" : "";
  return diagnose(recordings_in(first_rows(joint.log, rows)), options);
}

}  // namespace capstan::tools::machines
