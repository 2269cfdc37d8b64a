// SPDX-License-Identifier: Apache-2.0
#include "capstan/tools/identify/mean_sample.hpp"

#include <algorithm>

namespace capstan::tools {

auto mean_sample(std::span<const Sample<double>> samples) -> Sample<double> {
  using S = Sample<double>;
  Sample<double> mean = samples.back();
  const auto sum = [samples](const auto& of) {
    double all = 0.0;
    for (const auto& sample : samples) {
      all += of(sample);
    }
    return all;
  };
  const auto count = static_cast<double>(samples.size());
  for (const auto member :
       {&S::q1, &S::h, &S::dq1, &S::dh, &S::ddq1, &S::tau, &S::tau_late, &S::course_late, &S::warmth}) {
    mean.*member = sum([member](const S& sample) { return sample.*member; }) / count;
  }
  for (const auto member : {&S::advance, &S::advance_late}) {
    mean.*member = sum([member](const S& sample) { return sample.*member; });
  }
  for (std::size_t other = 0; other < kMostOthers; ++other) {
    mean.others[other].q1 = sum([other](const S& sample) { return sample.others[other].q1; }) / count;
    mean.others[other].tau = sum([other](const S& sample) { return sample.others[other].tau; }) / count;
  }
  const auto forward = std::count_if(samples.begin(), samples.end(), [](const S& sample) { return sample.forward; });
  mean.forward = 2 * static_cast<std::size_t>(forward) >= samples.size();
  return mean;
}

}  // namespace capstan::tools
