// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/select/law_parts.hpp"

namespace capstan::tools {

/// A part of a law with one of its settings.
struct ChosenPart {
  std::size_t part = 0;
  std::size_t setting = 0;
};
using PartLaw = std::vector<ChosenPart>;

/// Numbers that decide how a law grows. Chosen in November 2026 on the 13 effort joints of the shared measured machines
/// (first 60 % of each log to choose and fit, the rest to judge), on a prototype of this growth with the same terms:
/// with worth_it 0.02 the law was at most 1.10 times the best plain fit in 12 of 13, with 0.03 in 11; asking more of
/// logs with few reversals made it 11 (0.3 over their number) down to 8 (1 over it); the loss without the mean (logs of
/// single folds alone) 9. folds_better of 0 or 0.75 gives the same count. The other numbers were not varied.
struct GrowthNumbers {
  double worth_it = 0.02;     ///< fall of the log of the error that a part has to bring, out of fold
  double kept_for = 0.006;    ///< a part that brings less than this is left out again
  double folds_better = 0.6;  ///< share of the folds in which it must bring something
  double ridge = 1e-6;        ///< weight of the squared coefficients, of columns of size one
  std::size_t most_parts = 16;
};

/// How a law came about.
struct GrownLaw {
  PartLaw law;
  std::vector<std::string> path;  ///< terms in the order they came; "-" before one that was left out again
  double first_loss = 0.0;        ///< log of the out-of-fold error of what it began with, and of the law
  double loss = 0.0;
};

/// Scalar products of every column of every part, per block of rows: all that growing a law needs of a log.
class PartProducts {
 public:
  /// @param share  of the logs' rows that may be used, from the first on; they are cut into blocks, in time
  PartProducts(const EffortDesign& design, const Eigen::VectorXd& target, double share, const Catalogue& catalogue,
               std::vector<LawPart> parts);

  [[nodiscard]] auto parts() const -> const std::vector<LawPart>& { return parts_; }
  /// Mean squared error of each fold, fitted without it: six that leave out a sixth of the time, and three that only
  /// look forward.
  [[nodiscard]] auto fold_errors(const PartLaw& law, double ridge) const -> Eigen::VectorXd;
  /// Coefficients from all rows, part by part.
  [[nodiscard]] auto coefficients(const PartLaw& law, double ridge) const -> Eigen::VectorXd;

 private:
  [[nodiscard]] auto columns_of(const PartLaw& law) const -> std::vector<Eigen::Index>;
  [[nodiscard]] auto solved(const Eigen::MatrixXd& products, const std::vector<Eigen::Index>& columns,
                            double ridge) const -> Eigen::VectorXd;

  std::vector<LawPart> parts_;
  std::vector<std::vector<Eigen::Index>> first_;  ///< column of the first coefficient of each part's term, by setting
  Eigen::VectorXd scale_;                         ///< rms of each column
  struct Fold {
    Eigen::MatrixXd fit, check;  ///< products with the target last
    double fit_rows = 0.0, check_rows = 0.0;
  };
  std::vector<Fold> folds_;
  Eigen::MatrixXd all_;
  double all_rows_ = 0.0;
};

/// Grows a law from the first `base` parts, of which those stay that lower the error: part by part what lowers the
/// out-of-fold error most, settings looked for again, and what is not needed any more left out.
auto grow_law(const PartProducts& products, std::size_t base, const GrowthNumbers& numbers = {}) -> GrownLaw;

/// What `base` parts alone come to, those left out that do not lower the error.
auto grown_base(const PartProducts& products, std::size_t base, const GrowthNumbers& numbers = {}) -> GrownLaw;

}  // namespace capstan::tools
