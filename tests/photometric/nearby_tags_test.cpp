#include "nearby_tags.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "active_tags.h"
#include "apriltrack/base/random.h"
#include "apriltrack/geometry/rotation.h"
#include "camera/lens_models.h"
#include "view_cone.h"

namespace apriltrack {
namespace {

Eigen::Vector3d random_vector(RandomStream& random, double sigma) {
  return {sigma * random.normal(), sigma * random.normal(), sigma * random.normal()};
}

/// Tags of 2 to 40 cm in a ball, turned anyhow.
TagMap scattered(RandomStream& random, int num_tags, double spread_m) {
  TagMap map;
  for (int i = 0; i < num_tags; ++i) {
    MapTag tag;
    tag.key = {"tag36h11", i % 587};
    tag.size_m = random.uniform(0.02, 0.4);
    tag.T_map_tag = {rotation_exp(random_vector(random, 2.0)), random_vector(random, spread_m)};
    map.tags.push_back(tag);
  }
  return map;
}

/// Whether the camera of `model` shows a corner of the tag's square, from its front, its cells at least
/// `least_cell_px` wide across the line of sight: by projection, one corner after the other.
bool shows(const CameraModel& model, int width, int height, const MapTag& tag, const Pose& T_camera_map,
           double least_cell_px) {
  const Pose T_camera_tag = T_camera_map * tag.T_map_tag;
  const Eigen::Vector3d& centre = T_camera_tag.translation();
  // The tag's z axis points away from who reads it.
  if (!((T_camera_tag.rotation() * Eigen::Vector3d::UnitZ()).dot(centre) > 0.0)) return false;
  const double focal_px = 0.5 * (model.pinhole().fx + model.pinhole().fy);
  if (focal_px * tag.size_m / 8.0 / centre.norm() < least_cell_px) return false;  // tag36h11: 8 cells across
  return std::ranges::any_of(corners_in_map(tag), [&](const Eigen::Vector3d& corner) {
    const auto pixel = model.project(T_camera_map * corner);
    return pixel && pixel->x() >= 0.0 && pixel->y() >= 0.0 && pixel->x() <= width - 1 &&
           pixel->y() <= height - 1;
  });
}

/// Somewhere near `pose`, moving: within and beyond what a choice allows for.
MotionState wandered(const MotionState& from, RandomStream& random) {
  MotionState state = from;
  const double step = std::pow(10.0, random.uniform(-3.0, 0.5));
  state.pose = {state.pose.rotation() * rotation_exp(random_vector(random, step)),
                state.pose.translation() + random_vector(random, 0.5 * step)};
  state.velocity << random_vector(random, 1.5), random_vector(random, 6.0);
  return state;
}

TEST(NearbyTags, HoldAllThatAnyViewOfAPathShows) {
  constexpr double kExposure_s = 0.03;
  RandomStream random(11);
  int num_shown = 0, num_reused = 0, num_paths = 0;
  for (const test::Lens& lens : test::all_lenses()) {
    Camera camera{.model = lens.model};
    const int width = static_cast<int>(2.0 * lens.model.pinhole().cx);
    const int height = static_cast<int>(2.0 * lens.model.pinhole().cy);
    for (const TrackMode mode : {TrackMode::kEgo, TrackMode::kJoint}) {
      const double spread_m = random.uniform(0.5, 6.0);
      const TagMap map = scattered(random, 400, spread_m);
      const PhotometricWorld world(camera, map, mode, 0, 0);  // no picture is asked for
      const double cone_rad = max_view_angle_rad(lens.model, width, height);
      NearbyTags nearby(world.tags);
      MotionState state;
      std::vector<std::uint32_t> last;
      for (int i = 0; i < 40; ++i, ++num_paths) {
        state = wandered(state, random);
        const ViewPath path(state, kExposure_s, mode);
        const auto chosen = nearby.of_path(path, cone_rad);
        EXPECT_TRUE(std::ranges::is_sorted(chosen));
        num_reused += std::ranges::equal(chosen, last) ? 1 : 0;
        last.assign(chosen.begin(), chosen.end());
        for (const double share : {-0.5, 0.0, 0.5}) {
          const Pose view = camera_from_map(pose_after(state, share * kExposure_s), mode);
          for (std::size_t k = 0; k < map.tags.size(); ++k) {
            if (!shows(lens.model, width, height, map.tags[k], view, 0.7 * (1.0 + 1e-9))) continue;
            ++num_shown;
            EXPECT_TRUE(std::ranges::binary_search(chosen, k)) << lens.name << " " << k;
          }
        }
      }
    }
  }
  EXPECT_GT(num_shown, 10'000);
  // Both were met: choices that served again, and such that had to be made anew.
  EXPECT_GT(num_reused, num_paths / 10);
  EXPECT_LT(num_reused, 9 * num_paths / 10);
}

TEST(NearbyTags, AreFewOfAMapThatIsFarOrBehind) {
  RandomStream random(12);
  Camera camera{.model = CameraModel({500.0, 500.0, 319.5, 239.5}, NoDistortion{})};
  const TagMap map = scattered(random, 5000, 60.0);
  PhotometricWorld world(camera, map, TrackMode::kEgo, 640, 480);
  NearbyTags nearby(world.tags);
  const auto chosen =
      nearby.of_path(ViewPath(MotionState(), 0.01, TrackMode::kEgo), world.max_view_angle_rad);
  EXPECT_LT(chosen.size(), 100U);
}

TEST(NearbyTags, FollowAViewThatWidens) {
  RandomStream random(13);
  Camera camera{.model = CameraModel({500.0, 500.0, 319.5, 239.5}, NoDistortion{})};
  const TagMap map = scattered(random, 500, 2.0);
  PhotometricWorld world(camera, map, TrackMode::kEgo, 640, 480);
  NearbyTags nearby(world.tags);
  const ViewPath path(MotionState(), 0.01, TrackMode::kEgo);
  const std::size_t narrow = nearby.of_path(path, 0.3).size();
  EXPECT_GT(nearby.of_path(path, 1.5).size(), narrow);
  EXPECT_EQ(nearby.of_path(path, 0.3).size(), narrow);
}

/// A camera at rest at the origin, an even grey before it.
struct GreyFrame {
  Camera camera{.model = CameraModel({250.0, 250.0, 159.5, 119.5}, NoDistortion{})};
  PhotometricFrame frame;
  GreyFrame() {
    Image<float> image(320, 240);
    for (int y = 0; y < 240; ++y) std::fill_n(image.row(y), 320, 0.5F);
    frame.light = light_pyramid(std::move(image), PhotometricWorld::kNumLevels);
    frame.exposure_s = 0.01;
  }
  std::set<int> active(const TagMap& map) const {
    PhotometricWorld world(camera, map, TrackMode::kEgo, 320, 240);
    ViewPath path(MotionState(), frame.exposure_s, TrackMode::kEgo);
    ActiveTags found;
    found.find(world, frame, path, {});
    std::set<int> indices;
    for (const ActiveTag& tag : found.tags()) indices.insert(tag.index);
    return indices;
  }
};

TEST(ActiveTagsOfManyTags, AreTheirOwnInSmallMaps) {
  // What each tag is in a map of its own, it is among all others.
  RandomStream random(14);
  const TagMap map = scattered(random, 150, 1.0);
  const GreyFrame grey;
  std::set<int> alone;
  for (std::size_t k = 0; k < map.tags.size(); ++k) {
    TagMap one;
    one.tags = {map.tags[k]};
    if (!grey.active(one).empty()) alone.insert(static_cast<int>(k));
  }
  EXPECT_GT(alone.size(), 5U);
  EXPECT_EQ(grey.active(map), alone);
}

TEST(ActiveTagsOfManyTags, LeaveOutCellsTooSmallToBeToldApart) {
  const GreyFrame grey;
  const auto count_at = [&](double cell_px) {
    TagMap map;
    MapTag tag;
    tag.size_m = 0.16;
    tag.T_map_tag = {Eigen::Quaterniond::Identity(), {0.0, 0.0, 250.0 * 0.16 / 8.0 / cell_px}};
    map.tags = {tag};
    return grey.active(map).size();
  };
  EXPECT_EQ(count_at(0.71), 1U);
  EXPECT_EQ(count_at(0.69), 0U);
}

}  // namespace
}  // namespace apriltrack
