// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/campaign/campaign_report.hpp"

#include <algorithm>
#include <cstdio>
#include <map>

#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

template <typename... Values>
void put(std::ostream& out, const char* format, Values... values) {
  std::array<char, 300> line{};
  std::snprintf(line.data(), line.size(), format, values...);
  out << line.data();
}

auto count_of(const std::vector<CampaignRow>& rows, Outcome outcome) -> long {
  return std::count_if(rows.begin(), rows.end(), [=](const CampaignRow& row) { return row.outcome == outcome; });
}

void print_counts(std::ostream& out, const char* what, const std::vector<CampaignRow>& rows) {
  long cases = 0;
  long unsafe = 0;
  long unavoidable = 0;
  long mechanical = 0;
  for (const CampaignRow& row : rows) {
    cases += row.cases;
    unsafe += row.unsafe;
    unavoidable += row.unavoidable;
    mechanical += row.mechanical;
  }
  put(out,
      "%s: %zu rows of %ld cases: %ld faulted, %ld blocked, %ld tolerated, %ld mechanical, %ld unsafe (%ld cases)\n",
      what, rows.size(), cases, count_of(rows, Outcome::kFaulted), count_of(rows, Outcome::kBlocked),
      count_of(rows, Outcome::kTolerated), count_of(rows, Outcome::kMechanical), count_of(rows, Outcome::kUnsafe),
      unsafe);
  put(out,
      "  beyond a limit: %ld cases; %ld unsafe by the rule, %ld of them beyond a limit with torque cut at the onset "
      "too; %ld mechanical, within limits.fault_travel of that cut\n",
      unsafe + mechanical, unsafe, unavoidable, mechanical);
}

/// Unsafe cases by what the machine needs beside the firmware; they stay unsafe.
void print_remedies(std::ostream& out, const std::vector<CampaignRow>& rows) {
  std::map<std::string, long> unsafe;
  for (const CampaignRow& row : rows) {
    const char* needed = remedy(row.trouble.first);
    unsafe[needed == nullptr ? "nothing is known that would do" : std::string("needs ") + needed] += row.unsafe;
  }
  for (const auto& [needed, cases] : unsafe) {
    if (cases > 0) {
      put(out, "  unsafe, %s: %ld cases\n", needed.c_str(), cases);
    }
  }
}

void print_row(std::ostream& out, const CampaignRow& row) {
  const std::string detected = row.detected_ms < 0 ? "-" : std::to_string(row.detected_ms);
  const std::string cut = row.unavoidable_rad > 0.0 ? rounded(row.unavoidable_rad, 3) : "-";
  put(out, "%-36s %-11s %-10s %-10s %-16s %6s %3d %8.3f %8s %7.2f %7.3f %6.2f %5d/%d\n", name(row.trouble).c_str(),
      name(row.joint), name(row.situation), name(row.outcome), info(row.fault).name, detected.c_str(),
      row.off_after_cycles, row.hazard.travel_rad, cut.c_str(), row.hazard.speed_rad_s, row.hazard.torque_nm,
      row.severity, row.unsafe, row.cases);
}

constexpr const char* kHead =
    "fault                                joint       while      outcome    by                   ms off   travel  "
    " if cut   speed "
    " torque  sever unsafe\n";

/// The worst of each fault over joints and situations, in the order in which they first come.
auto worst_of_each(const std::vector<CampaignRow>& rows) -> std::vector<CampaignRow> {
  std::vector<CampaignRow> worst;
  for (const CampaignRow& row : rows) {
    const auto same = [&row](const CampaignRow& kept) { return name(kept.trouble) == name(row.trouble); };
    const auto place = std::find_if(worst.begin(), worst.end(), same);
    if (place == worst.end()) {
      worst.push_back(row);
      continue;
    }
    const CampaignRow old = *place;
    if (row.outcome > old.outcome || (row.outcome == old.outcome && row.severity > old.severity)) {
      *place = row;
    }
    place->cases = old.cases + row.cases;
    place->unsafe = old.unsafe + row.unsafe;
    place->unavoidable = old.unavoidable + row.unavoidable;
    place->mechanical = old.mechanical + row.mechanical;
    place->hazard = old.hazard;
    place->hazard.widen(row.hazard);
    place->unavoidable_rad = std::max(old.unavoidable_rad, row.unavoidable_rad);
    place->detected_ms = std::max(old.detected_ms, row.detected_ms);
    place->off_after_cycles = std::max(old.off_after_cycles, row.off_after_cycles);
  }
  return worst;
}

}  // namespace

void print_hazards(std::ostream& out, const std::vector<CampaignRow>& rows) {
  out << kHead;
  for (const CampaignRow& row : worst_of_each(rows)) {
    print_row(out, row);
  }
}

void print_fmea(std::ostream& out, const std::vector<CampaignRow>& rows) {
  out << "| failure | worst case | found by | ms | travel, rad | speed, rad/s | torque, N m | unsafe | mechanical |\n"
         "|---|---|---|---|---|---|---|---|---|\n";
  for (const CampaignRow& row : worst_of_each(rows)) {
    const std::string by = row.fault == Fault::kNone ? "-" : info(row.fault).name;
    const std::string ms = row.detected_ms < 0 ? "-" : std::to_string(row.detected_ms);
    const std::string cut =
        row.unavoidable_rad > 0.0 ? " (" + rounded(row.unavoidable_rad, 3) + " if cut at once)" : "";
    put(out, "| %s | %s, %s: %s | %s | %s | %.3f%s | %.2f | %.3f | %d of %d | %d |\n", name(row.trouble).c_str(),
        name(row.joint), name(row.situation), name(row.outcome), by.c_str(), ms.c_str(), row.hazard.travel_rad,
        cut.c_str(), row.hazard.speed_rad_s, row.hazard.torque_nm, row.unsafe, row.cases, row.mechanical);
  }
}

void print_campaign(std::ostream& out, const Campaign& campaign) {
  out << kHead;
  for (const auto* rows : {&campaign.single, &campaign.pairs}) {
    for (const CampaignRow& row : *rows) {
      print_row(out, row);
    }
  }
  out << "\nThe worst of each fault over all joints, situations and phases. ms: longest detection; off: cycles from "
         "there; "
         "travel (rad), speed (rad/s) and torque (Nm): of the true joint beyond the same motion without the fault; if "
         "cut: travel where the torque is cut at the onset\n";
  print_hazards(out, campaign.single);
  print_hazards(out, campaign.pairs);
  print_counts(out, "single faults", campaign.single);
  print_remedies(out, campaign.single);
  print_counts(out, "two faults", campaign.pairs);
}

}  // namespace capstan::tools
