// SPDX-License-Identifier: Apache-2.0
// Instantiates every law for the number formats in use, so that a mistake shows when the library is built.
#include "capstan/model/coupled_axes.hpp"
#include "capstan/model/disturbance.hpp"
#include "capstan/model/effort_catalogue.hpp"
#include "capstan/model/force_law.hpp"
#include "capstan/model/motion_law.hpp"
#include "capstan/model/preisach.hpp"
#include "capstan/model/pull_push.hpp"
#include "capstan/model/tension_state.hpp"

namespace capstan {
namespace {

template <typename Scalar>
constexpr auto all_sum_terms_meet_the_concept() -> bool {
  bool ok = true;
  const auto meets = [&ok]<typename Term>() { ok = ok && SumTerm<Term, Scalar>; };
  SumTerms::for_each<Scalar>(meets);
  EffortTerms::for_each<Scalar>(meets);
  InputTerms::for_each<Scalar>([&ok]<typename Term>() { ok = ok && InputTerm<Term, Scalar>; });
  MachineEffortTerms::for_each<Scalar>(meets);
  TorqueTerms::for_each<Scalar>(meets);
  CouplingEffortTerms::for_each<Scalar>(meets);
  GearTerms::for_each<Scalar>(meets);
  OutputTerms::for_each<Scalar>([&ok]<typename Term>() { ok = ok && OutputTerm<Term, Scalar>; });
  return ok;
}
static_assert(all_sum_terms_meet_the_concept<double>());
static_assert(all_sum_terms_meet_the_concept<Q24>());

}  // namespace

template class SampleConditioner<double>;
template class SampleConditioner<Q24>;
template class MotionLaw<double>;
template class MotionLaw<Q24>;
template class TorqueLaw<double>;
template class TorqueLaw<Q24>;
template class Disturbance<double>;
template class Disturbance<Q24>;
template class effort::Inertia<double>;
template class effort::Inertia<Q24>;
template class effort::ViscousFriction<double>;
template class effort::ViscousFriction<Q24>;
template class effort::CoulombFriction<double>;
template class effort::CoulombFriction<Q24>;
template class effort::FrictionAsymmetry<double>;
template class effort::FrictionAsymmetry<Q24>;
template class effort::StribeckFriction<double>;
template class effort::StribeckFriction<Q24>;
template class effort::PlayFriction<double>;
template class effort::PlayFriction<Q24>;
template class effort::Offset<double>;
template class effort::Offset<Q24>;
template class effort::PowerLawFriction<double>;
template class effort::PowerLawFriction<Q24>;
template class effort::Spring<double>;
template class effort::Spring<Q24>;
template class effort::LoadFriction<double>;
template class effort::LoadFriction<Q24>;
template class effort::MotionCoupling<double>;
template class effort::MotionCoupling<Q24>;
template class gear::GearTorque<double>;
template class gear::GearTorque<Q24>;
template class gear::LoadFriction<double>;
template class gear::LoadFriction<Q24>;
template class gear::TorqueSaturation<double>;
template class gear::TorqueSaturation<Q24>;
// 11 levels are the thesis's grid, 41 the largest one meant for the target.
template class Preisach<double, 11>;
template class Preisach<Q24, 11>;
template class Preisach<double, 41>;
template class Preisach<Q24, 41>;
template class PreisachBounds<double, 11>;
template class PreisachBounds<Q24, 11>;
template class PullPush<double>;
template class PullPush<Q24>;
template class ForceLaw<double, 11, 16>;
template class ForceLaw<Q24, 11, 16>;
template class TensionState<double>;
template class TensionState<Q24>;

}  // namespace capstan
