// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/campaign/commissioned.hpp"

#include <stdexcept>
#include <string>

#include "capstan/boards/common/file_banks.hpp"
#include "capstan/firmware/console/shell.hpp"
#include "capstan/firmware/loop/application.hpp"
#include "capstan/hal/sim/sim_io.hpp"

namespace capstan::tools {
namespace {

constexpr int kMostCycles = 200'000;  // for one answer

class Answers final : public TextSink {
 public:
  auto take() -> std::string { return std::exchange(text_, {}); }

 private:
  void do_write(std::string_view text) override { text_.append(text); }
  std::string text_;
};

/// As strict as a board with a real joint.
struct StrictBoard final : Board {
  [[nodiscard]] auto name() const -> const char* override { return "campaign"; }
  void print_timing(Print& /*out*/) const override {}
  void reboot() override {}
};

class Operator {
 public:
  Operator(const sim::PlantParameters& plant, AxisConfig config, std::uint64_t seed) : plant_(plant, seed) {
    config.observer = {};
    static_cast<void>(application_.configure({&config, 1}, Rights::kMaintenance));
    for (int i = 0; i < 100; ++i) {
      application_.rt_tick();
    }
  }
  void say(std::string_view line) {
    for (const char c : line) {
      shell_.receive(c);
    }
    shell_.receive('\n');
    for (int i = 0; i < kMostCycles && shell_.busy(); ++i) {
      application_.rt_tick();
      shell_.poll();
    }
    const std::string answer = answers_.take();
    if (!answer.ends_with("ok\r\n")) {
      const Fault fault = application_.telemetry().first_fault;
      throw std::runtime_error("'" + std::string(line) + "' was answered with " + answer +
                               "latched: " + info(fault).name);
    }
  }
  void wait(int cycles) {
    for (int i = 0; i < cycles; ++i) {
      application_.rt_tick();
      shell_.poll();
    }
  }
  [[nodiscard]] auto observer() const -> ObserverConfig { return application_.config()[0].observer; }

 private:
  sim::Plant plant_;
  SimIo io_{plant_};
  FileBanks banks_ = FileBanks::temporary();
  Application<SimIo> application_{io_, banks_};
  Answers answers_;
  StrictBoard board_;
  Shell shell_{application_, answers_, board_, false};
};

}  // namespace

auto commissioned(const sim::PlantParameters& plant, const AxisConfig& config, std::uint64_t seed) -> ObserverConfig {
  Operator operate(plant, config, seed);
  operate.say("maintenance open");
  operate.say("arm");
  operate.wait(300);
  operate.say("commission joint0");
  operate.wait(300);  // nobody arms in the cycle in which torque went
  operate.say("arm");
  operate.wait(300);
  operate.say("commission joint0 looks");
  return operate.observer();
}

}  // namespace capstan::tools
