// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "capstan/tools/identify/force_fit.hpp"

namespace capstan::tools {

/// A force law as the [force] section of a joint file.
auto force_section(const PullPushFit& fit) -> std::string;
auto force_section(const PreisachFit& fit) -> std::string;

/// Whether that model is one of two tendons: "pull_push" or "blend", which read_pull_push() reads.
auto is_of_tendons(const std::string& model) -> bool;

/// "pull_push", "blend", "preisach", or nothing where a joint file has no [force] section. Throws BadInput if it is no
/// TOML.
auto force_model(const std::string& joint_file, const std::string& name) -> std::string;

/// The file has a [force] section and no [terms]: nothing for the joint's angle.
auto is_force_alone(const std::string& joint_file, const std::string& name) -> bool;

/// What a [force] section says of its numbers and their fit; of a reversal table, its ends. Throws BadInput as the
/// functions below.
auto read_force_fit(const std::string& joint_file, const std::string& name) -> ForceFit;

/// The pull-push law, or its blend with the pull law, of a joint file's [force] section, as far as it is written there.
/// Throws BadInput: one sentence with file and cure where there is none or a number is missing.
auto read_pull_push(const std::string& joint_file, const std::string& name) -> PullPushFit;

/// The reversal table of a joint file's [force] section. Throws BadInput: one sentence with file and cure for a table
/// that is not whole or not monotone. @pre force_model() is "preisach"
auto read_preisach(const std::string& joint_file, const std::string& name) -> PreisachTable;

/// How far off that law may be; nothing where the file does not say. Throws BadInput: one sentence with file and cure.
auto read_force_error(const std::string& joint_file, const std::string& name) -> std::optional<ForceErrorNumbers>;

/// The text of a joint file with its [force] section replaced by another, or put behind everything else. An empty text
/// becomes a file of that section alone.
auto with_force_section(const std::string& joint_file, const std::string& section) -> std::string;

}  // namespace capstan::tools
