// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "capstan/firmware/console/shell.hpp"
#include "capstan/firmware/loop/application.hpp"
#include "capstan/firmware/parameters/parameters.hpp"

namespace capstan::test {

/// A motor without a transmission: inertia and viscous drag, a perfect encoder and current sensor, and a switch for
/// each way in which they may fail. Deterministic.
template <std::size_t Axes>
class FakeIo {
 public:
  static constexpr std::size_t kAxes = Axes;

  auto read(Sensed<Axes>& sensed) noexcept -> Status {
    if (read_status == Status::kFailed) {
      return read_status;
    }
    sensed.overruns = overruns;
    sensed.estop = estop;
    for (std::size_t i = 0; i < Axes; ++i) {
      constexpr double kCountsPerRad = 40960.0 / 6.283185307179586;
      const auto counts = static_cast<std::int64_t>(std::llround(motors[i].angle_rad * kCountsPerRad)) + encoder_shift;
      sensed.axis[i] = {.encoder_counts = static_cast<std::int32_t>(static_cast<std::uint32_t>(counts)),
                        .current_a = Q24::from_double(motors[i].current_a + current_shift_a),
                        .encoder = encoder,
                        .current = current,
                        .follows = cycles_enabled_ >= cycles_to_follow};
    }
    return read_status;
  }
  auto write(const Drive<Axes>& wanted) noexcept -> Status {
    ++writes;
    drive = wanted;
    cycles_enabled_ = has_torque() ? cycles_enabled_ + 1 : 0;
    if (write_status == Status::kOk) {
      step();
    }
    return write_status;
  }
  void release() noexcept {
    ++releases;
    drive = {};
    cycles_enabled_ = 0;
    step();
  }
  [[nodiscard]] auto has_torque() const -> bool {
    return std::any_of(drive.axis.begin(), drive.axis.end(), [](const AxisDrive& axis) { return axis.enabled; });
  }

  struct Motor {
    double angle_rad = 0.0;
    double speed_rad_s = 0.0;
    double current_a = 0.0;
  };
  std::array<Motor, Axes> motors{};
  Drive<Axes> drive{};
  Status read_status = Status::kOk;
  Status write_status = Status::kOk;
  Quality encoder = Quality::kOk;
  Quality current = Quality::kOk;
  std::int64_t encoder_shift = 0;
  double current_shift_a = 0.0;
  bool blocked = false;
  double drag_nms = 2.0e-3;
  bool estop = false;
  std::uint32_t overruns = 0;
  int writes = 0;
  int releases = 0;
  int cycles_to_follow = 0;  ///< of torque wanted, until the amplifiers follow

 private:
  void step() noexcept {
    constexpr double kInertiaKgm2 = 2.0e-5;
    constexpr double kTorqueNmPerA = 0.1;
    constexpr double kPeriodS = 0.001;
    for (std::size_t i = 0; i < Axes; ++i) {
      Motor& motor = motors[i];
      motor.current_a = drive.axis[i].enabled ? drive.axis[i].current_a.to_double() : 0.0;
      const double torque = kTorqueNmPerA * motor.current_a;
      motor.speed_rad_s =
          blocked ? 0.0
                  : (motor.speed_rad_s + torque * kPeriodS / kInertiaKgm2) / (1.0 + drag_nms * kPeriodS / kInertiaKgm2);
      motor.angle_rad += motor.speed_rad_s * kPeriodS;
    }
  }

  int cycles_enabled_ = 0;
};
static_assert(JointIo<FakeIo<1>>);

/// Flash in RAM: erasing sets bits, programming only clears them, and power may fail between any two changed bytes, or
/// in the middle of one.
class FlashBanks final : public Banks {
 public:
  static constexpr std::size_t kSize = std::size_t{16} * 1024;  // as the boards have
  FlashBanks() {
    for (auto& bank : memory) {
      bank.fill(0xFF);
    }
  }

  std::array<std::array<std::uint8_t, kSize>, kBanks> memory{};
  long power_left = -1;          ///< bytes that can still change; then nothing does. -1: no end
  bool tears_last_byte = false;  ///< when power fails, half the bits of one more byte change
  bool erases_backwards = false;
  long bytes_changed = 0;
  bool write_fails = false;
  bool write_does_nothing = false;  ///< and says that it did
  bool read_fails = false;
  long reads_left = -1;  ///< then all fail; -1: no end

