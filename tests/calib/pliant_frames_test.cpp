// Frames that small tags leave two poses are no witnesses against a tag; others are. By exact poses.
#include "faults/pliant_frames.h"

#include <gmock/gmock.h>

#include "adjusted_world.h"
#include "apriltrack/base/degrees.h"
#include "solve/frame_views.h"

namespace apriltrack {
namespace {

using test::AdjustedWorld;
using test::looking_along;
using test::SyntheticWorld;

constexpr int kSmall = 0, kSmallToo = 1, kNear = 2;
constexpr double kNoise_px = 0.25;

/// Two small tags side by side on a far wall, and a large one aslant before it, seen along a bow.
SyntheticWorld far_and_near() {
  SyntheticWorld world;
  world.rig.cameras.push_back(test::perspective_camera());
  const Eigen::Vector3d ahead = Eigen::Vector3d::UnitX();
  test::add_tag(world, 0.10, looking_along({5.0, 0.10, 0.0}, ahead));
  test::add_tag(world, 0.10, looking_along({5.0, -0.10, 0.0}, ahead));
  test::add_tag(world, 0.30, looking_along({1.5, -0.60, 0.1}, Eigen::Vector3d(1.0, -0.4, 0.1)));
  for (int i = 0; i < 24; ++i) {
    const double side = -1.2 + 0.1 * i;
    const Eigen::Vector3d eye(0.0, side, 0.2 * std::sin(0.5 * i));
    world.T_world_rig.push_back(looking_along(eye, Eigen::Vector3d(3.0, -0.1, 0.0) - eye));
  }
  return world;
}

std::vector<FrameDetections> filmed(const SyntheticWorld& world) {
  std::vector<FrameDetections> frames = test::exact_detections(world);
  RandomStream random(5);
  test::add_noise(frames, kNoise_px, random);
  return frames;
}

class PliantFrames : public ::testing::Test {
 protected:
  PliantFrames() : one_(far_and_near(), filmed(far_and_near()), noise()) {
    tag_ = one_.index_of(kNear);
    probes_ = probe_views(one_.task(), one_.offered, one_.solved, tag_);
  }

  static CalibrationOptions noise() {
    CalibrationOptions options;
    options.corner_sigma_px = kNoise_px;
    return options;
  }

  /// Where the tag hangs.
  TagFit fit() const {
    TagFit result;
    result.shape.size_m = one_.observations.sizes_m[static_cast<std::size_t>(tag_)];
    result.T_map_tag = one_.solved.state.T_map_tag[static_cast<std::size_t>(tag_)];
    return result;
  }

  /// The pose that the mirrored first tag of the others leaves the probe's frame, if they agree with it.
  bool mirror(ProbeView& probe) {
    MapState state = one_.solved.state;
    const std::size_t v = probe.others.front();
    const auto& candidates = one_.candidates[v].candidates;
    if (candidates.size() < 2) return false;
    FrameViews others(one_.task(), probe.others, state);
    others.pose() = state.T_map_tag[static_cast<std::size_t>(one_.observations.views[v].tag)] *
                    candidates[1].T_rig_tag.inverse();
    others.settle();
    const double turned_rad = rotation_angle_rad(others.pose().rotation(), probe.T_map_rig.rotation());
    if (turned_rad < 5.0 * kRadPerDeg || others.cost() > 12.0) return false;
    probe.T_map_rig = others.pose();
    return true;
  }

  AdjustedWorld one_;
  int tag_ = 0;
  std::vector<ProbeView> probes_;
};

TEST_F(PliantFrames, AreNoWitnessesWhereTheyWereMirrored) {
  const std::vector<ProbeView> before = probes_;
  std::size_t mirrored = 0;
  for (ProbeView& probe : probes_) mirrored += mirror(probe) ? 1 : 0;
  ASSERT_GE(mirrored, 4u);
  const auto witnesses = without_pliant_frames(one_.task(), one_.solved, probes_, fit());
  EXPECT_LE(witnesses.size(), before.size() - mirrored);
  for (const ProbeView& probe : witnesses)
    EXPECT_LT(probe_cost(probe, fit().T_map_tag, fit().shape), 8.0 * usual_probe_cost());
}

TEST_F(PliantFrames, OthersBearWitnessOfATagThatHangsElsewhere) {
  AdjustedWorld room(test::make_room(12, 60, test::perspective_camera()));
  const int tag = room.offered.tags.back();
  const auto probes = probe_views(room.task(), room.offered, room.solved, tag);
  TagFit elsewhere;
  elsewhere.shape.size_m = room.observations.sizes_m[static_cast<std::size_t>(tag)];
  elsewhere.T_map_tag = room.solved.state.T_map_tag[static_cast<std::size_t>(tag)] *
                        Pose(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.05, 0.0, 0.0));
  EXPECT_EQ(without_pliant_frames(room.task(), room.solved, probes, elsewhere).size(), probes.size());
}

}  // namespace
}  // namespace apriltrack
