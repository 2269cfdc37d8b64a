// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/commission/commission.hpp"
#include "capstan/tools/commission/joint_console.hpp"

namespace capstan::tools {

/// The steps of commissioning, each a look or a motion and what is made of it. Each throws Refusal with its sentence.
class CommissionSteps {
 public:
  CommissionSteps(JointConsole& joint, const Operator& person, const CommissionOptions& options, Commissioned& all)
      : joint_(joint), person_(person), options_(options), all_(all), home_rad_(here()) {}

  static void look(CommissionSteps& steps);
  static void shake(CommissionSteps& steps);
  static void press(CommissionSteps& steps);
  static void travel(CommissionSteps& steps);
  static void motor(CommissionSteps& steps);
  static void tune_gains(CommissionSteps& steps);
  static void check(CommissionSteps& steps);
  static void save(CommissionSteps& steps);
  /// Margins of a tuned joint while all others are held by theirs.
  static void together(CommissionSteps& steps);

 private:
  void find(const std::string& sentence);
  /// A parameter that stays.
  void decide(const std::string& name, const std::string& value);
  /// Lets the board commission by itself, and decides what it prints. @returns false: this board can not
  auto commission_by_board(const std::string& order) -> bool;
  /// By how much the motor answers a look, with the gains as they are.
  void find_answer();
  /// Joint limits about where it stood at first.
  void keep_to_corridor();
  /// Gains that suit the motor's inertia alone, until there are better ones.
  void calm();
  /// Hardly any control, and no way of the motor beyond 2.9 deg.
  void let_go();
  [[nodiscard]] auto here() -> double;
  [[nodiscard]] auto continuous_nm() const -> double;
  /// What the motor is shaken with.
  struct Shake {
    std::string band;  ///< options of the multisine
    double amplitude_nm;
    double way_rad;  ///< where it ends
    bool fast;
  };
  /// The loudest last. Beyond a share of the continuous torque only so fast that the data sheet's inertia bounds the
  /// way of a motor that can not be seen.
  [[nodiscard]] auto shakes() const -> std::vector<Shake>;
  [[nodiscard]] auto shaken(const Shake& shake, int seconds) -> CsvLog;
  /// 2.9 deg: the gate takes torque away there, and a loose motor runs on a little.
  static constexpr double kMotorWayRad = 0.05;
  /// To and fro with that torque, N m; nothing: the motor left its limits.
  [[nodiscard]] auto pressed(double torque_nm) -> std::optional<CsvLog>;
  /// By what the motor did when it was shaken: whether it would leave its limits the next time.
  [[nodiscard]] auto would_leave(const Eigen::VectorXd& angle) const -> bool;
  void judge_current(const CsvLog& log);
  /// kg m2, by the motor's answer; below 0 where the encoder counts against the torque. Nothing where it answers as a
  /// spring does, held by friction.
  [[nodiscard]] auto inertia_of(const CsvLog& log) const -> std::optional<double>;
  [[nodiscard]] auto over_data_sheet(double inertia) const -> double;
  /// Torque of a shake that an encoder has to show, N m; anything where nobody said what the data sheet has.
  [[nodiscard]] auto unseen_nm() const -> double;
  [[noreturn]] void refuse_scale(double inertia) const;
  /// Friction and the joint make a motor heavier than its data sheet says, never lighter.
  void require_no_lighter(double inertia) const;
  void judge_inertia(double inertia);
  /// Shakes the joint while it travels, louder or less until the response can be used and `take` takes it.
  void respond(const std::function<void(const Response&)>& take);
  /// Rms of reference less estimate in a sine of that frequency, rad; nothing: a fault ended it.
  [[nodiscard]] auto tracking(const char* frequency) -> std::optional<double>;

  JointConsole& joint_;
  const Operator& person_;
  const CommissionOptions& options_;
  Commissioned& all_;
  double home_rad_;  ///< the middle of the corridor
};

}  // namespace capstan::tools