 private:
  auto change(std::uint8_t& cell, std::uint8_t to) -> bool {
    if (cell == to) {
      return true;
    }
    if (power_left == 0) {
      constexpr std::uint8_t kHalf = 0x55;
      if (std::exchange(tears_last_byte, false)) {
        cell = static_cast<std::uint8_t>((cell & ~kHalf) | (to & kHalf));
      }
      return false;
    }
    power_left -= power_left > 0 ? 1 : 0;
    ++bytes_changed;
    cell = to;
    return true;
  }
  auto do_erase(int bank) -> bool override {
    auto& cells = memory[static_cast<std::size_t>(bank)];
    for (std::size_t i = 0; i < kSize; ++i) {
      if (!change(cells[erases_backwards ? kSize - 1 - i : i], 0xFF)) {
        return false;
      }
    }
    return true;
  }
  auto do_write(int bank, std::size_t offset, std::span<const std::uint8_t> bytes) -> bool override {
    if (write_fails || offset + bytes.size() > kSize) {
      return false;
    }
    if (write_does_nothing) {
      return true;
    }
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      std::uint8_t& cell = memory[static_cast<std::size_t>(bank)][offset + i];
      if (!change(cell, static_cast<std::uint8_t>(cell & bytes[i]))) {
        return false;
      }
    }
    return true;
  }
  auto do_read(int bank, std::size_t offset, std::span<std::uint8_t> bytes) -> bool override {
    if (read_fails || reads_left == 0 || offset + bytes.size() > kSize) {
      return false;
    }
    reads_left -= reads_left > 0 ? 1 : 0;
    std::copy_n(memory[static_cast<std::size_t>(bank)].begin() + static_cast<std::ptrdiff_t>(offset), bytes.size(),
                bytes.begin());
    return true;
  }
};

/// Every parameter at a value of its own within its range, and the whole consistent, for the joint whose number is the
/// seed's on a board of two. Sets of different seeds differ everywhere but in such choices.
inline auto distinct_config(std::uint32_t seed) -> AxisConfig {
  AxisConfig config;
  std::uint32_t next = seed * 2654435761U + 12345U;
  for (const ParameterInfo& parameter : parameters()) {
    next = next * 1664525U + 1013904223U;
    const auto span = static_cast<std::uint64_t>(std::int64_t{parameter.maximum} - parameter.minimum) + 1;
    const auto raw = static_cast<std::int32_t>(static_cast<std::int64_t>((next * span) >> 32) + parameter.minimum);
    const bool whole = parameter.type == ParameterType::kWhole;
    set_raw_value(config, parameter, whole ? Q24::from_int(raw >> Q24::kFrac).raw() : raw);
  }
  const auto scaled = [seed](double value) { return Q24::from_double(value * (1.0 + 0.001 * seed)); };
  for (Q24& coefficient : config.law.coefficients) {
    coefficient = Q24::from_raw(coefficient.raw() / 16);  // all together they may not reach 256
  }
  for (Q24& coefficient : config.effort.law.coefficients) {
    coefficient = Q24::from_raw(coefficient.raw() / 16);
  }
  const auto named = [&config](const char* name, Q24 value) {
    set_raw_value(config, *find_parameter(name), value.raw());
  };
  named("curved_ratio.square", scaled(0.01));  // any numbers would turn the ratio back
  named("curved_ratio.cube", scaled(0.005));
  named("curved_ratio.span", scaled(2.0));
  named("table.low", scaled(-1.0));
  named("table.high", scaled(1.0));
  config.coupled_to = {-1, seed % 2 == 0 ? 1 : 0, -1};  // on a board of two, where even seeds are joint 0
  config.tip.pitch = seed % 2 == 0 ? 1 : 0;
  config.motor.encoder_sign = seed % 2 == 0 ? 1 : -1;
  config.law.coefficients[0] = scaled(1.1);
  config.limits.motor_min_rad = scaled(-6.0);
  config.limits.motor_max_rad = scaled(6.0);
  config.limits.joint_min_rad = scaled(-2.0);
  config.limits.joint_max_rad = scaled(2.0);
  config.force.law = static_cast<std::int32_t>(seed % 3);  // a grid of any numbers would be no Preisach law
  config.limits.joint_jerk_krad_s3 = scaled(100.0);
  config.limits.continuous_current_a = scaled(1.0);
  config.limits.current_a = scaled(2.0);
  config.motor.torque_per_current_nm_per_a = scaled(0.1);
  config.control.torque_forward_nm = scaled(0.1);
  config.control.torque_backward_nm = scaled(-0.05);
  return config;
}

