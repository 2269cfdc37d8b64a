// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "capstan/tools/commission/commission.hpp"
#include "capstan/tools/commission/joint_console.hpp"

namespace capstan::tools {

/// The steps of commissioning, each a look or a motion and what is made of it. Each throws Refusal with its sentence.
class CommissionSteps {
 public:
  CommissionSteps(JointConsole& joint, const Operator& person, const CommissionOptions& options, Commissioned& all)
      : joint_(joint), person_(person), options_(options), all_(all), stood_rad_(here()), corridor_(corridor()) {}

  static void look(CommissionSteps& steps);
  static void turn(CommissionSteps& steps);
  static void shake(CommissionSteps& steps);
  static void press(CommissionSteps& steps);
  static void ends(CommissionSteps& steps);
  static void travel(CommissionSteps& steps);
  static void weigh(CommissionSteps& steps);
  static void motor(CommissionSteps& steps);
  static void tune_gains(CommissionSteps& steps);
  static void check(CommissionSteps& steps);
  static void save(CommissionSteps& steps);
  /// Margins of a tuned joint while all others are held by theirs.
  static void together(CommissionSteps& steps);
  [[nodiscard]] auto options() const -> const CommissionOptions& { return options_; }

 private:
  void find(const std::string& sentence);
  /// A parameter that stays.
  void decide(const std::string& name, const std::string& value);
  /// Lets the board commission by itself, and decides what it prints. @returns false: this board can not
  auto commission_by_board(const std::string& order) -> bool;
  /// By how much the motor answers a look, with the gains as they are.
  void find_answer();
  /// Angles of the joint, rad.
  struct Corridor {
    double middle, half;
  };
  /// About where it stood at first, within the joint's limits.
  [[nodiscard]] auto corridor() const -> Corridor;
  /// Joint limits at its ends. Throws Refusal where the joint stands outside, or it is too narrow.
  void keep_to_corridor();
  /// To its middle, under torque.
  void go_home();
  /// Without the motor observer, which knows no motor yet or would take the shaking for a sensor that lies: an encoder
  /// that stands still while the joint is to move is found after less of its way.
  void watch_frozen();
  /// Torque that a motion takes one way more than the other has to be that of `travel`.
  void require_same_friction(double backward_nm, double forward_nm) const;
  /// The person has done what the question says. Throws Stopped.
  void require_done(const std::string& question);
  /// Of the motor, mean of a fifth of a second without torque, rad.
  [[nodiscard]] auto motor_here() -> double;
  /// @param per_turn  counts that a turn by hand showed, below 0 where they fell   @param hand_share  its error
  void judge_counts(double per_turn, double hand_share);
  /// @param factor  of the present torque per current, by a weight   @param share  its error
  void judge_torque(double factor, double share);
  /// What a slow motion takes.
  struct SlowMotion {
    double backward_nm, forward_nm;  ///< about its middle
    double rise;                     ///< of the torque over the last half of a leg, of that at its end
    double reversal_rad;             ///< see Progress
  };
  /// To and fro about the middle of the corridor with calm gains at continuous current, and torque off behind it.
  auto slow_motion(double reach_rad) -> SlowMotion;
  /// Throws Refusal where the torque goes on rising.
  static void require_free(const SlowMotion& motion);
  void know(const SlowMotion& motion);
  /// Rad: where the motor pressed, and the joint's last place ahead of the stop.
  struct End {
    double motor_rad, joint_rad;
  };
  /// A step of a motion towards the ends.
  struct Pace {
    double step_rad;
    double most_nm;  ///< what takes more is a stop in any case
  };
  /// From the middle in steps; nothing: to the end of the corridor.
  [[nodiscard]] auto end_towards(double sign, const Pace& pace) -> std::optional<End>;
  /// Where a step ended.
  struct Stood {
    double motor_rad, joint_rad, torque_nm;
    bool there;  ///< at its target, with no more torque than it may take
  };
  [[nodiscard]] auto step_to(double target_rad, const Pace& pace) -> Stood;
  /// Limits of joint and motor there.
  void decide_end(const End& end, double sign, double margin_rad);
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
  /// A sine of that frequency over the corridor, with torque off behind it.
  [[nodiscard]] auto sine(const char* frequency) -> CsvLog;
  /// Rms of reference less estimate, rad.
  [[nodiscard]] auto tracking(const CsvLog& log) const -> double;

  JointConsole& joint_;
  const Operator& person_;
  const CommissionOptions& options_;
  Commissioned& all_;
  double stood_rad_;  ///< where the joint stood when this run began
  Corridor corridor_;
};

}  // namespace capstan::tools
