// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/grown_law.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "capstan/tools/select/effort_catalogue.hpp"
#include "capstan/tools/support/statistics.hpp"

namespace capstan::tools {
namespace {

constexpr Eigen::Index kBlocks = 12;
constexpr Eigen::Index kFolds = 6;

/// Columns of all parts side by side, and where each begins.
struct PartColumns {
  std::vector<Eigen::VectorXd> columns;
  std::vector<std::vector<Eigen::Index>> first;
};

auto columns_of_parts(const EffortDesign& design, Eigen::Index step, const Catalogue& catalogue,
                      const std::vector<LawPart>& parts) -> PartColumns {
  PartColumns all;
  std::map<std::pair<std::string, Shapes>, Eigen::Index> known;  // places of one term share their columns
  for (const auto& part : parts) {
    const auto& term = catalogue.term(part.term);
    const std::string name = term.of_axis ? part.term : effect_name(part.term);
    all.first.emplace_back();
    for (const auto& setting : part.settings) {
      const auto [found, is_new] = known.try_emplace({name, setting}, static_cast<Eigen::Index>(all.columns.size()));
      all.first.back().push_back(found->second);
      const Eigen::MatrixXd own = is_new ? design.columns(term, setting, step) : Eigen::MatrixXd();
      for (Eigen::Index i = 0; i < own.cols(); ++i) {
        all.columns.emplace_back(own.col(i));
      }
    }
  }
  return all;
}

/// Mean of the logs of the mean and of the single folds' errors: neither one bad fold nor many easy ones decide.
auto loss_of(const Eigen::VectorXd& errors) -> double {
  return 0.25 * (std::log(errors.mean()) + errors.array().log().mean());
}

}  // namespace

PartProducts::PartProducts(const EffortDesign& design, const Eigen::VectorXd& target, double share,
                           const Catalogue& catalogue, std::vector<LawPart> parts)
    : parts_(std::move(parts)) {
  constexpr Eigen::Index kEnoughRows = 8000;  // neighbours hardly differ
  const Eigen::Index step = std::max<Eigen::Index>(1, design.rows() / kEnoughRows);
  PartColumns all = columns_of_parts(design, step, catalogue, parts_);
  first_ = all.first;
  Eigen::VectorXd y = design.seen(target, step);
  const auto used = static_cast<Eigen::Index>(share * static_cast<double>(y.size()));
  y.conservativeResize(used);
  for (auto& column : all.columns) {
    column.conservativeResize(used);
  }
  const auto count = static_cast<Eigen::Index>(all.columns.size());
  Eigen::MatrixXd columns(y.size(), count + 1);
  scale_.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::VectorXd& column = all.columns[static_cast<std::size_t>(i)];
    scale_[i] = std::max(rms(column), 1e-300);
    columns.col(i) = column / scale_[i];
  }
  columns.col(count) = y;
  std::vector<Eigen::MatrixXd> products;
  std::vector<double> sizes;
  for (Eigen::Index block = 0; block < kBlocks; ++block) {
    const Eigen::Index begin = block * y.size() / kBlocks;
    const Eigen::Index size = (block + 1) * y.size() / kBlocks - begin;
    const auto own = columns.middleRows(begin, size);
    products.emplace_back(own.transpose() * own);
    sizes.push_back(static_cast<double>(size));
  }
  all_ = std::accumulate(products.begin() + 1, products.end(), products.front());
  all_rows_ = static_cast<double>(y.size());
  const auto add_fold = [&](auto&& fits, auto&& checks) {
    Fold fold{Eigen::MatrixXd::Zero(count + 1, count + 1), Eigen::MatrixXd::Zero(count + 1, count + 1)};
    for (Eigen::Index block = 0; block < kBlocks; ++block) {
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
  constexpr Eigen::Index kWide = kBlocks / kFolds;
  for (Eigen::Index fold = 0; fold < kFolds; ++fold) {
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

auto PartProducts::coefficients(const PartLaw& law, double ridge) const -> Eigen::VectorXd {
  const auto columns = columns_of(law);
  Eigen::VectorXd theta = solved(all_, columns, ridge * all_rows_);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    theta[static_cast<Eigen::Index>(i)] /= scale_[columns[i]];
  }
  return theta;
}

namespace {

/// A law on its way.
class Growth {
 public:
  Growth(const PartProducts& products, const GrowthNumbers& numbers) : products_(products), numbers_(numbers) {}

  void begin_with(std::size_t base) {
    for (std::size_t part = 0; part < base; ++part) {
      grown_.law.push_back({part, 0});
    }
    take(grown_.law);
    grown_.first_loss = grown_.loss;
    leave_out_what_is_not_needed();
  }

  /// Adds the best part there is; false where none is worth it.
  auto add_one() -> bool {
    PartLaw best;
    double lowest = grown_.loss - numbers_.worth_it;
    for (std::size_t part = 0; part < products_.parts().size(); ++part) {
      if (!fits_beside(part)) {
        continue;
      }
      for (std::size_t setting = 0; setting < products_.parts()[part].settings.size(); ++setting) {
        PartLaw trial = grown_.law;
        trial.push_back({part, setting});
        const Eigen::VectorXd errors = products_.fold_errors(trial, numbers_.ridge);
        if (loss_of(errors) < lowest && better_folds(errors) >= numbers_.folds_better) {
          lowest = loss_of(errors);
          best = trial;
        }
      }
    }
    if (best.empty() || best.size() > numbers_.most_parts) {
      return false;
    }
    grown_.path.push_back(products_.parts()[best.back().part].term);
    take(best);
    look_for_settings();
    leave_out_what_is_not_needed();
    return true;
  }

  [[nodiscard]] auto grown() const -> const GrownLaw& { return grown_; }

 private:
  /// A term is in the law once, so two of its parts go together only where it has no shapes.
  [[nodiscard]] auto fits_beside(std::size_t part) const -> bool {
    const auto& candidate = products_.parts()[part];
    const bool has_load = std::any_of(grown_.law.begin(), grown_.law.end(), [&](const ChosenPart& chosen) {
      return products_.parts()[chosen.part].term == candidate.needs;
    });
    return (candidate.needs.empty() || has_load) &&
           std::none_of(grown_.law.begin(), grown_.law.end(), [&](const ChosenPart& chosen) {
             const auto& other = products_.parts()[chosen.part];
             const bool shares = std::any_of(candidate.coefficients.begin(), candidate.coefficients.end(), [&](auto i) {
               return std::find(other.coefficients.begin(), other.coefficients.end(), i) != other.coefficients.end();
             });
             return other.term == candidate.term && (shares || !candidate.settings.front().empty());
           });
  }

  [[nodiscard]] auto better_folds(const Eigen::VectorXd& errors) const -> double {
    return static_cast<double>((errors.array() < errors_.array()).count()) / static_cast<double>(errors.size());
  }

  void take(const PartLaw& law) {
    grown_.law = law;
    errors_ = products_.fold_errors(law, numbers_.ridge);
    grown_.loss = loss_of(errors_);
  }

  void look_for_settings() {
    constexpr int kRounds = 2;
    for (int round = 0; round < kRounds; ++round) {
      for (std::size_t i = 0; i < grown_.law.size(); ++i) {
        const std::size_t count = products_.parts()[grown_.law[i].part].settings.size();
        for (std::size_t setting = 0; count > 1 && setting < count; ++setting) {
          PartLaw trial = grown_.law;
          trial[i].setting = setting;
          if (loss_of(products_.fold_errors(trial, numbers_.ridge)) < grown_.loss) {
            take(trial);
          }
        }
      }
    }
  }

  void leave_out_what_is_not_needed() {
    while (grown_.law.size() > 1) {
      PartLaw best;
      double lowest = grown_.loss + numbers_.kept_for;
      std::size_t gone = 0;
      for (std::size_t i = 0; i < grown_.law.size(); ++i) {
        PartLaw trial = grown_.law;
        trial.erase(trial.begin() + static_cast<std::ptrdiff_t>(i));
        const double loss = loss_of(products_.fold_errors(trial, numbers_.ridge));
        if (loss <= lowest) {
          lowest = loss;
          gone = grown_.law[i].part;
          best = trial;
        }
      }
      if (best.empty()) {
        return;
      }
      grown_.path.push_back("-" + products_.parts()[gone].term);
      take(best);
    }
  }

  const PartProducts& products_;
  const GrowthNumbers& numbers_;
  GrownLaw grown_;
  Eigen::VectorXd errors_;
};

}  // namespace

auto grown_base(const PartProducts& products, std::size_t base, const GrowthNumbers& numbers) -> GrownLaw {
  Growth growth(products, numbers);
  growth.begin_with(base);
  return growth.grown();
}

auto grow_law(const PartProducts& products, std::size_t base, const GrowthNumbers& numbers) -> GrownLaw {
  constexpr int kMostSteps = 40;
  Growth growth(products, numbers);
  growth.begin_with(base);
  for (int step = 0; step < kMostSteps && growth.add_one(); ++step) {
  }
  return growth.grown();
}

}  // namespace capstan::tools
