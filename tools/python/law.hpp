// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "capstan/tools/jobs/identify_job.hpp"
#include "capstan/tools/replay/replay.hpp"
#include "capstan/tools/select/effort_law.hpp"

namespace capstan::python {

/// One number of a law, as in the JSON of a diagnosis.
struct Parameter {
  std::string name;
  double value = 0.0;
  std::string unit;
  std::optional<tools::Interval> ci95;
};

struct Inputs {
  Eigen::VectorXd q1;
  std::optional<Eigen::VectorXd> tau, temperature;
  std::vector<std::pair<Eigen::VectorXd, Eigen::VectorXd>> others;  ///< q1 and tau of the axes that may pull, by slots
  double rate_hz = 1000.0;
};

/// A law with the text of its file.
class Law {
 public:
  /// Throws BadInput.
  static auto read(const std::string& path) -> Law;
  static auto from(const tools::Identified& identified) -> Law;
  static auto from(const tools::IdentifiedForce& identified, const std::string& model) -> Law;

  [[nodiscard]] auto text() const -> const std::string& { return text_; }
  /// "angle" (of the joint), "effort" (of the motor, or torque behind a gear) or "force" (joint torque).
  [[nodiscard]] auto kind() const -> std::string;
  [[nodiscard]] auto status() const -> std::string;
  [[nodiscard]] auto terms() const -> std::vector<std::string>;
  [[nodiscard]] auto parameters() const -> std::vector<Parameter>;
  [[nodiscard]] auto fit() const -> std::optional<tools::FitSummary>;
  /// How things were chosen in the fit, and what to look at.
  [[nodiscard]] auto notes() const -> const std::vector<std::string>& { return notes_; }

  /// Laws of joint angles. Throws BadInput for inputs that do not fit together, Refusal as tools::replay() does and
  /// where a number met the end of its range.
  [[nodiscard]] auto run(const Inputs& inputs, tools::Arithmetic arithmetic) const -> tools::Replayed;
  /// The log with the law's estimates as further columns: `capstan replay`.
  [[nodiscard]] auto replay(const tools::CsvLog& log, int axis, tools::Arithmetic arithmetic,
                            const tools::Say& warn) const -> tools::CsvLog;

  /// A law of a joint's torque is put beside the law of the joint's angle, if the file has one.
  void save(const std::filesystem::path& path) const;

 private:
  struct Force {
    std::string model;
    tools::ForceFit fit;  ///< of a file: as far as it is written there
  };
  std::variant<tools::JointFile, tools::EffortLaw, Force> law_;
  std::string text_, name_;
  std::vector<std::string> notes_;

  [[nodiscard]] auto joint() const -> const tools::JointFile&;
};

}  // namespace capstan::python
