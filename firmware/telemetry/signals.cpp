// SPDX-License-Identifier: Apache-2.0
#include "capstan/firmware/telemetry/signals.hpp"
#include "capstan/firmware/loop/expect.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>

#include "capstan/firmware/control/modes.hpp"

namespace capstan {
namespace {

constexpr auto real(const char* name, const char* column, const char* unit, const char* doc, std::size_t offset)
    -> SignalInfo {
  return {name, column, unit, doc, SignalType::kReal, static_cast<std::uint16_t>(offset)};
}

/// "active limits: 1 current, 2 ...", from their table; it ends in a zero.
constexpr auto limits_text() -> std::array<char, 128> {
  std::array<char, 128> text{};
  std::size_t length = 0;
  const auto add = [&](std::string_view part) {
    for (const char c : part) {
      text[length++] = c;
    }
  };
  add("active limits: ");
  for (const LimitInfo& info : kLimitTable) {
    const unsigned value = bit(info.limit);
    for (unsigned digit = 100; digit > 0; digit /= 10) {
      if (value >= digit) {
        text[length++] = static_cast<char>('0' + value / digit % 10);
      }
    }
    add(" ");
    add(info.name);
    add(info.limit == kLimitTable.back().limit ? "" : ", ");
  }
  return text;
}
constexpr auto kLimitsText = limits_text();
static_assert(kLimitsText.back() == 0);

constexpr std::array<SignalInfo, 31> kJointSignals = {
    real("q1", "q1_rad", "rad", "motor angle", offsetof(AxisTelemetry, q1_rad)),
    real("torque", "tau_Nm", "Nm", "torque from the measured current", offsetof(AxisTelemetry, tau_nm)),
    real("q2", "q2_est_rad", "rad", "estimated joint angle", offsetof(AxisTelemetry, q2_rad)),
    real("q2_reported", "q2_reported_rad", "rad", "reading of a joint sensor with the law's sensor effects",
         offsetof(AxisTelemetry, q2_reported_rad)),
    real("q2_error", "q2_err_rad", "rad",
         "95 % error bound of q2_reported within the range of the identification logs; -1: unknown",
         offsetof(AxisTelemetry, q2_error_rad)),
    real("reference", "q2_ref_rad", "rad", "wanted joint angle", offsetof(AxisTelemetry, q2_reference_rad)),
    real("motor_reference", "q1_ref_rad", "rad", "motor angle commanded to the servo",
         offsetof(AxisTelemetry, q1_reference_rad)),
    real("current", "current_A", "A", "measured current", offsetof(AxisTelemetry, current_a)),
    real("drive", "drive_A", "A", "current commanded to the amplifier", offsetof(AxisTelemetry, drive_a)),
    real("drive_torque", "tau_cmd_Nm", "Nm", "motor torque commanded to the amplifier",
         offsetof(AxisTelemetry, drive_nm)),
    real("excitation", "tau_exc_Nm", "Nm", "torque that an experiment adds", offsetof(AxisTelemetry, excitation_nm)),
    real("force", "tau_out_est_Nm", "Nm", "joint torque by the force law, or by the tendons of the law",
         offsetof(AxisTelemetry, joint_torque_nm)),
    real("force_error", "tau_out_err_Nm", "Nm",
         "95 % error bound of force within the torques of the identification logs; -1: unknown",
         offsetof(AxisTelemetry, joint_torque_error_nm)),
    real("force_reference", "tau_out_ref_Nm", "Nm", "wanted joint torque",
         offsetof(AxisTelemetry, joint_torque_reference_nm)),
    real("law_torque", "tau_est_Nm", "Nm", "motor torque by the effort law, of effort.window / 4 ago",
         offsetof(AxisTelemetry, law_torque_nm)),
    real("disturbance", "tau_dist_Nm", "Nm", "measured torque minus the effort law's, equally late: contact, collision",
         offsetof(AxisTelemetry, disturbance_nm)),
    real("misfit", "misfit", "1", "level of the law monitor relative to its warning, 0 to 1",
         offsetof(AxisTelemetry, misfit)),
    real("tension", "tension", "1", "tendon friction, a measure of tension, relative to the healthy joint; 0: unknown",
         offsetof(AxisTelemetry, tension)),
    real("pretension", "pretension_N", "N", "mean tension of both tendons together, with a free tip; 0: unknown",
         offsetof(AxisTelemetry, pretension_n)),
    real("pretension_error", "pretension_err_N", "N", "half of the 95 % interval of pretension",
         offsetof(AxisTelemetry, pretension_95_n)),
    real("tip_x", "tip_x_m", "m",
         "tip of a wrist's jaw, from its pitch axis along the shaft; zeros: tip.pitch is not set",
         offsetof(AxisTelemetry, tip_m)),
    real("tip_y", "tip_y_m", "m", "the same, across shaft and pitch axis",
         offsetof(AxisTelemetry, tip_m) + sizeof(Q24)),
    real("tip_z", "tip_z_m", "m", "the same, along the pitch axis", offsetof(AxisTelemetry, tip_m) + 2 * sizeof(Q24)),
    SignalInfo{"faults", "faults", "1", "faults present at this joint, bit N for number N", SignalType::kWord,
               offsetof(AxisTelemetry, faults)},
    SignalInfo{"limits", "limits", "1", kLimitsText.data(), SignalType::kByte, offsetof(AxisTelemetry, limits)},
    SignalInfo{"valid", "valid", "1", "1 while the estimate is valid", SignalType::kByte,
               offsetof(AxisTelemetry, estimate_valid)},
    SignalInfo{"force_known", "tau_out_known", "1", "1 once the force law's history no longer affects it",
               SignalType::kByte, offsetof(AxisTelemetry, joint_torque_known)},
    SignalInfo{
        "force_phase", "tau_out_phase", "1",
        "phase of pull_push or blend: 1 held, 2 the pulled tendon moves, 3 both do, 4 one is slack; 0 none or unknown",
        SignalType::kByte, offsetof(AxisTelemetry, joint_torque_phase)},
    SignalInfo{"mode", "mode", "1", "0 position, 1 motor torque, 2 force control, 3 motor position", SignalType::kByte,
               offsetof(AxisTelemetry, mode)},
    SignalInfo{"warnings", "warnings", "1", "warnings of this joint, bit N for number N", SignalType::kByte,
               offsetof(AxisTelemetry, warnings)},
    SignalInfo{"tendons", "tendons", "1",
               "state of the tendons: 1 loose, 2 slack, 3 worn, 4 frayed, 5 play, 6 zero moved, 7 slips, 8 broken",
               SignalType::kByte, offsetof(AxisTelemetry, tendons)},
};

constexpr std::array<SignalInfo, 6> kMachineSignals = {
    SignalInfo{"state", "state", "1", "number of the state, in the order of the table of states", SignalType::kByte,
               offsetof(MachineTelemetry, state)},
    SignalInfo{"fault", "fault", "1", "number of the latched fault", SignalType::kByte,
               offsetof(MachineTelemetry, first_fault)},
    SignalInfo{"conditions", "conditions", "1", "faults present now, bit N for number N", SignalType::kWord,
               offsetof(MachineTelemetry, conditions)},
    SignalInfo{"overruns", "overruns", "1", "late or skipped cycles since start", SignalType::kWord,
               offsetof(MachineTelemetry, overruns)},
    real("temperature", "temperature_C", "C", "of the transmission, the last one measured",
         offsetof(MachineTelemetry, temperature_c)),
    SignalInfo{"experiment", "experiment", "1", "0 none yet, 1 approaching, 2 running, 3 done, 4 ended early",
               SignalType::kByte, offsetof(MachineTelemetry, experiment)},
};

auto find(std::span<const SignalInfo> table, std::string_view name) -> const SignalInfo* {
  const auto found =
      std::find_if(table.begin(), table.end(), [name](const SignalInfo& signal) { return name == signal.name; });
  return found == table.end() ? nullptr : &*found;
}

auto after(std::string_view text, std::string_view prefix) -> std::string_view {
  const bool starts = text.size() > prefix.size() && std::string_view(text.data(), prefix.size()) == prefix;
  return starts ? std::string_view(text.data() + prefix.size(), text.size() - prefix.size()) : std::string_view();
}

}  // namespace

auto joint_signals() -> std::span<const SignalInfo> {
  return kJointSignals;
}
auto machine_signals() -> std::span<const SignalInfo> {
  return kMachineSignals;
}

auto find_signal(std::string_view text, std::size_t axes) -> Signal {
  if (const std::string_view name = after(text, "machine."); !name.empty()) {
    return {find(kMachineSignals, name), Signal::kMachine};
  }
  const std::string_view joint = after(text, "joint");
  if (joint.size() < 3 || joint[0] < '0' || joint[0] > '9' || joint[1] != '.') {
    return {};
  }
  const auto axis = static_cast<std::uint8_t>(joint[0] - '0');
  return {axis < axes ? find(kJointSignals, std::string_view(joint.data() + 2, joint.size() - 2)) : nullptr, axis};
}

auto rt_raw(const Signal& signal, const MachineTelemetry& machine, std::span<const AxisTelemetry> axes)
    -> std::int32_t {
  CAPSTAN_EXPECT(signal.info != nullptr);
  const auto* base = signal.axis == Signal::kMachine ? reinterpret_cast<const unsigned char*>(&machine)
                                                     : reinterpret_cast<const unsigned char*>(&axes[signal.axis]);
  if (signal.info->type == SignalType::kByte) {
    return base[signal.info->offset];
  }
  std::int32_t raw = 0;
  std::memcpy(&raw, base + signal.info->offset, sizeof raw);
  return raw;
}

void print_name(Print& out, const Signal& signal) {
  if (signal.axis == Signal::kMachine) {
    out << "machine.";
  } else {
    out << "joint" << static_cast<std::uint32_t>(signal.axis) << '.';
  }
  out << signal.info->name;
}

void print_column(Print& out, const Signal& signal) {
  if (signal.axis != Signal::kMachine) {
    out << "axis" << static_cast<std::uint32_t>(signal.axis) << '/';
  }
  out << signal.info->column;
}

void print_raw(Print& out, const Signal& signal, std::int32_t raw) {
  if (signal.info->type == SignalType::kReal) {
    out << Q24::from_raw(raw);
  } else {
    out << static_cast<std::uint32_t>(raw);
  }
}

}  // namespace capstan
