// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/response/response_report.hpp"

#include <cmath>
#include <numbers>

#include "capstan/tools/report/html.hpp"
#include "capstan/tools/report/svg_plot.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr const char* kBandColour = "#bbb";
constexpr const char* kTunedColour = "#0f766e";
constexpr const char* kFrequency = "frequency [log10 Hz]";
constexpr const char* kStyle = R"(
body { font: 15px/1.5 sans-serif; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; color: #222 }
pre { background: #f1f5f9; padding: 1rem; overflow-x: auto }
svg { max-width: 100%; height: auto; display: block; margin: .5rem 0 }
)";

auto decibel(double gain) -> double {
  return 20.0 * std::log10(std::max(gain, 1e-9));
}

/// One value of each point over the logarithm of its frequency.
template <typename Points, typename Value>
auto series(const Points& points, const std::string& label, const char* colour, Value&& value) -> Series {
  Series one{label, colour, Eigen::VectorXd(points.size()), Eigen::VectorXd(points.size())};
  Eigen::Index i = 0;
  for (const auto& point : points) {
    one.x[i] = std::log10(point.hz);
    one.y[i++] = value(point);
  }
  return one;
}

/// Phase without jumps of a whole turn.
void unwrap(Series& phase) {
  for (Eigen::Index i = 1; i < phase.y.size(); ++i) {
    phase.y[i] -= 360.0 * std::round((phase.y[i] - phase.y[i - 1]) / 360.0);
  }
}

/// One response as the plots show it.
struct View {
  const Response* response;
  const char* label;
  const char* colour;
  const char* band;  ///< colour of its circles
};

/// Backward and forward by themselves where margins are taken of each.
auto shown_views(const Response& response) -> std::vector<View> {
  const std::vector<const Response*> views = views_of(response);
  if (views.size() == 1) {
    return {{views[0], "measured", "#444", kBandColour}};
  }
  return {{views[0], "backward", "#b45309", "#fcd9a8"}, {views[1], "forward", "#1d4ed8", "#bfdbfe"}};
}

auto bode(const std::vector<View>& views, const std::string& name, const std::string& unit,
          Estimate ResponsePoint::*which) -> std::vector<Plot> {
  Plot gain{.title = name + ": gain",
            .x_label = kFrequency,
            .y_label = "gain [dB of 1 " + unit + "]",
            .series = {},
            .y_range = {}};
  Plot phase{.title = name + ": phase", .x_label = kFrequency, .y_label = "phase [deg]", .series = {}, .y_range = {}};
  for (const View& view : views) {
    const auto& points = view.response->points;
    const std::string circle = views.size() == 1 ? "95 % circle" : "95 % circle " + std::string(view.label);
    gain.series.push_back(series(points, circle, view.band, [which](const ResponsePoint& p) {
      return decibel(std::abs((p.*which).value) + (p.*which).radius95);
    }));
    gain.series.push_back(series(points, "", view.band, [which](const ResponsePoint& p) {
      const double size = std::abs((p.*which).value);
      return decibel(std::max(size - (p.*which).radius95, 0.1 * size));
    }));
  }
  for (const View& view : views) {
    const auto& points = view.response->points;
    gain.series.push_back(series(points, view.label, view.colour,
                                 [which](const ResponsePoint& p) { return decibel(std::abs((p.*which).value)); }));
    phase.series.push_back(series(points, view.label, view.colour,
                                  [which](const ResponsePoint& p) { return kDegrees * std::arg((p.*which).value); }));
    unwrap(phase.series.back());
  }
  return {gain, phase};
}

/// The loop near -1.
auto nyquist(const std::vector<View>& views, const std::optional<Tuning>& tuning) -> Plot {
  constexpr double kFar = 3.0;
  Plot plot{.title = "Nyquist: the loop, -1 being the point to stay away from",
            .x_label = "real part",
            .y_label = "imaginary part",
            .series = {},
            .y_range = {}};
  const auto add = [&plot](const std::vector<LoopPoint>& loop, const char* label, const char* colour) {
    Series one{label, colour, {}, {}};
    for (const LoopPoint& point : loop) {
      if (std::abs(point.value) < kFar) {
        one.x.conservativeResize(one.x.size() + 1);
        one.y.conservativeResize(one.y.size() + 1);
        one.x.tail(1)[0] = point.value.real();
        one.y.tail(1)[0] = point.value.imag();
      }
    }
    if (one.x.size() > 1) {
      plot.series.push_back(std::move(one));
    }
  };
  Series circle{"modulus margin 0.5", kBandColour, Eigen::VectorXd(73), Eigen::VectorXd(73)};
  for (Eigen::Index i = 0; i < 73; ++i) {
    circle.x[i] = -1.0 + 0.5 * std::cos(static_cast<double>(i) / 36.0 * std::numbers::pi);
    circle.y[i] = 0.5 * std::sin(static_cast<double>(i) / 36.0 * std::numbers::pi);
  }
  plot.series.push_back(circle);
  for (const View& view : views) {
    add(measured_loop(*view.response), view.label, view.colour);
  }
  if (tuning) {
    add(tuning->loop, "with the new gains", kTunedColour);
  }
  return plot;
}

auto plots_of(const Response& response, const std::optional<Tuning>& tuning) -> std::vector<Plot> {
  const std::vector<View> views = shown_views(response);
  std::vector<Plot> plots = bode(views, "Motor angle per torque", "rad/Nm", &ResponsePoint::motor);
  if (response.on_torque) {
    std::vector<Plot> loop = bode(views, "Loop, broken at the torque", "1", &ResponsePoint::loop);
    if (tuning) {
      loop[0].series.push_back(series(tuning->loop, "with the new gains", kTunedColour,
                                      [](const LoopPoint& p) { return decibel(std::abs(p.value)); }));
      loop[1].series.push_back(series(tuning->loop, "with the new gains", kTunedColour,
                                      [](const LoopPoint& p) { return kDegrees * std::arg(p.value); }));
      unwrap(loop[1].series.back());
    }
    plots.insert(plots.end(), loop.begin(), loop.end());
  }
  Plot coherence{.title = "Coherence",
                 .x_label = kFrequency,
                 .y_label = "share of the power",
                 .series = {},
                 .y_range = std::pair{0.0, 1.05}};
  for (const View& view : views) {
    coherence.series.push_back(
        series(view.response->points, view.label, view.colour, [](const ResponsePoint& p) { return p.coherence; }));
  }
  plots.push_back(std::move(coherence));
  if (response.on_torque) {
    plots.push_back(nyquist(views, tuning));
  }
  return plots;
}

auto padded(const std::string& text, std::size_t width) -> std::string {
  return std::string(width > text.size() ? width - text.size() : 0, ' ') + text;
}

/// A circle over its value, as far as it says anything.
auto share_text(const Estimate& estimate) -> std::string {
  const double percent = 100.0 * estimate.radius95 / std::max(std::abs(estimate.value), 1e-12);
  return percent > 100.0 ? ">100%" : percent < 0.01 ? "<0.01%" : rounded(percent, 2) + "%";
}

auto table_of(const Response& response) -> std::string {
  std::string text = "      Hz   rad/Nm      +-    deg |     loop      +-    deg | coherence\n";
  for (const ResponsePoint& p : response.points) {
    const auto three = [](const Estimate& e) {
      return padded(rounded(std::abs(e.value), 3), 9) + padded(share_text(e), 8) +
             padded(rounded(kDegrees * std::arg(e.value), 3), 7);
    };
    text += padded(rounded(p.hz, 3), 8) + three(p.motor) + " |" +
            (response.on_torque ? three(p.loop) : padded("", 24)) + " | " + rounded(p.coherence, 3) + "\n";
  }
  return text;
}

auto margins_text(const Margins& margins) -> std::string {
  if (margins.crossover_hz == 0.0) {
    return "gain below 1 throughout, modulus " + rounded(margins.modulus, 3);
  }
  return "crossover " + rounded(margins.crossover_hz, 3) + " Hz, phase margin " + rounded(margins.phase_deg, 3) +
         " deg, gain margin " + rounded(margins.gain_db, 3) + " dB, modulus " + rounded(margins.modulus, 3);
}

}  // namespace

