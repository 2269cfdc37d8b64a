// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "capstan/tools/identify/settled.hpp"

namespace capstan::tools {

/// What growing a law asks of a change, as factors of the mean squared error on rows that the law was not fitted to.
struct GrowthRules {
  double worth_a_step = 0.97;   ///< a step has to lower it to this share at least
  double as_good = 1.005;       ///< a smaller law is taken where it errs by this factor more at most
  double worth_a_move = 0.998;  ///< another value of a shape has to lower it to this share
  int most_steps = 8;
};

/// Every number that decides which law is delivered. Lengths are shares of the log's own ranges. Chosen on 22 November
/// 2026 on the 13 measured joint angles of shared/data/machines, each cut at 45 and 60 % of its rows; what other values
/// give, and what comes out on a machine when they are chosen on the others, is in docs/measured_machines.md.
struct DecidingNumbers {
  /// Rows that take no part.
  SettlingRule settling;
  /// A quarter of a log is half of what it shows of one branch where the motor turns twice, by this share of its range,
  /// and no more. Fewer rows are left out there, and plays begin where the log says that they began (play_start.hpp).
  /// Of logs with one turn a start is not told from a width; where strokes suffice the first one only does harm
  /// (docs/measured_machines.md).
  SettlingRule settling_of_few_strokes = {.most_share_of_rows = 0.1};
  int turns_of_a_cycle = 2;
  int turns_of_two_cycles = 3;
  double way_of_a_stroke = 0.3;

  /// Half widths of plays that are tried: shares of the motor's range, in equal ratios.
  double narrowest_play = 1.0 / 200.0;
  double widest_play = 1.0 / 2.02;
  std::size_t play_widths = 20;
  /// A play that the motion does not turn round this often is a step of the first stroke, and no hysteresis.
  int fewest_turns_of_play = 1;
  /// What it has to go back by, as a share of the motor's range: a play almost as wide as the motion touches its other
  /// side for a few rows, and a ratio learned there leads far astray once it moves. Taken for the worst errors, which
  /// it ends, on all measured angles (docs/measured_machines.md); 1/20 does the same.
  double way_of_a_turn = 1.0 / 50.0;
  /// As many as the input stage has room for.
  std::size_t most_plays = 6;
  /// Half widths of plays of other joints' tendons, shares of those motors' ranges.
  double narrowest_coupled_play = 1.0 / 100.0;
  std::size_t coupled_play_widths = 8;
  /// Other shapes: from this share of a signal's range on; times from so many samples to this share of the log.
  std::size_t shape_values = 8;
  double smallest_share = 1.0 / 25.0;
  double shortest_time = 3.0;
  double longest_time = 0.25;
  /// Knots of a table, and of those that are tried where something is missing for certain. The three that follow
  /// were set beforehand and none was varied; drawn joints 87001 to 87032 and 87101 to 87107 were looked
  /// at with them (tools/blind_benchmark, 23 November 2026).
  std::size_t table_knots = 9;
  std::size_t fine_table_knots = 17;
  /// Share of the rows at each end of a rate, and at the far end of time and way since a reversal, that a table's ends
  /// leave outside: a few jumps of the encoder would make most of its cells empty.
  double share_outside_table = 0.005;
  /// Weight of the squared step from knot to knot of a table, as a share of the mean energy of its columns: a knot
  /// where hardly a row has been takes its neighbour's value, where a ridge alone lets it run off.
  double smoothness = 1e-3;

  /// Parts of a log in time. A law is judged on each part of the later half, fitted to all parts before it: it will be
  /// used after the log, too.
  Eigen::Index parts = 16;
  Eigen::Index first_judged_part = 8;
  /// That alone judges by half of the rows. The score is the mean of it and of the error of so many parts in a row,
  /// fitted to all others, before and after. Of eight scores (forward alone, left out alone, larger of both, other
  /// means; 1, 2 and 4 parts), on eight windows of each log, none of them the scoreboard's, this one did best whichever
  /// machine was left out: 1.10 in 86 % and a geometric mean of 0.67, with forward alone 80 % and 0.72 (23 November
  /// 2026).
  Eigen::Index parts_left_out = 4;
  /// Pieces of each judged part, and how many of them in a row are resampled together.
  Eigen::Index pieces_per_part = 8;
  Eigen::Index run = 3;

  GrowthRules growth;
  /// Ridge on every coefficient but the ratio and the offset, as a share of its column's mean square.
  double ridge = 1e-6;

