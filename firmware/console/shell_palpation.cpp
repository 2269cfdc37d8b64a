// SPDX-License-Identifier: Apache-2.0
// What the shell tells of palpated sites.
#include <algorithm>

#include "capstan/firmware/console/shell_experiment.hpp"

namespace capstan {
namespace {

/// One line that a log's reader skips: the number with its interval, and a bar of up to 40 signs for the map.
void print_site(Print& out, const SiteStiffness& site, Q24 largest) {
  constexpr std::int64_t kWidest = 40;
  out << "# site " << site.site << " stiffness " << site.value_nm_per_rad << " +- " << site.half_interval
      << " Nm/rad (95 %, " << site.strokes << " strokes) ";
  const std::int64_t bar = largest > Q24{} ? kWidest * site.value_nm_per_rad.raw() / largest.raw() : 0;
  for (std::int64_t i = 0; i < bar; ++i) {
    out << '=';
  }
  out << "\r\n";
}

}  // namespace

void print_stiffness(Session& session) {
  if (const auto site = session.machine().palpation().end()) {
    print_site(session.out(), *site, site->value_nm_per_rad);
  } else {
    session.out() << "# no stiffness: fewer than two strokes pressed the tip far enough, or it rests on something as "
                     "stiff as the instrument; raise amplitude or cycles\r\n";
  }
}

void print_palpation_map(Session& session) {
  Q24 largest;
  for (const SiteStiffness& site : session.machine().palpation().map()) {
    largest = std::max(largest, site.value_nm_per_rad);
  }
  for (const SiteStiffness& site : session.machine().palpation().map()) {
    print_site(session.out(), site, largest);
  }
  session.ok();
}

}  // namespace capstan
