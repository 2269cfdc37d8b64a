// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <variant>

#include "capstan/model/preisach.hpp"
#include "capstan/model/pull_push.hpp"

namespace capstan {

enum class ForceLawKind : std::uint8_t { kNone, kPull, kPullPush, kPreisach, kBlend };

/// What a joint's force law is made of, whichever it is.
template <typename Scalar>
struct ForceLawParameters {
  ForceLawKind kind = ForceLawKind::kNone;
  PullPushParameters<Scalar> pull_push{};  ///< its weights are read of kBlend; else the kind says which law it is
  Scalar friction_nm{};                    ///< the motor's own, in the torque it is given, N m, 0 and above
  Scalar offset_nm{};                      ///< of that torque, N m
};

/// Motor torque to joint torque and back, by one of the force laws behind one face. The motor's own friction stands
/// before the law: what passes it is a play of the torque, as wide as the friction either way.
template <typename Scalar, std::size_t MaxLevels, std::size_t Depth>
class ForceLaw {
 public:
  using Grid = Preisach<Scalar, MaxLevels, Depth>;
  /// A table's values are rounded on their way here, each by itself.
  static constexpr Scalar kRounding = ScalarTraits<Scalar>::from(1e-6);

  ForceLaw() = default;

  /// Becomes another law, demagnetised where it has a past. @param table  of kPreisach; must outlive the law. What
  /// `check` refuses makes a law that is not there.
  constexpr void become(const ForceLawParameters<Scalar>& parameters, const typename Grid::Table& table) {
    friction_ = parameters.friction_nm;
    offset_ = parameters.offset_nm;
    passed_ = Scalar{};
    law_.template emplace<std::monostate>();
    PullPushParameters<Scalar> pull_push = parameters.pull_push;
    if (parameters.kind != ForceLawKind::kBlend) {
      pull_push.pull_weight = parameters.kind == ForceLawKind::kPull ? kOne : Scalar{};
      pull_push.pull_push_weight = parameters.kind == ForceLawKind::kPull ? Scalar{} : kOne;
    }
    switch (parameters.kind) {
      case ForceLawKind::kNone:
        break;
      case ForceLawKind::kPull:
      case ForceLawKind::kPullPush:
      case ForceLawKind::kBlend:
        if (check(pull_push) == PullPushFault::kNone) {
          law_.template emplace<Tendons>(pull_push);
        }
        break;
      case ForceLawKind::kPreisach:
        if (check(table, kRounding).ok()) {
          law_.template emplace<Grid>(table, StartState::kDemagnetised, kRounding);
        }
        break;
    }
  }
  void become(const ForceLawParameters<Scalar>& parameters, const typename Grid::Table&& table) = delete;

  [[nodiscard]] constexpr auto is_there() const -> bool { return law_.index() != 0; }

  /// One sample of the motor's torque, N m. @pre is_there()
  constexpr auto update(Scalar motor_nm) -> ForceEstimate<Scalar> {
    const Scalar middle = motor_nm - offset_;
    passed_ = clamp(passed_, middle - friction_, middle + friction_);
    Tendons* const tendons = std::get_if<Tendons>(&law_);
    return tendons != nullptr ? tendons->update(passed_, true) : std::get_if<Grid>(&law_)->update(passed_);
  }

  /// The motor torque that brings the joint's torque there from below (`rising`) or from above. Where the force does
  /// not change with the torque, the nearest to the present. @pre is_there()
  [[nodiscard]] constexpr auto torque_for(Scalar joint_nm, bool rising) const -> InputCommand<Scalar> {
    const Tendons* const tendons = std::get_if<Tendons>(&law_);
    InputCommand<Scalar> command = tendons != nullptr
                                       ? InputCommand<Scalar>{tendons->input_for(joint_nm, passed_), true}
                                       : std::get_if<Grid>(&law_)->input_for(joint_nm);
    command.input += offset_ + (rising ? friction_ : -friction_);
    return command;
  }

 private:
  using Tendons = PullPush<Scalar>;
  static constexpr Scalar kOne = ScalarTraits<Scalar>::from(1.0);

  std::variant<std::monostate, Tendons, Grid> law_;
  Scalar friction_{};
  Scalar offset_{};
  Scalar passed_{};  ///< what is left of the torque behind the motor's friction
};

}  // namespace capstan
