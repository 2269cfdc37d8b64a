// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/machines/plain_fits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "capstan/tests/tools/machines/plain_columns.hpp"
#include "capstan/tests/tools/play_operator.hpp"
#include "capstan/tools/identify/least_squares.hpp"

namespace capstan::tools::machines {
namespace {

/// What the fits share: the log's signals and plays of many widths.
struct Signals {
  explicit Signals(const AxisLog& log) : q(log.q1_rad), y(log.q2_rad), one(Eigen::VectorXd::Ones(q.size())) {
    const double range = q.maxCoeff() - q.minCoeff();
    plays.push_back(q);
    for (const double width : geometric(range / 400.0, range / 2.02, 48)) {
      plays.push_back(test::play_of(q, width));
    }
    if (log.has_torque) {
      tau = log.tau_nm;
    }
    for (const auto& other : log.others) {
      others.push_back(other.q1_rad);
      const double way = other.q1_rad.maxCoeff() - other.q1_rad.minCoeff();
      of_others.emplace_back();
      for (const double width : geometric(way / 50.0 + 1e-9, way / 2.1 + 1e-9, 8)) {
        of_others.back().push_back(test::play_of(other.q1_rad, width));
      }
    }
  }
  Eigen::VectorXd q, y, one, tau;
  Columns plays, others;
  std::vector<Columns> of_others;
};

/// The best of columns that are made with each of the plays.
auto best_play(const std::function<Columns(const Eigen::VectorXd&)>& make, const Signals& s, Eigen::Index rows,
               std::size_t step) -> Eigen::VectorXd {
  Eigen::VectorXd best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < s.plays.size(); i += step) {
    Eigen::VectorXd estimate = fitted(make(s.plays[i]), s.y, rows);
    if (const double left = rms_of(s.y - estimate, rows); left < least) {
      least = left;
      best = std::move(estimate);
    }
  }
  return best;
}

auto fourteen_plays(const Signals& s) -> Columns {
  Columns columns;
  for (std::size_t i = 0; i < 14; ++i) {
    columns.push_back(s.plays[i * (s.plays.size() - 1) / 13]);
  }
  return columns;
}

auto prandtl_ishlinskii(const Signals& s, Eigen::Index rows) -> Eigen::VectorXd {
  Columns columns = fourteen_plays(s);
  columns.push_back(s.one);
  const Eigen::MatrixXd all = side_by_side(columns);
  const Eigen::VectorXd q = s.q.head(rows).array() - s.q.head(rows).mean();
  const Sign sign = q.dot(s.y.head(rows)) < 0.0 ? Sign::kNonPositive : Sign::kNonNegative;
  std::vector<Sign> signs(14, sign);
  signs.push_back(Sign::kAny);
  const auto x = all.topRows(rows);
  return all * solve_signed(x.transpose() * x, x.transpose() * s.y.head(rows), signs);
}

void add_joints(const std::shared_ptr<Signals>& s, std::vector<PlainFit>& fits) {
  const auto with_others = [s](const Eigen::VectorXd& p) {
    Columns columns = {s->q, p, s->one};
    columns.insert(columns.end(), s->others.begin(), s->others.end());
    return columns;
  };
  fits.push_back({"play+joints", [=](Eigen::Index rows) { return best_play(with_others, *s, rows, 3); }});
  fits.push_back({"play+joints with play", [=](Eigen::Index rows) {
                    Eigen::VectorXd best;
                    for (std::size_t width = 0; width < s->of_others.front().size(); ++width) {
                      const auto make = [&](const Eigen::VectorXd& p) {
                        Columns columns = with_others(p);
                        for (const auto& plays : s->of_others) {
                          columns.push_back(plays[width]);
                        }
                        return columns;
                      };
                      Eigen::VectorXd estimate = best_play(make, *s, rows, 4);
                      if (best.size() == 0 || rms_of(s->y - estimate, rows) < rms_of(s->y - best, rows)) {
                        best = std::move(estimate);
                      }
                    }
                    return best;
                  }});
}

}  // namespace

auto plain_angle_fits(const AxisLog& log) -> std::vector<PlainFit> {
  const auto s = std::make_shared<Signals>(log);
  const auto play_fit = [&](const std::string& name, std::size_t step, auto make) -> PlainFit {
    return {name, [s, step, make](Eigen::Index rows) { return best_play(make, *s, rows, step); }};
  };
  std::vector<PlainFit> fits;
  fits.push_back({"affine", [s](Eigen::Index rows) { return fitted({s->q, s->one}, s->y, rows); }});
  fits.push_back(play_fit("play", 1, [s](const Eigen::VectorXd& p) { return Columns{p, s->one}; }));
  fits.push_back(play_fit("play+q", 1, [s](const Eigen::VectorXd& p) { return Columns{s->q, p, s->one}; }));
  fits.push_back(play_fit("play+cubic", 2, [s](const Eigen::VectorXd& p) {
    return Columns{s->q, p, p.array().square().matrix(), p.array().cube().matrix(), s->one};
  }));
  fits.push_back({"PI", [s](Eigen::Index rows) { return prandtl_ishlinskii(*s, rows); }});
  fits.push_back({"PI+cubic", [s](Eigen::Index rows) {
                    Columns columns = fourteen_plays(*s);
                    for (const auto& column :
                         {s->one, s->q.array().square().matrix().eval(), s->q.array().cube().matrix().eval()}) {
                      columns.push_back(column);
                    }
                    return fitted(columns, s->y, rows);
                  }});
  if (log.has_torque) {
    fits.push_back(play_fit("play+tau", 2, [s](const Eigen::VectorXd& p) { return Columns{s->q, p, s->tau, s->one}; }));
    fits.push_back({"affine+tau", [s](Eigen::Index rows) { return fitted({s->q, s->tau, s->one}, s->y, rows); }});
  }
  if (!s->others.empty()) {
    add_joints(s, fits);
  }
  return fits;
}

}  // namespace capstan::tools::machines
