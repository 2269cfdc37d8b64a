// SPDX-License-Identifier: Apache-2.0
// Margins that `capstan commission` promises, and what the same joint has when it is shaken again with the new gains.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "capstan/tests/tools/run/drawn_joint.hpp"
#include "capstan/tests/tools/run/number_from.hpp"
#include "capstan/tools/commission/commission.hpp"
#include "capstan/tools/support/errors.hpp"

namespace capstan::tools {
namespace {

struct Pair {
  Margins promised;
  double phase_deg = 0.0, gain_db = 0.0;  ///< measured
};

/// The number before that word of a sentence.
auto number_before(const std::string& sentence, const std::string& word) -> double {
  const std::size_t at = sentence.find(word);
  if (at == std::string::npos) {
    throw BadInput("there is no '" + word + "' in: " + sentence);
  }
  return std::stod(sentence.substr(sentence.rfind(' ', at - 1)));
}

/// Throws Refusal with its sentence where the joint is not commissioned.
auto promised_and_measured(const sim::Scenario& scenario) -> Pair {
  SimShell line(scenario);
  for (const std::string& one : data_sheet(scenario.plant)) {
    line.ask(one);
  }
  for (int i = 0; i < 40; ++i) {
    line.ask("log joint0 50 10");  // what fell, fell
  }
  const Operator person{.tell = [](const std::string&) {},
                        .agrees = [](const std::string&) { return true; },
                        .keep = [](int, const Progress&) {}};
  const CommissionOptions options{
      .axis = 0, .corridor_rad = 1.0, .inertia_kgm2 = scenario.plant.motor_inertia_kgm2, .key = {}, .saves = false};
  const std::vector<std::string> before = line.ask("dump");
  const Commissioned all = commission(line, person, options, {});
  std::string sentence;
  std::vector<Progress> progress = {all.progress};
  try {
    commission_together(line, person, {options}, progress, before);
    for (const std::string& found : progress[0].found) {
      sentence = found.starts_with("with the other joints under control") ? found : sentence;
    }
  } catch (const Refusal& refusal) {
    sentence = refusal.what();  // it has the measured margins, too
    sentence.resize(std::min(sentence.find(", where "), sentence.size()));
  }
  return {.promised = all.tuning->whole_nominal,
          .phase_deg = number_before(sentence, " deg"),
          .gain_db = number_before(sentence, " dB")};
}

/// For a table: CAPSTAN_SEED=1700 CAPSTAN_PLANTS=10 promised_margins_test; of one joint CAPSTAN_INSTRUMENT=raven2:1
TEST(PromisedMargins, AreMeasuredOnDrawnJointsOfAllInstruments) {
  const std::uint64_t first = number_from("CAPSTAN_SEED", 1690);
  const std::uint64_t plants = number_from("CAPSTAN_PLANTS", 1);
  for (const char* name : {"micro_forceps:0", "da_vinci_wrist:0", "robot_finger:0", "raven2:1"}) {
    if (const char* only = std::getenv("CAPSTAN_INSTRUMENT"); only != nullptr && std::string(only) != name) {
      continue;
    }
    std::uint64_t within = 0;
    std::uint64_t tuned = 0;
    for (std::uint64_t seed = first; seed < first + plants; ++seed) {
      try {
        const Pair pair = promised_and_measured(draw(seed, joint_of(name)));
        const double off_deg = pair.phase_deg - pair.promised.phase_deg;
        const double off_db = pair.gain_db - pair.promised.gain_db;
        const bool good = std::fabs(off_deg) <= 5.0 && std::fabs(off_db) <= 1.0;
        std::printf("%s | %llu | %.1f Hz | %.1f %.1f deg | %.1f %.1f dB |%s\n", name,
                    static_cast<unsigned long long>(seed), pair.promised.crossover_hz, pair.promised.phase_deg,
                    pair.phase_deg, pair.promised.gain_db, pair.gain_db, good ? "" : " off");
        ++tuned;
        within += good ? 1 : 0;
        EXPECT_GE(off_deg, -5.0) << name << ' ' << seed << ": less than was promised";
        EXPECT_GE(off_db, -1.0) << name << ' ' << seed << ": less than was promised";
      } catch (const Refusal& refusal) {
        std::printf("%s | %llu | stopped: %s\n", name, static_cast<unsigned long long>(seed), refusal.what());
      }
      std::fflush(stdout);
    }
    std::printf("%s: within 5 deg and 1 dB %llu of %llu\n", name, static_cast<unsigned long long>(within),
                static_cast<unsigned long long>(tuned));
    EXPECT_GT(tuned, 0U) << name;
  }
}

}  // namespace
}  // namespace capstan::tools
