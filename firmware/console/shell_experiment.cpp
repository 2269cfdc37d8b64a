// SPDX-License-Identifier: Apache-2.0
// The shell's commands that move a joint to learn about it, and print the log: experiment, palpate.
#include <algorithm>

#include "capstan/firmware/console/shell_commands.hpp"
#include "capstan/firmware/console/shell_experiment.hpp"

namespace capstan {

namespace {

/// A recipe as the shell knows it.
struct RecipeInfo {
  const char* name;
  Recipe recipe;
  const char* rungs;       ///< the option that gives them
  const char* rungs_unit;  ///< also of one rung
  Q24 amplitude;
  std::array<Q24, 4> usual_rungs;
  std::size_t usual_count;
  std::int32_t cycles;
  std::int32_t repeats;
};

constexpr std::int32_t kMostEvery = 1000;
constexpr Q24 kOne = Q24::from_int(1);

constexpr auto q(double value) -> Q24 {
  return Q24::from_double(value);
}
constexpr std::int32_t kUsualSeconds = 20;
constexpr Q24 kUsualDecay = q(0.15);

// What somebody gets who names the recipe only: small and slow, within the limits that a joint has by default.
constexpr std::array<RecipeInfo, 7> kRecipes = {{
    {"sine_ladder", Recipe::kSineLadder, "frequencies", "Hz", q(0.2), {q(0.1), q(0.2), q(0.4), q(0.8)}, 4, 2, 3},
    {"multisine", Recipe::kMultisine, "frequencies", "Hz", q(0.2), {q(0.1), q(0.3), q(0.7), {}}, 3, 1, 4},
    {"decaying_sine", Recipe::kDecayingSine, "frequencies", "Hz", q(0.4), {q(0.5), {}, {}, {}}, 1, 1, 3},
    {"triangle", Recipe::kTriangle, "speeds", "rad/s", q(0.4), {q(0.4), {}, {}, {}}, 1, 3, 3},
    {"speed_ladder", Recipe::kSpeedLadder, "speeds", "rad/s", q(0.4), {q(0.15), q(0.4), q(1.0), q(1.8)}, 4, 2, 3},
    {"reversals", Recipe::kReversals, "speeds", "rad/s", q(0.4), {q(0.4), {}, {}, {}}, 1, 1, 2},
    {"torque_triangle", Recipe::kTorqueTriangle, "rates", "Nm/s", q(0.05), {q(0.05), {}, {}, {}}, 1, 2, 1},
}};
constexpr const RecipeInfo& kPalpation = kRecipes.back();

auto recipe_named(std::string_view name) -> const RecipeInfo* {
  const auto* const found =
      std::find_if(kRecipes.begin(), kRecipes.end(), [name](const RecipeInfo& recipe) { return name == recipe.name; });
  return found == kRecipes.end() ? nullptr : found;
}

constexpr ExperimentSetup kPlain{.length_ms = kUsualSeconds * 1000};

void take_usual(ExperimentSetup& setup, const RecipeInfo& recipe, std::size_t axis) {
  setup = kPlain;
  setup.recipe = recipe.recipe;
  setup.axis = static_cast<std::uint8_t>(axis);
  setup.amplitude = recipe.amplitude;
  setup.rung_count = recipe.usual_count;
  setup.cycles = recipe.cycles;
  setup.repeats = recipe.repeats;
  std::copy(recipe.usual_rungs.begin(), recipe.usual_rungs.end(), setup.rungs.begin());
  setup.decay_per_s = recipe.recipe == Recipe::kDecayingSine ? kUsualDecay : Q24{};
}

constexpr auto make_recipe_names() -> std::array<const char*, kRecipes.size() + 1> {
  std::array<const char*, kRecipes.size() + 1> names{};
  for (std::size_t i = 0; i < kRecipes.size(); ++i) {
    names[i] = kRecipes[i].name;
  }
  names.back() = "chirp";
  return names;
}
constexpr auto kRecipeNames = make_recipe_names();

/// "0.1,0.3Hz,1"
auto parse_rungs(std::string_view text, const char* unit, ExperimentSetup& setup) -> bool {
  setup.rung_count = 0;
  while (!text.empty()) {
    const std::size_t comma = std::min(text.find(','), text.size());
    if (setup.rung_count == ExperimentSetup::kMostRungs ||
        parse_quantity(std::string_view(text.data(), comma), unit, setup.rungs[setup.rung_count++]) !=
            ValueError::kNone) {
      return false;
    }
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
  return setup.rung_count > 0;
}

/// What a line asks for besides the recipe itself.
struct Options {
  std::int32_t every = 10;
  std::int32_t site = -1;
};

/// One "name=value" of the line.
auto parse_option(std::string_view word, const RecipeInfo& recipe, ExperimentSetup& setup, Options& options) -> bool {
  const std::size_t sign = std::min(word.find('='), word.size());
  const std::string_view name(word.data(), sign);
  const std::string_view value(word.data() + std::min(sign + 1, word.size()),
                               word.size() - std::min(sign + 1, word.size()));
  const bool torque = recipe.recipe == Recipe::kTorqueTriangle;
  const auto quantity = [&value](const char* unit, Q24& into) {
    return parse_quantity(value, unit, into) == ValueError::kNone;
  };
  std::int32_t seconds = 0;
  if (name == "amplitude") {
    return quantity(torque ? "Nm" : "rad", setup.amplitude);
  }
  if (name == "offset") {
    return torque ? quantity("Nm", setup.offset_nm) : quantity("rad", setup.offset_rad);
  }
  if (name == "decay") {
    return recipe.recipe == Recipe::kDecayingSine && quantity("1/s", setup.decay_per_s);
  }
  if (name == "duration") {
    const bool good = recipe.recipe <= Recipe::kDecayingSine && parse_count(value, 1, 1000, seconds);
    setup.length_ms = good ? static_cast<std::uint32_t>(seconds) * 1000 : setup.length_ms;
    return good;
  }
  if (name == "levels") {
    return recipe.recipe == Recipe::kReversals && parse_count(value, 2, 100, setup.levels);
  }
  return (name == recipe.rungs && parse_rungs(value, recipe.rungs_unit, setup)) ||
         (name == "cycles" && parse_count(value, 1, 1000, setup.cycles)) ||
         (name == "repeats" && parse_count(value, 1, 1000, setup.repeats)) ||
         (name == "every" && parse_count(value, 1, kMostEvery, options.every)) ||
         (name == "site" && parse_count(value, 0, 9999, options.site));
}

/// The stream, or nullptr if it was refused. `palpating`: the stiffness will be told. It needs the mean of every cycle,
/// not the rows that a console has time for: noise that is left shows other phases of the tendons than they are in.
auto begin_experiment(Session& session, const RecipeInfo& recipe, std::size_t axis, std::string_view arguments,
                      bool palpating = false) -> ExperimentStream* {
  auto& stream = session.make<ExperimentStream>();
  ExperimentSetup& setup = stream.setup;
  take_usual(setup, recipe, axis);
  Options options;
  for (std::string_view word = next_word(arguments); !word.empty(); word = next_word(arguments)) {
    if (refuses_repeat(session, word, arguments)) {
      return nullptr;
    }
    if (!parse_option(word, recipe, setup, options)) {
      session.out() << "error option: '" << word << "' is not understood by " << recipe.name
                    << ", and nothing moved; write 'amplitude=" << recipe.amplitude
                    << (recipe.recipe == Recipe::kTorqueTriangle ? "Nm " : "rad ") << recipe.rungs << '='
                    << recipe.usual_rungs[0] << recipe.rungs_unit
                    << "', numbers in their range (every: 1 to 1000 ms); 'help experiment' shows all\r\n";
      session.refused();
      return nullptr;
    }
  }
  if (const char* problem = check_experiment(setup, session.machine().config()[axis])) {
    refuse_experiment(session, problem);
    return nullptr;
  }
  if (recipe.recipe == Recipe::kMultisine && session.machine().telemetry().state == State::kHolding) {
    scale_tones(setup);
  }
  stream.recording.site = options.site;
  stream.recording.choose(axis);
  stream.palpating = palpating;
  stream.recording.print_every = static_cast<std::uint32_t>(options.every);
  stream.recording.setup.every = palpating ? 1 : stream.recording.print_every;
  return stream.begin(session) ? &stream : nullptr;
}

}  // namespace

auto recipe_names() -> std::span<const char* const> {
  return kRecipeNames;
}

void refuse_experiment(Session& session, const char* problem) {
  session.out() << "error range: nothing moved, because " << problem << "\r\n";  // it ends in its own cure
  session.refused();
}

auto hand_over(Session& session, const ExperimentSetup& setup) -> bool {
  const char* problem = session.machine().begin_experiment(setup);
  if (problem != nullptr) {
    session.machine().recorder().stop(&session);
    refuse_experiment(session, problem);
  }
  return problem == nullptr;
}

auto ExperimentStream::begin(Session& session) -> bool {
  if (session.machine().telemetry().state != State::kHolding) {
    session.error("not_holding", "an experiment begins with torque on and every joint at rest",
                  "'arm' first, or wait until the joints stand");
    return false;
  }
  if (session.has_beside()) {
    session.error("frames_on", "frames are being sent, one recorder serves both, and nothing moved",
                  "'frames off' first");
    return false;
  }
  if (!session.machine().requests_taken()) {
    session.error("busy", "the cycle has not taken the last request yet, and nothing moved", "send the line again");
    return false;
  }
  if (!recording.begin(session) || !hand_over(session, setup)) {
    return false;
  }
  session.begin(*this);
  return true;
}

void ExperimentStream::step(Session& session) {
  Machine& machine = session.machine();
  if (!machine.requests_taken()) {
    return;  // or the phase could be that of the last one
  }
  const MachineTelemetry now = machine.telemetry();
  if (cancelled_ && now.state == State::kExperiment && !session.disarming()) {
    static_cast<void>(machine.post({.kind = Request::Kind::kStop, .axis = setup.axis}));
  }
  const bool over = now.experiment == ExperimentPhase::kDone || now.experiment == ExperimentPhase::kEnded;
  if (print_rows(session) && over) {
    answer(session, now);
  }
}

/// True: all that were there.
auto ExperimentStream::print_rows(Session& session) -> bool {
  Machine& machine = session.machine();
  const StepTime time(machine);
  SignalSample sample;
  while (machine.recorder().next(sample)) {
    if (sample.raw[recording.setup.count - 1] != static_cast<std::int32_t>(ExperimentPhase::kRunning)) {
      continue;
    }
    recording.print_row(session.out(), sample);
    if (palpating) {
      machine.palpation().add(Q24::from_raw(sample.raw[0]), Q24::from_raw(sample.raw[1]));
    }
    if (!time.left()) {
      return false;
    }
  }
  return true;
}

void ExperimentStream::answer(Session& session, const MachineTelemetry& now) {
  const std::uint32_t dropped = recording.end(session);
  const bool response =
      std::string_view(recording.setup.signals[recording.setup.count - 2].info->name) == kResponseMark;
  if (now.experiment == ExperimentPhase::kDone && response && dropped != 0) {
    session.error("dropped", "the console is too slow for this many rows, and a response needs every one",
                  "give a multisine a larger odd 'every', such as 11 at 115200 baud, and a duration to go with it");
  } else if (now.experiment == ExperimentPhase::kDone) {
    if (palpating) {
      print_stiffness(session);
    }
    session.ok();
  } else if (now.first_fault != Fault::kNone) {
    print_fault(session, "ended by ", info(now.first_fault));
    session.error("aborted", "a fault took the torque away before the experiment was over",
                  "read 'faults', then 'disarm'");
  } else {
    session.error("aborted", "the experiment ended early, or the joint left its limits or its corridor",
                  "lower what was asked for, or start it again");
  }
}

void commands::experiment(Session& session, std::string_view arguments) {
  std::string_view joint = next_word(arguments);
  const std::string_view name = next_word(arguments);
  const RecipeInfo* recipe = recipe_named(name);
  std::size_t axis = 0;
  if (!session.parse_axis(joint, axis) || !joint.empty()) {
    session.error("unknown_joint", "there is no such joint", "write 'experiment joint0 sine_ladder'");
  } else if (asks_for_response(name, arguments)) {
    begin_response(session, name, axis, arguments);
  } else if (recipe == nullptr) {
    session.error(
        "unknown_recipe", "there is no such recipe, and nothing moved",
        "sine_ladder, multisine, chirp, decaying_sine, triangle, speed_ladder, reversals and torque_triangle are");
  } else {
    static_cast<void>(begin_experiment(session, *recipe, axis, arguments));
  }
}

void commands::palpate(Session& session, std::string_view arguments) {
  std::string_view joint = next_word(arguments);
  std::size_t axis = 0;
  if (joint == "map" || joint == "clear") {
    Q24 factor = Palpation::kStiffFactor;
    std::string_view rest = arguments;
    if (joint == "map" && parse_quantity(next_word(rest), "1", factor) == ValueError::kNone && factor >= kOne) {
      arguments = rest;
    }
    if (refuses_more(session, arguments)) {
      return;
    }
    if (joint == "clear") {
      session.machine().palpation().clear();
    }
    print_palpation_map(session, factor);
    return;
  }
  if (!session.parse_axis(joint, axis) || !joint.empty()) {
    session.error("unknown_joint", "there is no such joint", "write 'palpate joint0 site=1'");
  } else {
    const ForceConfig& force = session.machine().config()[axis].force;
    const char* problem = Palpation::check(force);
    if (problem != nullptr) {  // before the log, which is one from its header on
      session.out() << "# no stiffness will be reported: " << problem << "\r\n";
    }
    ExperimentStream* const stream = begin_experiment(session, kPalpation, axis, arguments, problem == nullptr);
    if (stream != nullptr && stream->palpating) {
      session.machine().palpation().begin(force,
                                          {.site = std::max<std::int32_t>(stream->recording.site, 0),
                                           .largest_nm = abs(stream->setup.offset_nm) + stream->setup.amplitude});
    }
  }
}

}  // namespace capstan
