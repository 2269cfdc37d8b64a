// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/campaign/fault_campaign.hpp"

#include <algorithm>

#include "capstan/tools/support/side_by_side.hpp"

namespace capstan::tools {
namespace {

/// Two at once that could follow from one cause, or hide each other.
constexpr std::array kPairs = std::to_array<std::pair<OneFault, OneFault>>({
    {{Input::kEncoder, Mode::kStuck}, {Input::kCurrent, Mode::kStuck}},
    {{Input::kCurrent, Mode::kStuck}, {Input::kEncoder, Mode::kStuck}},
    {{Input::kCurrent, Mode::kStuck}, {Input::kAmplifier, Mode::kGarbage}},
    {{Input::kCurrent, Mode::kHalf}, {Input::kEncoder, Mode::kHalf}},
    {{Input::kCurrent, Mode::kDrift}, {Input::kEncoder, Mode::kLate}},
    {{Input::kEncoder, Mode::kLate}, {Input::kReference, Mode::kStuck}},
    {{Input::kEncoder, Mode::kHalf}, {Input::kAmplifier, Mode::kSlow}},
    {{Input::kSupply, Mode::kBrownout}, {Input::kEncoder, Mode::kStuck}},
    {{Input::kClock, Mode::kIntermittent}, {Input::kEncoder, Mode::kStuck}},
    {{Input::kTransmission, Mode::kLoose}, {Input::kEncoder, Mode::kStuck}},
    {{Input::kReference, Mode::kGarbage}, {Input::kEncoder, Mode::kSlow}},
    {{Input::kAmplifier, Mode::kHalf}, {Input::kEncoder, Mode::kWrongSign}},
});

auto single_faults() -> std::vector<Trouble> {
  std::vector<Trouble> all;
  for (const Input input : kInputs) {
    for (std::size_t mode = 0; mode < kModeCount; ++mode) {
      if (const OneFault fault{input, static_cast<Mode>(mode)}; why_impossible(fault) == nullptr) {
        all.push_back({fault});
      }
    }
  }
  return all;
}
auto double_faults() -> std::vector<Trouble> {
  std::vector<Trouble> all;
  for (const auto& [first, second] : kPairs) {
    all.push_back({first, second});
  }
  return all;
}

/// One joint in one situation.
struct Job {
  Joint joint{};
  Situation situation{};
  int phases = 1;
  bool pairs = false;
};

auto jobs_of(Extent extent) -> std::vector<Job> {
  std::vector<Job> jobs;
  for (const Joint joint : kJoints) {
    const bool all = extent == Extent::kLong || joint == Joint::kForceps;
    for (const Situation situation : kSituations) {
      const bool moves = has_phases(situation);
      if (!all && situation != Situation::kMoving && situation != Situation::kHolding) {
        continue;
      }
      // A stuck encoder takes RAVEN's elbow furthest in few of its phases.
      const bool every = all || (joint == Joint::kElbow && moves);
      jobs.push_back({joint, situation, !moves ? 1 : every ? kPhases : 4, false});
      if (moves && all) {
        jobs.push_back({joint, situation, extent == Extent::kLong ? kPhases : 5, true});
      }
    }
  }
  return jobs;
}

class Judge {
 public:
  Judge(const Scene& scene, const Course& healthy) : scene_(scene), healthy_(healthy) {}

  void add(CampaignRow& row) const {
    const RunResult run = run_scene(scene_, row.trouble);
    const bool wrongly_asked = row.trouble.first.input == Input::kReference && !row.trouble.second;
    const Hazard hazard = wrongly_asked ? hazard_from_asked(healthy_, run.course) : hazard_beyond(healthy_, run.course);
    const HazardLimits limits = hazard_limits(setup_of(scene_.joint).config);
    const double severity = hazard.severity(limits);
    const Outcome outcome = judge(run, row, hazard, limits);
    const bool worse = row.cases == 0 || outcome > row.outcome || (outcome == row.outcome && severity > row.severity);
    ++row.cases;
    row.unsafe += outcome == Outcome::kUnsafe ? 1 : 0;
    row.mechanical += outcome == Outcome::kMechanical ? 1 : 0;
    row.hazard.widen(hazard);
    row.severity = std::max(row.severity, severity);
    row.detected_ms = std::max(row.detected_ms, run.detected_ms);
    row.off_after_cycles = std::max(row.off_after_cycles, run.off_after_cycles);
    if (worse) {
      row.outcome = outcome;
      row.worst_phase = scene_.phase;
      row.fault = run.fault;
      row.end = run.end;
    }
  }

