// SPDX-License-Identifier: Apache-2.0
// Instantiates every law for the number formats in use, so that a mistake shows when the library is built.
#include "model/motion_law.hpp"
#include "model/preisach.hpp"

namespace capstan {
namespace {

template <typename Scalar>
constexpr auto all_sum_terms_meet_the_concept() -> bool {
  bool ok = true;
  SumTerms::for_each<Scalar>([&ok]<typename Term>() { ok = ok && SumTerm<Term, Scalar>; });
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
// 11 levels are the thesis's grid, 41 the largest one meant for the target.
template class Preisach<double, 11>;
template class Preisach<Q24, 11>;
template class Preisach<double, 41>;
template class Preisach<Q24, 41>;

}  // namespace capstan
