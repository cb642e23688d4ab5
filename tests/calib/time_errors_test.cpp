// Pictures that are not of the moments that their times say: rows read one after another, cameras that are
// not triggered together.
#include "cameras/time_errors.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "calibrating.h"

namespace apriltrack {
namespace {

using test::SyntheticWorld;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

constexpr double kFramePeriod_s = 0.05;  // of exact_detections()
constexpr int kSteps = 20;               // of a frame, in which the camera moves evenly

/// A camera that moves evenly from each pose of a made-up room to the next, in kPeriod frames.
SyntheticWorld moving_world(int cameras) {
  SyntheticWorld world = test::make_room(10, 26, test::perspective_camera());
  const std::vector<Pose> places = world.T_world_rig;
  constexpr int kPeriod = 12;
  world.T_world_rig.clear();
  for (std::size_t i = 0; i + 1 < places.size(); ++i) {
    const Vector6d step = (places[i].inverse() * places[i + 1]).log();
    for (int k = 0; k < kPeriod; ++k)
      world.T_world_rig.push_back(places[i] * Pose::exp(step * (static_cast<double>(k) / kPeriod)));
  }
  if (cameras == 2) {
    Camera second = test::perspective_camera("cam1");
    second.T_this_previous =
        Pose(Eigen::Matrix3d(Eigen::Matrix3d::Identity()), Eigen::Vector3d(-0.3, 0.0, 0.0));
    world.rig.cameras.push_back(second);
  }
  return world;
}

/// The same seen `part` of a frame later.
SyntheticWorld later(const SyntheticWorld& world, double part) {
  SyntheticWorld result = world;
  for (std::size_t i = 0; i + 1 < world.T_world_rig.size(); ++i)
    result.T_world_rig[i] =
        world.T_world_rig[i] *
        Pose::exp(part * (world.T_world_rig[i].inverse() * world.T_world_rig[i + 1]).log());
  return result;
}

/// What is seen at moments within a frame, from half of one before to half of one after.
std::vector<std::vector<FrameDetections>> seen_within_frames(const SyntheticWorld& world) {
  std::vector<std::vector<FrameDetections>> moments;
  for (int k = -kSteps / 2; k <= kSteps / 2; ++k)
    moments.push_back(test::exact_detections(later(world, static_cast<double>(k) / kSteps)));
  return moments;
}

/// Each corner as it was when its row was read, to a twentieth of a frame.
std::vector<FrameDetections> rolled(const SyntheticWorld& world, double readout_s) {
  const auto moments = seen_within_frames(world);
  std::vector<FrameDetections> frames = test::exact_detections(world);
  const double rows = world.rig.cameras[0].height;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    for (Detection& detection : frames[i].detections) {
      for (std::size_t c = 0; c < detection.corners_px.size(); ++c) {
        const double part = (detection.corners_px[c].y() / rows - 0.5) * readout_s / kFramePeriod_s;
        const double at = std::clamp(part * kSteps + kSteps / 2.0, 0.0, kSteps - 1e-9);
        const auto before = static_cast<std::size_t>(at);
        const auto corner = [&](std::size_t moment) -> std::optional<Eigen::Vector2d> {
          for (const Detection& there : moments[moment][i].detections)
            if (there.tag == detection.tag) return there.corners_px[c];
          return std::nullopt;
        };
        const auto first = corner(before), last = corner(before + 1);
        const double share = at - static_cast<double>(before);
        if (first && last) detection.corners_px[c] = (1.0 - share) * *first + share * *last;
      }
    }
  }
  return frames;
}

CalibrationResult calibrated(const SyntheticWorld& world, std::vector<FrameDetections> frames,
                             const CalibrationOptions& options = {}) {
  RandomStream random(5);
  test::add_edge_noise(frames, 0.1, -0.45, random);
  return test::calibrate(world, frames, options);
}

TEST(TimeErrors, OfAGlobalShutterAreNone) {
  for (const int cameras : {1, 2}) {
    const SyntheticWorld world = moving_world(cameras);
    const CalibrationResult result = calibrated(world, test::exact_detections(world));
    EXPECT_THAT(result.time_errors, IsEmpty()) << cameras;
  }
}

TEST(TimeErrors, OfARollingShutterAreToldAndCounted) {
  const SyntheticWorld world = moving_world(1);
  const CalibrationResult result = calibrated(world, rolled(world, 0.02));
  ASSERT_EQ(result.time_errors.size(), 1U);
  EXPECT_EQ(result.time_errors[0].kind, TimeError::Kind::kReadout);
  EXPECT_NEAR(result.time_errors[0].value_s, 0.02, 0.003);
  EXPECT_THAT(result.warnings, Contains(HasSubstr("a rolling shutter, which bends what moves")));
  EXPECT_LT(test::mean_normalised_error(world, result), 2.0);
}

TEST(TimeErrors, OfACameraThatIsTriggeredLateAreToldAndCounted) {
  const SyntheticWorld world = moving_world(2);
  for (const double part : {0.3, -0.3}) {
    std::vector<FrameDetections> frames = test::exact_detections(world);
    const std::vector<FrameDetections> others = test::exact_detections(later(world, part));
    ASSERT_EQ(frames.size(), others.size());
    for (std::size_t i = 0; i < frames.size(); ++i)
      if (frames[i].camera == "cam1") frames[i].detections = others[i].detections;
    const CalibrationResult result = calibrated(world, frames);
    ASSERT_EQ(result.time_errors.size(), 1U) << part;
    EXPECT_EQ(result.time_errors[0].camera, "cam1");
    EXPECT_EQ(result.time_errors[0].kind, TimeError::Kind::kDelay);
    EXPECT_NEAR(result.time_errors[0].value_s, part * kFramePeriod_s, 0.001);
    EXPECT_THAT(result.warnings,
                Contains(AllOf(StartsWith("cam1: its pictures look as if they were taken 1"),
                               HasSubstr(part > 0.0 ? "after those of cam0" : "before those of cam0"))));
    EXPECT_LT(test::mean_normalised_error(world, result), 2.0) << part;
  }
}

/// An upside-down sensor reads its last row first.
TEST(TimeErrors, OfRowsThatAreReadBackwardsAreToldAsSuch) {
  const SyntheticWorld world = moving_world(1);
  const CalibrationResult result = calibrated(world, rolled(world, -0.02));
  ASSERT_EQ(result.time_errors.size(), 1U);
  EXPECT_NEAR(result.time_errors[0].value_s, -0.02, 0.003);
  EXPECT_THAT(result.warnings,
              Contains(AllOf(HasSubstr("from the last to the first"), Not(HasSubstr("over -")))));
}

/// Two cameras whose clocks are 10 us apart: who takes the other's picture for the moment before divides by
/// that.
TEST(TimeErrors, AreAskedOfMomentsThatAreApart) {
  const SyntheticWorld world = moving_world(2);
  std::vector<FrameDetections> frames = rolled(world, 0.02);
  for (FrameDetections& frame : frames)
    if (frame.camera == "cam1") frame.timestamp = advance(frame.timestamp, 1e-5);
  const CalibrationResult result = calibrated(world, frames);
  ASSERT_EQ(result.time_errors.size(), 2U);
  for (const TimeError& error : result.time_errors) {
    EXPECT_EQ(error.kind, TimeError::Kind::kReadout) << error.camera;
    EXPECT_NEAR(error.value_s, 0.02, 0.003) << error.camera;
  }
}

/// Twelve frames of other tags do not say it by themselves; the camera is the same.
TEST(TimeErrors, AreCountedInOtherPartsToo) {
  const SyntheticWorld world = moving_world(1);
  std::vector<FrameDetections> frames = rolled(world, 0.02);
  const TagKey middle = world.map.tags[world.map.tags.size() / 2].key;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const bool is_of_second = i % 2 == 1 && i < 24;
    std::erase_if(frames[i].detections,
                  [&](const Detection& detection) { return is_of_second == (detection.tag < middle); });
  }
  const CalibrationResult result = calibrated(world, frames);
  ASSERT_EQ(result.other_parts.size(), 1U);
  ASSERT_EQ(result.time_errors.size(), 1U);
  EXPECT_EQ(std::ranges::count_if(result.warnings,
                                  [](const std::string& warning) {
                                    return warning.find("rolling shutter") != std::string::npos;
                                  }),
            1);
  double largest = 0.0;
  EXPECT_LT(test::mean_normalised_error(world.map, result.held_tags_of_other_parts[0], result.other_parts[0],
                                        &largest),
            2.0);
}

