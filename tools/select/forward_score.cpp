// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/select/forward_score.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "capstan/model/terms/hysteresis.hpp"
#include "capstan/model/terms/table.hpp"

namespace capstan::tools {
namespace {

constexpr std::size_t kTarget = 0;
constexpr double kNoLaw = std::numeric_limits<double>::infinity();
/// Fits of a bent law: what it bends over comes from the fit before.
constexpr int kBends = 2;

/// Whether a placed term is drawn over what comes out of the plays.
auto reads_plays(const TermChoice& choice) -> bool {
  return choice.term != "table" || choice.shapes[0] == static_cast<double>(TableSignal::kMotorAngle);
}

}  // namespace

ForwardScore::ForwardScore(SelectionData& data, const Blocks& rows) : data_(data) {
  auto order = ordered_in_parts(data, rows);
  rows_ = std::move(order.rows);
  parts_ = std::move(order.parts);
  column_id("target", data.target());
}

auto ForwardScore::taken(const Eigen::VectorXd& coarse) const -> Eigen::VectorXd {
  return coarse(rows_);
}

auto ForwardScore::column_id(const std::string& key, const Eigen::VectorXd& coarse) -> std::size_t {
  const auto [found, is_new] = ids_.try_emplace(key, columns_.size());
  if (is_new) {
    columns_.push_back(taken(coarse));
  }
  return found->second;
}

auto ForwardScore::products_of(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const -> Products {
  Products result(static_cast<Eigen::Index>(parts_.size()));
  for (std::size_t part = 0; part < parts_.size(); ++part) {
    const RowRange& rows = parts_[part];
    result[static_cast<Eigen::Index>(part)] =
        a.segment(rows.begin, rows.size()).dot(b.segment(rows.begin, rows.size()));
  }
  return result;
}

auto ForwardScore::products(std::size_t a, std::size_t b) -> const Products& {
  constexpr unsigned kHalfWord = 32;
  const auto [found, is_new] = products_.try_emplace((std::min(a, b) << kHalfWord) | std::max(a, b));
  if (is_new) {
    found->second = products_of(columns_[a], columns_[b]);
  }
  return found->second;
}

/// A column per log: each has a zero of its own.
auto ForwardScore::offset_ids() -> const std::vector<std::size_t>& {
  for (std::size_t log = offsets_.size(); log < data_.logs().size(); ++log) {
    Eigen::VectorXd here = Eigen::VectorXd::Zero(data_.rows());
    here.segment(data_.logs()[log].begin, data_.logs()[log].size()).setOnes();
    offsets_.push_back(column_id("offset of log " + std::to_string(log), here));
  }
  return offsets_;
}

void ForwardScore::add_columns(const TermChoice& choice, const TermChoice* output, LawAssembly& fit) {
  const CatalogueTerm& term = data_.catalogue().term(choice.term);
  const Eigen::Index first = fit.coefficients;
  fit.coefficients += static_cast<Eigen::Index>(term.coefficients.size());
  if (is_offset(choice.term)) {
    for (const std::size_t id : offset_ids()) {
      fit.offsets.push_back(static_cast<Eigen::Index>(fit.columns.size()));
      fit.columns.push_back({id, {}, Sign::kAny, 0.0, {first}});
    }
    return;
  }
  const bool is_ratio = choice.term == "motor_angle";
  const std::string key = key_of(choice) + (output != nullptr ? "|" + key_of(*output) : "");
  const Eigen::MatrixXd& columns = data_.columns(choice, output);
  for (Eigen::Index i = 0; i < columns.cols(); ++i) {
    const std::size_t id = column_id(key + "#" + std::to_string(i), columns.col(i));
    fit.columns.push_back(
        {id, {}, term.coefficients[static_cast<std::size_t>(i)].sign, is_ratio ? 0.0 : numbers().ridge, {first + i}});
  }
  if (is_ratio) {
    fit.beta = static_cast<Eigen::Index>(fit.columns.size()) - 1;
  }
}

/// A table: a column per knot, of each direction or of both together.
/// @param h  the motor angle behind the plays, where it reads that and there are plays; no column is kept then
void ForwardScore::add_table(const TermChoice& choice, Eigen::Index first, const Eigen::VectorXd* h, LawAssembly& fit) {
  const auto most = static_cast<Eigen::Index>(Table<double>::kKnots);
  const auto knots = static_cast<Eigen::Index>(std::lround(choice.shapes[1]));
  const std::string key = key_of(choice) + "#";
  const bool known = h == nullptr && ids_.contains(key + "0");
  const Eigen::MatrixXd columns = known ? Eigen::MatrixXd() : data_.columns_at(choice, h != nullptr ? *h : data_.q1());
  const auto add = [&](Eigen::Index i, std::vector<Eigen::Index> places) {
    Eigen::VectorXd own = known ? Eigen::VectorXd() : Eigen::VectorXd(columns.col(places.front() - first));
    if (!known && places.size() > 1) {
      own += columns.col(places.back() - first);
    }
    const std::size_t id = h == nullptr ? column_id(key + std::to_string(i), own) : LawAssembly::kNotKept;
    fit.columns.push_back(
        {id, h == nullptr ? Eigen::VectorXd() : taken(own), Sign::kAny, numbers().ridge, std::move(places)});
  };
  for (Eigen::Index direction = 0; direction < (choice.by_direction ? 2 : 1); ++direction) {
    const auto begin = static_cast<Eigen::Index>(fit.columns.size());
    for (Eigen::Index i = 0; i < knots; ++i) {
      const Eigen::Index place = first + direction * most + i;
      add(direction * most + i,
          choice.by_direction ? std::vector<Eigen::Index>{place} : std::vector<Eigen::Index>{place, place + most});
    }
    fit.lines.push_back({begin, begin + knots});
  }
  fit.smoothness = numbers().smoothness;
}

void ForwardScore::add_bent(const TermChoice& choice, Eigen::Index first, const Eigen::VectorXd& h, LawAssembly& fit) {
  if (data_.catalogue().term(choice.term).form_free) {
    const bool bare = fit.plays == 0 && fit.held.size() == 0 && fit.law.output(data_.catalogue()) == nullptr;
    add_table(choice, first, bare ? nullptr : &h, fit);
    return;
  }
  const Eigen::MatrixXd columns = data_.columns_at(choice, h);
  for (Eigen::Index i = 0; i < columns.cols(); ++i) {
    fit.columns.push_back({LawAssembly::kNotKept, taken(columns.col(i)), Sign::kAny, numbers().ridge, {first + i}});
  }
}

void ForwardScore::multiply(LawAssembly& fit) {
  const auto n = static_cast<Eigen::Index>(fit.columns.size());
  fit.grams.assign(parts_.size(), Eigen::MatrixXd(n + 1, n + 1));
  fit.signs.clear();
  fit.ridge.resize(n);
  const auto values = [&](const LawAssembly::Column& column) -> const Eigen::VectorXd& {
    return column.id == LawAssembly::kNotKept ? column.own : columns_[column.id];
  };
  LawAssembly::Column target{kTarget, {}, Sign::kAny, 0.0, {}};
  for (Eigen::Index i = 0; i <= n; ++i) {
    const LawAssembly::Column& a = i < n ? fit.columns[static_cast<std::size_t>(i)] : target;
    for (Eigen::Index k = 0; k <= i; ++k) {
      if (fit.are_apart(i, k)) {
        for (auto& gram : fit.grams) {
          gram(i, k) = gram(k, i) = 0.0;
        }
        continue;
      }
      const LawAssembly::Column& b = k < n ? fit.columns[static_cast<std::size_t>(k)] : target;
      const bool kept = a.id != LawAssembly::kNotKept && b.id != LawAssembly::kNotKept;
      const Products all = kept ? products(a.id, b.id) : products_of(values(a), values(b));
      for (std::size_t part = 0; part < parts_.size(); ++part) {
        fit.grams[part](i, k) = fit.grams[part](k, i) = all[static_cast<Eigen::Index>(part)];
      }
    }
    if (i < n) {
      fit.signs.push_back(a.sign);
      fit.ridge[i] = a.ridge;
    }
  }
}

/// The motor angle as the ratio sees it where there are no plays.
auto ForwardScore::ratio_column(const LawCandidate& law) -> Eigen::VectorXd {
  return data_.columns({"motor_angle", {}}, law.output(data_.catalogue())).col(0);
}

auto ForwardScore::behind_plays(const LawCandidate& law, const LawAssembly& fit, const Eigen::VectorXd& theta)
    -> Eigen::VectorXd {
  Eigen::VectorXd h = ratio_column(law);
  for (Eigen::Index i = 0; i < fit.plays && theta[fit.beta] != 0.0; ++i) {
    const TermChoice play{"play", {law.plays[static_cast<std::size_t>(i)]}};
    h += theta[fit.first_play + i] / theta[fit.beta] * data_.columns(play, law.output(data_.catalogue())).col(0);
  }
  return h;
}

/// What lies behind the plays reaches as far as their output does.
auto ForwardScore::placed(TermChoice choice, const Eigen::VectorXd& h) const -> TermChoice {
  const Eigen::VectorXd seen = taken(h);
  const double low = seen.minCoeff();
  const double high = seen.maxCoeff();
  if (choice.term == "curved_ratio") {
    choice.shapes = {0.5 * (low + high), 0.5 * (high - low)};
  } else if (choice.term == "table") {
    choice.shapes[2] = low;
    choice.shapes[3] = high;
  }
  return choice;
}

/// Holds the plays as they were fitted: what bends over their output was fitted beside it, so a law of both is one
/// whose plays stay where they are. Their columns go; the ratio's is that of their output.
void ForwardScore::hold_plays(const LawCandidate& law, LawAssembly& fit) const {
  const Eigen::VectorXd theta = fit.fit(numbers().parts);
  fit.held = theta.segment(fit.first_play, fit.plays) / theta[fit.beta];
  const auto first = fit.columns.begin() + fit.first_play;
  fit.columns.erase(first, first + static_cast<std::ptrdiff_t>(law.plays.size()));
  fit.columns[static_cast<std::size_t>(fit.beta)].id = LawAssembly::kNotKept;
  fit.plays = 0;
}

auto ForwardScore::behind_held_plays(const LawCandidate& law, const LawAssembly& fit) -> Eigen::VectorXd {
  Eigen::VectorXd h = ratio_column(law);
  for (std::size_t i = 0; i < law.plays.size(); ++i) {
    h += fit.held[static_cast<Eigen::Index>(i)] *
         data_.columns({"play", {law.plays[i]}}, law.output(data_.catalogue())).col(0);
  }
  return h;
}

void ForwardScore::add_plays(const LawCandidate& law, LawAssembly& fit) {
  const TermChoice* output = law.output(data_.catalogue());
  fit.first_play = static_cast<Eigen::Index>(fit.columns.size());
  fit.plays = static_cast<Eigen::Index>(law.plays.size());
  for (const double half_width : law.plays) {
    const TermChoice play{"play", {half_width}};
    const std::string key = key_of(play) + (output != nullptr ? "|" + key_of(*output) : "");
    fit.columns.push_back({column_id(key, data_.columns(play, output).col(0)), {}, Sign::kAny, numbers().ridge, {}});
  }
}

auto ForwardScore::assemble(const LawCandidate& law) -> LawAssembly {
  LawAssembly fit;
  fit.law = law;
  const TermChoice* output = law.output(data_.catalogue());
  std::vector<std::pair<const TermChoice*, Eigen::Index>> bent;
  for (const auto& choice : law.terms) {
    const CatalogueTerm& term = data_.catalogue().term(choice.term);
    if (term.acts_on_output) {
      continue;
    }
    if (term.reads_input && term.placed) {
      if (reads_plays(choice)) {
        bent.emplace_back(&choice, fit.coefficients);
      } else {
        add_table(choice, fit.coefficients, nullptr, fit);
      }
      fit.coefficients += static_cast<Eigen::Index>(term.coefficients.size());
    } else {
      add_columns(choice, output, fit);
    }
  }
  add_plays(law, fit);
  if (bent.empty()) {
    multiply(fit);
    return fit;
  }
  const std::size_t straight = fit.columns.size();
  const std::size_t lines = fit.lines.size();
  const auto bend_over = [&](const Eigen::VectorXd& h, std::size_t kept) {
    fit.columns.resize(kept);
    fit.lines.resize(lines);
    for (const auto& [choice, first] : bent) {
      const TermChoice there = placed(*choice, h);
      fit.law = with_term(data_.catalogue(), std::move(fit.law), there);
      add_bent(there, first, h, fit);
    }
    multiply(fit);
  };
  Eigen::VectorXd h = ratio_column(law);
  bend_over(h, straight);
  for (int bend = 0; bend < kBends && fit.plays > 0; ++bend) {
    h = behind_plays(law, fit, fit.fit(numbers().parts));
    bend_over(h, straight);
  }
  if (fit.plays > 0) {
    hold_plays(law, fit);
    h = behind_held_plays(law, fit);
    fit.columns[static_cast<std::size_t>(fit.beta)].own = taken(h);
    bend_over(h, straight - law.plays.size());
  }
  return fit;
}

void ForwardScore::limit_as(const LawCandidate& base) {
  most_ = kAnyNumber;
  scores_.clear();
  const LawAssembly fit = assemble(base);
  most_ = fit.fit(numbers().parts).cwiseAbs().maxCoeff() <= kLargestNumber ? kLargestNumber : kAnyNumber;
}

auto ForwardScore::is_law(const LawAssembly& fit, const Eigen::VectorXd& theta) const -> bool {
  if (!theta.allFinite() || theta.cwiseAbs().maxCoeff() > most_) {
    return false;
  }
  constexpr double kMost = Hysteresis<double>::kMostWeight;
  if (fit.held.size() > 0) {
    return fit.held.allFinite() && fit.held.cwiseAbs().maxCoeff() <= kMost;
  }
  return fit.plays == 0 ||
         theta.segment(fit.first_play, fit.plays).cwiseAbs().maxCoeff() <= kMost * std::abs(theta[fit.beta]);
}

auto ForwardScore::score(const LawCandidate& law) -> double {
  const auto [found, is_new] = scores_.try_emplace(key_of(law));
  if (is_new) {
    found->second = score_of(law);
  }
  return found->second;
}

auto ForwardScore::score_of(const LawCandidate& law) -> double {
  const LawAssembly fit = assemble(law);
  if (!is_law(fit, fit.fit(numbers().parts))) {
    return kNoLaw;
  }
  double energy = 0.0;
  for (Eigen::Index part = numbers().first_judged_part; part < numbers().parts; ++part) {
    energy += energy_left(fit.grams[static_cast<std::size_t>(part)], fit.fit(part));
  }
  const Eigen::Index rows = parts_.back().end - parts_[static_cast<std::size_t>(numbers().first_judged_part)].begin;
  if (rows <= 0 || !std::isfinite(energy)) {
    return kNoLaw;
  }
  const double forward = energy / static_cast<double>(rows);
  return 0.5 * (forward + left_out(fit) / static_cast<double>(parts_.back().end));
}

/// What a law leaves of each piece of the log in turn, fitted to all others: energy of all rows.
auto ForwardScore::left_out(const LawAssembly& fit) const -> double {
  const Eigen::MatrixXd all = fit.sum(0, numbers().parts);
  double energy = 0.0;
  for (Eigen::Index part = 0; part < numbers().parts; part += numbers().parts_left_out) {
    const Eigen::MatrixXd own = fit.sum(part, std::min(part + numbers().parts_left_out, numbers().parts));
    energy += energy_left(own, fit.solved(all - own));
  }
  return energy;
}

auto ForwardScore::losses(const LawCandidate& law) -> Eigen::VectorXd {
  const LawAssembly fit = assemble(law);
  Eigen::VectorXd losses((numbers().parts - numbers().first_judged_part) * numbers().pieces_per_part);
  Eigen::Index at = 0;
  for (Eigen::Index part = numbers().first_judged_part; part < numbers().parts; ++part) {
    const Eigen::VectorXd theta = fit.fit(part);
    const RowRange& rows = parts_[static_cast<std::size_t>(part)];
    Eigen::VectorXd error = columns_[kTarget].segment(rows.begin, rows.size());
    for (std::size_t i = 0; i < fit.columns.size(); ++i) {
      const auto& column = fit.columns[i];
      const Eigen::VectorXd& values = column.id == LawAssembly::kNotKept ? column.own : columns_[column.id];
      error -= theta[static_cast<Eigen::Index>(i)] * values.segment(rows.begin, rows.size());
    }
    for (Eigen::Index piece = 0; piece < numbers().pieces_per_part; ++piece) {
      const Eigen::Index begin = rows.size() * piece / numbers().pieces_per_part;
      const Eigen::Index end = rows.size() * (piece + 1) / numbers().pieces_per_part;
      losses[at++] =
          end > begin ? error.segment(begin, end - begin).squaredNorm() / static_cast<double>(end - begin) : 0.0;
    }
  }
  return losses;
}

auto ForwardScore::fitted(const LawCandidate& law) -> FittedCandidate {
  const LawAssembly fit = assemble(law);
  const Eigen::VectorXd theta = fit.fit(numbers().parts);
  FittedCandidate result{
      fit.law, Eigen::VectorXd::Zero(fit.coefficients),
      fit.held.size() > 0 ? Eigen::VectorXd(fit.held * theta[fit.beta])
                          : Eigen::VectorXd(theta.segment(fit.first_play, fit.plays)),
      energy_left(fit.sum(0, numbers().parts), theta) / static_cast<double>(std::max<std::size_t>(1, rows_.size())),
      is_law(fit, theta)};
  const auto logs = static_cast<double>(data_.logs().size());
  for (std::size_t i = 0; i < fit.columns.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const bool is_zero = std::find(fit.offsets.begin(), fit.offsets.end(), at) != fit.offsets.end();
    for (const Eigen::Index coefficient : fit.columns[i].coefficients) {
      result.theta[coefficient] += theta[at] / (is_zero ? logs : 1.0);
    }
  }
  return result;
}

}  // namespace capstan::tools
