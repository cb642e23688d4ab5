#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace apriltrack::app {

// Each adds one subcommand with its options and its callback; callbacks throw apriltrack::Error, and main
// turns that into the exit status (docs/file_formats.md). One file per command.

void add_simulate_command(CLI::App& app);
void add_doctor_command(CLI::App& app);
void add_detect_command(CLI::App& app);
void add_calibrate_command(CLI::App& app);
void add_track_command(CLI::App& app);
void add_evaluate_command(CLI::App& app);
void add_map_command(CLI::App& app);
void add_camera_command(CLI::App& app);
void add_trajectory_command(CLI::App& app);
void add_demo_command(CLI::App& app);
void add_help_command(CLI::App& app);
void add_completion_command(CLI::App& app);

void add_all_commands(CLI::App& app);

/// Runs one command as if it had been typed: {"track", "room", "--output", "out.tum"}. Throws what it throws.
void run_command(std::vector<std::string> words);

}  // namespace apriltrack::app
