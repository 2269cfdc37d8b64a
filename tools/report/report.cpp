// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/report/report.hpp"

#include <array>
#include <filesystem>
#include <numbers>

#include "capstan/tools/diagnose/next_experiment.hpp"
#include "capstan/tools/identify/term_catalogue.hpp"
#include "capstan/tools/report/covariance_section.hpp"
#include "capstan/tools/report/html.hpp"
#include "capstan/tools/report/svg_plot.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr const char* kMeasuredColour = "#444";
constexpr const char* kBeforeColour = "#c2410c";
constexpr const char* kAfterColour = "#0f766e";

constexpr const char* kNextExperiment = "next_experiment.toml";
/// What a page may have beside it.
constexpr std::array kBesideThePage = {
    "loop_before.svg", "loop_after.svg", "residual_before.svg",         "residual_after.svg", "map_angle.svg",
    "map_speed.svg",   "map_load.svg",   "map_time_since_reversal.svg", kNextExperiment};

constexpr const char* kStyle = R"(
body { font: 15px/1.5 sans-serif; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; color: #222 }
h1 { font-size: 1.5rem }
h2 { font-size: 1.15rem; margin-top: 2rem }
table { border-collapse: collapse }
th, td { text-align: left; padding: .2rem .8rem .2rem 0; border-bottom: 1px solid #ddd }
td.n { text-align: right; font-variant-numeric: tabular-nums }
.verdict { background: #f1f5f9; padding: 1rem; font-size: 1.1rem }
svg { max-width: 100%; height: auto; display: block; margin: .5rem 0 }
.dim { color: #777 }
)";

struct Picture {
  std::string file;
  Plot plot;
};

/// Angles are shown in degrees, everything else as it is.
struct Shown {
  std::string unit;
  double factor = 1.0;
};
auto shown(const std::string& unit) -> Shown {
  return unit == "rad" ? Shown{"deg", kDegrees} : Shown{unit, 1.0};
}

/// Time that keeps rising where one log ends and the next begins.
auto running_time(const Eigen::VectorXd& time_s) -> Eigen::VectorXd {
  Eigen::VectorXd running = time_s;
  for (Eigen::Index i = 1; i < running.size(); ++i) {
    const double step = time_s[i] - time_s[i - 1];
    running[i] = running[i - 1] + (step > 0.0 ? step : 0.0);
  }
  return running;
}

auto loop_plot(const Diagnosis& d, const Eigen::VectorXd& estimate, const std::string& which, const char* colour)
    -> Plot {
  const Traces& t = d.traces;
  const Shown motion = shown(d.motion_unit);
  const Shown target = shown(d.unit);
  const bool angle = d.base.catalogue->target() == TargetKind::kAngle;
  // A joint angle is nearly beta q1: its loop only shows beside that.
  const double beta = angle ? beta_of(d.base) : 0.0;
  Plot plot;
  plot.title = "Loop " + which;
  plot.x_label = "motion q1 [" + motion.unit + "]";
  plot.y_label = (angle ? "q2 less beta q1 [" : "torque or force [") + target.unit + "]";
  plot.series = {{"measured", kMeasuredColour, t.q1 * motion.factor, (t.measured - beta * t.q1) * target.factor},
                 {"law " + which, colour, t.q1 * motion.factor, (estimate - beta * t.q1) * target.factor}};
  return plot;
}

auto residual_plot(const Diagnosis& d, const Eigen::VectorXd& estimate, const std::string& which, const char* colour)
    -> Plot {
  const Traces& t = d.traces;
  const Shown target = shown(d.unit);
  Plot plot;
  plot.title = "Residual " + which;
  plot.x_label = "time [s]";
  plot.y_label = "measured less estimated [" + target.unit + "]";
  plot.series = {{"law " + which, colour, running_time(t.time_s), (t.measured - estimate) * target.factor}};
  return plot;
}

/// Mean residual over one signal, each direction for itself: what the law lacks there, and what is left of it.
auto map_plot(const Diagnosis& d, const std::string& signal) -> Plot {
  const Shown target = shown(d.unit);
  Plot plot;
  plot.title = "Where the residual lies: " + signal;
  plot.x_label = signal == "angle" ? "motion q1 [" + d.motion_unit + "]"
                                   : (signal == "speed" ? "speed [" + d.motion_unit + "/s]"
                                                        : (signal == "load" ? "load [Nm]" : "since the reversal [s]"));
  plot.y_label = "mean of measured less estimated [" + target.unit + "]";
  const auto add = [&](const ResidualMap& map, bool forward, const char* which, const char* colour) {
    Series series{std::string(which) + (forward ? ", forward" : ", backward"), colour, {}, {}};
    for (const auto& cell : map.cells) {
      if (cell.signal == signal && cell.forward == forward && cell.visits > 0) {
        series.x.conservativeResize(series.x.size() + 1);
        series.y.conservativeResize(series.y.size() + 1);
        series.x.tail(1)[0] = 0.5 * (cell.from + cell.to);
        series.y.tail(1)[0] = cell.mean * target.factor;
      }
    }
    if (series.x.size() > 1) {
      plot.series.push_back(std::move(series));
    }
  };
  add(d.map_before, true, "before", "#c2410c");
  add(d.map_before, false, "before", "#fdba74");
  add(d.map_after, true, "after", "#0f766e");
  add(d.map_after, false, "after", "#5eead4");
  return plot;
}

/// What the delivered law corrects without a name, and where it and the base law leave something.
auto map_section(const Diagnosis& d) -> std::string {
  std::string html = "<h2>Where the residual lies</h2>\n";
  if (d.unnamed) {
    html += "<p>" + escaped(d.unnamed->sentence) + "</p>\n";
  }
  html +=
      "<p>Before: " + escaped(d.map_before.sentence) + "</p>\n<p>After: " + escaped(d.map_after.sentence) +
      " Of the cells listed one in twenty is wrong at most.</p>\n<table><tr><th>after: signal</th><th>direction</th>"
      "<th>from</th><th>to</th><th>mean [" +
      d.unit + "]</th><th>visits</th><th>p</th></tr>\n";
  for (const auto& found : d.map_after.cells) {
    if (found.found) {
      html += "<tr>" + html_cell(found.signal) + html_cell(found.forward ? "forward" : "backward") +
              html_number(rounded(found.from, 3)) + html_number(rounded(found.to, 3)) +
              html_number(rounded(found.mean, 3)) + html_number(std::to_string(found.visits)) +
              html_number(rounded(found.p_value, 2)) + "</tr>\n";
    }
  }
  return html + "</table>\n";
}

auto pictures_of(const Diagnosis& d) -> std::vector<Picture> {
  if (d.traces.measured.size() == 0) {
    return {};
  }
  std::vector<Plot> loops = {loop_plot(d, d.traces.before, "before", kBeforeColour)};
  std::vector<Plot> residuals = {residual_plot(d, d.traces.before, "before", kBeforeColour)};
  if (d.traces.after.size() > 0) {
    loops.push_back(loop_plot(d, d.traces.after, "after", kAfterColour));
    residuals.push_back(residual_plot(d, d.traces.after, "after", kAfterColour));
  }
  std::vector<Picture> pictures;
  const auto loop_range = common_range(loops);
  const auto residual_range = common_range(residuals);
  const char* names[] = {"before", "after"};
  for (std::size_t i = 0; i < loops.size(); ++i) {
    loops[i].y_range = loop_range;
    residuals[i].y_range = residual_range;
    pictures.push_back({std::string("loop_") + names[i] + ".svg", loops[i]});
    pictures.push_back({std::string("residual_") + names[i] + ".svg", residuals[i]});
  }
  for (const char* signal : {"angle", "speed", "load", "time_since_reversal"}) {
    if (Plot plot = map_plot(d, signal); !plot.series.empty()) {
      plot.y_range = common_range({plot});
      pictures.push_back({std::string("map_") + signal + ".svg", std::move(plot)});
    }
  }
  return pictures;
}

auto error_table(const Diagnosis& d) -> std::string {
  const bool angle = d.unit == "rad";  // shown in degrees too; an effort is shown beside itself
  std::string html = "<h2>Error on rows that took no part in fit or choice</h2>\n<table><tr><th></th><th>RMSE [" +
                     d.unit + "]</th><th>" + (angle ? "RMSE [deg]" : "of the effort [%]") +
                     "</th><th>goodness of fit [%]</th></tr>\n";
  auto row = [&](const std::string& name, const ErrorSummary& e) {
    html += "<tr>" + html_cell(name) + html_number(rounded(e.rmse)) +
            html_number(rounded(angle ? e.rmse * kDegrees : e.relative_percent, 3)) +
            html_number(rounded(e.gof_percent)) + "</tr>\n";
  };
  row("before: " + d.base_model, d.before);
  row(std::string("after: ") + word_of(d.law.status) + " law", d.after);
  for (const auto& log : d.tested) {
    row("before, on " + log.name, log.before);
    row("after, on " + log.name, log.after);
  }
  html += "<tr>" + html_cell("noise floor (from " + d.floor_from + ")") + html_number(rounded(d.noise_floor)) +
          html_number(angle ? rounded(d.noise_floor * kDegrees, 3) : "") + html_cell("") + "</tr>\n</table>\n";
  if (!d.effects.empty()) {
    html += "<p>Ratio after / before, 95 % interval: " + rounded(d.ratio_ci95[0], 3) + " to " +
            rounded(d.ratio_ci95[1], 3) + ". The effects explain " + rounded(100.0 * d.explained_share, 3) +
            " % of what can be explained (at least " + rounded(100.0 * d.explained_share_lower, 3) + " %).</p>\n";
  }
  return html;
}

/// @param otherwise  what it means that there is none
auto interval_text(const std::optional<Interval>& ci95, const char* otherwise) -> std::string {
  return ci95 ? rounded((*ci95)[0], 4) + " to " + rounded((*ci95)[1], 4) : otherwise;
}

auto parameter_row(const CatalogueTerm& term, const char* name, double value, const std::string& interval,
                   const char* unit, const char* doc) -> std::string {
  return "<tr>" + html_cell(term.name + "." + name) + html_number(rounded(value, 5)) + html_cell(interval) +
         html_cell(unit) + html_cell(doc) + "</tr>\n";
}

auto parameter_table(const JointFile& joint, const std::vector<std::string>& undetermined) -> std::string {
  std::string html =
      "<h2>Parameters of the law</h2>\n<table><tr><th>parameter</th><th>value</th><th>95 % interval</th>"
      "<th>unit</th><th>meaning</th></tr>\n";
  for (const auto& term : *joint.catalogue) {
    if (!joint.has(term.name)) {
      continue;
    }
    for (std::size_t i = 0; i < term.coefficients.size(); ++i) {
      const auto& info = term.coefficients[i];
      const std::size_t at = term.first_coefficient + i;
      const std::string name = term.name + "." + info.name;
      const bool known = std::find(undetermined.begin(), undetermined.end(), name) == undetermined.end();
      if (known && joint.left_out(term, i)) {
        continue;
      }
      const double value = joint.parameters.coefficients[at];
      const char* without = value == 0.0 ? "held at its bound" : "no interval";
      html += known ? parameter_row(term, info.name, value, interval_text(joint.coefficient_ci95[at], without),
                                    info.unit, info.doc)
                    : "<tr>" + html_cell(name) + html_cell("") + html_cell("this log can not determine it") +
                          html_cell(info.unit) + html_cell(info.doc) + "</tr>\n";
    }
    for (std::size_t i = 0; i < term.shapes.size(); ++i) {
      const auto& info = term.shapes[i];
      const std::size_t at = term.first_shape + i;
      html += parameter_row(term, info.name, joint.parameters.shapes[at],
                            interval_text(joint.shape_ci95[at], "any near this one"), info.unit, info.doc);
    }
  }
  return html + "</table>\n";
}

auto ranking_tables(const Diagnosis& d) -> std::string {
  std::string html =
      "<h2>Which other effects could it be?</h2>\n<p>Every possible effect was fitted beside the law. Those in grey "
      "are not in "
      "the catalogue: they are in the line-up so that something foreign is not given the nearest catalogue name.</p>\n";
  for (std::size_t i = 0; i < d.rounds.size(); ++i) {
    html += "<h3>Round " + std::to_string(i + 1) + "</h3>\n<p>" + rounded(100.0 * d.rounds[i].reducible_share, 3) +
            " % of the residual's energy is no noise" +
            (d.rounds[i].lacks_something ? "" : " (not certain, or too little to matter)") +
            ".</p>\n<table><tr><th>effect</th><th>explains [%]</th><th>p, family-wise</th>"
            "<th>evidence [nats]</th><th>outcome</th></tr>\n";
    for (const auto& ranked : d.rounds[i].ranking) {
      html += std::string("<tr") + (ranked.in_catalogue ? "" : " class=\"dim\"") + ">" + html_cell(ranked.name) +
              html_number(rounded(100.0 * ranked.explained, 3)) + html_number(rounded(ranked.p_value, 2)) +
              html_number(rounded(ranked.log_e_value, 3)) + html_cell(ranked.outcome) + "</tr>\n";
    }
    html += "</table>\n";
  }
  return html;
}

auto what_would_change(const Diagnosis& d) -> std::string {
  std::string html = "<h2>What would change the verdict</h2>\n<ul>\n";
  auto item = [&](const std::string& text) { html += "<li>" + escaped(text) + "</li>\n"; };
  if (d.next_experiment) {
    item(*d.next_experiment);
  }
  if (!next_scenario(d).empty()) {
    html += std::string("<li>That motion, for <code>capstan run --scenario</code>: <a href=\"") + kNextExperiment +
            "\">" + kNextExperiment + "</a></li>\n";
  }
  for (const auto& effect : d.effects) {
    const CatalogueTerm& term = (d.found ? *d.found : d.law).catalogue->term(effect.name);
    item(effect.name + " (" + term.equation + ") is easily taken for " + term.confusable_with +
         "; a log of this motion tells them apart: " + term.exciting_motion + ".");
  }
  if (d.repeats < 2) {
    item("Four equal cycles in one log: the noise is then measured instead of judged from the residual.");
  }
  if (d.verdict == Verdict::kUnknown || d.verdict == Verdict::kEffectPlusUnlisted) {
    item("A new effect in the catalogue that explains what is left; the ranking shows what it looks like.");
  }
  if (d.verdict == Verdict::kNothingMissing) {
    item("More data, less noise or a richer motion, if an effect smaller than those listed under warnings matters.");
  }
  return html + "</ul>\n";
}

auto page(const Diagnosis& d, const std::vector<Picture>& pictures) -> std::string {
  std::string html =
      std::string("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Diagnosis of ") +
      escaped(d.target) + "</title><style>" + kStyle + "</style></head><body>\n<h1>Diagnosis of " + escaped(d.target) +
      "</h1>\n<p class=\"verdict\"><b>" + verdict_word(d.verdict) + "</b>: " + escaped(d.reason) + "</p>\n<p>" +
      std::to_string(d.samples) + " samples at " + rounded(d.rate_hz) + " Hz, " +
      (d.repeats > 1 ? std::to_string(d.repeats) + " repeated cycles" : std::string("no repeated cycles")) +
      ", base law " + escaped(d.base_model) + ".</p>\n";
  for (const auto& size : d.sizes) {
    html += "<p>" + escaped(size) + "</p>\n";
  }
  if (!pictures.empty()) {
    html += error_table(d);
    html += "<h2>Pictures</h2>\n";
    for (const auto& picture : pictures) {
      html += svg_of(picture.plot);
    }
    html += map_section(d) + ranking_tables(d) + parameter_table(d.law, d.undetermined) + covariance_section(d.told);
  }
  html += what_would_change(d);
  if (const auto notes = all_notes(d); !notes.empty()) {
    html += "<h2>Notes and warnings</h2>\n<ul>\n";
    for (const auto& warning : notes) {
      html += "<li>" + escaped(warning) + "</li>\n";
    }
    html += "</ul>\n";
  }
  return html + "</body></html>\n";
}

}  // namespace

auto write_report(const std::string& folder, const Diagnosis& diagnosis) -> std::string {
  make_folder(folder);
  for (const char* file : kBesideThePage) {  // an older page's would be taken for this one's
    std::filesystem::remove(std::filesystem::path(folder) / file);
  }
  const auto pictures = pictures_of(diagnosis);
  for (const auto& picture : pictures) {
    write_text_file(folder + "/" + picture.file, svg_of(picture.plot));
  }
  if (const std::string next = next_scenario(diagnosis); !next.empty()) {
    write_text_file(folder + "/" + kNextExperiment, next);
  }
  const std::string path = folder + "/index.html";
  write_text_file(path, page(diagnosis, pictures));
  return path;
}

}  // namespace capstan::tools
