#include "apriltrack/source/session_clocks.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <tuple>
#include <utility>

#include "apriltrack/base/error.h"

namespace apriltrack {
namespace {

using Input = SessionClocks::Input;
using Span = SessionClocks::Span;

/// A minute: no time in which a camera is taken to have gone on from where it was.
constexpr std::int64_t kGap_ns = 60'000'000'000;

void extend(std::optional<Span>& span, const Span& by) {
  span = span ? Span{std::min(span->first, by.first), std::max(span->last, by.last)} : by;
}

bool overlap(const std::optional<Span>& a, const std::optional<Span>& b) {
  return a && b && a->first <= b->last && b->first <= a->last;
}

bool share_a_camera(const Input& a, const Input& b) {
  return std::ranges::any_of(a.cameras,
                             [&](const std::string& camera) { return b.cameras.contains(camera); });
}

/// Two that a camera cannot both have filmed by one clock.
using Restart = std::pair<const Input*, const Input*>;

std::optional<Restart> find_restart(const std::vector<Input>& inputs) {
  for (auto b = inputs.begin(); b != inputs.end(); ++b) {
    for (auto a = inputs.begin(); a != b; ++a) {
      for (const std::string& camera : a->cameras)
        if (overlap(a->span_of(camera), b->span_of(camera))) return Restart{&*a, &*b};
    }
  }
  return std::nullopt;
}

/// Whether an input may be of a take.
using MayBeOf = std::function<bool(std::size_t input, int take)>;

/// The earliest take that each input may be of, where each is of a later one than those of its cameras before
/// it; num_takes or more where there is none.
std::vector<int> earliest(const std::vector<Input>& inputs, int num_takes, const MayBeOf& may_be_of) {
  std::vector<int> takes(inputs.size(), 0);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    for (std::size_t before = 0; before < i; ++before)
      if (share_a_camera(inputs[before], inputs[i])) takes[i] = std::max(takes[i], takes[before] + 1);
    while (takes[i] < num_takes && !may_be_of(i, takes[i])) ++takes[i];
  }
  return takes;
}

/// The latest one likewise; negative where there is none.
std::vector<int> latest(const std::vector<Input>& inputs, int num_takes, const MayBeOf& may_be_of) {
  std::vector<int> takes(inputs.size(), num_takes - 1);
  for (std::size_t i = inputs.size(); i-- > 0;) {
    for (std::size_t after = i + 1; after < inputs.size(); ++after)
      if (share_a_camera(inputs[i], inputs[after])) takes[i] = std::min(takes[i], takes[after] - 1);
    while (takes[i] >= 0 && !may_be_of(i, takes[i])) --takes[i];
  }
  return takes;
}

[[noreturn]] void refuse(const Input& input, const Restart& restart, std::ptrdiff_t num_overlapped) {
  throw invalid_input(
      input.name,
      fmt::format(
          "with which take it goes cannot be told: clocks began anew, as one camera filmed both {} and "
          "{} at the same times, and its own times fall into {} of the takes; shift the time stamps so "
          "that all recordings share one clock, or give --detections one file per take with all "
          "cameras of the take in it",
          restart.first->name, restart.second->name,
          num_overlapped == 0 ? "none" : std::to_string(num_overlapped)));
}

/// The take of each input. Those of the camera with most recordings are fixed by their number; they say when
/// a take was, and that says which take the others are of.
std::vector<int> assign_takes(const std::vector<Input>& inputs, const Restart& restart) {
  const auto any = [](std::size_t, int) { return true; };
  const std::vector<int> first = earliest(inputs, static_cast<int>(inputs.size()), any);
  const int num_takes = *std::ranges::max_element(first) + 1;
  const std::vector<int> last = latest(inputs, num_takes, any);
  std::vector<std::optional<Span>> takes(static_cast<std::size_t>(num_takes));
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (first[i] == last[i] && inputs[i].span)
      extend(takes[static_cast<std::size_t>(first[i])], *inputs[i].span);
  }
  const auto by_time = [&](std::size_t i, int take) {
    if (first[i] == last[i]) return take == first[i];
    return !inputs[i].span || overlap(inputs[i].span, takes[static_cast<std::size_t>(take)]);
  };
  std::vector<int> assigned = earliest(inputs, num_takes, by_time);
  const std::vector<int> otherwise = latest(inputs, num_takes, by_time);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (first[i] == last[i] || assigned[i] == otherwise[i] || !inputs[i].span) continue;
    refuse(inputs[i], restart, std::ranges::count_if(takes, [&](const std::optional<Span>& take) {
             return overlap(inputs[i].span, take);
           }));
  }
  return assigned;
}

std::string describe(const Input& input, std::int64_t shift_ns) {
  return fmt::format("{} ({}) by {} s", input.name, fmt::join(input.cameras, ", "),
                     format_seconds(Timestamp{shift_ns}));
}

/// Moves each take behind the one before where it is not. Returns what was moved.
std::vector<std::string> move_apart(std::vector<Input>& inputs, const std::vector<int>& takes) {
  std::vector<std::string> moved;
  std::optional<Timestamp> end;
  for (int take = 0; take <= *std::ranges::max_element(takes); ++take) {
    std::optional<Span> span;
    for (std::size_t i = 0; i < inputs.size(); ++i)
      if (takes[i] == take && inputs[i].span) extend(span, *inputs[i].span);
    if (!span) continue;
    const std::int64_t shift_ns = end && span->first <= *end ? end->ns + kGap_ns - span->first.ns : 0;
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      if (takes[i] != take || !inputs[i].span || shift_ns == 0) continue;
      for (FrameDetections& frame : inputs[i].frames) frame.timestamp.ns += shift_ns;
      moved.push_back(describe(inputs[i], shift_ns));
    }
    end = Timestamp{span->last.ns + shift_ns};
  }
  return moved;
}

}  // namespace

std::optional<Span> SessionClocks::Input::span_of(const std::string& camera) const {
  std::optional<Span> span_of_camera;
  for (const FrameDetections& frame : frames)
    if (frame.camera == camera) extend(span_of_camera, {frame.timestamp, frame.timestamp});
  return span_of_camera;
}

void SessionClocks::add(const std::string& name, const std::set<std::string>& cameras,
                        std::vector<FrameDetections> frames) {
  Input input{name, cameras, std::move(frames), std::nullopt};
  for (const FrameDetections& frame : input.frames) extend(input.span, {frame.timestamp, frame.timestamp});
  inputs_.push_back(std::move(input));
}

SessionClocks::Aligned SessionClocks::align() {
  std::vector<Input> inputs = std::exchange(inputs_, {});
  Aligned all;
  if (const auto restart = find_restart(inputs)) {
    const std::vector<std::string> moved = move_apart(inputs, assign_takes(inputs, *restart));
    all.warning = fmt::format(
        "one camera filmed both {} and {} at the same times, so that clocks began anew; moved behind the "
        "takes before: {}",
        restart->first->name, restart->second->name, fmt::join(moved, ", "));
  }
  for (Input& input : inputs)
    std::move(input.frames.begin(), input.frames.end(), std::back_inserter(all.frames));
  std::ranges::stable_sort(
      all.frames, {}, [](const FrameDetections& frame) { return std::tie(frame.timestamp, frame.camera); });
  return all;
}

}  // namespace apriltrack
