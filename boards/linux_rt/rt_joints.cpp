// SPDX-License-Identifier: Apache-2.0
#include "capstan/boards/linux_rt/rt_joints.hpp"

#include <array>
#include <stdexcept>

#include "capstan/boards/linux_rt/can_report.hpp"
#include "capstan/boards/linux_rt/lined_io.hpp"
#include "capstan/firmware/loop/application.hpp"
#include "capstan/hal/linux/can_joint_io.hpp"
#include "capstan/hal/sim/sim_io.hpp"

namespace capstan {
namespace {

/// Application, lines and backend; what the backend alone can tell is left to those who derive.
template <JointIo Backend>
class JointsOn : public RtJoints {
 public:
  template <typename Source>
  JointsOn(Source&& source, const GpioSetup& gpio, Banks& banks, std::span<std::uint32_t> fault_memory)
      : backend_(std::forward<Source>(source)),
        io_(backend_, GpioLines(gpio)),
        application_(io_, banks, fault_memory) {}

  void rt_tick(std::uint32_t overruns) override {
    io_.rt_set_overruns(overruns);
    application_.rt_tick();
  }
  void release() override { io_.release(); }
  auto machine() -> Machine& override { return application_; }
  void link_lost() override { application_.link_lost(); }

 protected:
  [[nodiscard]] auto backend() const -> const Backend& { return backend_; }

 private:
  Backend backend_;
  LinedIo<Backend, GpioLines> io_;
  Application<LinedIo<Backend, GpioLines>> application_;
};

struct OnePlant {
  sim::Plant plant{{}, 1};
};

class SimulatedJoints final : private OnePlant, public JointsOn<SimIo> {
 public:
  SimulatedJoints(const GpioSetup& gpio, Banks& banks, std::span<std::uint32_t> fault_memory)
      : JointsOn(plant, gpio, banks, fault_memory) {}
  [[nodiscard]] auto simulated() const -> bool override { return true; }
  [[nodiscard]] auto failure() const -> std::string override { return backend().failure(); }
};

template <std::size_t Axes>
class CanJoints final : public JointsOn<CanJointIo<Axes>> {
 public:
  CanJoints(typename CanJointIo<Axes>::Buses buses, const GpioSetup& gpio, Banks& banks,
            std::span<std::uint32_t> fault_memory)
      : JointsOn<CanJointIo<Axes>>(std::move(buses), gpio, banks, fault_memory),
        reports_(this->backend().buses().size()) {}
  ~CanJoints() override { this->release(); }

  void print(Print& out) const override {
    for (const auto& bus : this->backend().buses()) {
      print_counters(out, *bus);
    }
  }
  void report(std::ostream& out) override {
    for (std::size_t i = 0; i < reports_.size(); ++i) {
      reports_[i].say_news(out, *this->backend().buses()[i]);
    }
  }

 private:
  std::vector<CanReport> reports_;
};

template <std::size_t Axes>
auto make(std::vector<std::unique_ptr<CanBus>> buses, const GpioSetup& gpio, Banks& banks,
          std::span<std::uint32_t> fault_memory) -> std::unique_ptr<RtJoints> {
  return std::make_unique<CanJoints<Axes>>(std::move(buses), gpio, banks, fault_memory);
}

}  // namespace

auto simulated_joints(Banks& banks, const GpioSetup& gpio, std::span<std::uint32_t> fault_memory)
    -> std::unique_ptr<RtJoints> {
  return std::make_unique<SimulatedJoints>(gpio, banks, fault_memory);
}

auto can_joints(const CanSetup& setup, const GpioSetup& gpio, Banks& banks, std::span<std::uint32_t> fault_memory,
                std::ostream& out) -> std::unique_ptr<RtJoints> {
  static constexpr std::array kMake = {make<1>, make<2>, make<3>, make<4>};
  std::vector<std::unique_ptr<CanBus>> buses;
  std::size_t drives = 0;
  for (const CanBusSetup& bus : setup.buses) {
    drives += bus.nodes.size();
  }
  if (drives == 0 || drives > kMake.size()) {
    throw std::runtime_error("There are " + std::to_string(drives) + " drives; a board has one to four");
  }
  for (const CanBusSetup& bus : setup.buses) {
    buses.push_back(std::make_unique<CanBus>(bus, setup, out));
  }
  for (const auto& bus : buses) {
    bus->catch_up();
  }
  return kMake[drives - 1](std::move(buses), gpio, banks, fault_memory);
}

}  // namespace capstan
