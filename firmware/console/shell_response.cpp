// SPDX-License-Identifier: Apache-2.0
// The experiments that measure a frequency response: chirp, and multisine with `on=`.
#include "capstan/firmware/console/shell_commands.hpp"
#include "capstan/firmware/console/shell_experiment.hpp"

namespace capstan {
namespace {

constexpr std::array<std::string_view, 6> kLogged = {"q1", "drive_torque", "q2", "reference", "current", kResponseMark};
/// Of the torque of limits.continuous_current: 7.5 mNm on the forceps, two and a half times its motor's own friction.
/// docs/tuning.md was measured with 8 mNm before and 5 mNm after.
constexpr Q24 kUsualShare = Q24::from_double(0.05);
constexpr Q24 kUsualReference = Q24::from_double(0.01);
constexpr Q24 kUsualSpeedShare = Q24::from_double(0.05);  // of limits.joint_speed
constexpr std::int32_t kLongest = 600;

constexpr ExperimentSetup kUsual{
    .recipe = Recipe::kResponse,
    .excitation = {.from_khz = Q24::from_double(0.001), .length_ms = 20 * 1000, .corridor_rad = Q24::from_double(0.1)}};

void take_usual(ExcitationSetup& own, bool chirp, bool reference, const AxisConfig& config) {
  using Setup = ExcitationSetup;
  own.kind = chirp ? Setup::Kind::kChirp : Setup::Kind::kMultisine;
  own.point = reference ? Setup::Point::kJointReference : Setup::Point::kMotorTorque;
  own.amplitude = reference
                      ? kUsualReference
                      : config.limits.continuous_current_a * config.motor.torque_per_current_nm_per_a * kUsualShare;
  own.to_khz = Q24::from_double(reference ? 0.003 : 0.2);
  own.speed_rad_s = config.limits.joint_speed_rad_s * kUsualSpeedShare;
}

/// Hz, also above the 128 where Q24 ends.
auto parse_frequency(std::string_view text, Q24& khz) -> bool {
  std::size_t used = 0;
  if (parse_scaled(text, {.exponent = -3}, khz, used) != ParseResult::kOk) {
    return false;
  }
  text.remove_prefix(used);
  return text.empty() || text == "Hz";
}

/// One "name=value" of the line.
auto parse_option(std::string_view word, ExperimentSetup& setup, std::int32_t& every) -> bool {
  const std::size_t sign = std::min(word.find('='), word.size());
  const std::string_view name(word.data(), sign);
  const std::string_view value(word.data() + std::min(sign + 1, word.size()),
                               word.size() - std::min(sign + 1, word.size()));
  ExcitationSetup& own = setup.excitation;
  const auto quantity = [&value](const char* unit, Q24& into) {
    return parse_quantity(value, unit, into) == ValueError::kNone;
  };
  const bool torque = own.point == ExcitationSetup::Point::kMotorTorque;
  std::int32_t seconds = 0;
  if (name == "duration") {
    const bool good = parse_count(value, 1, kLongest, seconds);
    own.length_ms = good ? static_cast<std::uint32_t>(seconds) * 1000U : own.length_ms;
    return good;
  }
  return (name == "on" && value == (torque ? "torque" : "reference")) ||
         (name == "amplitude" && quantity(torque ? "Nm" : "rad", own.amplitude)) ||
         (name == "from" && parse_frequency(value, own.from_khz)) ||
         (name == "to" && parse_frequency(value, own.to_khz)) ||
         (name == "offset" && quantity("rad", setup.offset_rad)) ||
         (name == "travel" && quantity("rad", own.travel_rad)) ||
         (name == "speed" && quantity("rad/s", own.speed_rad_s)) ||
         (name == "corridor" && quantity("rad", own.corridor_rad)) ||
         (name == "every" && parse_count(value, 1, 1000, every));
}

/// nullptr, or why rows so far apart can not show it.
auto check_rows(const ExcitationSetup& setup, std::int32_t every) -> const char* {
  if (every == 1) {
    return nullptr;
  }
  if (setup.kind == ExcitationSetup::Kind::kChirp || setup.travel_rad != Q24{}) {
    return "a chirp, or a joint that travels, needs every row; leave 'every' out, or excite a joint at rest with a "
           "multisine";
  }
  if (every % 2 == 0) {
    return "rows an even number of ms apart always meet a multisine at the same places; give an odd 'every'";
  }
  // The first window settles, and two are the least that tell noise.
  return setup.length_ms < 3 * ExcitationSetup::kPeriodMs * static_cast<std::uint32_t>(every)
             ? "rows that far apart need a longer duration: three times 2.048 s times 'every' at least; raise it"
             : nullptr;
}

}  // namespace

auto asks_for_response(std::string_view recipe, std::string_view arguments) -> bool {
  const std::string_view word = next_word(arguments);
  return recipe == "chirp" || (recipe == "multisine" && word.size() >= 3 && std::string_view(word.data(), 3) == "on=");
}

void begin_response(Session& session, std::string_view recipe, std::size_t axis, std::string_view arguments) {
  const AxisConfig& config = session.machine().config()[axis];
  const bool chirp = recipe == "chirp";
  auto& stream = session.make<ExperimentStream>();
  ExperimentSetup& setup = stream.setup;
  setup = kUsual;
  setup.axis = static_cast<std::uint8_t>(axis);
  setup.offset_rad = session.machine().axis_telemetry(axis).q2_rad;
  std::string_view first = arguments;
  take_usual(setup.excitation, chirp, next_word(first) == "on=reference", config);
  std::int32_t every = 1;
  for (std::string_view word = next_word(arguments); !word.empty(); word = next_word(arguments)) {
    if (refuses_repeat(session, word, arguments)) {
      return;
    }
    if (!parse_option(word, setup, every)) {
      session.out()
          << "error option: '" << word << "' is not understood by " << recipe
          << ", and nothing moved; write 'on=torque amplitude=5mNm from=1Hz to=200Hz duration=20', 'on=' before "
             "all others, numbers in their range; 'help experiment' shows all\r\n";
      session.refused();
      return;
    }
  }
  ExcitationSetup& own = setup.excitation;
  constexpr std::uint32_t kPeriod = ExcitationSetup::kPeriodMs;
  if (!chirp) {
    own.length_ms = (own.length_ms + kPeriod - 1) / kPeriod * kPeriod;
  }
  const char* problem = check_rows(own, every);
  if (problem == nullptr) {
    problem = check_experiment(setup, config);
  }
  if (problem != nullptr) {
    refuse_experiment(session, problem);
    return;
  }
  prepare_excitation(own);
  choose_signals(stream.recording.setup, axis, kLogged);
  stream.recording.setup.every = static_cast<std::uint32_t>(every);
  static_cast<void>(stream.begin(session));
}

}  // namespace capstan
