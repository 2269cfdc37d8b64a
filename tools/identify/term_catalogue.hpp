// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "capstan/model/effort_catalogue.hpp"
#include "capstan/model/input_stage.hpp"

namespace capstan::tools {

using Shapes = std::vector<double>;
using Samples = std::vector<Sample<double>>;

/// One term of a catalogue, as data: what the terms know at compile time, for programs that loop over them.
struct CatalogueTerm {
  std::string name, equation, source, confusable_with, exciting_motion;
  std::vector<CoefficientInfo> coefficients;
  std::vector<ShapeInfo> shapes;
  std::size_t first_coefficient = 0;  ///< in the flat list of the catalogue's coefficients
  std::size_t first_shape = 0;        ///< in that of its shapes
  bool acts_on_input = false;         ///< an input term: it changes what those that read h are given
  bool reads_input = false;           ///< its columns change with the input terms of the law
  bool acts_on_output = false;
  std::optional<int> of_axis = {};        ///< a term of another axis's samples
  bool shapes_are_open = false;           ///< at the end of their range they say something too, so a fit may end there
  bool shapes_are_given = false;          ///< known before a fit, which leaves them alone
  bool form_free = false;                 ///< describes what has no name; never the name of an effect
  bool placed = false;                    ///< who builds a law puts it there; no candidate of the search term by term
  std::vector<std::string> doubles = {};  ///< terms that a poor log can not tell from it
  Motion shown_by = Motion::kNone;        ///< motions that show it beside them
  std::size_t slots = 0;                  ///< of the coupling, from the first, that it reads
  /// A difference from one of these, so no effect of its own before one of them is in the law; empty: stands alone.
  std::vector<std::string> builds_on = {};
  /// Terms that it can stand for by a choice of its shapes or coefficients. Where one of them does as well, the answer
  /// is that one.
  std::vector<std::string> special_cases = {};

  /// Sum terms: one column per coefficient over consecutive samples of one log, by the term's own update().
  std::function<Eigen::MatrixXd(const Samples&, double period_s, const Shapes&)> columns;
  /// Terms of both an axis's own samples and of_axis's, taken at the same times.
  std::function<Eigen::MatrixXd(const Samples& own, const Samples& other)> pair_columns;
  /// Output terms: a signal of one log passed through the term. It is linear, so the columns of a fit may be passed
  /// instead.
  std::function<Eigen::VectorXd(const Eigen::VectorXd&, double period_s, const Shapes&)> apply;

  /// Input terms: consecutive samples of one log as those behind it see them.
  std::function<Samples(const Samples&, double period_s, double rate_time_constant_s, const Shapes&)> input;

  [[nodiscard]] auto initial_shapes() const -> Shapes;
};

/// What the laws of a catalogue give.
enum class TargetKind {
  kAngle,   ///< of the joint, from motor angle and torque
  kEffort,  ///< of the motor, from its motion
  kForce    ///< joint torque, from motor torque
};

/// How an axis moves: it decides the units of an effort law.
enum class AxisKind { kRotary, kLinear };

/// A family of laws: every term that they may consist of, in the order of their coefficients and shapes.
class Catalogue {
 public:
  /// Numbers the terms' coefficients and shapes in the order given.
  Catalogue(TargetKind target, std::string target_unit, std::string motion_unit, std::vector<CatalogueTerm> terms);

  [[nodiscard]] auto target() const -> TargetKind { return target_; }
  [[nodiscard]] auto target_unit() const -> const std::string& { return target_unit_; }
  [[nodiscard]] auto motion_unit() const -> const std::string& { return motion_unit_; }
  [[nodiscard]] auto coefficient_count() const -> std::size_t { return coefficient_count_; }
  [[nodiscard]] auto begin() const { return terms_.begin(); }
  [[nodiscard]] auto end() const { return terms_.end(); }
  [[nodiscard]] auto has(const std::string& name) const -> bool;
  /// @pre the name is in the catalogue
  [[nodiscard]] auto term(const std::string& name) const -> const CatalogueTerm&;
  /// Initial values of all shapes.
  [[nodiscard]] auto initial_shapes() const -> Shapes;

 private:
  TargetKind target_;
  std::string target_unit_, motion_unit_;
  std::vector<CatalogueTerm> terms_;
  std::size_t coefficient_count_ = 0;
};

/// Motor angle and torque to joint angle: InputTerms, SumTerms, OutputTerms, as the firmware numbers them.
auto term_catalogue() -> const Catalogue&;
/// The same, its tendons seen at 32 places each: for a fit of what the tendons are made of.
auto fine_tendon_catalogue() -> const Catalogue&;
/// Motion to effort: EffortTerms, the terms of the joint angle that a torque may hold as well, then OutputTerms.
/// Inertia is in kg m2 (kg): the firmware's krad/s2 is for fixed point.
auto effort_catalogue(AxisKind axis) -> const Catalogue&;
/// A term of term_catalogue().
auto catalogue_term(const std::string& name) -> const CatalogueTerm&;
/// Whether a term only moves the zero of a joint angle or an effort.
auto is_offset(const std::string& term) -> bool;

}  // namespace capstan::tools
