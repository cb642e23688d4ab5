#include "time_matching.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <limits>

namespace apriltrack {
namespace {

constexpr std::uint64_t kMaxTimeDifference_ns = 1'000'000;

const TimedPose* nearest(const Trajectory& trajectory, Timestamp time) {
  const auto after = std::ranges::lower_bound(trajectory, time, {}, &TimedPose::timestamp);
  const TimedPose* best = nullptr;
  std::uint64_t best_ns = kMaxTimeDifference_ns;
  const auto offer = [&](const TimedPose& pose) {
    const std::uint64_t difference_ns = nanoseconds_apart(pose.timestamp, time);
    if (difference_ns >= best_ns) return;
    best = &pose;
    best_ns = difference_ns;
  };
  if (after != trajectory.begin()) offer(*std::prev(after));
  if (after != trajectory.end()) offer(*after);
  return best;
}

/// What would make the recordings meet, if they begin together on clocks that are apart; else empty.
std::string describe_offset(const Trajectory& truth, const Trajectory& estimate) {
  const auto span_ns = [](const Trajectory& t) {
    return nanoseconds_apart(t.front().timestamp, t.back().timestamp);
  };
  // Times so far apart that moving them would leave 64 bits are no recordings: a century fits in.
  constexpr std::uint64_t kMaxMove_ns = std::numeric_limits<std::int64_t>::max() / 2;
  if (nanoseconds_apart(truth.front().timestamp, estimate.front().timestamp) > kMaxMove_ns ||
      span_ns(truth) > kMaxMove_ns || span_ns(estimate) > kMaxMove_ns)
    return "";
  const std::int64_t offset_ns = estimate.front().timestamp.ns - truth.front().timestamp.ns;
  Trajectory moved = estimate;
  for (TimedPose& pose : moved) pose.timestamp.ns -= offset_ns;
  const std::ptrdiff_t num_matched = count_matches(match(truth, moved));
  if (num_matched < 2) return "";
  return fmt::format("; taking {} s off the estimate's times would join {} of its {} poses",
                     format_seconds({offset_ns}), num_matched, estimate.size());
}

}  // namespace

Matches match(const Trajectory& truth, const Trajectory& estimate) {
  Matches matches(truth.size());
  std::ranges::transform(truth, matches.begin(),
                         [&](const TimedPose& pose) { return nearest(estimate, pose.timestamp); });
  return matches;
}

std::ptrdiff_t count_matches(const Matches& matches) {
  return std::ranges::count_if(matches, [](const TimedPose* pose) { return pose != nullptr; });
}

int count_unmatched(const Trajectory& truth, const Trajectory& estimate) {
  return static_cast<int>(std::ranges::count_if(
      estimate, [&](const TimedPose& pose) { return nearest(truth, pose.timestamp) == nullptr; }));
}

std::string describe_time_mismatch(const Trajectory& truth, const Trajectory& estimate) {
  if (estimate.empty())
    return "the estimate has no pose at all: the tracker lost every frame, or wrote another file";
  std::string text = fmt::format(
      "no frame is in both within 1 ms: the truth runs from {} to {} s, the estimate from {} to {} s",
      format_seconds(truth.front().timestamp), format_seconds(truth.back().timestamp),
      format_seconds(estimate.front().timestamp), format_seconds(estimate.back().timestamp));
  return text + describe_offset(truth, estimate) + "; are both of the same recording, and on the same clock?";
}

}  // namespace apriltrack
