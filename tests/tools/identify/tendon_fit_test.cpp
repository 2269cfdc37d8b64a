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
  explicit Motion(double noise_rad) : target(kRows) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal(0.0, noise_rad);
    const SamplePeriod<double> period(1e-3);
    TendonsOf<double, Places> tendons(period, {kEta, kEta, kPretensionNm, 0.5, 0.0, 0.0, 0.0, 0.0});
    for (Eigen::Index i = 0; i < kRows; ++i) {
      const double time = 1e-3 * static_cast<double>(i);
      auto& s = samples.emplace_back();
      s.q1 = s.h = 0.5 * std::sin(5.0 * time);
      s.dq1 = s.dh = 2.5 * std::cos(5.0 * time);
      s.forward = s.dq1 > 0.0;
      s.tau = s.tau_late = 0.06 * std::sin(5.0 * time + 0.8) + 0.03 * std::sin(17.0 * time);
      target[i] = kBeta * s.q1 + kCompliance * tendons.update(s)[0] + normal(random);
    }
  }
  [[nodiscard]] auto fitted() const -> LawForm {
    LawForm form;
    form.terms = {"motor_angle", "joint_offset", kTendonModel};
    return fit_tendon(LawDesign({samples}, {1e-3}), target, {{0, kRows}}, form);
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

}  // namespace
}  // namespace capstan::tools
