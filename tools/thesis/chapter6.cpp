// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>

#include "capstan/tools/thesis/study.hpp"
#include "capstan/tools/thesis/thesis.hpp"

namespace capstan::tools {
namespace {

// What returns the printed alphas of an axis; each set was fitted on 24 Nov 2026 (Newton on the identification itself,
// left to 0.5 %). Jaws: stiffnesses and pretension to the two alphas of table 6.1 and KM of signal V in table 6.2.
// Pitch: to the two alphas and the mean goodness of fit of table 6.1, for table 6.2 has no pitch; again on 29 Nov 2026,
// when elongations came to be learned from rows of known direction alone.
struct Tendons {
  double top_n_per_m, bottom_n_per_m, pretension_n;
};
constexpr Tendons kPitch = {3.2902e4, 1.291e4, 11.36};
constexpr Tendons kRightJaw = {1.5584e4, 3.2508e4, 8.453};
constexpr Tendons kLeftJaw = {2.9581e4, 6.6567e4, 13.815};

// The same with drag in the tendons, fitted to KM of the right jaw's signal I too. The left jaw has the right one's
// drag: no drag makes its loop wide at signal I and narrow at V.
constexpr double kDragNsPerM = 303.6;
constexpr Tendons kRightJawWithDrag = {1.4565e4, 3.4182e4, 6.957};
constexpr Tendons kLeftJawWithDrag = {2.938e4, 6.655e4, 13.63};

// The same with pictures at the printed 30 Hz that come late instead, by what KM of signal I asks for.
constexpr Tendons kRightJawLate = {1.6374e4, 3.7536e4, 8.024};
constexpr Tendons kLeftJawLate = {3.0496e4, 9.0201e4, 11.845};
constexpr std::array<double, 2> kJawPictureDelayS = {0.016, 0.022};
constexpr double kWristPicturesHz = 30.0;
// By KM of signal IV of both jaws, 24 Nov 2026; PM and its goodness of fit of both are predicted.
constexpr double kPretensionOfIv = 1.72;
// How far off its zero a jaw stood where a run began, by the standard deviation of the left jaw's goodness of fit in
// table 6.1, 29 Nov 2026.
constexpr double kJawStoodOffDeg = 0.48;
// Rows of table 6.2: I and V of both jaws, by whose KM stiffness, pretension and delay were chosen, and V and IV.
const std::vector<std::size_t> kRowsOfIAndV = {0, 4, 5, 9};
const std::vector<std::size_t> kRowsOfV = {4, 9};
const std::vector<std::size_t> kRowsOfIv = {3, 8};

auto jaw_index(std::size_t axis) -> std::size_t {
  return axis - 1;
}

auto with_tendons(Study study, const Tendons& tendons) -> Study {
  auto& plant = study.instrument[study.axis].plant;
  plant.stiffness_top_n_per_m = tendons.top_n_per_m;
  plant.stiffness_bottom_n_per_m = tendons.bottom_n_per_m;
  plant.pretension_n = tendons.pretension_n;
  return study;
}

/// Four of the twelve experiments of 6.4, one of each amplitude.
auto wrist_identification() -> std::vector<sim::Motion> {
  std::vector<sim::Motion> motions;
  for (const double amplitude : {20.0, 15.0, 10.0, 7.0}) {
    motions.push_back(sine(amplitude, 0.1, 20.0));
  }
  return motions;
}

auto plain(std::size_t axis) -> Study {
  return {built_in("da_vinci_wrist"), axis, wrist_identification()};
}

auto without_pretension(Study study) -> Study {
  study.instrument[study.axis].plant.pretension_n = 0.2;
  return study;
}

struct Summary {
  std::array<double, 3> parameters;
  double mean, deviation;
};

auto summary_of(const Study& study, double FitQuality::*goodness) -> Summary {
  const StudyErrors errors = run_study(study, {});
  Summary s{thesis_parameters(errors.laws.thesis), 0.0, 0.0};
  const auto n = static_cast<double>(errors.identification.size());
  for (const SignalErrors& e : errors.identification) {
    s.mean += e.pm.*goodness / n;
  }
  for (const SignalErrors& e : errors.identification) {
    // The thesis has each of them three times.
    s.deviation += 3.0 * std::pow(e.pm.*goodness - s.mean, 2.0) / (3.0 * n - 1.0);
  }
  s.deviation = std::sqrt(s.deviation);
  return s;
}

}  // namespace

auto wrist_of_chapter_6() -> Instrument {
  Instrument axes = with_tendons(plain(1), kRightJawWithDrag).instrument;
  for (auto& axis : axes) {
    axis.plant.effects.transmission_viscous_forward_ns_per_m = kDragNsPerM;
    axis.plant.effects.transmission_viscous_backward_ns_per_m = kDragNsPerM;
  }
  return axes;
}

auto table_6_1() -> ThesisTable {
  struct Axis {
    const char* name;
    std::size_t axis;
    Tendons tendons;
    std::array<double, 5> printed;  // alpha_1, alpha_2, beta, mean and standard deviation of the goodness of fit
  };
  const std::vector<Axis> axes = {{"right jaw", 1, kRightJaw, {-1.907, -1.054, 1.109, 91.3, 3.78}},
                                  {"left jaw", 2, kLeftJaw, {-1.047, -0.541, 1.138, 92.8, 3.68}},
                                  {"pitch", 0, kPitch, {-0.424, -2.828, 0.996, 82.0, 9.64}}};
  ThesisTable table{"6.1", "da Vinci wrist (ch. 6): identified on sines of 0.1 Hz", {}, {}, {}};
  table.trials = {
      {"(5.29)", "stiffness by (5.29) and the pretension of ch. 2, as in the instrument file",
       "the fitted stiffness and pretension", "(5.29) is for an end load without pretension."},
      {"slack", "the fitted stiffness, next to no pretension", "the fitted pretension",
       "what a slack drive loses is the joint's friction alone."},
      {"play", "0.5 deg of play in the joint", "none", "a jaw on a pin has play, which no elongation describes."},
      {"noisy camera", "0.4 deg of noise, what a jitter of 0.22 mm makes of a lever of 32 mm", "0.1 deg",
       "noise takes more of the fit from small motions than from large ones."},
      {"stood off",
       "a tip that stood 0.48 deg off its zero where a run began",
       "on it",
       "where a joint stops after a swing differs from run to run, and no law of the chapter has an offset.",
       {{1, "gof_deviation"}}},
      {"as written", "GoF over the spread of the estimate, as 6.4 writes it", "over that of the measurement",
       "6.4 divides by the estimate's spread, and in a small motion the law makes more of it than the joint does."}};
  for (const char* group :
       {"printed", "simulated", "(5.29)", "slack", "play", "noisy camera", "stood off", "as written"}) {
    table.columns.push_back({group, "alpha_1", "alpha_1", "rad/(N m)", 3});
    table.columns.push_back({group, "alpha_2", "alpha_2", "rad/(N m)", 3});
    table.columns.push_back({group, "beta", "beta", "1", 3});
    table.columns.push_back({group, "gof_mean", "GoF", "%", 1});
    table.columns.push_back({group, "gof_deviation", "its std", "%", 2});
  }
  for (const Axis& a : axes) {
    ThesisTable::Row row{a.name, {a.printed.begin(), a.printed.end()}, {"alpha_1", "alpha_2"}};
    if (a.axis == 0) {
      row.fitted.emplace_back("gof_mean");
    }
    const Study fitted = with_tendons(plain(a.axis), a.tendons);
    Study play = fitted;
    play.instrument[a.axis].plant.effects.play_half_width_rad = 0.25 / 57.29577951308232;
    Study noisy = fitted;
    noisy.instrument[a.axis].plant.camera_noise_rad = 0.007;
    Study stood_off = fitted;
    stood_off.stood_off_deg = kJawStoodOffDeg;
    const auto append = [&](const Study& study, double FitQuality::*goodness) {
      const Summary s = summary_of(study, goodness);
      row.values.insert(row.values.end(), s.parameters.begin(), s.parameters.end());
      row.values.insert(row.values.end(), {s.mean, s.deviation});
    };
    for (const Study& study : {fitted, plain(a.axis), without_pretension(fitted), play, noisy, stood_off}) {
      append(study, &FitQuality::gof_percent);
    }
    append(fitted, &FitQuality::gof_as_written_percent);
    table.rows.push_back(std::move(row));
  }
  table.conditions = {
      "Fitted (f): stiffness of both tendons to the alphas, pretension of a jaw to KM of its signal V in table 6.2 and "
      "of the pitch to its mean GoF. K_r and K_l, 0.674 and 0.664, are in the instrument file by their printed values.",
      "Why plants made by (5.29) return smaller alphas: (5.29) is for one tendon under an end load without pretension, "
      "alpha = -(1 - exp(-eta)) / (r1 r2 eta K). With both tendons taut and a free tip, tau is all friction and the "
      "two "
      "tendons share the stretch: x = 1/K_t and y = 1/K_b give alpha_t = -(A x - B y) / (4 r1 r2 sinh eta) and alpha_b "
      "= "
      "-(A y - B x) / (4 r1 r2 sinh eta) with A = (exp(eta) - 1) / eta and B = (1 - exp(-eta)) / eta; for equal "
      "tendons "
      "that is tanh(eta/2) / (2 (1 - exp(-eta))) = 0.38 of (5.29). Both agree with 15.6 and 32.5 kN/m and 8.5 N of "
      "pretension for the right jaw, 29.6 and 66.6 kN/m and 13.8 N for the left. No stiffness does with the 27.7 N of "
      "chapter 2's grasper in the right jaw: its loop would be wider than sines of 7 deg."};
  return table;
}

auto table_6_2() -> ThesisTable {
  struct Tones {
    const char* name;
    std::vector<double> frequencies_hz;
    double duration_s;
    std::array<FitQuality, 2> km, pm;  // right, left
  };
  const std::vector<Tones> all = {
      {"I",
       {0.2, 0.5, 0.8, 1.1, 1.4, 1.7, 2.0, 2.3},
       20.0,
       {{{4.0539, 59.4}, {3.6706, 58.1}}},
       {{{1.1175, 88.8}, {1.7892, 79.6}}}},
      {"II",
       {0.4, 0.7, 1.0, 1.3, 1.6, 1.9, 2.2},
       20.0,
       {{{4.060, 56.5}, {3.9115, 62.0}}},
       {{{1.083, 88.4}, {1.3599, 86.8}}}},
      {"III", {0.05, 0.1, 1.0}, 20.0, {{{3.1377, 72.1}, {2.5800, 76.0}}}, {{{1.2733, 88.7}, {1.3295, 87.6}}}},
      {"IV", {0.05, 0.25, 0.45, 0.65}, 20.0, {{{2.7831, 60.5}, {2.1206, 68.2}}}, {{{1.5760, 77.6}, {1.3704, 79.4}}}},
      {"V", {0.05, 0.07, 0.09}, 100.0, {{{2.012, 80.9}, {1.6037, 85.2}}}, {{{0.8222, 92.2}, {0.6593, 93.9}}}}};
  ThesisTable table;
  std::vector<std::string> conditions = {
      "Drag is in the plant of both jaws: 304 N s/m over a tendon's length, fitted to KM of the right jaw's signal I "
      "(f). Stiffness and pretension are fitted to the alphas of table 6.1 and to KM of signal V (f). The rest is "
      "predicted."};
  for (std::size_t axis = 1; axis <= 2; ++axis) {
    const std::size_t jaw = jaw_index(axis);
    Study study = with_tendons(plain(axis), jaw == 0 ? kRightJawWithDrag : kLeftJawWithDrag);
    auto& plant = study.instrument[axis].plant;
    study.drag = true;
    const auto& radii = plant;
    const std::string name = jaw == 0 ? "right jaw " : "left jaw ";
    std::vector<Signal> signals;
    for (const Tones& t : all) {
      signals.push_back(multisine_signal(name + t.name, t.frequencies_hz, t.duration_s, t.km[jaw], t.pm[jaw], radii));
    }
    study.identification.clear();
    study.identification_signals = {signals.front()};
    Study no_drag = with_tendons(study, jaw == 0 ? kRightJaw : kLeftJaw);
    Study late = with_tendons(study, jaw == 0 ? kRightJawLate : kLeftJawLate);
    late.late_s = kJawPictureDelayS[jaw];
    late.instrument[axis].plant.camera_rate_hz = kWristPicturesHz;
    late.extra_terms = {"transport_delay"};
    plant.effects.transmission_viscous_forward_ns_per_m = kDragNsPerM;
    plant.effects.transmission_viscous_backward_ns_per_m = kDragNsPerM;
    Study noisy = late;
    noisy.instrument[axis].plant.camera_noise_rad = 0.014;
    Study tighter = late;
    tighter.pretension_of_signals = kPretensionOfIv;
    const std::vector<StudyTrial> tried = {
        {{"late camera", "pictures at 30 Hz that come 16 ms (right) and 22 ms (left) late", "drag in the tendons",
          "a late picture errs with speed as drag does, and fits more rows with the same number of unknowns.",
          fitted_places("km", kRowsOfIAndV)},
         late},
        {{"no drag", "no drag", "304 N s/m", "what grows with speed is the tendons' drag.",
          fitted_places("km", kRowsOfV)},
         no_drag},
        {{"noisy camera", "late pictures with 0.8 deg of noise, what a jitter of 0.22 mm makes of a marker of 16 mm",
          "0.1 deg and drag", "the camera's own noise is in every printed error, and PM has least else.",
          fitted_places("km", kRowsOfIAndV)},
         noisy},
        {{"tighter", "late pictures, and 72 % more pretension in this run than in that of identification", "the same",
          "the loop of this run is wider than that of its neighbours in frequency, and pretension drifts between "
          "runs.",
          fitted_places("km", kRowsOfIv)},
         tighter,
         {3}}};
    if (jaw == 0) {
      table = estimation_table("6.2", "da Vinci wrist (ch. 6): both jaws, dynamic law (6.21), RMSE", tried, false);
    }
    const StudyErrors errors = add_rows(table, signals, study, tried).front();
    conditions.push_back(name + "identified on I: " + parameter_line(errors.laws.thesis));
    const std::size_t first = 5 * jaw;
    if (jaw == 0) {
      table.rows[first].fitted = fitted_keys("km");
    }
    table.rows[first + 4].fitted = fitted_keys("km");
  }
  table.conditions = std::move(conditions);
  return table;
}

}  // namespace capstan::tools
