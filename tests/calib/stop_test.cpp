// Work that is told to stop leaves at once, wherever it is: no trial takes that for a failure of its own.
#include "apriltrack/calib/stop.h"

#include <gmock/gmock.h>

#include <atomic>
#include <cstddef>
#include <limits>

#include "apriltrack/calib/refine_map.h"
#include "calibrating.h"
#include "filmed_room.h"

namespace apriltrack {
namespace {

using test::FilmedRoom;
using test::SyntheticWorld;

constexpr std::size_t kNever = std::numeric_limits<std::size_t>::max();

/// Says so from its `first` answer on, the first of all being number 0.
struct StopAt {
  std::size_t first = kNever;
  std::size_t asked = 0;

  ShouldStop hook() {
    return [this] { return asked++ >= first; };
  }
};

/// One of eight tags hangs by turns in two places: of its faults many are tried, and many of these fail.
std::vector<FrameDetections> contradictory_views(const SyntheticWorld& world) {
  SyntheticWorld copy = world;
  copy.map.tags.back().T_map_tag =
      copy.map.tags.back().T_map_tag * Pose(Eigen::Matrix3d(Eigen::Matrix3d::Identity()), {0.5, 0.3, 0.0});
  std::vector<FrameDetections> frames = test::exact_detections(world);
  const std::vector<FrameDetections> others = test::exact_detections(copy);
  for (std::size_t i = 0; i < frames.size(); ++i)
    if (i / 6 % 2 == 1) frames[i] = others[i];
  RandomStream random(77);
  test::add_edge_noise(frames, 0.1, -0.45, random);
  return frames;
}

TEST(StoppableLoop, RunsNoBodyOnceItIsToStop) {
  StopAt stop{.first = 3};
  std::size_t runs = 0;
  EXPECT_THROW(stoppable(parallel_for(1), stop.hook())(10, [&](std::size_t) { ++runs; }), Stopped);
  EXPECT_EQ(runs, 3U);
}

TEST(StoppableLoop, RunsAllWhereNothingStopsIt) {
  std::atomic<std::size_t> runs = 0;
  const auto run = [&](std::size_t) { ++runs; };
  stoppable(parallel_for(2), {})(10, run);
  stoppable(parallel_for(2), [] { return false; })(10, run);
  EXPECT_EQ(runs, 20U);
}

TEST(StoppedCalibration, LeavesAtOnceWhereverItIs) {
  const SyntheticWorld world = test::make_room(8, 48, test::perspective_camera());
  const std::vector<FrameDetections> frames = contradictory_views(world);
  StopAt whole;
  CalibrationOptions options;
  options.cross_validate = true;
  options.should_stop = whole.hook();
  test::calibrate(world, frames, options);
  ASSERT_GT(whole.asked, 300U);
  constexpr std::size_t kPlaces = 5;
  for (std::size_t place = 0; place <= kPlaces; ++place) {
    StopAt stop{.first = (whole.asked - 1) * place / kPlaces};
    options.should_stop = stop.hook();
    EXPECT_THROW(test::calibrate(world, frames, options), Stopped) << place;
    EXPECT_EQ(stop.asked, stop.first + 1) << "it went on for a while at " << place;
  }
}

TEST(StoppedCalibration, LeavesFromSeveralThreadsToo) {
  const SyntheticWorld world = test::make_room(8, 48, test::perspective_camera());
  std::atomic<int> asked = 0;
  CalibrationOptions options;
  options.num_threads = 2;
  options.should_stop = [&] { return ++asked > 300; };
  EXPECT_THROW(test::calibrate(world, contradictory_views(world), options), Stopped);
}

TEST(StoppedRefinement, LeavesTheMapOfTheCorners) {
  const FilmedRoom& filmed = FilmedRoom::once();
  StopAt whole;
  RefinementOptions options;
  options.should_stop = whole.hook();
  ASSERT_TRUE(refine_map(filmed.by_corners, filmed.frames, filmed.rig, options).is_accepted);
  ASSERT_GT(whole.asked, 300U);
  for (const std::size_t first : {std::size_t{0}, whole.asked / 2, whole.asked - 1}) {
    StopAt stop{.first = first};
    options.should_stop = stop.hook();
    const RefinementResult result = refine_map(filmed.by_corners, filmed.frames, filmed.rig, options);
    EXPECT_TRUE(result.is_stopped);
    EXPECT_FALSE(result.is_accepted);
    EXPECT_EQ(result.reason, "interrupted");
    EXPECT_EQ(stop.asked, first + 1);
    EXPECT_TRUE(result.refined.empty());
    ASSERT_EQ(result.map.tags.size(), filmed.by_corners.map.tags.size());
    for (std::size_t i = 0; i < result.map.tags.size(); ++i)
      EXPECT_EQ(result.map.tags[i].T_map_tag.matrix(), filmed.by_corners.map.tags[i].T_map_tag.matrix());
  }
}

}  // namespace
}  // namespace apriltrack
