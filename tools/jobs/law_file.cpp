// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/jobs/law_file.hpp"

#include <algorithm>
#include <cmath>

#include "capstan/tools/identify/force_section.hpp"
#include "capstan/tools/identify/preisach_rows.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

constexpr const char* kReversalTable = "preisach";

}  // namespace

void warn_of_left_out(Diagnosis& d) {
  if (is_reversal_table(d.law) && d.law.terms.size() > 1) {
    d.warnings.emplace_back("a file holds the reversal table alone, without the effects that were added to it");
  }
}

auto is_reversal_table(const JointFile& law) -> bool {
  return law.has(kReversalTable);
}

auto write_reversal_table(const JointFile& law, const std::string& path) -> std::string {
  const CatalogueTerm& term = law.catalogue->term(kReversalTable);
  const double* ends = &law.parameters.shapes[term.first_shape];
  PreisachTable levels;
  levels.levels = kPreisachLevels;
  const Levels inputs = even_levels(ends[0], ends[1], kPreisachLevels);
  std::copy(inputs.begin(), inputs.end(), levels.inputs.begin());
  PreisachFit fit;
  fit.table =
      with_weights(levels, Eigen::Map<const Eigen::VectorXd>(&law.parameters.coefficients[term.first_coefficient],
                                                             static_cast<Eigen::Index>(term.coefficients.size())));
  fit.half_intervals.assign(PreisachTable::index(kPreisachLevels, 0), std::nan(""));  // nobody knows those of the table
  if (law.fit) {
    fit.rmse_nm = law.fit->rmse;
    fit.samples = law.fit->samples;
  }
  write_text_file(path, with_force_section("", force_section(fit)));
  return word_of(law.terms.size() > 1 ? LawStatus::kBase : law.status);
}

}  // namespace capstan::tools
