#include "takes.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

namespace apriltrack::app {
namespace {

constexpr std::int64_t kGap_ns = 1'000'000'000;

std::pair<Timestamp, Timestamp> first_and_last(const std::vector<FrameDetections>& frames) {
  const auto [first, last] = std::ranges::minmax_element(frames, {}, &FrameDetections::timestamp);
  return {first->timestamp, last->timestamp};
}

}  // namespace

void Takes::add(std::vector<FrameDetections> frames) {
  std::set<std::string> cameras;
  for (const FrameDetections& frame : frames) cameras.insert(frame.camera);
  std::size_t take = 0;
  for (const std::string& camera : cameras) take = std::max(take, num_takes_[camera]);
  for (const std::string& camera : cameras) num_takes_[camera] = take + 1;
  if (takes_.size() <= take) takes_.resize(take + 1);
  std::move(frames.begin(), frames.end(), std::back_inserter(takes_[take]));
}

std::vector<FrameDetections> Takes::take_all() {
  std::vector<FrameDetections> all;
  std::optional<Timestamp> end;
  for (std::vector<FrameDetections>& take : takes_) {
    if (take.empty()) continue;
    const auto [first, last] = first_and_last(take);
    const std::int64_t shift_ns = end && first <= *end ? end->ns + kGap_ns - first.ns : 0;
    for (FrameDetections& frame : take) frame.timestamp.ns += shift_ns;
    end = Timestamp{last.ns + shift_ns};
    std::move(take.begin(), take.end(), std::back_inserter(all));
  }
  std::ranges::stable_sort(
      all, {}, [](const FrameDetections& frame) { return std::tie(frame.timestamp, frame.camera); });
  takes_.clear();
  num_takes_.clear();
  return all;
}

}  // namespace apriltrack::app
