// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <unordered_map>

#include "capstan/tools/select/law_assembly.hpp"

namespace capstan::tools {

/// A candidate with its coefficients.
struct FittedCandidate {
  LawCandidate law;
  Eigen::VectorXd theta;         ///< per coefficient of its terms, in their order
  Eigen::VectorXd play_weights;  ///< coefficients c_i of its plays
  double mean_square = 0.0;      ///< of what it leaves of the rows it was fitted to
  bool valid = false;            ///< false: a ratio of nothing, or plays that no input stage can be made of
};

/// How well laws predict what comes after the rows that they were fitted to. The logs are cut into parts of equal
/// length; each part of the later half is predicted by the law fitted to the parts before it, of every log alike, so no
/// row is judged by a law that has seen it. Every log has a zero offset of its own. One score for all laws: the mean
/// squared error.
class ForwardScore {
 public:
  /// `rows`: coarse rows that may be looked at, in order; those that have not settled are left out.
  ForwardScore(SelectionData& data, const Blocks& rows);

  /// Mean squared error on unseen parts; infinity if the candidate is no law.
  auto score(const LawCandidate& law) -> double;
  /// Mean squared error on each piece of the unseen parts. @pre score() is finite
  auto losses(const LawCandidate& law) -> Eigen::VectorXd;
  /// Fitted to all rows.
  auto fitted(const LawCandidate& law) -> FittedCandidate;

  /// From now on a law with a coefficient that no joint file holds is none, unless the base law has one already: then
  /// the log's units are not a board's, and the diagnosis says so.
  void limit_as(const LawCandidate& base);
  [[nodiscard]] auto numbers() const -> const DecidingNumbers& { return data_.numbers(); }
  [[nodiscard]] auto data() const -> SelectionData& { return data_; }

 private:
  using Products = Eigen::Matrix<double, Eigen::Dynamic, 1>;  ///< one per part

  auto assemble(const LawCandidate& law) -> LawAssembly;
  void add_columns(const TermChoice& choice, const TermChoice* output, LawAssembly& fit);
  void add_bent(const TermChoice& choice, Eigen::Index first, const Eigen::VectorXd& h, LawAssembly& fit);
  void add_table(const TermChoice& choice, Eigen::Index first, const Eigen::VectorXd* h, LawAssembly& fit);
  void add_plays(const LawCandidate& law, LawAssembly& fit);
  [[nodiscard]] auto score_of(const LawCandidate& law) -> double;
  [[nodiscard]] auto placed(TermChoice choice, const Eigen::VectorXd& h) const -> TermChoice;
  void multiply(LawAssembly& fit);
  /// The motor angle behind the plays of a fit, coarse.
  auto behind_plays(const LawCandidate& law, const LawAssembly& fit, const Eigen::VectorXd& theta) -> Eigen::VectorXd;
  auto ratio_column(const LawCandidate& law) -> Eigen::VectorXd;
  void hold_plays(const LawCandidate& law, LawAssembly& fit) const;
  auto behind_held_plays(const LawCandidate& law, const LawAssembly& fit) -> Eigen::VectorXd;
  [[nodiscard]] auto left_out(const LawAssembly& fit) const -> double;
  [[nodiscard]] auto is_law(const LawAssembly& fit, const Eigen::VectorXd& theta) const -> bool;
  auto column_id(const std::string& key, const Eigen::VectorXd& coarse) -> std::size_t;
  auto offset_ids() -> const std::vector<std::size_t>&;
  auto products(std::size_t a, std::size_t b) -> const Products&;
  [[nodiscard]] auto products_of(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const -> Products;
  [[nodiscard]] auto taken(const Eigen::VectorXd& coarse) const -> Eigen::VectorXd;

  static constexpr double kAnyNumber = std::numeric_limits<double>::infinity();

  SelectionData& data_;
  double most_ = kAnyNumber;              ///< size of a coefficient
  std::vector<Eigen::Index> rows_;        ///< coarse rows in the order of the parts
  Blocks parts_;                          ///< in taken rows
  std::vector<Eigen::VectorXd> columns_;  ///< taken rows; [0] is the target
  std::unordered_map<std::string, std::size_t> ids_;
  std::unordered_map<std::size_t, Products> products_;
  std::unordered_map<std::string, double> scores_;
  std::vector<std::size_t> offsets_;
};

}  // namespace capstan::tools