  /// Level at which a law leaves the model confidence set.
  double confidence_level = 0.1;
  int resamplings = 500;
  /// The named law is delivered where it errs by this factor more at most, in the mean square: a name is worth 2.5 % of
  /// the error. The confidence set is not asked: with one law in ten it leaves out the right one.
  double worth_a_name = 1.05;
  /// The base law stays where it is in the set and errs by this factor more at most. A short log leaves much in the
  /// set: one that errs ten times as much is no answer, even where chance might have it.
  double worth_a_law = 1.3;
};

/// The same for laws of efforts and gears. Chosen in November 2026 on the 13 effort joints of the shared measured
/// machines (first 60 % of each log to choose and fit, the rest to judge), on a prototype of this growth with the same
/// terms: with a step worth 2 % of the rms error the law was at most 1.10 times the best plain fit in 12 of 13, with 3
/// % in 11; asking more of logs with few reversals made it 11 (0.3 over their number) down to 8 (1 over it); the score
/// without the mean (logs of single folds alone) 9; folds_better of 0 or 0.75 gives the same count. The other numbers
/// were not varied.
struct EffortNumbers {
  GrowthRules growth = {.worth_a_step = 0.961, .as_good = 1.012, .worth_a_move = 1.0, .most_steps = 40};
  double folds_better = 0.6;  ///< share of the folds in which a part must bring something
  /// What the law grown in another view of rest must leave of the mean squared error on unseen rows: a tenth less, rms,
  /// as of an effect that could hide. Where it helps on drawn machines it leaves half or less; with 0.96
  /// `ur10e_joint1` leaves 9.2 % for 8.6 (27 November 2026).
  double worth_another_rest = 0.81;
  double ridge = 1e-6;  ///< weight of the squared coefficients, of columns of size one
  /// No part of a law is larger than so many of the efforts that were measured, rms: over a small angle a weight, a
  /// spring and an offset hardly differ, and large ones that cancel there run apart beyond. `xl330` behind a rest took
  /// a weight of 101 N m for efforts of 5, and was left with 17 times the plain fit. On 126 windows 2, 5 and 10 do as
  /// well (27 November 2026).
  double largest_share = 3.0;
  std::size_t most_parts = 16;
};
inline constexpr EffortNumbers kEffortNumbers;

/// `nothing_missing` takes a law that leaves less than this many floors on rows set aside; 1.2 is the contract's.
inline constexpr double kAboveFloor = 1.2;
/// Names that are certain to explain this share, in energy, of all that can be explained are the whole answer: a term
/// is a form of its effect, and a seventh of it, rms, may be form. Drawn joints named rightly with "something beyond"
/// left 0.3 to 1.1 % (seeds 98029 to 98107 and 41039 to 41111, 23 November 2026), the weaker of two effects leaves 6 %
/// where it is four times smaller.
inline constexpr double kWholeEffect = 0.98;
/// And, where no cycles repeat or they differ by as much, that no effect of this share of the target's rms could hide;
/// the contract's.
inline constexpr double kLargestHiddenShare = 0.1;
/// Where a law for each part of a log leaves this share, rms, or less for certain (the 95 % interval's upper end) of
/// what one law leaves, on rows that none of them has seen, the joint has changed once. A straight wander leaves a half
/// when it is cut in two, so what goes on all the time is never called a change. Set beforehand. Joints that change,
/// own simulators (a sheath bent anew, a gap that steps, a jump; 13 logs, 28 November 2026), come to 0.15 to 0.44 at
/// the first look, joints that do not to 0.94 and more, the measured angles of the scoreboard to 0.71 and more.
inline constexpr double kTwoLawsLeave = 0.5;
/// That first look moves shapes along a straight line only; where two laws leave more than this share there, their
/// shapes are not searched.
inline constexpr double kWorthTwoLaws = 0.7;
/// Slices of a log that fit two laws or judge them, and how many at each end are no part by themselves.
inline constexpr Eigen::Index kLogSlices = 64;
inline constexpr std::size_t kSlicesOfAPart = 8;
/// A law of more numbers is not fitted to a part: the slices that choose are those that it is fitted to, and one that
/// was grown (43 to 52 numbers on the scoreboard's machines) would fit any of them. Tendons with a delay have 11.
inline constexpr Eigen::Index kMostNumbersOfAPart = 16;
/// Rows of the coarse grid in a slice, or the log is too short to be asked.
inline constexpr Eigen::Index kRowsOfASlice = 4;
/// A weight that moves the joint needs a torque of the motor; where the log's torque holds less than this share of that
/// for certain, `gravity` comes with a warning. Half way between all and none; set beforehand (28 November 2026).
inline constexpr double kWeightInTorque = 0.5;
/// The law of two tendons becomes the base where the usual law leaves more than so many floors on unseen rows, and it
/// no more than kAboveFloor. Set before a drawn plant was looked at (November 2026).
inline constexpr double kMuchIsMissing = 1.5;
/// Or where the effects found are what tendons look like to whoever does not ask the torque, and it leaves no more,
/// rms, than so much of what the law with them does: `worth_a_name`, which is in the mean square.
inline constexpr double kAsGoodABase = 1.025;
/// And beside that this share of the loop's half width at the joint: by so much a law of tendons errs itself, noise
/// aside 1.9 % on drawn joints 704, 705 and 741, whose loop is 52 noises of its camera (23 November 2026).
inline constexpr double kTendonForm = 0.03;
/// Or where it leaves this share, rms, of what the usual law with the effects found does: with eight shapes it has to
/// be clearly better.
inline constexpr double kWorthABase = 0.8;
/// A share of the tendons' ends that touches nothing has to leave this share, rms of means over the rows to settle on,
/// of what is left without, for it can be exchanged for the motor's friction: on the simulated forceps it leaves 0.98
/// and the friction comes out as 4.2 mNm of 3 (2.8 without), on joints 24 and 28 of the third plant 0.55 and 0.94, on
/// 25 0.97 (26 November 2026).
inline constexpr double kWorthFreeEnds = 0.95;
/// Numbers fitted with as many places along the tendons as the board has must leave this share, rms of the same means,
/// of what those fitted with 32 leave there, to take their place: these say what the tendons are made of. Where
/// friction sits at a few points, as on the third plant, 32 places find twice the friction number.
inline constexpr double kWorthOwnPlaces = 0.95;
/// Change of a loop's width or torque, as a share, that counts as one. Healthy joints drawn by chance come out within
/// 1 % (seeds 400 to 405, November 2026).
inline constexpr double kLoopTold = 0.03;
/// What a loop's width may be off by, two spreads, beside its fit's interval, how late the joint is fitted beside it:
/// with gaps 0.15 % at most on drawn joints 700 to 705, and up to 1.9 on independent joints 6200 to 6206 and 8600 to
/// 8606 (November 2026), always too wide: a load that turns over within the gap leaves tension in tendons whose
/// friction sits at guides.
inline constexpr double kLoopBias = 0.02;
/// How well a law with tendons knows the motor's own friction, as a share of all friction, two spreads: off by 2.6,
/// 0.5, -3.7, -0.1, 0.4 and -0.6 % on drawn joints 700 to 705 (November 2026).
inline constexpr double kMotorFrictionKnown = 0.04;
/// By how much more of the loop's half width, rms, another pretension has to leave (PretensionTrial) to be told from
/// the friction numbers: what a law of tendons errs itself was 1.9 % (kTendonForm). Where the tip is held and no tendon
/// goes slack it is 0.4 to 1.4 % (six joints), where each does 12 to 25 %; on joints 9240 to 9255, whose motors can not
/// pull further than 0.25 Nm, 1.3 to 25 % (28 November 2026).
inline constexpr double kPretensionShows = 0.02;
/// How well a log with the tip held, beside a free one, tells eta and pretension, as shares, two spreads: eta was off
/// by 0.1 to 2.6 %, the pretension by 0.0 to 1.3 % on drawn joints 9001 to 9012 with 3 to 30 N (23 November 2026).
inline constexpr double kTendonEtaKnown = 0.025;
/// Friction numbers from here on come out small, as the board's few places take them: by 0.7 to 6.2 % on twelve joints
/// of 9240 to 9287; of smaller ones the worst was 1.1 % (28 November 2026).
inline constexpr double kLargeEta = 0.8;
inline constexpr double kLargeEtaKnown = 0.06;
inline constexpr double kTendonPretensionKnown = 0.015;
/// How well a free tip alone tells their product: the motor's friction beside it is off by up to so much of itself
/// (joints 701 to 705), the rest by so much of the product. 9001 to 9012: all held, 6 to 24 % off.
inline constexpr double kMotorFrictionOfFreeTip = 0.3;
inline constexpr double kProductOfFreeTip = 0.1;
/// By how much, as a share of the change, a loop's width may change otherwise than the torque says when the pretension
/// alone does: 12 % at most on 9001 to 9010 with 0.5 to 1.8 times the pretension (23 November 2026).
inline constexpr double kWidthWithTorque = 0.2;
/// How well the torque of a loop comes again, as a share, two spreads.
inline constexpr double kTorqueAgain = 0.005;
/// How much wider than in its own log a force law's error bar is: other loops are not quite like those that it was
/// fitted to. Without it, bars of drawn joints 9001 to 9005 held 84 to 98 % in another motion (23 November 2026).
inline constexpr double kOtherLoops = 1.2;
/// How well a mass is known that swings on its tendons, as a share, two spreads: 2.5, 1.0, 1.3, 0.1, 3.4 and -1.0 % off
/// on drawn joints 700 to 705, -0.9, 0.8, 3.9, 3.2, 6.9, -8.5 and 8.8 % on independent joints 6200 to 6206 (November
/// 2026).
inline constexpr double kMassKnown = 0.15;
/// What a healthy joint is late by comes again in another motion within this share of itself, two spreads: 7 % off at
/// most on five joints of a third plant, whose drag makes them late by 0.5 to 1.3 ms (November 2026).
inline constexpr double kLatenessKnown = 0.1;
/// Tendons whose joint is late take the place of those without where they leave this share, rms, of what those do, and
/// its loop too.
inline constexpr double kWorthLateness = 0.99;
/// What turns the joint by stretching its tendons, drag or a detent, shows at least this share of its torque in the
/// motor's; a late clock and an angle that errs show none (joints of a third plant, 95 % and none, November 2026).
inline constexpr double kTorqueOfStretch = 0.5;
/// Tendons that take less of the torque than this share are no gauge of their pretension.
inline constexpr double kLeastOfFriction = 0.1;
/// Width and torque of a loop change together, as pretension changes them, where the logarithm of the one is at least
/// this share of the other's: some of the torque is not the tendons'.
inline constexpr double kLeastTogether = 0.5;
/// Change of the motor's torque, rms over the healthy joint's friction, that counts as one: 0.6 % without a change, 0.7
/// to 1.4 % by what shows in the joint's angle alone, 1.7 % and more by what acts at the joint (independent joints 6200
/// to 6206, drawn joints 760 and 761). This and the next three on seeds 700 to 705, November 2026.
inline constexpr double kTorqueTold = 0.015;
/// Share of that change's energy that a weight, a mass or drag takes away alone: 66 % and more where it is the cause, a
/// mass, by the joint's own acceleration, 84 %; 18 % and less where none is.
inline constexpr double kTorqueCauseShare = 0.45;
/// A mass that swings on its tendons makes the joint's acceleration large and the motor's not. Told by the latter it is
/// this many times as large, or as small, at most: 0.8 to 2.6 times (coulomb joints 24 to 28, independent joints 6200
/// to 6204, November 2026).
inline constexpr double kMassAsLarge = 4.0;
/// And one pitch takes this share of the change's energy at most: a tremor 0.8 and more, such a mass 0.11 at most
/// (coulomb joints 24 and 25).
inline constexpr double kOneTone = 0.4;
/// The same of friction that bends before it slides: 82 % and more where it is the cause, less where tendons go slack.
inline constexpr double kBendsShare = 0.6;
/// And of what friction that is the same everywhere leaves it leaves this share at most: 5 to 18 % where it is the
/// cause (7 to 23 % being left), next to all of it with wear, a sticky spot, cogging, a tremor, bent sheaths, fading
/// magnets and drag. Joints 701 to 705 with 0.01 Nm, the others on 702 (23 November 2026). Until then it had to take
/// away 15 % more of the change, and a bend that is short beside the stroke takes 7 (joint 703).
inline constexpr double kBendsLeaves = 0.4;
/// And this much of the change more: another pretension is all but friction alone, and its rest looks like anything.
inline constexpr double kBendsBeyond = 0.03;
/// A spring at the joint leaves this share of what a weight leaves, or less, where it is one, and the other way round:
/// 0.29 of a spring of 0.15 Nm/rad, 0.19, 0.48 and 0.54 the other way; 0.95 to 1 where a tendon goes slack or the tip
/// touches now and then (joints of a plant by itself that move by 0.5 to 0.9 rad, 29 November 2026).
inline constexpr double kLoadTold = 0.7;
/// And a weight whose interval reaches this share of itself to either side is none: 0.57 where the tip touched now and
/// then.
inline constexpr double kWeightUnsure = 0.5;
/// A weight is taken to lean where the joint is at 0 if that leaves this share, or less, of the squares left otherwise.
/// With 0.9 the upright weight of hal/sim's joint 765 was given a lean (24 November 2026).
inline constexpr double kLeanLeaves = 0.5;
/// How well a leaning weight is known, as a share, two spreads: 9.5, -17.7 and 3.9 % off on independent joints 1 to 3
/// (24 November 2026). Its lean is told by where tendons go slack.
inline constexpr double kLeaningKnown = 0.2;
/// By how much more than such friction a weight, a mass or drag takes away, or else it leaves kBendsLeaves of what that
/// leaves: strokes of one speed make drag all but friction.
inline constexpr double kBeyondFriction = 0.15;
/// Share of that change's energy that friction takes away where another pretension is what came: 99 % and more; bends,
/// wear and growth of a tendon leave 61 to 82 % to it, for theirs is not the same everywhere (independent joints 6200
/// to 6206, November 2026).
inline constexpr double kPretensionShare = 0.9;
/// Change of the friction in the torque, over the healthy joint's, by an angle error of the motor's pulley: 2.4 % at
/// most; a bend of the sheaths that passes for one made 5.4 (the same joints).
inline constexpr double kAngleErrorTorque = 0.035;

}  // namespace capstan::tools