 private:
  [[nodiscard]] auto judge(const RunResult& run, CampaignRow& row, const Hazard& hazard,
                           const HazardLimits& limits) const -> Outcome {
    const bool ended = run.end == State::kFaulted || run.blocked;
    if (run.torque_returned || (ended && (run.fault == Fault::kNone || run.off_after_cycles > 2))) {
      return Outcome::kUnsafe;
    }
    if (hazard.severity(limits) > 1.0) {
      return by_mechanics(row, hazard, limits) ? Outcome::kMechanical : Outcome::kUnsafe;
    }
    return run.blocked ? Outcome::kBlocked : run.end == State::kFaulted ? Outcome::kFaulted : Outcome::kTolerated;
  }
  /// What the firmware adds to it is held to its limit all the same.
  [[nodiscard]] auto by_mechanics(CampaignRow& row, const Hazard& hazard, const HazardLimits& limits) const -> bool {
    Trouble cut = row.trouble;
    cut.cut_at_onset = true;
    const Hazard least = hazard_beyond(healthy_, run_scene(scene_, cut).course);
    row.unavoidable_rad = std::max(row.unavoidable_rad, least.travel_rad);
    const bool beyond = least.severity(limits) > 1.0;
    const bool mechanical = row.trouble.first.input == Input::kTransmission && beyond &&
                            hazard.travel_rad <= least.travel_rad + limits.travel_rad;
    row.unavoidable += beyond && !mechanical ? 1 : 0;
    return mechanical;
  }

  Scene scene_;
  const Course& healthy_;
};

auto run_job(const Job& job) -> std::vector<CampaignRow> {
  std::vector<CampaignRow> rows;
  for (const Trouble& trouble : job.pairs ? double_faults() : single_faults()) {
    if (!takes_part(trouble.first.input, job.situation) ||
        (trouble.second && !takes_part(trouble.second->input, job.situation))) {
      continue;
    }
    CampaignRow row;
    row.joint = job.joint;
    row.situation = job.situation;
    row.trouble = trouble;
    rows.push_back(row);
  }
  for (int i = 0; i < job.phases; ++i) {
    const Scene scene{job.joint, job.situation, i * kPhases / job.phases};
    const RunResult healthy = run_scene(scene, std::nullopt);
    const Judge judge(scene, healthy.course);
    for (CampaignRow& row : rows) {
      judge.add(row);
    }
  }
  return rows;
}

}  // namespace

auto hazard_limits(const AxisConfig& config) -> HazardLimits {
  return {.travel_rad = config.limits.fault_travel_rad.to_double(),
          .speed_rad_s = config.limits.joint_speed_rad_s.to_double(),
          .torque_nm = config.limits.joint_torque_nm.to_double()};
}

auto run_without_fault(Joint joint, Situation situation) -> CampaignRow {
  const RunResult run = run_scene({joint, situation, 0}, std::nullopt);
  CampaignRow row;
  row.joint = joint;
  row.situation = situation;
  row.fault = run.fault;
  row.end = run.end;
  row.detected_ms = run.detected_ms;
  row.outcome = run.end == State::kFaulted ? Outcome::kFaulted : Outcome::kTolerated;
  return row;
}

auto run_fault_campaign(Extent extent, int threads) -> Campaign {
  const std::vector<Job> jobs = jobs_of(extent);
  std::vector<std::vector<CampaignRow>> done(jobs.size());
  side_by_side(threads, jobs.size(), [&](std::size_t i) { done[i] = run_job(jobs[i]); });
  Campaign campaign;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    auto& rows = jobs[i].pairs ? campaign.pairs : campaign.single;
    rows.insert(rows.end(), done[i].begin(), done[i].end());
  }
  return campaign;
}

auto name(Outcome outcome) -> const char* {
  static constexpr std::array kNames = {"faulted", "blocked", "tolerated", "mechanical", "UNSAFE"};
  return kNames[static_cast<std::size_t>(outcome)];
}

auto name(const Trouble& trouble) -> std::string {
  std::string text = std::string(name(trouble.first.input)) + " " + name(trouble.first.mode);
  if (trouble.second) {
    text += std::string(" + ") + name(trouble.second->input) + " " + name(trouble.second->mode);
  }
  return text;
}

}  // namespace capstan::tools
