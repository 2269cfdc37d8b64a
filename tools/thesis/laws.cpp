// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/thesis/laws.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/support/statistics.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kBlendS = 0.5;

auto form_of(std::vector<std::string> terms, bool drag) -> LawForm {
  if (drag) {
    terms.emplace_back("transmission_viscous");
  }
  LawForm form;
  form.terms = std::move(terms);
  return form;
}

/// The form with its shapes refined from several starts: those of the extra terms are spread over their ranges, for a
/// search from one start ends in the valley next to it.
auto best_form(const LawDesign& design, const Eigen::VectorXd& target, const LawForm& form,
               const std::vector<std::string>& extra) -> LawForm {
  const Blocks blocks = even_blocks(design.log_rows(), 2);
  LawForm best;
  double least = std::numeric_limits<double>::infinity();
  for (const double share : {0.0, 0.15, 0.4}) {
    LawForm start = form;
    for (const std::string& name : extra) {
      const CatalogueTerm& term = start.catalogue->term(name);
      Shapes shapes = term.initial_shapes();
      for (std::size_t i = 0; i < shapes.size() && share > 0.0; ++i) {
        shapes[i] = term.shapes[i].minimum + share * (term.shapes[i].maximum - term.shapes[i].minimum);
      }
      start.set_shapes(term, shapes);
    }
    const LawForm refined = refine_shapes(design, target, blocks, start);
    const double rmse = fit_law(design, target, blocks, refined).rmse;
    if (rmse < least) {
      least = rmse;
      best = refined;
    }
    if (extra.empty()) {
      break;
    }
  }
  return best;
}

auto motion_of(sim::Segment segment) -> sim::Motion {
  return sim::Motion({std::move(segment)}, 1, kBlendS);
}

}  // namespace

auto fit_laws(const std::vector<AxisLog>& logs, bool drag, const std::vector<std::string>& extra) -> Laws {
  Laws laws;
  laws.kinematic = identify(logs, form_of({"motor_angle"}, false)).joint;
  laws.thesis = identify(logs, form_of({"motor_angle", "tendon_elongation"}, drag)).joint;
  LawForm form =
      form_of({"motor_angle", "joint_offset", "tendon_elongation", "pretension_offset", "slip_propagation"}, drag);
  form.terms.insert(form.terms.end(), extra.begin(), extra.end());
  const LawDesign design(logs, laws.thesis.parameters.conditioner);
  laws.augmented = identify(logs, best_form(design, stacked_target(logs), form, extra)).joint;
  return laws;
}

auto law_error_deg(const AxisLog& log, const JointFile& law) -> double {
  return rms_deg(log.q2_rad - simulate({log}, motion_parameters(law)));
}

auto rms_deg(const Eigen::VectorXd& angle_rad) -> double {
  return rms(angle_rad) / kDegree;
}

auto parameter_line(const JointFile& law) -> std::string {
  const auto& theta = law.parameters.coefficients;
  const CatalogueTerm& elongation = catalogue_term("tendon_elongation");
  return "alpha_t " + rounded(theta[elongation.first_coefficient], 4) + ", alpha_b " +
         rounded(theta[elongation.first_coefficient + 1], 4) + ", beta " + rounded(theta[0], 4);
}

auto sine(double amplitude_deg, double frequency_hz, double duration_s) -> sim::Motion {
  return motion_of({.kind = sim::SegmentKind::kSine,
                    .duration_s = duration_s,
                    .amplitude_rad = amplitude_deg * kDegree,
                    .frequency_hz = frequency_hz});
}

auto multisine(double rms_deg, const std::vector<double>& frequencies_hz, double duration_s) -> sim::Motion {
  sim::Segment segment{.kind = sim::SegmentKind::kMultisine,
                       .duration_s = duration_s,
                       .amplitude_rad = 1.0,
                       .phase_rad = std::numbers::pi,  // cos(x + pi / 2) of (5.31) is sin(x + pi)
                       .frequencies_hz = frequencies_hz};
  const sim::Motion unit = motion_of(segment);
  double sum = 0.0;
  constexpr int kSamples = 10000;
  for (int i = 0; i < kSamples; ++i) {
    const double angle = unit.reference_rad(duration_s * i / kSamples);
    sum += angle * angle;
  }
  segment.amplitude_rad = rms_deg * kDegree / std::sqrt(sum / kSamples);
  return motion_of(segment);
}

auto decaying_sine(double amplitude_deg, double frequency_hz, double decay_per_s, double duration_s) -> sim::Motion {
  return motion_of({.kind = sim::SegmentKind::kDecayingSine,
                    .duration_s = duration_s,
                    .amplitude_rad = amplitude_deg * kDegree,
                    .frequency_hz = frequency_hz,
                    .decay_per_s = decay_per_s});
}

}  // namespace capstan::tools
