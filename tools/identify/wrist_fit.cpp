// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/wrist_fit.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/model/coupled_axes.hpp"
#include "capstan/tools/identify/bounded_search.hpp"
#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

constexpr double kMostFollow = 10.0;
constexpr Eigen::Index kOwn = 4;  // unknowns of a joint: beta, offset, and the pair of its tendons
enum Own : Eigen::Index { kOwnBeta, kOwnOffset, kOwnTop, kOwnBottom };

/// A joint's rows, divided by what its own law leaves, so that joints count by how well they can be known.
struct JointRows {
  LawDesign design;
  Eigen::MatrixXd own;    ///< a column per unknown of the joint
  Eigen::MatrixXd pitch;  ///< the same of the pitch without its offset, seen by a jaw: beta, top, bottom
  Eigen::VectorXd target;
};
using Wrist = std::vector<JointRows>;

auto columns_of(const LawDesign& design, const char* term) -> Eigen::MatrixXd {
  const CatalogueTerm& t = catalogue_term(term);
  return design.columns(t, t.initial_shapes());
}

auto rows_of(const std::vector<AxisLog>& logs, const JointFile& untied) -> JointRows {
  const double share = 1.0 / untied.fit->rmse;
  LawDesign design(logs, untied.parameters.conditioner);
  Eigen::MatrixXd own(design.rows(), kOwn);
  own << columns_of(design, "motor_angle"), columns_of(design, "joint_offset"), columns_of(design, "tendon_elongation");
  const Eigen::MatrixXd pitch =
      untied.has("axis_coupling") ? columns_of(design, "axis_coupling") : Eigen::MatrixXd(design.rows(), 0);
  return {std::move(design), share * own, share * pitch, share * stacked_target(logs)};
}

/// What follows of the pitch's unknowns, as columns over all rows of the wrist, and the joints' own.
auto tied_columns(const Wrist& wrist, const Eigen::VectorXd& follow) -> Eigen::MatrixXd {
  Eigen::Index rows = 0;
  for (const JointRows& joint : wrist) {
    rows += joint.own.rows();
  }
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(rows, kOwn * static_cast<Eigen::Index>(wrist.size()));
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < wrist.size(); ++i) {
    const Eigen::Index count = wrist[i].own.rows();
    columns.block(row, kOwn * static_cast<Eigen::Index>(i), count, kOwn) = wrist[i].own;
    if (i > 0) {
      const double k = follow[static_cast<Eigen::Index>(i) - 1];
      columns.block(row, kOwnBeta, count, 1) += k * wrist[i].pitch.col(0);
      columns.block(row, kOwnTop, count, 2) += k * wrist[i].pitch.rightCols(2);
    }
    row += count;
  }
  return columns;
}

auto target_of(const Wrist& wrist) -> Eigen::VectorXd {
  Eigen::VectorXd target(0);
  for (const JointRows& joint : wrist) {
    Eigen::VectorXd longer(target.size() + joint.target.size());
    longer << target, joint.target;
    target = std::move(longer);
  }
  return target;
}

auto signs() -> std::vector<Sign> {
  std::vector<Sign> result;
  for (std::size_t i = 0; i < kWristAxes; ++i) {
    result.insert(result.end(), {Sign::kAny, Sign::kAny, Sign::kNonPositive, Sign::kNonPositive});
  }
  return result;
}

/// What the best law with given K leaves.
class Left final : public SteppedResidual {
 public:
  explicit Left(const Wrist& wrist) : wrist_(wrist), target_(target_of(wrist)) {}
  [[nodiscard]] auto solved(const Eigen::MatrixXd& columns) const -> Eigen::VectorXd {
    return solve_signed(columns.transpose() * columns, columns.transpose() * target_, signs());
  }

 private:
  auto left_of(const Eigen::VectorXd& follow) -> Eigen::VectorXd override {
    const Eigen::MatrixXd columns = tied_columns(wrist_, follow);
    return columns * solved(columns) - target_;
  }
  const Wrist& wrist_;
  Eigen::VectorXd target_;
};

/// The pitch's part in the jaws' rows, a column per jaw: how the law moves with K.
auto follow_columns(const Wrist& wrist, const Eigen::VectorXd& theta, Eigen::Index rows) -> Eigen::MatrixXd {
  const Eigen::Vector3d pitch(theta[kOwnBeta], theta[kOwnTop], theta[kOwnBottom]);
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(rows, static_cast<Eigen::Index>(wrist.size()) - 1);
  Eigen::Index row = wrist.front().own.rows();
  for (std::size_t i = 1; i < wrist.size(); ++i) {
    const Eigen::Index count = wrist[i].own.rows();
    columns.block(row, static_cast<Eigen::Index>(i) - 1, count, 1) = wrist[i].pitch * pitch;
    row += count;
  }
  return columns;
}

/// The law linear about its solution, for intervals of all unknowns and of both K.
auto linear_fit(const Wrist& wrist, const Eigen::MatrixXd& columns, const Eigen::VectorXd& theta,
                const Eigen::VectorXd& follow) -> LinearFit {
  const Eigen::MatrixXd by_follow = follow_columns(wrist, theta, columns.rows());
  Eigen::MatrixXd all(columns.rows(), columns.cols() + by_follow.cols());
  all << columns, by_follow;
  auto all_signs = signs();
  all_signs.insert(all_signs.end(), static_cast<std::size_t>(by_follow.cols()), Sign::kAny);
  const Eigen::VectorXd target = target_of(wrist);
  std::vector<Eigen::Index> rows;
  for (const JointRows& joint : wrist) {
    rows.insert(rows.end(), joint.design.log_rows().begin(), joint.design.log_rows().end());
  }
  return fit_columns(all, target + by_follow * follow, interval_blocks(pieces_of(rows), target - columns * theta),
                     all_signs);
}

