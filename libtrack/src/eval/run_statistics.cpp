#include "apriltrack/eval/run_statistics.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>

#include "apriltrack/base/check.h"
#include "apriltrack/eval/statistics.h"

namespace apriltrack {
namespace {

/// Claims of several poses, for medians.
struct Claims {
  std::vector<double> position_m;
  std::vector<double> rotation_rad;

  void add(const FrameLogRow& row) {
    if (!row.pose || !row.covariance) return;
    position_m.push_back(std::sqrt(row.covariance->topLeftCorner<3, 3>().trace()));
    rotation_rad.push_back(std::sqrt(row.covariance->bottomRightCorner<3, 3>().trace()));
  }
  std::optional<ClaimedSigma> sigma() const {
    if (position_m.empty()) return std::nullopt;
    return ClaimedSigma{median(position_m), std::ranges::max(position_m), median(rotation_rad),
                        std::ranges::max(rotation_rad)};
  }
};

using Reasons = std::map<std::string, std::size_t>;

std::string most_frequent(const Reasons& reasons) {
  if (reasons.empty()) return "";
  return std::ranges::max_element(reasons, {}, [](const auto& entry) { return entry.second; })->first;
}

void count_in(BlindStretch& stretch, Reasons& reasons, const FrameLogRow& row, const std::string& reason) {
  if (row.status == "predicted") {
    ++stretch.predicted;
  } else if (row.status == "unreadable") {
    ++stretch.unreadable;
  } else {
    ++stretch.lost;
    ++reasons[reason];
  }
}

/// The stretch that begins with row `first`; `next` becomes the row behind it.
BlindStretch stretch_from(std::span<const FrameLogRow> rows, std::span<const std::string> lost_reasons,
                          std::size_t first, std::size_t& next) {
  const auto time_s = [&](std::size_t i) {
    return seconds_between(rows.front().timestamp, rows[i].timestamp);
  };
  BlindStretch stretch;
  Reasons reasons;
  for (next = first; next < rows.size() && !claims_evidence(rows[next]); ++next)
    count_in(stretch, reasons, rows[next], lost_reasons[next]);
  stretch.first_frame = rows[first].timestamp;
  stretch.from_s = time_s(first == 0 ? 0 : first - 1);
  stretch.to_s = time_s(std::min(next, rows.size() - 1));
  stretch.reason = most_frequent(reasons);
  return stretch;
}

std::vector<BlindStretch> blind_stretches(std::span<const FrameLogRow> rows,
                                          std::span<const std::string> lost_reasons) {
  std::vector<BlindStretch> stretches;
  for (std::size_t i = 0; i < rows.size();) {
    if (claims_evidence(rows[i])) {
      ++i;
    } else {
      stretches.push_back(stretch_from(rows, lost_reasons, i, i));
    }
  }
  std::ranges::stable_sort(stretches, std::greater(), &BlindStretch::duration_s);
  return stretches;
}

void count_statuses(std::span<const FrameLogRow> rows, RunStatistics& figures) {
  std::array<Claims, kFrameStatuses.size()> claims;
  Claims all;
  for (std::size_t i = 0; i < kFrameStatuses.size(); ++i) figures.statuses[i].status = kFrameStatuses[i];
  for (const FrameLogRow& row : rows) {
    const std::size_t status = index_of_status(row.status);
    ++figures.statuses[status].frames;
    figures.with_evidence += claims_evidence(row);
    figures.from_one_tag += claims_evidence(row) && row.tags_tracked == 1;
    figures.with_second_pose += row.second_mode_odds > 0.0;
    claims[status].add(row);
    all.add(row);
  }
  for (std::size_t i = 0; i < kFrameStatuses.size(); ++i) figures.statuses[i].sigma = claims[i].sigma();
  figures.sigma = all.sigma();
}

}  // namespace

std::size_t index_of_status(std::string_view status) {
  const auto found = std::ranges::find(kFrameStatuses, status);
  APRILTRACK_CHECK(found != kFrameStatuses.end(), "a row's status is one of the five");
  return static_cast<std::size_t>(std::distance(kFrameStatuses.begin(), found));
}

RunStatistics run_statistics(std::span<const FrameLogRow> rows, std::span<const std::string> lost_reasons) {
  APRILTRACK_CHECK(!rows.empty(), "a run has frames");
  APRILTRACK_CHECK(lost_reasons.size() == rows.size(), "there is a reason, or none, for each row");
  RunStatistics figures;
  figures.frames = rows.size();
  figures.duration_s = seconds_between(rows.front().timestamp, rows.back().timestamp);
  count_statuses(rows, figures);
  figures.blind = blind_stretches(rows, lost_reasons);
  const auto first_pose =
      std::ranges::find_if(rows, [](const FrameLogRow& row) { return row.pose.has_value(); });
  if (first_pose != rows.end())
    figures.first_pose_s = seconds_between(rows.front().timestamp, first_pose->timestamp);
  std::vector<double> latencies_ms;
  const FrameLogRow* slowest = nullptr;
  for (const FrameLogRow& row : rows) {
    if (!row.latency_ms) continue;
    latencies_ms.push_back(*row.latency_ms);
    if (slowest == nullptr || *row.latency_ms > *slowest->latency_ms) slowest = &row;
  }
  if (!latencies_ms.empty()) {
    figures.latency_p50_ms = percentile(latencies_ms, 0.50);
    figures.latency_p99_ms = percentile(latencies_ms, 0.99);
  }
  if (slowest != nullptr) {
    figures.latency_max_ms = slowest->latency_ms;
    figures.latency_max_at_s = seconds_between(rows.front().timestamp, slowest->timestamp);
  }
  return figures;
}

}  // namespace apriltrack
