// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>

#include "capstan/model/trigonometry.hpp"

namespace capstan {

/// The links of a wrist like the da Vinci's (thesis 6.3.1), from its pitch axis to the tip of a jaw.
template <typename Scalar>
struct JawLinks {
  Scalar pitch_to_jaw_m{};  ///< l1, between the axes of pitch and jaws
  Scalar jaw_m{};           ///< l2, jaw axis to tip
  Scalar offset_m{};        ///< d, of the tip along the jaw axis
};

/// Where the tip of a jaw is, m, from the pitch axis: x along the shaft, z along the pitch axis.            (6.12)
/// In fixed point to a unit of rounding a product, some 0.2 um.  @param pitch_rad, jaw_rad  any angle
template <typename Scalar>
auto jaw_tip(const JawLinks<Scalar>& links, Scalar pitch_rad, Scalar jaw_rad) -> std::array<Scalar, 3> {
  const PhaseScale<Scalar> in_rad(ScalarTraits<Scalar>::from(1.0));
  const auto [sp, cp] = in_rad(pitch_rad).sine_and_cosine();
  const auto [sj, cj] = in_rad(jaw_rad).sine_and_cosine();
  const Scalar reach_m = links.pitch_to_jaw_m + links.jaw_m * cj;
  return {cp * reach_m - links.offset_m * sp, sp * reach_m + links.offset_m * cp, -(links.jaw_m * sj)};
}

using Vector3 = std::array<double, 3>;
/// Of a jaw's frame, row by row: its columns are the jaw, across it, and the jaws' axis.                   (6.11)
using Rotation = std::array<Vector3, 3>;

struct WristAngles {
  double pitch;
  double jaw;
};

/// The angles behind a measured rotation: those whose (6.11) is nearest to it, all its entries counted, so that noise
/// of the single entries averages. Exact for an exact rotation. Each angle in closed form with the other held; the sum
/// that they maximise rises every time, and two or three rounds settle it. Host only.
inline auto angles_of(const Rotation& r) -> WristAngles {
  constexpr int kRounds = 20;
  double jaw = std::atan2(-r[2][0], -r[2][1]);
  double pitch = std::atan2(-r[0][2], r[1][2]);
  for (int i = 0; i < kRounds; ++i) {
    const double cj = std::cos(jaw);
    const double sj = std::sin(jaw);
    pitch = std::atan2(cj * r[1][0] - sj * r[1][1] - r[0][2], cj * r[0][0] - sj * r[0][1] + r[1][2]);
    const double cp = std::cos(pitch);
    const double sp = std::sin(pitch);
    jaw = std::atan2(-cp * r[0][1] - sp * r[1][1] - r[2][0], cp * r[0][0] + sp * r[1][0] - r[2][1]);
  }
  return {pitch, jaw};
}

}  // namespace capstan
