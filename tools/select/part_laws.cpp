// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/part_laws.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "capstan/tools/select/effort_catalogue.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

constexpr Eigen::Index kPartBlocks = 12;
constexpr Eigen::Index kPartFolds = 6;

}  // namespace

PartColumns::PartColumns(const EffortDesign& design, const Eigen::VectorXd& measured, const Catalogue& catalogue,
                         std::vector<LawPart> of)
    : parts(std::move(of)) {
  constexpr Eigen::Index kEnoughRows = 8000;  // neighbours hardly differ
  const Eigen::Index step = std::max<Eigen::Index>(1, design.rows() / kEnoughRows);
  target = design.seen(measured, step);
  std::map<std::pair<std::string, Shapes>, Eigen::Index> known;  // places of one term share their columns
  for (const auto& part : parts) {
    const auto& term = catalogue.term(part.term);
    const std::string name = term.of_axis ? part.term : effect_name(part.term);
    first.emplace_back();
    for (const auto& setting : part.settings) {
      const auto [found, is_new] = known.try_emplace({name, setting}, std::ssize(columns));
      first.back().push_back(found->second);
      const Eigen::MatrixXd own = is_new ? design.columns(term, setting, step) : Eigen::MatrixXd();
      for (Eigen::Index i = 0; i < own.cols(); ++i) {
        columns.emplace_back(own.col(i));
      }
    }
  }
}

PartProducts::PartProducts(const PartColumns& from, double share) : parts_(from.parts), first_(from.first) {
  const auto used = static_cast<Eigen::Index>(share * static_cast<double>(from.target.size()));
  const Eigen::VectorXd y = from.target.head(used);
  const auto count = std::ssize(from.columns);
  Eigen::MatrixXd columns(y.size(), count + 1);
  scale_.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto column = from.columns[static_cast<std::size_t>(i)].head(used);
    scale_[i] = std::max(rms(Eigen::VectorXd(column)), 1e-300);
    columns.col(i) = column / scale_[i];
  }
  columns.col(count) = y;
  std::vector<Eigen::MatrixXd> products;
  std::vector<double> sizes;
  for (Eigen::Index block = 0; block < kPartBlocks; ++block) {
    const Eigen::Index begin = block * y.size() / kPartBlocks;
    const Eigen::Index size = (block + 1) * y.size() / kPartBlocks - begin;
    const auto own = columns.middleRows(begin, size);
    products.emplace_back(own.transpose() * own);
    sizes.push_back(static_cast<double>(size));
  }
  all_ = std::accumulate(products.begin() + 1, products.end(), products.front());
  all_rows_ = static_cast<double>(y.size());
  const auto add_fold = [&](auto&& fits, auto&& checks) {
    Fold fold{Eigen::MatrixXd::Zero(count + 1, count + 1), Eigen::MatrixXd::Zero(count + 1, count + 1)};
    for (Eigen::Index block = 0; block < kPartBlocks; ++block) {
      const auto at = static_cast<std::size_t>(block);
      if (fits(block)) {
        fold.fit += products[at];
        fold.fit_rows += sizes[at];
      } else if (checks(block)) {
        fold.check += products[at];
        fold.check_rows += sizes[at];
      }
    }
    folds_.push_back(std::move(fold));
  };
  constexpr Eigen::Index kWide = kPartBlocks / kPartFolds;
  for (Eigen::Index fold = 0; fold < kPartFolds; ++fold) {
    add_fold([fold](Eigen::Index block) { return block / kWide != fold; }, [](Eigen::Index) { return true; });
  }
  for (const Eigen::Index known : {6, 8, 10}) {
    add_fold([known](Eigen::Index block) { return block < known; },
             [known](Eigen::Index block) { return block < known + kWide; });
  }
}

auto PartProducts::columns_of(const PartLaw& law) const -> std::vector<Eigen::Index> {
  std::vector<Eigen::Index> columns;
  for (const auto& chosen : law) {
    for (const std::size_t coefficient : parts_[chosen.part].coefficients) {
      columns.push_back(first_[chosen.part][chosen.setting] + static_cast<Eigen::Index>(coefficient));
    }
  }
  return columns;
}

auto PartProducts::solved(const Eigen::MatrixXd& products, const std::vector<Eigen::Index>& columns, double ridge) const
    -> Eigen::VectorXd {
  Eigen::MatrixXd gram = products(columns, columns);
  gram.diagonal().array() += ridge;
  return gram.ldlt().solve(products(columns, products.cols() - 1));
}

