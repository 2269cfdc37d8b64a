// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "capstan/tools/diagnose/repeats.hpp"

namespace capstan::tools {

/// What a stretch of the log is for. Decided once, before anything is fitted.
enum class Role { kFit, kChoose, kReport };

struct RoleBlock {
  RowRange rows;
  Role role = Role::kFit;
};

/// The log cut into blocks with gaps between different roles, so that no noise is shared across. With repeats the roles
/// go by whole cycles; otherwise they take turns, half of the blocks to fit, a fifth to choose, three tenths to report.
struct Split {
  std::vector<RoleBlock> blocks;
  [[nodiscard]] auto of(Role role) const -> Blocks;
  /// Fit and choose together: everything but what is reported on.
  [[nodiscard]] auto learned() const -> Blocks;
};

struct SplitRequest {
  Blocks pieces;  ///< evenly sampled stretches (logs), warm-up left out
  std::optional<Repeats> repeats;
  Eigen::Index gap = 0;  ///< rows
};

auto split_rows(const SplitRequest& request) -> Split;

/// The same split on a grid `factor` times finer; a coarse row i covers fine rows i factor .. (i + 1) factor - 1.
auto refined(const Split& split, Eigen::Index factor) -> Split;

}  // namespace capstan::tools
