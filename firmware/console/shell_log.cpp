// SPDX-License-Identifier: Apache-2.0
// The shell's commands that stream a log by the contract: log, experiment, palpate.
#include <algorithm>

#include "capstan/firmware/console/shell_commands.hpp"

namespace capstan {

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

namespace {

constexpr std::int32_t kMostEvery = 1000;
constexpr std::array<std::string_view, 5> kLogged = {"q1", "torque", "q2", "reference", "current"};

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

/// A whole number in a range.
auto parse_count(std::string_view text, std::int32_t minimum, std::int32_t maximum, std::int32_t& value) -> bool {
  return parse_integer(text, value) == ParseResult::kOk && value >= minimum && value <= maximum;
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
    return !torque && quantity("rad", setup.offset_rad);
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

}  // namespace

auto recipe_names() -> std::span<const char* const> {
  return kRecipeNames;
}

void ShellCommands::log(Shell& shell, std::string_view arguments) {
  constexpr std::int32_t kLongest = 1'000'000;
  std::string_view joint = next_word(arguments);
  std::size_t axis = 0;
  const std::string_view count_text = next_word(arguments);
  const std::string_view every_text = next_word(arguments);
  std::int32_t count = 0;
  std::int32_t every = 1;
  if (!shell.parse_axis(joint, axis) || !joint.empty() || !parse_count(count_text, 1, kLongest, count) ||
      (!every_text.empty() && !parse_count(every_text, 1, kMostEvery, every))) {
    shell.error("usage", "log takes a joint, a count up to 1000000 and a spacing of 1 to 1000 ms",
                "write 'log joint0 100 10'");
    return;
  }
  shell.log_site_ = -1;
  if (shell.begin_recording(axis, static_cast<std::uint32_t>(every))) {
    shell.log_left_ = static_cast<std::uint32_t>(count);
    shell.activity_ = Shell::Activity::kLogging;
  }
}

/// Prints the header. False: the recorder is not free, and that was answered.
auto Shell::begin_recording(std::size_t axis, std::uint32_t every) -> bool {
  if (framing_) {
    error("frames_on", "frames are being sent, and one recorder serves both", "'frames off' first");
    return false;
  }
  choose_signals(recorded_, axis, kLogged);
  return begin_recording(every);
}

/// Of what is in recorded_, whose last signal is not printed.
auto Shell::begin_recording(std::uint32_t every) -> bool {
  recorded_.every = every;
  if (!machine_.recorder().start(this, recorded_)) {
    error("busy", "the recorder is in use, by another console or still by the last command", "send the line again");
    return false;
  }
  log_dropped_before_ = machine_.recorder().dropped();
  out_ << "time_s" << (log_site_ >= 0 ? ",site" : "");
  for (std::size_t i = 0; i + 1 < recorded_.count; ++i) {
    out_ << ',';
    print_column(out_, recorded_.signals[i]);
  }
  out_ << "\r\n";
  return true;
}

void Shell::print_row(const SignalSample& sample) {
  print_seconds(out_, sample.tick);
  if (log_site_ >= 0) {
    out_ << ',' << log_site_;
  }
  for (std::size_t i = 0; i + 1 < recorded_.count; ++i) {
    out_ << ',';
    print_raw(out_, recorded_.signals[i], sample.raw[i]);
  }
  out_ << "\r\n";
}

auto Shell::end_recording() -> std::uint32_t {
  machine_.recorder().stop(this);
  const std::uint32_t dropped = machine_.recorder().dropped() - log_dropped_before_;
  if (dropped != 0) {
    out_ << "# " << dropped << " samples found no room; log every " << 2 * recorded_.every << " or fewer at a time\r\n";
  }
  return dropped;
}

void Shell::go_on_logging() {
  SignalSample sample;
  while (log_left_ > 0 && machine_.recorder().next(sample)) {
    --log_left_;
    print_row(sample);
  }
  if (log_left_ == 0) {
    static_cast<void>(end_recording());
    ok();
  }
}

void ShellCommands::experiment(Shell& shell, std::string_view arguments) {
  std::string_view joint = next_word(arguments);
  const std::string_view name = next_word(arguments);
  const RecipeInfo* recipe = recipe_named(name);
  std::size_t axis = 0;
  if (!shell.parse_axis(joint, axis) || !joint.empty()) {
    shell.error("unknown_joint", "there is no such joint", "write 'experiment joint0 sine_ladder'");
  } else if (asks_for_response(name, arguments)) {
    begin_response(shell, name, axis, arguments);
  } else if (recipe == nullptr) {
    shell.error(
        "unknown_recipe", "there is no such recipe, and nothing moved",
        "sine_ladder, multisine, chirp, decaying_sine, triangle, speed_ladder, reversals and torque_triangle are");
  } else {
    begin_experiment(shell, *recipe, axis, arguments);
  }
}

void ShellCommands::palpate(Shell& shell, std::string_view arguments) {
  std::string_view joint = next_word(arguments);
  std::size_t axis = 0;
  if (joint == "map" || joint == "clear") {
    if (joint == "clear") {
      shell.machine_.palpation().clear();
    }
    palpation_map(shell);
    return;
  }
  if (!shell.parse_axis(joint, axis) || !joint.empty()) {
    shell.error("unknown_joint", "there is no such joint", "write 'palpate joint0 site=1'");
  } else {
    const ForceConfig& force = shell.machine_.config()[axis].force;
    const char* problem = Palpation::check(force);
    if (problem != nullptr) {  // before the log, which is one from its header on
      shell.out_ << "# no stiffness will be told: " << problem << "\r\n";
    }
    begin_experiment(shell, kPalpation, axis, arguments);
    if (problem == nullptr && shell.activity_ == Shell::Activity::kExperimenting) {
      shell.palpating_ = true;
      shell.machine_.palpation().begin(force, std::max<std::int32_t>(shell.log_site_, 0),
                                       static_cast<std::int32_t>(shell.recorded_.every));
    }
  }
}

void ShellCommands::begin_experiment(Shell& shell, const RecipeInfo& recipe, std::size_t axis,
                                     std::string_view arguments) {
  ExperimentSetup& setup = shell.setup_;
  take_usual(setup, recipe, axis);
  Options options;
  for (std::string_view word = next_word(arguments); !word.empty(); word = next_word(arguments)) {
    if (!parse_option(word, recipe, setup, options)) {
      shell.out_ << "error option: '" << word << "' is not understood by " << recipe.name
                 << ", and nothing moved; write 'amplitude=0.2rad " << recipe.rungs << '=' << recipe.usual_rungs[0]
                 << recipe.rungs_unit << "', numbers in their range; 'help experiment' shows all\r\n";
      shell.prompt();
      return;
    }
  }
  if (const char* problem = check_experiment(setup, shell.machine_.config()[axis])) {
    shell.out_ << "error range: nothing moved, because " << problem << "\r\n";  // it ends in its own cure
    shell.prompt();
    return;
  }
  if (recipe.recipe == Recipe::kMultisine && shell.machine_.telemetry().state == State::kHolding) {
    scale_tones(setup);
  }
  shell.log_site_ = options.site;
  choose_signals(shell.recorded_, axis, kLogged);
  start_experiment(shell, static_cast<std::uint32_t>(options.every));
}

void ShellCommands::start_experiment(Shell& shell, std::uint32_t every) {
  shell.palpating_ = false;
  if (shell.machine_.telemetry().state != State::kHolding) {
    shell.error("not_holding", "an experiment begins with torque on and every joint at rest",
                "'arm' first, or wait until the joints stand");
    return;
  }
  if (shell.framing_) {
    shell.error("frames_on", "frames are being sent, one recorder serves both, and nothing moved",
                "'frames off' first");
    return;
  }
  if (!shell.machine_.settled()) {
    shell.error("busy", "the cycle has not taken the last request yet, and nothing moved", "send the line again");
    return;
  }
  if (!shell.begin_recording(every)) {
    return;
  }
  static_cast<void>(shell.machine_.begin_experiment(shell.setup_));  // its way to the cycle is free, see above
  shell.log_left_ = 1;
  shell.activity_ = Shell::Activity::kExperimenting;
}

void Shell::go_on_experimenting() {
  if (!machine_.settled()) {
    return;  // or the phase could be that of the last one
  }
  const MachineTelemetry now = machine_.telemetry();
  SignalSample sample;
  while (machine_.recorder().next(sample)) {
    if (sample.raw[recorded_.count - 1] == static_cast<std::int32_t>(ExperimentPhase::kRunning)) {
      print_row(sample);
      if (palpating_) {
        machine_.palpation().add(Q24::from_raw(sample.raw[0]), Q24::from_raw(sample.raw[1]));
      }
    }
  }
  if (log_left_ == 0 && now.state == State::kExperiment && urgent_ == Urgent::kNone) {  // somebody wants it to end
    static_cast<void>(machine_.post({.kind = Request::Kind::kStop, .axis = recorded_.signals[0].axis}));
  }
  if (now.experiment != ExperimentPhase::kDone && now.experiment != ExperimentPhase::kEnded) {
    return;
  }
  const std::uint32_t dropped = end_recording();
  const bool response = std::string_view(recorded_.signals[recorded_.count - 2].info->name) == kResponseMark;
  if (now.experiment == ExperimentPhase::kDone && response && dropped != 0) {
    error("dropped", "the console is too slow for this many rows, and a response needs every one",
          "give a multisine a larger odd 'every', such as 11 at 115200 baud, and a duration to go with it");
  } else if (now.experiment == ExperimentPhase::kDone) {
    if (palpating_) {
      print_stiffness();
    }
    ok();
  } else if (now.first_fault != Fault::kNone) {
    print_fault("ended by ", info(now.first_fault));
    error("aborted", "a fault took the torque away before the experiment was over", "read 'faults', then 'disarm'");
  } else {
    error("aborted", "the experiment was ended before it was over, or the joint left its limits or its corridor",
          "lower what was asked for, or begin it again");
  }
}

}  // namespace capstan
