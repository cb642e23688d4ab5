#include "mirrored_frames.h"

#include <map>
#include <vector>

#include "frame_views.h"

namespace apriltrack {
namespace {

constexpr double kLess = 1.0;  // by more than rounding within one minimum; of half the robust sum of squares

/// To the pose of another minimum, if it explains the views better.
bool turn(FrameViews frame) {
  const Pose before = frame.pose();
  frame.settle();
  const double as_it_is = frame.cost();
  const auto [cost, turned] = frame.best_of_proposals();
  const bool is_better = cost < as_it_is - kLess;
  frame.pose() = is_better ? turned : before;
  return is_better;
}

}  // namespace

bool turn_mirrored_frames(const PartTask& task, const Part& part, MapState& state) {
  std::map<int, std::vector<std::size_t>> views_of_frame;
  for (const std::size_t v : part.views) views_of_frame[task.observations.views[v].frame].push_back(v);
  bool has_turned = false;
  for (const auto& [frame, views] : views_of_frame)
    if (turn({task, views, state})) has_turned = true;
  return has_turned;
}

}  // namespace apriltrack