/// A lossy tendon transmission whose two directions differ.
inline auto lossy_config() -> AxisConfig {
  AxisConfig config;
  const auto set = [&config](const char* name, double value) {
    set_raw_value(config, *find_parameter(name), Q24::from_double(value).raw());
  };
  set("motor_angle.beta", 1.08);
  set("joint_offset.offset", 0.05);
  set("tendon_elongation.top", -0.9);
  set("tendon_elongation.bottom", -0.7);
  set("play.gain", 1.0);
  set("play.half_width", 0.02);
  set("control.torque_forward", 0.06);
  set("control.torque_backward", -0.04);
  return config;
}

inline auto same(const AxisConfig& a, const AxisConfig& b) -> bool {
  const auto all = parameters();
  return std::all_of(all.begin(), all.end(),
                     [&](const ParameterInfo& p) { return raw_value(a, p) == raw_value(b, p); });
}

class StringSink final : public TextSink {
 public:
  [[nodiscard]] auto text() const -> const std::string& { return text_; }
  auto take() -> std::string { return std::exchange(text_, {}); }

 private:
  void do_write(std::string_view text) override { text_.append(text); }
  std::string text_;
};

/// Splits an answer into lines without their CR LF.
inline auto lines_of(const std::string& text) -> std::vector<std::string> {
  std::vector<std::string> lines;
  std::size_t begin = 0;
  while (begin < text.size()) {
    std::size_t end = text.find("\r\n", begin);
    end = end == std::string::npos ? text.size() : end;
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 2;
  }
  return lines;
}

inline auto is_final(const std::string& line) -> bool {
  return line == "ok" || line.rfind("error ", 0) == 0;
}

/// The last line of an answer.
inline auto verdict(const std::string& answer) -> std::string {
  const auto lines = lines_of(answer);
  return lines.empty() ? "" : lines.back();
}

/// The name of the error that an answer ends in; its last line where it is none.
inline auto error_of(const std::string& answer) -> std::string {
  const std::string last = verdict(answer);
  return last.rfind("error ", 0) == 0 ? last.substr(6, last.find(':') - 6) : last;
}

inline auto has_line(const std::string& answer, const std::string& begin) -> bool {
  const auto lines = lines_of(answer);
  return std::any_of(lines.begin(), lines.end(), [&](const std::string& line) { return line.rfind(begin, 0) == 0; });
}

/// Says what it is asked for.
class FakeBoard final : public Board {
 public:
  [[nodiscard]] auto name() const -> const char* override { return "bench"; }
  void print_timing(Print& out) const override { out << "the bench has no clock\r\n"; }
  void reboot() override { ++reboots; }
  [[nodiscard]] auto simulated() const -> bool override { return is_simulated; }
  bool is_simulated = true;
  int reboots = 0;
};

/// Firmware and operator: a machine on the fake motor, and a shell over an in-memory pipe.
template <std::size_t Axes>
struct Bench {
  explicit Bench(bool echo = false) : shell(application, sink, board, echo) { application.rt_tick(); }

  void ticks(int count) {
    for (int i = 0; i < count; ++i) {
      application.rt_tick();
    }
  }
  /// Feeds the line, then lets time pass until it is answered (`answered` says if it was).
  auto say(std::string_view line) -> std::string {
    for (const char c : line) {
      shell.receive(c);
    }
    shell.receive('\n');
    constexpr int kPatience = 5000;
    for (int i = 0; i < kPatience && shell.busy(); ++i) {
      application.rt_tick();
      shell.poll();
    }
    answered = !shell.busy();
    return sink.take();
  }
  [[nodiscard]] auto state() const -> State { return application.telemetry().state; }
  [[nodiscard]] auto joint(std::size_t axis = 0) const -> AxisTelemetry { return application.axis_telemetry(axis); }

  FakeIo<Axes> io;
  FlashBanks banks;
  Application<FakeIo<Axes>> application{io, banks};
  StringSink sink;
  FakeBoard board;
  Shell shell;
  bool answered = false;
};

}  // namespace capstan::test