TEST(TimeErrors, OfOtherPartsStandBesideThoseThatAreKnown) {
  const TimeError readout{.camera = "cam0", .value_s = 0.03}, other{.camera = "cam0", .value_s = 0.02};
  const TimeError delay{.camera = "cam1", .kind = TimeError::Kind::kDelay, .value_s = 0.01};
  const std::vector<TimeError> both = with_known({readout}, {other, delay});
  ASSERT_EQ(both.size(), 2U);
  EXPECT_EQ(both[0].value_s, readout.value_s);
  EXPECT_EQ(both[1].camera, delay.camera);
}

/// To and fro would tell them apart: six passes of half a second at 0.5 m/s, all the same way.
SyntheticWorld on_a_cart() {
  SyntheticWorld world = moving_world(2);
  const std::vector<FrameDetections> seen = test::exact_detections(world);
  const auto most = std::ranges::max_element(
      seen, {}, [](const FrameDetections& frame) { return frame.detections.size(); });
  const Pose middle = world.T_world_rig[static_cast<std::size_t>(most - seen.begin()) / 2];
  world.T_world_rig.clear();
  for (int pass = 0; pass < 6; ++pass) {
    for (int k = -7; k <= 7; ++k)
      world.T_world_rig.push_back(middle * Pose(Eigen::Matrix3d(Eigen::Matrix3d::Identity()),
                                                Eigen::Vector3d(0.5 * kFramePeriod_s * k, 0.02 * pass, 0.0)));
  }
  return world;
}

/// There 5 mm of the baseline are 10 ms of one camera.
TEST(TimeErrors, AreNotToldWhereABaselineMayBeOff) {
  SyntheticWorld world = on_a_cart();
  std::vector<FrameDetections> frames = test::exact_detections(world);
  for (FrameDetections& frame : frames) {  // the cart goes back between passes
    const double since_s = seconds_between(frames.front().timestamp, frame.timestamp);
    frame.timestamp = advance(frame.timestamp, std::floor((since_s + 1e-3) / (15 * kFramePeriod_s)));
  }
  world.rig.cameras[1].T_this_previous =
      Pose(Eigen::Matrix3d(Eigen::Matrix3d::Identity()), Eigen::Vector3d(-0.305, 0.0, 0.0));
  const CalibrationResult result = calibrated(world, frames, {.intrinsics = Intrinsics::kKeep});
  EXPECT_THAT(result.time_errors, IsEmpty());
}

TEST(TimeErrors, AreInDoubtWhereConstraintsContradictTheMap) {
  const SyntheticWorld world = moving_world(1);
  CalibrationOptions options;
  options.constraints = {test::false_distance(world)};
  const std::string message =
      test::error_of(ErrorKind::kNoResult, [&] { calibrated(world, rolled(world, 0.02), options); });
  EXPECT_THAT(message, HasSubstr("cam0: the rows of a picture look as if they were taken one after another"));
}

}  // namespace
}  // namespace apriltrack
