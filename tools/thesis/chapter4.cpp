// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/thesis/chapter4.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "capstan/hal/sim/plant.hpp"
#include "capstan/model/preisach.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"
#include "capstan/tools/thesis/thesis.hpp"

namespace capstan::tools {
namespace {

constexpr double kSlowVPerS = 1.0;
constexpr int kReadEveryMs = 10;
constexpr std::uint64_t kSeed = 400;
// Two steps of noise of the force sensor, about the joint: what may fall along a curve without being one.
constexpr double kToleranceNm = 1e-3;

class Forceps {
 public:
  explicit Forceps(const ForcepsNumbers& numbers = {})
      : plant_(locked(numbers), kSeed), saturates_at_v_(numbers.saturates_at_v) {}

  /// 10 ms towards `volts`; what the force sensor shows over them on average, N m.
  auto hold(double volts) -> double {
    double sum = 0.0;
    const double start = volts_;
    for (int i = 1; i <= kReadEveryMs; ++i) {
      volts_ = start + (volts - start) * i / kReadEveryMs;
      const double driven = std::clamp(volts_, -saturates_at_v_, saturates_at_v_);
      plant_.step(driven * kTorquePerVolt / plant_.parameters().torque_constant_nm_per_a, true);
      sum += plant_.truth().tip_torque_nm / kReadEveryMs;
    }
    return sum;
  }
  /// Slowly to `volts`, a row for every 10 ms.
  template <typename Row>
  auto go(double volts, Row&& row) -> double {
    const double step = kSlowVPerS * 0.001 * kReadEveryMs;
    double torque = hold(volts_);
    row(volts_, torque);
    while (std::fabs(volts - volts_) > 1e-9) {
      torque = hold(volts_ + std::clamp(volts - volts_, -step, step));
      row(volts_, torque);
    }
    return torque;
  }
  auto go(double volts) -> double {
    return go(volts, [](double, double) {});
  }
  [[nodiscard]] auto q1_rad() const -> double {
    return 2.0 * std::numbers::pi / plant_.parameters().encoder_counts_per_turn * plant_.readings().encoder_counts;
  }

