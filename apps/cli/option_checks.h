#pragma once

#include <CLI/CLI.hpp>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

namespace apriltrack::app {

// Checks of an option's text, for CLI::Option::check: key, value and range are told in the words of the
// command line. A number that CLI11 alone would wrap round (-1 as an unsigned one) does not pass.

/// high: none = no limit worth a word.
CLI::Validator whole_number(long long low, std::optional<long long> high = std::nullopt);
/// NaN does not pass.
CLI::Validator number_between(double low, double high);
CLI::Validator number_at_least(double low);
CLI::Validator not_empty(const std::string& what);
/// Not the name of an option. command: outlives this.
CLI::Validator no_option_of(const CLI::App& command);

CLI::Validator seed();        ///< Of random numbers: 64 bits, unsigned.
CLI::Validator threads();     ///< 0 (one per core) to 256.
CLI::Validator rate();        ///< Of images without times, in frames a second.
CLI::Validator decimation();  ///< What the detector can reduce an image by.
CLI::Validator decision_margin();
CLI::Validator corrected_bits();
CLI::Validator known_family();

/// Adds --bits: how many of 16 bits count in image files.
void add_bits_option(CLI::App& command, std::optional<int>& bits);

/// Throws Error(kInvalidInput) when one of them is given twice.
void check_families(const std::vector<std::string>& families);

/// Throws Error(kInvalidInput) when an option was given that says how images are looked at, where corners are
/// read from a file.
void refuse_beside_detections(const CLI::App& command, std::initializer_list<const char*> options);

}  // namespace apriltrack::app
