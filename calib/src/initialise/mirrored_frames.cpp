#include "initialise/mirrored_frames.h"

#include <atomic>
#include <map>
#include <utility>
#include <vector>

#include "apriltrack/base/parallel.h"
#include "solve/frame_views.h"

namespace apriltrack {
namespace {

// Of half the robust sum of squares: more than rounding makes of one and the same minimum.
constexpr double kLeastGain = 1.0;

/// To the pose of another minimum, if it explains the views better.
bool turn(FrameViews frame) {
  const Pose before = frame.pose();
  const double as_it_is = frame.settle();
  const auto [cost, turned] = frame.best_of_proposals();
  const bool is_better = cost < as_it_is - kLeastGain;
  frame.pose() = is_better ? turned : before;
  return is_better;
}

}  // namespace

bool turn_mirrored_frames(const PartTask& task, const Part& part, MapState& state,
                          const ParallelFor& parallel) {
  std::map<int, std::vector<std::size_t>> views_of_frame;
  for (const std::size_t v : part.views) views_of_frame[task.observations.views[v].frame].push_back(v);
  std::vector<std::vector<std::size_t>> frames;
  for (auto& [frame, views] : views_of_frame) frames.push_back(std::move(views));
  std::atomic<bool> has_turned = false;
  parallel(frames.size(), [&](std::size_t i) {
    if (turn({task, std::move(frames[i]), state})) has_turned = true;
  });
  return has_turned;
}

}  // namespace apriltrack
