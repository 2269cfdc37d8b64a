// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/capstan/identify_wrist.hpp"

#include <filesystem>
#include <iostream>

#include "capstan/tools/identify/wrist_fit.hpp"
#include "capstan/tools/jobs/identify_job.hpp"
#include "capstan/tools/support/errors.hpp"
#include "capstan/tools/support/first_repeat.hpp"
#include "capstan/tools/support/text.hpp"

namespace capstan::tools {
namespace {

auto file_of_axis(const std::string& output, int axis) -> std::string {
  const std::filesystem::path path(output);
  return (path.parent_path() / (path.stem().string() + "_axis" + std::to_string(axis) + path.extension().string()))
      .string();
}

}  // namespace

auto identify_wrist(const LogOptions& options, const std::vector<int>& axes, const std::string& output) -> int {
  if (first_repeat(axes) != axes.end()) {
    throw BadInput("--wrist-axes names an axis twice; give pitch, right and left jaw, for instance 0 1 2");
  }
  const JobLogs job = options.job_logs();
  AxisRequest request;
  request.needs_torque = true;
  std::array<std::vector<AxisLog>, kWristAxes> logs;
  for (std::size_t i = 0; i < kWristAxes; ++i) {
    request.axis = axes[i];
    request.other_axes = i == 0 ? std::vector<int>{} : std::vector<int>{axes[0]};
    logs[i] = read_axes(job.files, request, warn);
  }
  const WristFit fit = fit_wrist(logs);
  constexpr std::array kNames = {"pitch", "right jaw", "left jaw"};
  for (std::size_t i = 0; i < kWristAxes; ++i) {
    std::cout << kNames[i] << ", axis " << axes[i] << "\n" << law_table(fit.joints[i], {});
    if (i > 0) {
      std::cout << "  follows the pitch by " << rounded(fit.follow[i]) << " ["
                << rounded(fit.follow[i] - fit.follow_half[i]) << ", " << rounded(fit.follow[i] + fit.follow_half[i])
                << "], its stretch included\n";
    }
    std::cout << "  error (RMSE) " << error_text(fit.joints[i].fit->rmse, "rad") << ", fitted for itself "
              << error_text(fit.untied_rmse_rad[i], "rad") << "\n";
  }
  if (!fit.undetermined.empty()) {
    throw Refusal(undetermined_sentence(fit.undetermined) + (output.empty() ? "" : " (nothing was written)"));
  }
  for (std::size_t i = 0; i < kWristAxes && !output.empty(); ++i) {
    const std::string file = file_of_axis(output, axes[i]);
    write_text_file(file, joint_file_text(fit.joints[i]));
    std::cerr << "wrote " << file << "\n";
  }
  return kExitDone;
}

}  // namespace capstan::tools
