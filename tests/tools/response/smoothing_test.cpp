// SPDX-License-Identifier: Apache-2.0
// Noisy lines of a response that is known in closed form.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>

#include "capstan/tools/response/loop.hpp"

namespace capstan::tools {
namespace {

constexpr double kPi = std::numbers::pi;

/// What is drawn about a known response: an inertia behind a delay, an amplifier of 300 Hz and a torque that is held
/// for a cycle, with a smooth bump of 10 % at 150 Hz that no model of motor and joint has.
struct DrawnLines {
  static constexpr double kInertia = 1.5e-5, kDrag = 1e-4, kLateS = 6e-4, kLagS = 5.3e-4;
  double noise_per_nm = 0.0;  ///< rms of a line, rad/Nm: the same at all, so the higher the more it hides

  [[nodiscard]] static auto bump(double hz) -> double {
    return 1.0 + 0.1 * std::exp(-0.5 * std::pow(std::log2(hz / 150.0) / 0.7, 2));
  }
  [[nodiscard]] static auto truth(double hz) -> Complex {
    const double w = 2.0 * kPi * hz;
    const double held = std::sin(0.5e-3 * w) / (0.5e-3 * w);
    return bump(hz) * std::polar(held, -w * kLateS) / Complex(1.0, w * kLagS) / Complex(-kInertia * w * w, kDrag * w);
  }
  [[nodiscard]] auto drawn(unsigned seed) const -> Response {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0.0, noise_per_nm / std::sqrt(2.0));
    Response response{.name = "drawn", .points = {}, .distortion = {}};
    for (double hz = 3.0; hz < 250.0; hz *= 1.08) {
      const double radius = std::sqrt(3.0) * noise_per_nm;  // of 95 %, of many windows
      const Complex value = truth(hz) + Complex(normal(random), normal(random));
      response.points.push_back({hz, {value, radius}, {1.0, 0.0}, {0.1 * value, 0.1 * radius}, 1.0});
    }
    return response;
  }
};

// Lines of 150 to 200 Hz have 23 to 42 % of noise each.
TEST(Smoothing, WhereNoiseHidesLinesTheResponseIsStillTheTruthAndNotALargerOne) {
  const DrawnLines lines{.noise_per_nm = 0.012};
  constexpr int kDraws = 24;
  struct Sums {
    double hz, bias_db = 0.0, square = 0.0;
    int held = 0;
  };
  std::array<Sums, 4> all = {Sums{20.0}, Sums{60.0}, Sums{120.0}, Sums{175.0}};
  for (unsigned seed = 1; seed <= kDraws; ++seed) {
    const Response response = lines.drawn(seed);
    const MotorModel model = fit_motor_and_joint(response);
    const Smoothing smoothing(points_above_noise(response, model), model);
    for (Sums& sums : all) {
      const Estimate seen = smoothing.at(sums.hz);
      const Complex truth = DrawnLines::truth(sums.hz);
      sums.bias_db += 20.0 * std::log10(std::abs(seen.value / truth)) / kDraws;
      sums.square += std::norm(seen.value / truth - 1.0) / kDraws;
      sums.held += std::abs(seen.value - truth) < seen.radius95 ? 1 : 0;
    }
  }
  for (const Sums& sums : all) {
    const double of_a_line = lines.noise_per_nm / std::abs(DrawnLines::truth(sums.hz));
    std::printf("%.0f Hz: %.2f dB, rms %.3f where a line has %.3f, %d of %d in the circle\n", sums.hz, sums.bias_db,
                std::sqrt(sums.square), of_a_line, sums.held, kDraws);
    EXPECT_NEAR(sums.bias_db, 0.0, 0.4) << sums.hz;
    EXPECT_LT(std::sqrt(sums.square), 0.5 * of_a_line) << sums.hz << ": neighbours and model help";
    EXPECT_GE(sums.held, kDraws * 8 / 10) << sums.hz;
  }
}

TEST(Smoothing, WithoutNoiseLinesAreKeptWhateverTheModelExpects) {
  const DrawnLines lines{.noise_per_nm = 1e-6};
  const Response response = lines.drawn(1);
  MotorModel wrong = fit_motor_and_joint(response);
  wrong.inertia_kgm2 *= 1.5;
  const Smoothing smoothing(response.points, wrong);
  for (const ResponsePoint& point : response.points) {
    EXPECT_LT(std::abs(smoothing.at(point.hz).value / DrawnLines::truth(point.hz) - 1.0), 0.01) << point.hz;
  }
}

TEST(Smoothing, TheModelOfNoisyLinesHasTheTrueInertia) {
  const DrawnLines lines{.noise_per_nm = 0.012};
  double inertia = 0.0;
  constexpr int kDraws = 16;
  for (unsigned seed = 101; seed <= 100 + kDraws; ++seed) {
    Response response = lines.drawn(seed);
    for (ResponsePoint& point : response.points) {  // without the bump
      const Complex truth = DrawnLines::truth(point.hz);
      point.motor.value += truth / DrawnLines::bump(point.hz) - truth;
    }
    inertia += fit_motor_and_joint(response).inertia_kgm2 / kDraws;
  }
  EXPECT_NEAR(inertia, DrawnLines::kInertia, 0.02 * DrawnLines::kInertia);
}

}  // namespace
}  // namespace capstan::tools
