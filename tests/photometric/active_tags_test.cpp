#include "active_tags.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "apriltrack/base/random.h"
#include "apriltrack/photometric/evidence.h"

namespace apriltrack {
namespace {

constexpr int kWidth = 640, kHeight = 480;

/// `across` x `across` tags of 12 cm, 15 cm apart, on a wall that a camera at rest looks at from a distance
/// at which they just fill the picture's height.
struct Wall {
  Camera camera{.model = CameraModel({500.0, 500.0, 319.5, 239.5}, NoDistortion{})};
  TagMap map;
  MotionState state;
  PhotometricFrame frame;

  explicit Wall(int across) {
    camera.width = kWidth;
    camera.height = kHeight;
    for (int i = 0; i < across * across; ++i) {
      MapTag tag;
      tag.key = {"tag36h11", i};
      tag.size_m = 0.12;
      const double half = 0.5 * (across - 1);
      const int row = i / across;
      tag.T_map_tag = {Eigen::Quaterniond::Identity(),
                       {0.15 * (i % across - half), 0.15 * (row - half), 0.0}};
      map.tags.push_back(tag);
    }
    state.pose = {Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.15 * across * 500.0 / kHeight}};
    RandomStream random(1);
    Image<float> image(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) image(x, y) = static_cast<float>(random.uniform(0.0, 0.9));
    }
    frame.light = light_pyramid(std::move(image), PhotometricWorld::kNumLevels);
    frame.exposure_s = 0.01;
  }

  PhotometricWorld world() const { return {camera, map, TrackMode::kJoint, kWidth, kHeight}; }
};

ActiveTags found(PhotometricWorld& world, const Wall& wall, int level, int max_pixels) {
  ViewPath path(wall.state, wall.frame.exposure_s, world.mode);
  ActiveTags active;
  active.find(world, wall.frame, path, {.level = level, .max_pixels = max_pixels});
  return active;
}

/// Level and pixels asked for of each tag: those of the fit and of the cloud.
struct Asked {
  int level, max_pixels;
};
constexpr Asked kAsked[] = {{0, 700}, {1, 700}, {2, 700}, {2, 196}};

TEST(ActiveTags, AFewHaveAllThePixelsThatAreAskedFor) {
  // Nine in view, and nine times as many in the map that are not.
  Wall wall(3);
  for (int i = 0; i < 81; ++i) {
    MapTag tag = wall.map.tags[0];
    tag.key.id = 100 + i;
    tag.T_map_tag = {Eigen::Quaterniond::Identity(), {3.0 + 0.15 * i, 0.0, 0.0}};
    wall.map.tags.push_back(tag);
  }
  PhotometricWorld world = wall.world();
  for (const Asked& asked : kAsked) {
    const ActiveTags active = found(world, wall, asked.level, asked.max_pixels);
    ASSERT_EQ(active.tags().size(), 9U);
    for (const ActiveTag& tag : active.tags()) {
      PhotometricTag& mapped = world.tags[static_cast<std::size_t>(tag.index)];
      ViewPath path(wall.state, wall.frame.exposure_s, world.mode);
      const TagPrediction prediction(world, mapped, path, asked.level);
      PredictedPixels predicted;
      TagPixels alone;
      select_pixels(world, wall.frame.light, prediction,
                    swept_area(world, wall.frame.light[static_cast<std::size_t>(asked.level)], prediction,
                               mapped, asked.level),
                    asked.level, asked.max_pixels, &alone, &predicted);
      EXPECT_EQ(tag.pixels.stride, alone.stride);
      EXPECT_EQ(tag.pixels.area_px, alone.area_px);
      EXPECT_EQ(tag.pixels.count, alone.count);
      EXPECT_EQ(tag.pixels.ray_x, alone.ray_x);
      EXPECT_EQ(tag.pixels.ray_y, alone.ray_y);
      EXPECT_EQ(tag.pixels.image, alone.image);
      EXPECT_EQ(tag.pixels.inverse_sigma, alone.inverse_sigma);
      EXPECT_EQ(tag.predicted.light, predicted.light);
    }
  }
}

TEST(ActiveTags, ManyShareThePixelsOfAFrame) {
  // 100 and 225 tags of 38 and 26 px: 144,000 pixels that could be looked at.
  for (const int across : {10, 15}) {
    const Wall wall(across);
    PhotometricWorld world = wall.world();
    const std::size_t num_tags = wall.map.tags.size();
    const double share = std::max(64.0, 10'000.0 / static_cast<double>(num_tags));
    for (const int max_pixels : {700, 196}) {
      const ActiveTags active = found(world, wall, 0, max_pixels);
      EXPECT_EQ(active.tags().size(), num_tags);
      std::size_t num_pixels = 0;
      for (const ActiveTag& tag : active.tags()) {
        num_pixels += tag.pixels.count;
        EXPECT_GE(tag.pixels.count, 48U);
        // Thinned out evenly: what is left stands for all of the tag, which is 8 / 10 of its cell of the
        // wall.
        const double edge_px = 0.8 * kHeight / across * 10.0 / 8.0;
        EXPECT_NEAR(tag.pixels.area_px, edge_px * edge_px, 0.25 * edge_px * edge_px);
      }
      // Tags that face the camera fill their box, which is twice what is expected of tags.
      EXPECT_LT(static_cast<double>(num_pixels), 3.0 * share * static_cast<double>(num_tags));
      EXPECT_GT(static_cast<double>(num_pixels), share * static_cast<double>(num_tags));
    }
  }
}

TEST(ActiveTags, ShowAsManyMorePixelsAsTheirPathIsShort) {
  // Nine tags of 128 px: 160 px with their margins, all of which a stride of 4, and of 2, thins out.
  Wall wall(3);
  PhotometricWorld world = wall.world();
  const auto count_at = [&](double path_px, bool more_where_sharp) {
    const double speed_m_per_s = path_px / wall.frame.exposure_s / 500.0 * wall.state.pose.translation().z();
    wall.state.velocity[0] = speed_m_per_s;
    ViewPath path(wall.state, wall.frame.exposure_s, world.mode);
    ActiveTags active;
    active.find(world, wall.frame, path, {.max_pixels = 700, .more_where_sharp = more_where_sharp});
    EXPECT_EQ(active.tags().size(), 9U);
    return static_cast<double>(active.tags()[4].pixels.count);
  };
  const double usual = count_at(0.0, false);
  EXPECT_NEAR(count_at(0.0, true), 4.0 * usual, 0.3 * usual);  // one instant
  EXPECT_NEAR(count_at(2.0, true), 2.0 * usual, 0.6 * usual);  // two
  EXPECT_EQ(count_at(4.0, true), count_at(4.0, false));        // four
}

TEST(ActiveTags, EvidenceOfManyStandsForWhatTheTagsCover) {
  const Wall wall(10);
  PhotometricWorld world = wall.world();
  int num_pixels = 0;
  for (const TagEvidence& tag : weigh_evidence(world, wall.frame, wall.state)) num_pixels += tag.num_pixels;
  EXPECT_LT(num_pixels, 30'000);
  EXPECT_GT(num_pixels, 10'000);
}

}  // namespace
}  // namespace apriltrack