 private:
  static auto locked(const ForcepsNumbers& numbers) -> sim::PlantParameters {
    sim::PlantParameters p;
    p.eta_top *= numbers.friction;
    p.eta_bottom *= numbers.friction;
    p.pretension_n = numbers.pretension_n;
    p.environment.kind = sim::EnvironmentKind::kLocked;
    return p;
  }
  sim::Plant plant_;
  double saturates_at_v_;
  double volts_ = 0.0;
};

// The best of 36 frictions and pretensions at each of 3.2, 3.39 and 3.6 V, by the mean difference from table 4.1, 24
// Nov 2026; neighbours differ by half as much again, for where loops fall between levels is chance.
constexpr ForcepsNumbers kOwnForceps = {0.4, 22.0, 3.6};

auto input_v(std::size_t signal, double t) -> double {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  if (signal == 0) {
    return 2.0 * std::sin(kTurn * t / 10.0) + 2.0 * std::sin(kTurn * t / 30.0 + std::numbers::pi);
  }
  if (signal == 1) {
    return 2.0 * std::sin(kTurn * t / 10.0) + 2.0 * std::sin(kTurn * t / 11.0);
  }
  double sum = 0.0;
  for (int k = 1; k <= 4; ++k) {
    sum += std::sin(kTurn * t / (10.0 * k));
  }
  return sum;
}

struct ForceErrors {
  double largest, rms;
};

auto errors_of(const ForceSurface& surface, const ForceRun& run) -> ForceErrors {
  const Eigen::VectorXd error = preisach_estimate(surface, run) - run.torque_nm;
  return {error.cwiseAbs().maxCoeff(), rms(error)};
}

}  // namespace

auto run_of_chapter_4(std::size_t signal, const ForcepsNumbers& numbers) -> ForceRun {
  constexpr std::array<double, 3> kSeconds = {60.0, 110.0, 120.0};
  Forceps forceps(numbers);
  forceps.go(-kSaturationV);
  const auto rows = static_cast<Eigen::Index>(kSeconds[signal] * 1000.0 / kReadEveryMs);
  ForceRun run{Eigen::VectorXd(rows), Eigen::VectorXd(rows), Eigen::VectorXd(rows), Eigen::VectorXd(rows)};
  forceps.go(input_v(signal, 0.0));
  for (Eigen::Index i = 0; i < rows; ++i) {
    run.time_s[i] = 0.001 * kReadEveryMs * static_cast<double>(i);
    run.input_v[i] = input_v(signal, run.time_s[i]);
    run.torque_nm[i] = forceps.hold(run.input_v[i]);
    run.q1_rad[i] = forceps.q1_rad();
  }
  return run;
}

auto reversal_run(std::size_t levels) -> ForceRun {
  Forceps forceps;
  std::vector<double> volts, torque, q1;
  const auto record = [&](double v, double t) {
    volts.push_back(v);
    torque.push_back(t);
    q1.push_back(forceps.q1_rad());
  };
  forceps.go(-kSaturationV);
  for (std::size_t peak = levels; peak-- > 1;) {
    forceps.go(kSaturationV * (2.0 * static_cast<double>(peak) / static_cast<double>(levels - 1) - 1.0), record);
    forceps.go(-kSaturationV, record);
  }
  const auto rows = static_cast<Eigen::Index>(volts.size());
  const auto column = [rows](const std::vector<double>& values) -> Eigen::VectorXd {
    return Eigen::Map<const Eigen::VectorXd>(values.data(), rows);
  };
  const double seconds = 0.001 * kReadEveryMs * static_cast<double>(rows - 1);
  return {Eigen::VectorXd::LinSpaced(rows, 0.0, seconds), column(volts), column(torque), column(q1)};
}

auto fitted_surface(const ForceRun& run, const PreisachGrid& grid) -> ForceSurface {
  AxisLog log;
  log.name = "4.1";
  log.time_s = run.time_s;
  log.q1_rad = run.q1_rad;
  log.tau_nm = run.input_v;
  log.effort = run.torque_nm;
  return fit_preisach({log}, grid).table;
}

auto share_of(const Eigen::VectorXd& estimate_nm, const ForceRun& run) -> double {
  return 100.0 * rms(estimate_nm - run.torque_nm) / run.torque_nm.cwiseAbs().maxCoeff();
}

auto measured_surface(std::size_t levels, const ForcepsNumbers& numbers) -> ForceSurface {
  ForceSurface surface;
  surface.levels = static_cast<std::uint32_t>(levels);
  for (std::size_t i = 0; i < levels; ++i) {
    surface.inputs[i] = kSaturationV * (2.0 * static_cast<double>(i) / static_cast<double>(levels - 1) - 1.0);
  }
  Forceps forceps(numbers);
  double lowest = forceps.go(-kSaturationV);
  for (std::size_t peak = levels; peak-- > 0;) {
    forceps.go(-kSaturationV);
    double last = forceps.go(surface.inputs[peak]);
    surface.set_force(peak, peak, last);
    for (std::size_t valley = peak; valley-- > 0;) {
      // The sensor's noise must not make a curve rise on its way down.
      last = std::min(last, forceps.go(surface.inputs[valley]));
      surface.set_force(peak, valley, last);
    }
  }
  // One lower saturation for all curves, as the model has it.
  for (std::size_t peak = 0; peak < levels; ++peak) {
    lowest = std::min(lowest, surface.force(peak, 0));
  }
  for (std::size_t peak = 0; peak < levels; ++peak) {
    surface.set_force(peak, 0, lowest);
    for (std::size_t valley = 1; valley <= peak; ++valley) {
      const double below = valley < peak && peak > 0 ? surface.force(peak - 1, valley) : lowest;
      surface.set_force(peak, valley, std::max({surface.force(peak, valley), surface.force(peak, valley - 1), below}));
    }
  }
  return surface;
}

auto preisach_estimate(const ForceSurface& surface, const ForceRun& run) -> Eigen::VectorXd {
  Preisach<double, kMostLevels> law(surface, StartState::kNegativeSaturation, kToleranceNm);
  Eigen::VectorXd estimate(run.input_v.size());
  for (Eigen::Index i = 0; i < estimate.size(); ++i) {
    estimate[i] = law.update(run.input_v[i]).force;
  }
  return estimate;
}

auto table_4_1() -> ThesisTable {
  constexpr std::array<std::array<double, 3>, 3> kPrinted = {
      {{6.40, 0.55, 0.15}, {6.16, 0.60, 0.22}, {5.48, 0.59, 0.22}}};
  ThesisTable table{"4.1",
                    "EndoWrist forceps (ch. 4), simulated as ch. 2's grasper with a locked tip: force by the classical "
                    "Preisach model",
                    {},
                    {},
                    {}};
  table.trials = {
      {"21 levels", "21 levels", "11", "the grid of 1 V is coarse beside the loops."},
      {"41 levels", "41 levels", "11", "the grid of 1 V is coarse beside the loops."},
      {"own numbers",
       "0.4 of the grasper's friction, 22 N of pretension, a drive that saturates at 3.6 V",
       "the grasper's numbers, no saturation",
       "chapter 4's forceps is another instrument than chapter 2's grasper, and the thesis says that its "
       "output saturates within the 5 V.",
       {{0, "largest"}, {0, "rms"}, {1, "largest"}, {1, "rms"}, {2, "magnitude"}, {2, "largest"}, {2, "rms"}}}};
  for (const char* group : {"printed", "simulated", "21 levels", "41 levels", "own numbers"}) {
    table.columns.push_back({group, "magnitude", "magnitude", "N", 2});
    table.columns.push_back({group, "largest", "max error", "N", 2});
    table.columns.push_back({group, "rms", "RMS", "N", 3});
    table.columns.push_back({group, "share", "RMS share", "%", 1, true});
  }
  const std::array<ForceSurface, 3> surfaces = {measured_surface(11), measured_surface(21), measured_surface(41)};
  const ForceSurface own_surface = measured_surface(11, kOwnForceps);
  double newton_per_nm = 0.0;
  double own_newton_per_nm = 0.0;
  for (std::size_t s = 0; s < kPrinted.size(); ++s) {
    const ForceRun run = run_of_chapter_4(s);
    const double magnitude = run.torque_nm.cwiseAbs().maxCoeff();
    const ForceRun own_run = run_of_chapter_4(s, kOwnForceps);
    const double own_magnitude = own_run.torque_nm.cwiseAbs().maxCoeff();
    if (s == 0) {
      newton_per_nm = kPrinted[0][0] / magnitude;
      own_newton_per_nm = kPrinted[0][0] / own_magnitude;
    }
    const auto& p = kPrinted[s];
    ThesisTable::Row row{"u" + std::to_string(s + 1), {p[0], p[1], p[2], 100.0 * p[2] / p[0]}};
    for (const ForceSurface& surface : surfaces) {
      const ForceErrors e = errors_of(surface, run);
      row.values.insert(row.values.end(), {magnitude * newton_per_nm, e.largest * newton_per_nm, e.rms * newton_per_nm,
                                           100.0 * e.rms / magnitude});
    }
    const ForceErrors own = errors_of(own_surface, own_run);
    row.values.insert(row.values.end(), {own_magnitude * own_newton_per_nm, own.largest * own_newton_per_nm,
                                         own.rms * own_newton_per_nm, 100.0 * own.rms / own_magnitude});
    if (s == 0) {
      row.fitted = {"magnitude"};
    }
    table.rows.push_back(std::move(row));
  }
  table.conditions = {
      "The lever from joint to force sensor is not printed: fitted to the magnitude of u1 (f), " +
          rounded(1000.0 / newton_per_nm, 3) +
          " mm; the other magnitudes are predicted. Torque per volt: 0.06228 N m of "
          "figure 2.10 for the 2 V of these signals. Every run starts from the lower saturation.",
      "The trial with own numbers has three, chosen on a grid by the errors and the magnitude of u3 of this "
      "table: the magnitude of u2 is all that it foretells, and how u1, u2 and u3 share the errors."};
  return table;
}

}  // namespace capstan::tools
