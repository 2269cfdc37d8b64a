// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/diagnose/split.hpp"

#include <algorithm>
#include <array>

namespace capstan::tools {
namespace {

constexpr std::array<Role, 10> kTurns = {Role::kFit,    Role::kChoose, Role::kReport, Role::kFit, Role::kFit,
                                         Role::kReport, Role::kChoose, Role::kFit,    Role::kFit, Role::kReport};
constexpr Eigen::Index kFewestRowsPerBlock = 40;

/// Of `count` cycles: the last quarter reports, the one before it chooses, the rest fits.
auto role_of_cycle(Eigen::Index cycle, Eigen::Index count) -> Role {
  const Eigen::Index reporting = std::max<Eigen::Index>(1, count / 4);
  const Eigen::Index choosing = std::max<Eigen::Index>(1, count / 5);
  if (cycle >= count - reporting) {
    return Role::kReport;
  }
  return cycle >= count - reporting - choosing ? Role::kChoose : Role::kFit;
}

void add_blocks(std::vector<RoleBlock>& blocks, RowRange rows, Eigen::Index count, Role role) {
  for (Eigen::Index i = 0; i < count; ++i) {
    blocks.push_back({{rows.begin + rows.size() * i / count, rows.begin + rows.size() * (i + 1) / count}, role});
  }
}

/// Leaves out rows that belong to no piece, and blocks of such rows alone.
void keep_inside(std::vector<RoleBlock>& blocks, const Blocks& pieces) {
  for (auto& block : blocks) {
    RowRange inside{block.rows.begin, block.rows.begin};
    for (const auto& piece : pieces) {
      if (block.rows.begin < piece.end && block.rows.end > piece.begin) {
        inside = {std::max(block.rows.begin, piece.begin), std::min(block.rows.end, piece.end)};
        break;
      }
    }
    block.rows = inside;
  }
  blocks.erase(std::remove_if(blocks.begin(), blocks.end(), [](const auto& block) { return block.rows.size() == 0; }),
               blocks.end());
}

/// Cuts the gap off the front of every block whose role differs from that of the block before it.
void open_gaps(std::vector<RoleBlock>& blocks, Eigen::Index gap) {
  for (std::size_t i = blocks.size(); i-- > 1;) {
    auto& block = blocks[i];
    const auto& before = blocks[i - 1];
    if (block.role != before.role && block.rows.begin == before.rows.end) {
      block.rows.begin = std::min(block.rows.begin + std::min(gap, block.rows.size() / 4), block.rows.end);
    }
  }
}

auto by_cycles(const Repeats& repeats) -> std::vector<RoleBlock> {
  std::vector<RoleBlock> blocks;
  const Eigen::Index per_cycle =
      std::clamp<Eigen::Index>(std::min(repeats.length / kFewestRowsPerBlock, 60 / repeats.count), 1, 15);
  for (Eigen::Index i = 0; i < repeats.count; ++i) {
    add_blocks(blocks, repeats.cycle(i), per_cycle, role_of_cycle(i, repeats.count));
  }
  return blocks;
}

auto by_turns(const Blocks& pieces) -> std::vector<RoleBlock> {
  constexpr Eigen::Index kMostBlocks = 60;
  const Eigen::Index total = rows_in(pieces);
  const Eigen::Index wanted = std::clamp<Eigen::Index>(total / kFewestRowsPerBlock / 10 * 10, 10, kMostBlocks);
  std::vector<RoleBlock> blocks;
  for (const auto& piece : pieces) {
    const Eigen::Index here = std::max<Eigen::Index>(1, wanted * piece.size() / total);
    for (Eigen::Index i = 0; i < here; ++i) {
      const Role role = kTurns[blocks.size() % kTurns.size()];
      blocks.push_back({{piece.begin + piece.size() * i / here, piece.begin + piece.size() * (i + 1) / here}, role});
    }
  }
  return blocks;
}

}  // namespace

auto Split::of(Role role) const -> Blocks {
  Blocks rows;
  for (const auto& block : blocks) {
    if (block.role == role) {
      rows.push_back(block.rows);
    }
  }
  return rows;
}

auto Split::learned() const -> Blocks {
  Blocks rows;
  for (const auto& block : blocks) {
    if (block.role != Role::kReport) {
      rows.push_back(block.rows);
    }
  }
  return rows;
}

auto split_rows(const SplitRequest& request) -> Split {
  constexpr Eigen::Index kCyclesForRoles = 3;  // with two, one role would have none
  const bool cycles = request.repeats && request.repeats->count >= kCyclesForRoles;
  Split split{cycles ? by_cycles(*request.repeats) : by_turns(request.pieces)};
  keep_inside(split.blocks, request.pieces);
  open_gaps(split.blocks, request.gap);
  return split;
}

auto refined(const Split& split, Eigen::Index factor) -> Split {
  Split result = split;
  for (auto& block : result.blocks) {
    block.rows = {block.rows.begin * factor, block.rows.end * factor};
  }
  return result;
}

}  // namespace capstan::tools
