// SPDX-License-Identifier: Apache-2.0
// What the shell tells of palpated sites.
#include <algorithm>

#include "capstan/firmware/console/shell_experiment.hpp"

namespace capstan {
namespace {

/// One line that a log's reader skips: the number with its interval, and a bar of up to 40 signs for the map.
/// @param mark  behind it
void print_site(Print& out, const SiteStiffness& site, Q24 largest, const char* mark) {
  constexpr std::int64_t kWidest = 40;
  out << "# site " << site.site << " stiffness " << site.value_nm_per_rad << " +- " << site.half_interval
      << " Nm/rad (95 %, " << site.strokes << " strokes) ";
  const std::int64_t bar = largest > Q24{} ? kWidest * site.value_nm_per_rad.raw() / largest.raw() : 0;
  for (std::int64_t i = 0; i < bar; ++i) {
    out << '=';
  }
  out << mark << "\r\n";
}

}  // namespace

void print_stiffness(Session& session) {
  if (const auto site = session.machine().palpation().end()) {
    print_site(session.out(), *site, site->value_nm_per_rad, "");
  } else {
    session.out() << "# no stiffness: fewer than two strokes pressed the tip far enough, or it rests on something as "
                     "stiff as the instrument; raise amplitude or cycles, and where the tip left the tissue offset\r\n";
  }
}

void print_palpation_map(Session& session, Q24 factor) {
  const Palpation& palpation = session.machine().palpation();
  Q24 largest;
  for (const SiteStiffness& site : palpation.map()) {
    largest = std::max(largest, site.value_nm_per_rad);
  }
  const std::optional<Q24> stiff = palpation.stiff_from(factor);
  for (const SiteStiffness& site : palpation.map()) {
    print_site(session.out(), site, largest, stiff && site.value_nm_per_rad - site.half_interval > *stiff ? " *" : "");
  }
  session.ok();
}

}  // namespace capstan
