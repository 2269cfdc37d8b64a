// SPDX-License-Identifier: Apache-2.0
// Folds every bit that an observer of two plants sees into one number. Whatever compiler, options and processor: the
// same scenario and seed print the same number. After a change of the plant itself, the host's new number goes into
// CMakeLists.txt, and every other machine has to agree with it.
#include <bit>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "capstan/hal/sim/deterministic_math.hpp"
#include "capstan/hal/sim/multi_plant.hpp"

namespace {

using namespace capstan::sim;

class Fold {
 public:
  void add(std::uint64_t value) { hash_ = (hash_ ^ value) * 0x100000001b3U; }  // FNV-1a, a word at a time
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  void add(const Readings& r, const Truth& t) {
    add(static_cast<std::uint64_t>(static_cast<std::uint32_t>(r.encoder_counts)));
    for (const double x : {r.current_a, t.q1_rad, t.q2_rad, t.tau_in_nm, t.tau_out_nm, t.q2_camera_rad, t.tip_force_n})
      add(x);
  }
  [[nodiscard]] std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325U;
};

void run(const char* text, Fold& fold) {
  MultiPlant plant(parse_scenario(text, "fingerprint"));
  std::vector<MotorCommand> commands(plant.axis_count());
  for (int i = 0; i < 3000; ++i) {
    for (std::size_t axis = 0; axis < commands.size(); ++axis) {
      const double wanted = 0.9 * det_sin(0.004 * i + static_cast<double>(axis));
      commands[axis] = {wanted - 0.5 * plant.truth(axis).q1_rad, i % 700 < 650};
    }
    plant.step(commands);
    for (std::size_t axis = 0; axis < commands.size(); ++axis)
      fold.add(plant.readings(axis), plant.truth(axis));
  }
}

}  // namespace

int main() {
  Fold fold;
  run(R"(seed = 7
[effects]
transmission_viscous = 600
play = 0.02
gravity = 0.01
viscoelastic_creep = { ratio = 0.2, time_s = 0.5 }
thermal_drift = { growth_m = 1e-4, time_s = 1 }
angle_periodic = 0.01
stiffness_hardening = 0.01
axis_coupling = 0.1
presliding = 0.002
stribeck_friction = 0.002
wear = 0.01
sticky_spot = 0.005
magnetic_detent = 0.003
tremor = 0.004
sheath_bend = 0.1
torque_fade = 0.1
[environment]
kind = "hunt_crossley"
stiffness = 0.4
damping = 0.5
angle_rad = 0.1
[[faults]]
time_s = 1
duration_s = 0.3
target = "current"
kind = "garbage"
)",
      fold);
  run("seed = 8\ninstrument = \"da_vinci_wrist\"\n[plant]\nsample_delay_s = 0.0004\n", fold);
  std::printf("%016llx\n", static_cast<unsigned long long>(fold.value()));
  return 0;
}
