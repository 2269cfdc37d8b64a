// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

namespace capstan::tools {

/// Each adds one subcommand, whose callback sets the exit status (tools/support/errors.hpp) or throws BadInput or
/// Refusal.
void add_run(CLI::App& app, int& exit_status);
void add_faults(CLI::App& app, int& exit_status);
void add_commission(CLI::App& app, int& exit_status);
void add_apply(CLI::App& app, int& exit_status);
void add_shell(CLI::App& app, int& exit_status);
void add_identify(CLI::App& app, int& exit_status);
void add_palpate(CLI::App& app, int& exit_status);
void add_record(CLI::App& app, int& exit_status);
void add_replay(CLI::App& app, int& exit_status);
void add_diagnose(CLI::App& app, int& exit_status);
void add_compare(CLI::App& app, int& exit_status);
void add_dbc(CLI::App& app, int& exit_status);
void add_mjcf(CLI::App& app, int& exit_status);
void add_flash(CLI::App& app, int& exit_status);
void add_response(CLI::App& app, int& exit_status);
void add_tune(CLI::App& app, int& exit_status);
void add_console(CLI::App& app, int& exit_status);
void add_routing(CLI::App& app, int& exit_status);
void add_tip(CLI::App& app, int& exit_status);
void add_thesis(CLI::App& app, int& exit_status);

}  // namespace capstan::tools
