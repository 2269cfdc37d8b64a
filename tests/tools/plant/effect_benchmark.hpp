// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "capstan/tools/log/axis_log.hpp"

namespace capstan::tools::plant {

/// A switch of a plant's effects, and what the catalogue calls it.
struct Switchable {
  std::string name;      ///< of the effect in the plant
  std::string expected;  ///< in the catalogue; empty: foreign to it
  double usual;          ///< with which a search for the size wanted begins, in the switch's unit
  double most;           ///< beyond which the plant refuses it, or nobody would call it small
};

/// A joint drawn by chance in one motion, whose effects are switched on one at a time.
class SwitchedJoint {
 public:
  SwitchedJoint() = default;
  virtual ~SwitchedJoint() = default;
  SwitchedJoint(const SwitchedJoint&) = delete;
  auto operator=(const SwitchedJoint&) -> SwitchedJoint& = delete;

  [[nodiscard]] virtual auto motion() const -> std::string = 0;
  [[nodiscard]] virtual auto camera_noise_rad() const -> double = 0;
  [[nodiscard]] virtual auto switches() const -> std::vector<Switchable> = 0;
  /// The log with a switch that far on; healthy if it is 0. Throws where there is none.
  /// @param which  of switches()   @param again  another run: other noises   @param keep  file to write it to, or empty
  [[nodiscard]] virtual auto log(std::size_t which, double size, bool again, const std::string& keep) const
      -> AxisLog = 0;
  /// What the diagnosis should tell of its size; 0 where it means something else.
  [[nodiscard]] virtual auto true_size(std::size_t which, double size) const -> double = 0;
  /// The healthy joint in another motion, that nothing was chosen on.
  [[nodiscard]] virtual auto other_motion() const -> std::optional<AxisLog> { return std::nullopt; }
};

/// How often each truth got each answer.
using Confusion = std::map<std::string, std::map<std::string, int>>;
void print(const Confusion& confusion);

struct EffectOptions {
  std::uint64_t seed = 1;
  int joints = 1;
  std::vector<double> strengths = {4.0};
  std::vector<std::string> only;
  std::string keep;
  bool healthy = false, from_nothing = false, compare = false, verbose = false;
};

/// Asks what came to joints drawn by these seeds, and prints how often it was named, and its size.
/// @param drawn  the joints of a seed, one per motion
void ask_effects(const EffectOptions& options,
                 const std::function<std::vector<std::unique_ptr<SwitchedJoint>>(std::uint64_t seed)>& drawn);

}  // namespace capstan::tools::plant
