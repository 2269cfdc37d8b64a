// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "capstan/model/tendon.hpp"

namespace capstan {

/// A tendon's way over idlers, pulley by pulley: the reference that the curved surface replaces (thesis 1.5, 5.2.1).
/// Steady slow motion, creep theory. Host only.
struct Idler {
  double wrap_rad;          ///< Gamma, 0 to pi
  double radius_ratio;      ///< bore r' over pulley r, 0 to 1
  double joint_friction;    ///< mu_J in the bore, 0 and more
  double surface_friction;  ///< mu_s between tendon and pulley, above 0
  double radius_m = 0.0;    ///< r; 0: what lies on the pulley does not count as tendon that stretches
};
/// A surface that stands still is an idler whose bearing holds it.
inline constexpr double kSeizedBearing = 2.0;

/// T2 / T1 across an idler, T1 the larger: the root of (5.7) below 1, unless the tendon would rather slide over a
/// pulley that stands still, (5.1) with Phi = Gamma.
inline auto idler_ratio(const Idler& idler) -> double {
  const double root_kappa = idler.joint_friction * idler.radius_ratio;
  const double kappa = root_kappa * root_kappa;
  const double slides = std::exp(-idler.surface_friction * idler.wrap_rad);
  if (kappa >= 1.0) {
    return slides;
  }
  // rho^2 - 2 h rho + 1 = 0 with h - 1 = kappa (1 - cos Gamma) / (1 - kappa): written so that little friction keeps its
  // digits.
  const double half_sine = std::sin(0.5 * idler.wrap_rad);
  const double above_one = 2.0 * kappa * half_sine * half_sine / (1.0 - kappa);
  const double rho = 1.0 / (1.0 + above_one + std::sqrt(above_one * (2.0 + above_one)));
  return rho > slides ? rho : slides;
}

/// The slip arc that the idler is equal to, rad: fixed, whatever the tension (5.2.1). At most Gamma.
inline auto slip_arc(const Idler& idler) -> double {
  return -std::log(idler_ratio(idler)) / idler.surface_friction;
}

/// One run from input to output pulley: n idlers between n + 1 free spans, m, in this order.
struct BeltRun {
  std::span<const Idler> idlers;
  std::span<const double> spans_m;
};

/// How tension goes along a run that moves: T = T_in times factors. `end` is that of the last span, `weighted` the sum
/// of span lengths times factors, m.
struct RunShape {
  double end;
  double weighted_m;
};

/// Tendon on a pulley times its tension's factor, m: at the lower tension until it slips, then along (5.1) up to the
/// higher. Motion meets the lower first, whichever way it goes.
inline auto weighted_arc(const Idler& idler, double one_end, double other_end) -> double {
  const double slips = slip_arc(idler);
  const double high = std::fmax(one_end, other_end);
  const double low = std::fmin(one_end, other_end);
  return idler.radius_m * ((idler.wrap_rad - slips) * low + slips * high * mean_decay(idler.surface_friction * slips));
}

/// Span by span. @param s  +1 the run moves toward the input, tension falls along it; -1 the other way
inline auto exact_shape(const BeltRun& run, double s) -> RunShape {
  double factor = 1.0;
  double sum = run.spans_m[0];
  for (std::size_t i = 0; i < run.idlers.size(); ++i) {
    const double rho = idler_ratio(run.idlers[i]);
    const double before = factor;
    factor *= s > 0.0 ? rho : 1.0 / rho;
    sum += weighted_arc(run.idlers[i], before, factor) + run.spans_m[i + 1] * factor;
  }
  return {factor, sum};
}

inline auto length_of(const BeltRun& run) -> double {
  double sum = 0.0;
  for (const double span : run.spans_m) {
    sum += span;
  }
  for (const Idler& idler : run.idlers) {
    sum += idler.radius_m * idler.wrap_rad;
  }
  return sum;
}

/// The friction-bending number of the surface that a run is replaced by.
inline auto equivalent_eta(const BeltRun& run) -> double {
  double sum = 0.0;
  for (const Idler& idler : run.idlers) {
    sum -= std::log(idler_ratio(idler));
  }
  return sum;
}

/// The same run as one curved surface (5.2.1): right at the ends, spread evenly between.
inline auto surface_shape(const BeltRun& run, double s) -> RunShape {
  const double eta = equivalent_eta(run);
  return {std::exp(-eta * s), length_of(run) * mean_decay(eta * s)};
}

struct BeltDrive {
  double r1;        ///< input radius, m
  double r2;        ///< output radius, m
  double axial_n;   ///< E A, N
  double preset_n;  ///< T_s, tension at rest, N
  BeltRun top;
  BeltRun bottom;
};

struct BeltState {
  double top_in_n, top_out_n, bottom_in_n, bottom_out_n;
  double torque_out_nm;
  double joint_shift_rad;  ///< q2 - (r1 / r2) q1
  bool one_slack;
};

/// Input torque to everything else, motion in direction s: (2.11) at both pulleys, the shapes along the runs, and
/// compatibility (5.6), sum l_i T_i = L_t T_s, as long as nothing is slack.
inline auto solve_belt(const BeltDrive& drive, const RunShape& top, const RunShape& bottom, double torque_in_nm)
    -> BeltState {
  const double top_length = length_of(drive.top);
  const double total = (top_length + length_of(drive.bottom)) * drive.preset_n;
  const double x = torque_in_nm / drive.r1;
  double bottom_in = (total - top.weighted_m * x) / (top.weighted_m + bottom.weighted_m);
  double top_in = bottom_in + x;
  const bool one_slack = bottom_in < 0.0 || top_in < 0.0;
  if (one_slack) {
    top_in = x > 0.0 ? x : 0.0;
    bottom_in = x > 0.0 ? 0.0 : -x;
  }
  const double top_out = top_in * top.end;
  const double bottom_out = bottom_in * bottom.end;
  // The joint hangs on whichever run is taut.
  const double shift = x > 0.0 || !one_slack ? -(top_in * top.weighted_m - top_length * drive.preset_n)
                                             : bottom_in * bottom.weighted_m - length_of(drive.bottom) * drive.preset_n;
  return {
      top_in,   top_out, bottom_in, bottom_out, (top_out - bottom_out) * drive.r2, shift / (drive.axial_n * drive.r2),
      one_slack};
}

inline auto solve_exactly(const BeltDrive& drive, double torque_in_nm, double s) -> BeltState {
  return solve_belt(drive, exact_shape(drive.top, s), exact_shape(drive.bottom, -s), torque_in_nm);
}
inline auto solve_as_surfaces(const BeltDrive& drive, double torque_in_nm, double s) -> BeltState {
  return solve_belt(drive, surface_shape(drive.top, s), surface_shape(drive.bottom, -s), torque_in_nm);
}

/// The input torque at which solve_belt gives this output torque, N m.
inline auto torque_in_for(const BeltDrive& drive, const RunShape& top, const RunShape& bottom, double torque_out_nm)
    -> double {
  const double total = (length_of(drive.top) + length_of(drive.bottom)) * drive.preset_n;
  const double y = torque_out_nm / drive.r2;
  const double bottom_in =
      (total - top.weighted_m * y / top.end) / (bottom.weighted_m + top.weighted_m * bottom.end / top.end);
  const double top_in = (y + bottom_in * bottom.end) / top.end;
  if (bottom_in < 0.0 || top_in < 0.0) {
    return drive.r1 * y / (y > 0.0 ? top.end : bottom.end);
  }
  return drive.r1 * (top_in - bottom_in);
}

/// Torque that arrives at a held joint per radian that it would turn by the motor, N m/rad: of (3.20) what reaches the
/// output. A slack run adds nothing.
inline auto arriving_stiffness(const BeltDrive& drive, const RunShape& top, const RunShape& bottom,
                               const BeltState& state) -> double {
  const double top_share = state.top_in_n > 0.0 ? top.end / top.weighted_m : 0.0;
  const double bottom_share = state.bottom_in_n > 0.0 ? bottom.end / bottom.weighted_m : 0.0;
  return drive.r2 * drive.r2 * drive.axial_n * (top_share + bottom_share);
}

}  // namespace capstan
