// SPDX-License-Identifier: Apache-2.0
#include "capstan/tests/tools/plant/plant_health.hpp"

#include <cmath>
#include <cstdio>

#include "capstan/boards/common/file_banks.hpp"
#include "capstan/boards/sim/sim_board.hpp"
#include "capstan/tests/tools/plant/plant_joint.hpp"
#include "capstan/tools/apply/model_lines.hpp"
#include "capstan/tools/campaign/commissioned.hpp"
#include "capstan/tools/identify/identify.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/random.hpp"

namespace capstan::tools::plant {
namespace {

constexpr double kOnsetS = 20.0;

class Answers final : public TextSink {
 public:
  auto take() -> std::string { return std::exchange(text_, {}); }

 private:
  void do_write(std::string_view text) override { text_.append(text); }
  std::string text_;
};

/// A board, and an operator who sets it up.
class Watcher {
 public:
  explicit Watcher(const sim::Scenario& scenario) : board_(scenario, banks_, answers_, false) { board_.tick(); }
  void say(const std::string& line) {
    for (const char c : line + "\n") {
      board_.shell().receive(c);
    }
    for (int i = 0; i < 200'000 && board_.shell().busy(); ++i) {
      board_.tick();
      board_.shell().poll();
    }
    if (const std::string answer = answers_.take(); answer.find("error ") != std::string::npos) {
      throw Refusal("'" + line + "' was answered with " + answer);
    }
  }
  void move_to(double reference_rad) { board_.tick(std::array<double, 1>{reference_rad}); }
  [[nodiscard]] auto joint() const -> AxisTelemetry { return board_.machine().axis_telemetry(0); }
  [[nodiscard]] auto fault() const -> Fault { return board_.machine().telemetry().first_fault; }