/// One number of the law with the interval that its dependence on the unknowns gives.
void put(JointFile& joint, std::size_t at, double value, const Eigen::VectorXd& slope, const LinearFit& fit) {
  const double half = student_t95(fit.degrees_of_freedom) * std::sqrt(std::max(0.0, slope.dot(fit.covariance * slope)));
  joint.parameters.coefficients[at] = value;
  joint.coefficient_ci95[at] = Interval{value - half, value + half};
}

auto transmission_of(const Eigen::VectorXd& theta, const Eigen::VectorXd& follow) -> WristTransmission<double> {
  const auto pair = [&](Eigen::Index i) {
    return ElongationPair<double>{theta[kOwn * i + kOwnTop], theta[kOwn * i + kOwnBottom]};
  };
  return {theta[kOwnBeta], theta[kOwn + kOwnBeta], theta[2 * kOwn + kOwnBeta], follow[0], follow[1], pair(0), pair(1),
          pair(2)};
}

void put_row(std::size_t i, const CouplingMatrices<double, kWristAxes>& m, const Eigen::VectorXd& follow,
             const LinearFit& fit, JointFile& joint) {
  const auto first = kOwn * static_cast<Eigen::Index>(i);
  const auto unit = [&](Eigen::Index at) -> Eigen::VectorXd { return Eigen::VectorXd::Unit(fit.theta.size(), at); };
  const auto at = [](const char* term) { return catalogue_term(term).first_coefficient; };
  put(joint, at("motor_angle"), m.rigid[i][i], unit(first + kOwnBeta), fit);
  put(joint, at("joint_offset"), fit.theta[first + kOwnOffset], unit(first + kOwnOffset), fit);
  put(joint, at("tendon_elongation"), m.elongation_top[i][i], unit(first + kOwnTop), fit);
  put(joint, at("tendon_elongation") + 1, m.elongation_bottom[i][i], unit(first + kOwnBottom), fit);
  if (i == 0) {
    return;
  }
  const double k = follow[static_cast<Eigen::Index>(i) - 1];
  const Eigen::VectorXd by_k = unit(kOwn * static_cast<Eigen::Index>(kWristAxes) + static_cast<Eigen::Index>(i) - 1);
  const std::size_t coupling = at("axis_coupling");
  put(joint, coupling, m.rigid[i][0], k * unit(kOwnBeta) + fit.theta[kOwnBeta] * by_k, fit);
  put(joint, coupling + 1, m.elongation_top[i][0], k * unit(kOwnTop) + fit.theta[kOwnTop] * by_k, fit);
  put(joint, coupling + 2, m.elongation_bottom[i][0], k * unit(kOwnBottom) + fit.theta[kOwnBottom] * by_k, fit);
}

}  // namespace

auto fit_wrist(const std::array<std::vector<AxisLog>, kWristAxes>& logs) -> WristFit {
  WristFit result;
  Wrist wrist;
  Eigen::VectorXd follow(kWristAxes - 1);
  for (std::size_t i = 0; i < kWristAxes; ++i) {
    const Identification untied = identify(logs[i], form_of_model(i == 0 ? "pseudo_kinematic" : "multi_dof", logs[i]));
    result.joints[i] = untied.joint;
    result.untied_rmse_rad[i] = untied.joint.fit->rmse;
    std::copy_if(untied.undetermined.begin(), untied.undetermined.end(), std::back_inserter(result.undetermined),
                 [](const std::string& name) { return !name.starts_with("axis_coupling"); });
    wrist.push_back(rows_of(logs[i], untied.joint));
    const auto& numbers = untied.joint.parameters.coefficients;
    if (i > 0) {
      const double by_pitch = beta_of(result.joints[0]);
      follow[static_cast<Eigen::Index>(i) - 1] =
          std::clamp(numbers[catalogue_term("axis_coupling").first_coefficient] / by_pitch, -kMostFollow, kMostFollow);
    }
  }
  Left left(wrist);
  const auto limit = Eigen::VectorXd::Constant(follow.size(), kMostFollow);
  follow = least_squares_within({-limit, limit}, follow, left).parameters;
  const Eigen::MatrixXd columns = tied_columns(wrist, follow);
  const Eigen::VectorXd theta = left.solved(columns);
  const LinearFit fit = linear_fit(wrist, columns, theta, follow);
  const auto matrices = coupling_of(transmission_of(theta, follow));
  for (std::size_t i = 0; i < kWristAxes; ++i) {
    put_row(i, matrices, follow, fit, result.joints[i]);
    result.joints[i].coupled_to.clear();
    describe_logs(logs[i], wrist[i].design, stacked_target(logs[i]),
                  estimates(logs[i], wrist[i].design, result.joints[i]), result.joints[i]);
    if (i > 0) {
      const auto at = static_cast<Eigen::Index>(i) - 1;
      result.follow[i] = follow[at];
      result.follow_half[i] = half_interval(fit, kOwn * static_cast<Eigen::Index>(kWristAxes) + at);
    }
  }
  return result;
}

}  // namespace capstan::tools
