// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/loop_course.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/identify/loop.hpp"
#include "capstan/tools/identify/tendon_fit.hpp"

namespace capstan::tools {
namespace {

/// The rows of the blocks that are `begin` to `end` of all of them, counted through.
auto share_of(const Blocks& blocks, Eigen::Index begin, Eigen::Index end) -> Blocks {
  Blocks share;
  Eigen::Index before = 0;
  for (const auto& block : blocks) {
    const RowRange here{block.begin + std::max<Eigen::Index>(0, begin - before),
                        std::min(block.end, block.begin + end - before)};
    if (here.begin < here.end) {
      share.push_back(here);
    }
    before += block.size();
  }
  return share.size() > 1 ? share : even_parts(share, 2);
}

auto loop_in(const Preparation& p, const LawForm& loop, const Blocks& rows) -> Loop {
  const LawForm now = refine_shapes(p.noncausal, p.target, rows, loop);
  return {half_width_of(now), friction_torque(p.noncausal, rows)};
}

}  // namespace

auto course_of(const Preparation& p, const LawForm& loop) -> Course {
  constexpr Eigen::Index kParts = 5;
  constexpr double kMost = 2.0;
  const Blocks rows = p.certain();
  const Eigen::Index all = rows_in(rows);
  const auto part = [&](Eigen::Index i) {
    return loop_in(p, loop, share_of(rows, all * i / kParts, all * (i + 1) / kParts));
  };
  const Loop first = part(0);
  const Loop middle = part(kParts / 2);
  const Loop last = part(kParts - 1);
  return {last.half_width_rad / first.half_width_rad, last.torque_nm / first.torque_nm,
          std::abs(middle.half_width_rad - first.half_width_rad) >
              kMost * std::abs(last.half_width_rad - middle.half_width_rad)};
}

}  // namespace capstan::tools
