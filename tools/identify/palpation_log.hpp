// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/identify/palpation.hpp"

namespace capstan::tools {

/// Where a log has which site.
struct NumberedSite {
  int number = 0;
  SiteSpan span;
};

/// The motor's side of a log. Throws BadInput with file, line and cure as read_axis does, and where nothing was
/// pressed.
auto read_palpation_log(const CsvLog& log, int axis) -> AxisLog;

/// Stretches of one value of the column `site`; without one, stretches of `period_s` from the log's start, numbered
/// from 1, or the whole log as site 1 if that is 0. Throws BadInput for a site that is no whole number.
auto sites_of(const CsvLog& log, double period_s) -> std::vector<NumberedSite>;

/// One line of a map.
struct MapRow {
  std::string log;
  int site = 0;
  SiteStiffness stiffness;
};

/// Every site of a log, each judged by its own samples, for between two sites nobody knows how the tip moved.
auto map_sites(const std::vector<NumberedSite>& sites, const Jaw& jaw) -> std::vector<MapRow>;

/// The same of what two jaws, each an axis of the log, hold between them: `palpate_between`. Throws BadInput if both
/// are the same axis.
auto map_grip(const std::vector<NumberedSite>& sites, const Jaw& first, const Jaw& second) -> std::vector<MapRow>;

/// Table and picture for people: stiffness with its 95 % interval, and '*' where a site is stiffer than the rest.
auto map_text(const std::vector<MapRow>& rows, double stiff_factor = kStiffFactor) -> std::string;
/// The same as CSV; empty cells where nothing can be said.
auto map_csv(const std::vector<MapRow>& rows) -> std::string;

}  // namespace capstan::tools
