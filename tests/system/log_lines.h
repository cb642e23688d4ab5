#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace apriltrack::test {

/// By the names of columns.
using LogLine = std::map<std::string, std::string>;

/// A frame log or a log of tags, read without the library.
std::vector<LogLine> read_log(const std::filesystem::path& path);

/// The numbers that are there; of all frames or those of a status.
std::vector<double> column(const std::vector<LogLine>& log, const std::string& name,
                           const std::string& status = "");

/// Of the sorted values, the one at that fraction of the way, linearly between ranks.
double quantile(std::vector<double> values, double fraction);

double time_s_of(const LogLine& line);

/// By latency.
const LogLine& slowest(const std::vector<LogLine>& log);

/// Longest time between frames with evidence, or to the recording's ends, in which frames have none.
double longest_gap_s(const std::vector<LogLine>& log);

}  // namespace apriltrack::test
