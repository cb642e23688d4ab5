#include "log_lines.h"

#include <algorithm>
#include <sstream>

#include "program.h"

namespace apriltrack::test {

std::vector<LogLine> read_log(const std::filesystem::path& path) {
  std::istringstream lines(read_text(path));
  std::vector<std::string> names;
  std::vector<LogLine> log;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream cells(line);
    std::vector<std::string> values;
    for (std::string cell; std::getline(cells, cell, ',');) values.push_back(cell);
    if (names.empty()) {
      names = values;
      continue;
    }
    values.resize(names.size());
    log.emplace_back();
    for (std::size_t i = 0; i < names.size(); ++i) log.back()[names[i]] = values[i];
  }
  return log;
}

std::vector<double> column(const std::vector<LogLine>& log, const std::string& name,
                           const std::string& status) {
  std::vector<double> values;
  for (const LogLine& line : log)
    if (!line.at(name).empty() && (status.empty() || line.at("status") == status))
      values.push_back(std::stod(line.at(name)));
  return values;
}

double quantile(std::vector<double> values, double fraction) {
  std::ranges::sort(values);
  const double rank = fraction * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(rank);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (rank - static_cast<double>(below)) * (values[above] - values[below]);
}

double time_s_of(const LogLine& line) {
  return 1e-9 * static_cast<double>(std::stoll(line.at("timestamp_ns")));
}

const LogLine& slowest(const std::vector<LogLine>& log) {
  const auto latency_ms = [](const LogLine& line) {
    return line.at("latency_ms").empty() ? -1.0 : std::stod(line.at("latency_ms"));
  };
  return *std::ranges::max_element(log, {}, latency_ms);
}

double longest_gap_s(const std::vector<LogLine>& log) {
  const auto time_s = [&](std::size_t i) {
    return 1e-9 *
           static_cast<double>(std::stoll(log[i].at("timestamp_ns")) - std::stoll(log[0].at("timestamp_ns")));
  };
  double longest = 0.0, since = 0.0;
  bool is_blind = false;
  for (std::size_t i = 0; i < log.size(); ++i) {
    const std::string& status = log[i].at("status");
    const bool has_evidence = status == "detected" || status == "tracked";
    if ((has_evidence && is_blind) || (!has_evidence && i + 1 == log.size()))
      longest = std::max(longest, time_s(i) - since);
    if (has_evidence) since = time_s(i);
    is_blind = !has_evidence;
  }
  return longest;
}

}  // namespace apriltrack::test