 private:
  FileBanks banks_ = FileBanks::temporary();
  Answers answers_;
  SimBoard board_;
};

/// Changes plant or schedule so that it fails at the onset, or from the start where it has none. @returns the share of
/// pretension that is left
auto break_it(sim::Scenario& scenario, const std::string& fault, double error_rms_rad, Random& random) -> double {
  sim::PlantParameters& plant = scenario.plant;
  sim::Effects& effects = plant.effects;
  const auto between = [&](double low, double high) { return low + (high - low) * random.uniform(); };
  const double least_rad = 1.5 * error_rms_rad;  // what the monitor allows
  effects.pretension_change_at_s = effects.fraying_at_s = effects.pulley_slip_at_s = kOnsetS;
  if (fault == "loose" || fault == "slack") {
    const double lost = fault == "slack" ? between(0.93, 0.99) : between(0.15, 0.6);
    effects.pretension_change_n = -lost * plant.pretension_n;
    return 1.0 - lost;
  }
  if (fault == "worn") {  // a fifth to a half within some 20 s at about 1 rad/s
    effects.wear_per_rad = between(0.01, 0.025);
  } else if (fault == "frayed") {
    effects.fraying_share = between(0.4, 0.7);
  } else if (fault == "play") {
    effects.play_half_width_rad = between(2.0, 4.0) * least_rad;
  } else if (fault == "zero_moved" || fault == "slips") {
    effects.pulley_slip_rad = (random.uniform() < 0.5 ? -1.0 : 1.0) * between(2.0, 4.0) * least_rad;
    effects.pulley_slip_every_s = fault == "slips" ? 7.0 : 0.0;
  } else if (fault == "broken") {
    scenario.faults.push_back(
        {.time_s = kOnsetS,
         .target = random.uniform() < 0.5 ? sim::FaultTarget::kTendonTop : sim::FaultTarget::kTendonBottom,
         .kind = sim::FaultKind::kSnap});
  }
  return 1.0;
}

auto healthy_law(const sim::PlantParameters& plant, std::uint64_t seed, const std::string& model) -> JointFile {
  LawForm form;
  form.terms = terms_of_model(model);
  return identify({log_of(plant, PlantMotion::kIdentify, seed)}, form).joint;
}

}  // namespace

auto tendon_faults() -> const std::vector<TendonFault>& {
  using H = TendonHealth;
  // A torque alone shows no angle: there a broken tendon is a slack one, and strands that are torn a loose one.
  static const std::vector<TendonFault> kAll = {
      {"", H::kNothing, H::kNothing},    {"loose", H::kLoose, H::kLoose},
      {"slack", H::kSlack, H::kSlack},   {"worn", H::kWorn, H::kWorn},
      {"frayed", H::kFrayed, H::kLoose}, {"play", H::kPlay, H::kNothing},
      {"slips", H::kSlips, H::kNothing}, {"zero_moved", H::kZeroMoved, H::kNothing},
      {"broken", H::kBroken, H::kSlack}};
  return kAll;
}

WatchedJoint::WatchedJoint(sim::PlantParameters plant, std::uint64_t seed, const std::string& model)
    : WatchedJoint(plant, seed, healthy_law(plant, seed, model)) {}

WatchedJoint::WatchedJoint(sim::PlantParameters plant, std::uint64_t seed, const JointFile& joint) : plant_(plant) {
  if (!joint.steady_torque || !joint.fit) {
    throw Refusal("the healthy log gave no steady torque");
  }
  error_rms_rad_ = joint.fit->rmse;
  lines_ = model_lines(joint, 0);
  const auto set = [this](const char* name, double value, const char* unit) {
    std::array<char, 80> line{};
    std::snprintf(line.data(), line.size(), "set joint0.%s %.6f %s", name, value, unit);
    lines_.emplace_back(line.data());
  };
  AxisConfig config;
  config.motor.encoder_counts_per_turn = static_cast<std::int32_t>(plant.encoder_counts_per_turn);
  config.motor.torque_per_current_nm_per_a = Q24::from_double(plant.torque_constant_nm_per_a);
  lines_.emplace_back("maintenance open");
  set("observer.coulomb", commissioned(plant, config, seed + 1).coulomb_nm.to_double(), "Nm");
  lines_.emplace_back("maintenance close");
}

auto WatchedJoint::watch(const std::string& fault, bool joint_sensor, double seconds, std::uint64_t seed) const
    -> HealthAnswer {
  Random random(seed);
  sim::Scenario scenario;
  scenario.seed = seed;
  scenario.plant = plant_;
  scenario.plant.joint_sensor = joint_sensor ? 1.0 : 0.0;
  HealthAnswer answer;
  answer.true_tension = break_it(scenario, fault, error_rms_rad_, random);
  Watcher watcher(scenario);
  for (const std::string& line : lines_) {
    watcher.say(line);
  }
  watcher.say("arm");
  const double hz = 0.2 + 0.3 * random.uniform();
  TendonHealth last = TendonHealth::kNothing;
  for (long i = 0; i < std::lround((kOnsetS + seconds) * kCycleRateHz); ++i) {
    const double t = sim::kStepS * static_cast<double>(i);
    const double amplitude = 0.45 + 0.15 * std::sin(0.11 * t);
    watcher.move_to(0.1 * std::sin(0.037 * t) + amplitude * std::sin(6.283185307179586 * hz * t));
    const AxisTelemetry joint = watcher.joint();
    if (joint.tendons != last) {
      last = joint.tendons;
      answer.after_s = t - kOnsetS;
    }
    if (watcher.fault() != Fault::kNone) {
      throw Refusal(std::string("the firmware stopped: ") + info(watcher.fault()).name);
    }
  }
  const AxisTelemetry joint = watcher.joint();
  answer.health = joint.tendons;
  answer.tension = joint.tension.to_double();
  answer.pretension_n = joint.pretension_n.to_double();
  answer.pretension_95_n = joint.pretension_95_n.to_double();
  answer.warnings = joint.warnings;
  return answer;
}

}  // namespace capstan::tools::plant
