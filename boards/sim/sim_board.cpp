// SPDX-License-Identifier: Apache-2.0
#include "capstan/boards/sim/sim_board.hpp"

#include <algorithm>
#include <stdexcept>

#include "capstan/firmware/loop/application.hpp"
#include "capstan/hal/sim/multi_plant.hpp"
#include "capstan/hal/sim/sim_io.hpp"

namespace capstan {

/// Plant and firmware, whatever their number of axes.
class SimBoard::Joints {
 public:
  virtual ~Joints() = default;
  virtual void tick(std::span<const double> references_rad) = 0;
  virtual void put_on_bench(std::span<const double> currents_a) = 0;
  virtual void schedule(const sim::Fault& fault) = 0;
  virtual auto machine() -> Machine& = 0;
  virtual auto truth(std::size_t axis) const -> const sim::Truth& = 0;
  virtual void link_lost() = 0;
};

template <std::size_t Axes, class PlantType>
class SimBoard::JointsOf final : public SimBoard::Joints {
 public:
  JointsOf(PlantType plant, Banks& banks, std::span<std::uint32_t> fault_memory)
      : plant_(std::move(plant)), io_(plant_), application_(io_, banks, fault_memory) {}

  void tick(std::span<const double> references_rad) override {
    typename Application<Io>::Streamed streamed{};
    for (std::size_t i = 0; i < std::min(Axes, references_rad.size()); ++i) {
      streamed[i] = {.kind = Request::Kind::kFollow, .position_rad = Q24::from_double(references_rad[i])};
    }
    application_.rt_tick(streamed);
    if (!io_.failure().empty()) {
      throw std::runtime_error(io_.failure());
    }
  }
  void put_on_bench(std::span<const double> currents_a) override {
    if (currents_a.empty()) {
      io_.take_off_bench();
      return;
    }
    typename Io::Commands commands;
    for (std::size_t i = 0; i < std::min(Axes, currents_a.size()); ++i) {
      commands[i] = {currents_a[i], true};
    }
    io_.put_on_bench(commands);
  }
  void schedule(const sim::Fault& fault) override {
    if (fault.axis >= static_cast<int>(plant_.axis_count())) {
      throw std::invalid_argument("the instrument has no such axis; correct its number");
    }
    plant_.schedule(fault);
  }
  auto machine() -> Machine& override { return application_; }
  auto truth(std::size_t axis) const -> const sim::Truth& override { return plant_.truth(axis); }
  void link_lost() override { application_.link_lost(); }

 private:
  using Io = PlantIo<Axes, PlantType>;
  PlantType plant_;
  Io io_;
  Application<Io> application_;
};

auto SimBoard::make_joints(const sim::Scenario& scenario, Banks& banks, std::span<std::uint32_t> fault_memory)
    -> std::unique_ptr<Joints> {
  const auto several = [&]<std::size_t Axes>() {
    return std::make_unique<JointsOf<Axes, sim::MultiPlant>>(sim::MultiPlant(scenario), banks, fault_memory);
  };
  switch (scenario.other_axes.size()) {
    case 0: {
      sim::Plant plant(scenario.plant, scenario.seed);
      for (const sim::Fault& fault : scenario.faults) {
        plant.schedule(fault);
      }
      return std::make_unique<JointsOf<1, sim::Plant>>(std::move(plant), banks, fault_memory);
    }
    case 1:
      return several.template operator()<2>();
    case 2:
      return several.template operator()<3>();
    case 3:
      return several.template operator()<4>();
    default:
      throw std::runtime_error("the instrument has more axes than a board, which has four; leave axes out of its file");
  }
}

SimBoard::SimBoard(const sim::Scenario& scenario, Banks& banks, TextSink& sink, bool echo,
                   std::span<std::uint32_t> fault_memory)
    : joints_(make_joints(scenario, banks, fault_memory)), shell_(joints_->machine(), sink, *this, echo) {}

SimBoard::~SimBoard() = default;

void SimBoard::tick(std::span<const double> references_rad) {
  joints_->tick(references_rad);
}

void SimBoard::tick_on_bench(std::span<const double> currents_a) {
  joints_->put_on_bench(currents_a);
  joints_->tick({});
}

auto SimBoard::axes() const -> std::size_t {
  return machine().axes();
}

auto SimBoard::machine() const -> const Machine& {
  return joints_->machine();
}

auto SimBoard::truth(std::size_t axis) const -> const sim::Truth& {
  return joints_->truth(axis);
}

void SimBoard::link_lost() {
  joints_->link_lost();
}

void SimBoard::set_lateness(std::chrono::nanoseconds late) {
  late_ = std::chrono::duration_cast<std::chrono::microseconds>(late);
  latest_ = std::max(latest_, late_);
  in_real_time_ = true;
}

void SimBoard::print_timing(Print& out) const {
  if (!in_real_time_) {
    out << "simulated joint, as fast as it goes: the board's time is the plant's\r\n";
    return;
  }
  out << "simulated joint in an ordinary thread: the last cycle began " << static_cast<std::int32_t>(late_.count())
      << " us late, the latest " << static_cast<std::int32_t>(latest_.count()) << " us\r\n";
}

auto SimBoard::run_command(std::string_view word, std::string_view rest, Print& out) -> BoardAnswer {
  if (word != "fail") {
    return BoardAnswer::kUnknown;
  }
  try {
    sim::Fault fault = sim::parse_fault(rest);
    fault.time_s += truth(0).time_s + sim::kStepS;  // the schedule sees one healthy step first, to hold or to delay
    joints_->schedule(fault);
    return BoardAnswer::kDone;
  } catch (const std::exception& refusal) {
    out << "error fault: " << refusal.what() << "\r\n";
    return BoardAnswer::kRefused;
  }
}

void SimBoard::print_commands(Print& out) const {
  out << "  fail TARGET KIND [at SECONDS] [for SECONDS] [amount AMOUNT] [axis N]\r\n"
         "      injects a fault into the simulated joint, now or later: fail encoder stuck for 0.5\r\n";
}

}  // namespace capstan
