// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/select/growth.hpp"
#include "capstan/tools/select/law_parts.hpp"

namespace capstan::tools {

/// A part of a law with one of its settings.
struct ChosenPart {
  std::size_t part = 0;
  std::size_t setting = 0;
};
using PartLaw = std::vector<ChosenPart>;

/// Every part of a law over some logs, as the law sees them: at enough rows of long ones.
struct PartColumns {
  PartColumns(const EffortDesign& design, const Eigen::VectorXd& measured, const Catalogue& catalogue,
              std::vector<LawPart> of);
  std::vector<LawPart> parts;
  std::vector<Eigen::VectorXd> columns;
  std::vector<std::vector<Eigen::Index>> first;  ///< column of the first coefficient of each part's term, by setting
  Eigen::VectorXd target;
};

/// Scalar products of every column of every part, per block of rows: all that growing a law needs of a log.
class PartProducts {
 public:
  /// @param from  of which a share of the rows may be used, from the first on; they are cut into blocks, in time
  PartProducts(const PartColumns& from, double share);

  [[nodiscard]] auto parts() const -> const std::vector<LawPart>& { return parts_; }
  /// Mean squared error of each fold, fitted without it: six that leave out a sixth of the time, and three that only
  /// look forward.
  [[nodiscard]] auto fold_errors(const PartLaw& law, double ridge) const -> Eigen::VectorXd;
  /// Largest rms of what one part adds to the law, all rows taken, over the target's.
  [[nodiscard]] auto largest_share(const PartLaw& law, double ridge) const -> double;
  /// Coefficients from all rows, part by part.
  [[nodiscard]] auto coefficients(const PartLaw& law, double ridge) const -> Eigen::VectorXd;

 private:
  [[nodiscard]] auto columns_of(const PartLaw& law) const -> std::vector<Eigen::Index>;
  [[nodiscard]] auto solved(const Eigen::MatrixXd& products, const std::vector<Eigen::Index>& columns,
                            double ridge) const -> Eigen::VectorXd;

  std::vector<LawPart> parts_;
  std::vector<std::vector<Eigen::Index>> first_;  ///< PartColumns::first
  Eigen::VectorXd scale_;                         ///< rms of each column
  struct Fold {
    Eigen::MatrixXd fit, check;  ///< products with the target last
    double fit_rows = 0.0, check_rows = 0.0;
  };
  std::vector<Fold> folds_;
  Eigen::MatrixXd all_;
  double all_rows_ = 0.0;
};

/// Laws that are made of parts, by what they leave of rows that they were not fitted to.
class PartLaws final : public LawFamily<PartLaw> {
 public:
  PartLaws(const PartProducts& products, const EffortNumbers& numbers) : products_(products), numbers_(numbers) {}

  auto score(const PartLaw& law) -> double override;
  [[nodiscard]] auto additions(const PartLaw& law) const -> std::vector<PartLaw> override;
  [[nodiscard]] auto reductions(const PartLaw& law) const -> std::vector<PartLaw> override;
  [[nodiscard]] auto variations(const PartLaw& law) const -> std::vector<PartLaw> override;

 private:
  [[nodiscard]] auto fits_beside(const PartLaw& law, const LawPart& part) const -> bool;

  const PartProducts& products_;
  const EffortNumbers& numbers_;
};

}  // namespace capstan::tools
