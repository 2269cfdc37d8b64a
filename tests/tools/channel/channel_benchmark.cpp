// SPDX-License-Identifier: Apache-2.0
// Hurts channels of clean logs by chance and prints what the gate makes of them, as a confusion matrix.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>

#include "capstan/tests/tools/channel/faulty_log.hpp"

namespace capstan::tools::test {
namespace {

struct Options {
  int logs = 500;
  std::uint64_t seed = 1;
  bool verbose = false;
};

constexpr const char* kColumns[] = {"held", "late", "unsigned", "spikes", "degrees", "time", "other", "nothing"};

/// Column of the matrix for each verdict.
auto words_of(const Verdicts& verdicts) -> std::map<std::string, int> {
  std::map<std::string, int> words;
  for (const auto& finding : verdicts.findings) {
    const std::string word = fault_word(finding.fault);
    const bool own = word == "held" || word == "late" || word == "unsigned" || word == "spikes" || word == "degrees";
    words[own ? word : "other"] = 1;
  }
  if (verdicts.time_unit) {
    words["time"] = 1;
  }
  if (words.empty()) {
    words["nothing"] = 1;
  }
  return words;
}

struct Row {
  std::map<std::string, int> said;
  int logs = 0, named = 0;
};

void explain(const Options& options, std::uint64_t seed, Injury injury, const Injured& hurt, const Verdicts& verdicts) {
  if (!options.verbose) {
    return;
  }
  std::printf("seed %llu %s, %s of %s, size %.3g:\n", static_cast<unsigned long long>(seed), hurt.log.source.c_str(),
              injury_word(injury), hurt.channel.c_str(), hurt.size);
  for (const auto& finding : verdicts.findings) {
    std::printf("    %s %s: %s\n", fault_word(finding.fault), finding.channel.c_str(), finding.what.c_str());
  }
}

void judge_one(const Options& options, std::uint64_t seed, std::map<Injury, Row>& rows) {
  const ChannelLog clean = clean_log(seed);
  const Verdicts innocent = judged(clean);
  const auto take = [&](Injury injury, const Verdicts& verdicts) {
    Row& row = rows[injury];
    ++row.logs;
    for (const auto& [word, count] : words_of(verdicts)) {
      row.said[word] += count;
    }
  };
  take(Injury::kNone, innocent);
  if (!innocent.findings.empty()) {
    explain(options, seed, Injury::kNone, {clean, "", 0.0}, innocent);
  }
  for (const Injury injury : kInjuries) {
    const Injured hurt = injured(clean, injury, seed);
    if (hurt.channel.empty()) {
      continue;
    }
    const Verdicts verdicts = judged(hurt.log);
    take(injury, verdicts);
    const bool named = is_named(verdicts, injury, hurt.channel);
    rows[injury].named += named ? 1 : 0;
    if (!named) {
      explain(options, seed, injury, hurt, verdicts);
    }
  }
}

auto run(const Options& options) -> int {
  std::map<Injury, Row> rows;
  for (int i = 0; i < options.logs; ++i) {
    judge_one(options, options.seed + static_cast<std::uint64_t>(i), rows);
  }
  std::printf("%-10s %5s", "was", "logs");
  for (const char* column : kColumns) {
    std::printf(" %8s", column);
  }
  std::printf("   right name and channel\n");
  bool good = true;
  for (const auto& [injury, row] : rows) {
    std::printf("%-10s %5d", injury_word(injury), row.logs);
    for (const char* column : kColumns) {
      const auto at = row.said.find(column);
      std::printf(" %8d", at == row.said.end() ? 0 : at->second);
    }
    if (injury == Injury::kNone) {
      const int accused = row.logs - rows[injury].said["nothing"];
      std::printf("   %d accused\n", accused);
      good = good && accused == 0;
    } else {
      std::printf("   %5.1f %%\n", 100.0 * row.named / row.logs);
      good = good && row.named * 100 >= row.logs * 95;
    }
  }
  return good ? 0 : 1;
}

}  // namespace
}  // namespace capstan::tools::test

auto main(int argc, char** argv) -> int {
  capstan::tools::test::Options options;
  CLI::App app{"what the gate says of channels that are hurt by chance"};
  app.add_option("--logs", options.logs, "clean logs, each hurt in every way in turn")->capture_default_str();
  app.add_option("--seed", options.seed, "first seed")->capture_default_str();
  app.add_flag("--verbose", options.verbose, "a line for each wrong answer");
  CLI11_PARSE(app, argc, argv);
  return capstan::tools::test::run(options);
}