auto response_text(const Response& response) -> std::string {
  std::string text = std::string(response.multisine ? "multisine" : "chirp") + " on the " +
                     (response.on_torque ? "torque" : "reference") + ", " + std::to_string(response.windows) +
                     (response.windows == 1 ? " sweep" : " periods") +
                     (response.travels ? " while the joint travels\n" : " while the joint stands\n");
  for (const View& view : shown_views(response)) {
    text += view.response == &response ? "" : std::string(view.label) + ":\n";
    text += table_of(*view.response);
  }
  if (response.distortion.known) {
    text += "distortion of the motor's motion: even " + rounded(100.0 * response.distortion.even, 2) + " %, odd " +
            rounded(100.0 * response.distortion.odd, 2) + " %, noise " + rounded(100.0 * response.distortion.noise, 2) +
            " %\n";
  }
  if (response.on_torque) {
    text += "the loop as it was: " + margins_text(measured_margins(response, false)) + "\n";
    text += "worst within the circles: " + margins_text(measured_margins(response, true)) + "\n";
  }
  return text;
}

auto tuning_text(const Tuning& tuning, const LoopGains& present) -> std::string {
  const MotorModel& motor = tuning.motor;
  std::string text =
      "plant: inertia " + rounded(1e3 * motor.inertia_kgm2, 3) + " g m2, drag " + rounded(motor.viscous_nms, 2) +
      " Nms/rad, spring " + rounded(motor.stiffness_nm, 2) + " Nm/rad, delay " +
      rounded(1e3 * (motor.delay_s + motor.lag_s), 2) + " ms; " + rounded(100.0 * motor.share_left, 2) +
      " % is not of that kind" +
      (motor.resonance_hz > 0.0 ? ", a resonance near " + rounded(motor.resonance_hz, 3) + " Hz\n" : "\n");
  if (motor.joint_inertia_kgm2 > 0.0) {
    text += "joint: " + rounded(1e3 * motor.joint_inertia_kgm2, 3) +
            " g m2 at the motor swings on its tendons; with the motor held at " + rounded(motor.joint_hz, 3) +
            " Hz, damped by " + rounded(motor.joint_damping, 2) + " of critical\n";
  }
  text += "gains: stiffness " + rounded(present.stiffness) + " -> " + rounded(tuning.gains.stiffness) +
          " Nm/rad, damping " + rounded(present.damping) + " -> " + rounded(tuning.gains.damping) +
          " Nms/rad, filter of its rate " + rounded(1e3 * present.rate_time_constant_s) + " -> " +
          rounded(1e3 * tuning.gains.rate_time_constant_s) + " ms, kp " + rounded(present.kp) + " -> " +
          rounded(tuning.gains.kp) + ", ki " + rounded(present.ki_per_s) + " -> " + rounded(tuning.gains.ki_per_s) +
          " 1/s\n";
  text += "motor servo, worst within the circles: " + margins_text(tuning.servo) + "\n";
  text += "whole loop, worst within the circles: " + margins_text(tuning.whole) + "\n";
  text += "whole loop, to compare a measurement with: " + margins_text(tuning.whole_nominal) + "\n";
  text += "joint loop up to " + rounded(tuning.joint_bandwidth_hz, 2) + " Hz\n";
  text += "limited by " + tuning.limited_by + "\n";
  text += tuning.swings.empty() ? "" : tuning.swings + "\n";
  text += tuning.ways.empty() ? "" : tuning.ways + "\n";
  text += tuning.warning.empty() ? "" : "warning: " + tuning.warning + "\n";
  return text;
}

auto write_response_report(const std::string& folder, const Response& response, const std::optional<Tuning>& tuning,
                           int axis) -> std::string {
  make_folder(folder);
  std::string page = "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Frequency response: " +
                     escaped(response.name) + "</title><style>" + kStyle +
                     "</style></head><body>\n<h1>Frequency response: " + escaped(response.name) + "</h1>\n";
  for (const Plot& plot : plots_of(response, tuning)) {
    page += svg_of(plot) + "\n";
  }
  page += "<pre>" + escaped(response_text(response)) + "</pre>\n";
  if (tuning) {
    page += "<h2>Gains</h2>\n<p>Limited by " + escaped(tuning->limited_by) + ".</p>\n<p>" + escaped(tuning->swings) +
            "</p>\n<p>" + escaped(tuning->warning) + "</p>\n<pre>" +
            escaped(joined(tuning_lines(tuning->gains, axis), "\n")) + "</pre>\n";
  }
  const std::string path = folder + "/index.html";
  write_text_file(path, page + "</body></html>\n");
  return path;
}

}  // namespace capstan::tools
