#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apriltrack/eval/trajectory.h"

namespace apriltrack {

/// A line that is neither blank nor a comment.
struct ContentLine {
  std::string_view text;   ///< Without a comment at its end.
  std::size_t number = 0;  ///< From 1.
};

/// `#` begins a comment, wherever it stands. contents: must outlive the lines.
std::vector<ContentLine> content_lines(std::string_view contents);

std::vector<std::string_view> split_blanks(std::string_view text);
/// Fields between commas, without blanks around them.
std::vector<std::string_view> split_commas(std::string_view text);

/// "1.4036365797e+09" as "1403636579.7": the point is moved in the text, so that no digit is lost. What is
/// no number, or has no exponent, or none that can be meant, stays as it is.
std::string without_exponent(std::string_view number);

/// Throws Error(kInvalidInput) that names the column unless the field is a finite number.
double parse_finite(std::string_view field, std::string_view column, const std::string& where);

/// A pose and the line that it stands in.
struct PoseLine {
  TimedPose pose;
  std::size_t number = 0;
};

/// Throws Error(kInvalidInput) with both lines where two have one time. name: of the file.
Trajectory sorted_by_time(std::vector<PoseLine> lines, const std::string& name);

/// Requires poses that are finite and sorted by time, each time once.
void check_trajectory(const Trajectory& trajectory);

}  // namespace apriltrack