auto PartProducts::fold_errors(const PartLaw& law, double ridge) const -> Eigen::VectorXd {
  const auto columns = columns_of(law);
  Eigen::VectorXd errors(static_cast<Eigen::Index>(folds_.size()));
  for (Eigen::Index i = 0; i < errors.size(); ++i) {
    const Fold& fold = folds_[static_cast<std::size_t>(i)];
    const Eigen::Index y = fold.check.cols() - 1;
    double energy = fold.check(y, y);
    if (!columns.empty()) {
      const Eigen::VectorXd theta = solved(fold.fit, columns, ridge * fold.fit_rows);
      const Eigen::MatrixXd gram = fold.check(columns, columns);
      const Eigen::VectorXd with_target = fold.check(columns, y);
      energy += theta.dot(gram * theta) - 2.0 * theta.dot(with_target);
    }
    errors[i] = std::max(energy / fold.check_rows, 1e-12 * std::max(fold.check(y, y), 1e-280) / fold.check_rows);
  }
  return errors;
}

auto PartProducts::largest_share(const PartLaw& law, double ridge) const -> double {
  const auto columns = columns_of(law);
  if (columns.empty()) {
    return 0.0;
  }
  const Eigen::VectorXd theta = solved(all_, columns, ridge * all_rows_);
  const double target = all_(all_.rows() - 1, all_.cols() - 1);
  double largest = 0.0;
  Eigen::Index next = 0;
  for (const auto& chosen : law) {
    const auto own = columns_of({chosen});
    const Eigen::VectorXd of_part = theta.segment(next, std::ssize(own));
    largest = std::max(largest, of_part.dot(all_(own, own) * of_part));
    next += of_part.size();
  }
  return target > 0.0 ? std::sqrt(largest / target) : 0.0;
}

auto PartProducts::coefficients(const PartLaw& law, double ridge) const -> Eigen::VectorXd {
  const auto columns = columns_of(law);
  Eigen::VectorXd theta = solved(all_, columns, ridge * all_rows_);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    theta[static_cast<Eigen::Index>(i)] /= scale_[columns[i]];
  }
  return theta;
}

auto PartLaws::score(const PartLaw& law) -> double {
  if (products_.largest_share(law, numbers_.ridge) > numbers_.largest_share) {
    return std::numeric_limits<double>::infinity();
  }
  const Eigen::ArrayXd errors = products_.fold_errors(law, numbers_.ridge).array();
  // The geometric mean of their mean and of the single folds' errors: neither one bad fold nor many easy ones decide.
  return std::exp(0.5 * (std::log(errors.mean()) + errors.log().mean()));
}

/// A term is in the law once, so two of its parts go together only where it has no shapes.
auto PartLaws::fits_beside(const PartLaw& law, const LawPart& part) const -> bool {
  const auto& parts = products_.parts();
  const bool has_load = std::any_of(law.begin(), law.end(),
                                    [&](const ChosenPart& chosen) { return parts[chosen.part].term == part.needs; });
  return (part.needs.empty() || has_load) && std::none_of(law.begin(), law.end(), [&](const ChosenPart& chosen) {
           const LawPart& other = parts[chosen.part];
           const bool shares = std::any_of(part.coefficients.begin(), part.coefficients.end(), [&](auto i) {
             return std::find(other.coefficients.begin(), other.coefficients.end(), i) != other.coefficients.end();
           });
           return other.term == part.term && (shares || !part.settings.front().empty());
         });
}

/// A part has to help in most folds, and not in a few of them much.
auto PartLaws::additions(const PartLaw& law) const -> std::vector<PartLaw> {
  const Eigen::VectorXd before = products_.fold_errors(law, numbers_.ridge);
  const double needed = numbers_.folds_better * static_cast<double>(before.size());
  std::vector<PartLaw> laws;
  for (std::size_t part = 0; law.size() < numbers_.most_parts && part < products_.parts().size(); ++part) {
    if (fits_beside(law, products_.parts()[part])) {
      for (std::size_t setting = 0; setting < products_.parts()[part].settings.size(); ++setting) {
        PartLaw more = law;
        more.push_back({part, setting});
        const Eigen::VectorXd after = products_.fold_errors(more, numbers_.ridge);
        if (static_cast<double>((after.array() < before.array()).count()) >= needed) {
          laws.push_back(std::move(more));
        }
      }
    }
  }
  return laws;
}

auto PartLaws::reductions(const PartLaw& law) const -> std::vector<PartLaw> {
  std::vector<PartLaw> laws;
  for (std::size_t i = 0; law.size() > 1 && i < law.size(); ++i) {
    laws.push_back(law);
    laws.back().erase(laws.back().begin() + static_cast<std::ptrdiff_t>(i));
  }
  return laws;
}

auto PartLaws::variations(const PartLaw& law) const -> std::vector<PartLaw> {
  std::vector<PartLaw> laws;
  for (std::size_t i = 0; i < law.size(); ++i) {
    const std::size_t count = products_.parts()[law[i].part].settings.size();
    for (const std::size_t setting : {law[i].setting - 1, law[i].setting + 1}) {  // -1 wraps beyond the last
      if (setting < count) {
        laws.push_back(law);
        laws.back()[i].setting = setting;
      }
    }
  }
  return laws;
}

}  // namespace capstan::tools
