// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/tendon_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "capstan/model/terms/tendon.hpp"

namespace capstan::tools {
namespace {

constexpr double kEta = 1.2;
constexpr double kPretensionNm = 0.08;
constexpr double kBeta = 0.9;
constexpr double kCompliance = -2.0;
constexpr Eigen::Index kRows = 6000;

/// Loops within loops of a torque, and the angles of tendons seen at so many places under it.
template <std::size_t Places>
struct Motion {
  explicit Motion(double noise_rad, double torque_nm = 0.06, double eta = kEta) : target(kRows) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal(0.0, noise_rad);
    const SamplePeriod<double> period(1e-3);
    TendonsOf<double, Places> tendons(period, {eta, eta, kPretensionNm, 0.5, 0.0, 0.0, 0.0, 0.0});
    for (Eigen::Index i = 0; i < kRows; ++i) {
      const double time = 1e-3 * static_cast<double>(i);
      auto& s = samples.emplace_back();
      s.q1 = s.h = 0.5 * std::sin(5.0 * time);
      s.dq1 = s.dh = 2.5 * std::cos(5.0 * time);
      s.forward = s.dq1 > 0.0;
      s.tau = s.tau_late = torque_nm * (std::sin(5.0 * time + 0.8) + 0.5 * std::sin(17.0 * time));
      target[i] = kBeta * s.q1 + kCompliance * tendons.update(s)[0] + normal(random);
    }
  }
  [[nodiscard]] auto fitted() const -> LawForm {
    LawForm form;
    form.terms = {"motor_angle", "joint_offset", kTendonModel};
    return fit_tendon(LawDesign({samples}, {1e-3}), target, {{0, kRows}}, form);
  }
  [[nodiscard]] auto trial() const -> PretensionTrial {
    return try_pretensions(LawDesign({samples}, {1e-3}), target, {{0, kRows}}, fitted());
  }
  [[nodiscard]] auto left_by(const LawForm& law) const -> double {
    return fit_law(LawDesign({samples}, {1e-3}), target, {{0, kRows}}, law).rmse;
  }
  Samples samples;
  Eigen::VectorXd target;
};

auto eta_of(const LawForm& law) -> double {
  return law.shapes_of(law.catalogue->term(kTendonModel))[TendonShape::kEtaTop];
}

TEST(TendonFit, TakesNumbersOfTheBoardsOwnPlacesWhereFrictionSitsAtThem) {
  const Motion<8> motion(1e-5);
  const LawForm law = motion.fitted();
  EXPECT_LT(motion.left_by(law), 1.1e-5) << "of a stretch of 0.06 rad";
  EXPECT_NEAR(eta_of(law), kEta, 0.05 * kEta);
  EXPECT_EQ(law.catalogue, &term_catalogue()) << "as the board runs it";
}

TEST(TendonFit, KeepsWhatManyPlacesTellWhereTheBoardsOwnAreNoBetter) {
  const Motion<128> motion(2e-3);
  const LawForm law = motion.fitted();
  EXPECT_LT(motion.left_by(law), 1.05 * 2e-3);
  EXPECT_NEAR(eta_of(law), kEta, 0.1 * kEta);
  EXPECT_EQ(law.catalogue, &term_catalogue());
}

// A tendon goes slack where the torque passes the pretension, (2.13). Far below that it hardly matters how taut they
// are.
TEST(PretensionTrial, ShowsThePretensionWhereTendonsGoSlackAlone) {
  constexpr double kFriction = 0.3;
  const auto rise = [](double torque_nm) {
    const Motion<128> motion(1e-4, torque_nm, kFriction);
    return motion.trial().rise;
  };
  const double taut = rise(0.4 * kPretensionNm);
  EXPECT_LT(taut, 2e-4) << "of a stretch of 0.064 rad";
  EXPECT_GT(rise(1.5 * kPretensionNm), 8.0 * taut) << "of one less than four times as large";
}

TEST(PretensionTrial, LeavesNoNoiseOfTheCamera) {
  EXPECT_LT(Motion<128>(2e-3).trial().left, 0.5e-3);
}

}  // namespace
}  // namespace capstan::tools
