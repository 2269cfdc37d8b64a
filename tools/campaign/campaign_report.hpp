// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/campaign/fault_campaign.hpp"

namespace capstan::tools {

/// One line for each row, the longest detection of each fault, and the counts.
void print_campaign(std::ostream& out, const Campaign& campaign);
/// One line for each input and mode: the worst over joints and situations.
void print_hazards(std::ostream& out, const std::vector<CampaignRow>& rows);

/// The same as the FMEA table of docs/safety_concept.md, in Markdown.
void print_fmea(std::ostream& out, const std::vector<CampaignRow>& rows);

}  // namespace capstan::tools
