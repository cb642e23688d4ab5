#include "swept_area.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "tag_film.h"
#include "view_path.h"

namespace apriltrack {
namespace {

struct Sweep {
  const char* name;
  double turn_rad;           ///< Of the tag in the image.
  Vector6d velocity;         ///< Metres and radians a second.
  Eigen::Vector3d place_m;   ///< Before the camera.
  double most_spare = 1.45;  ///< Pixels of the rows over those that are passed.
};

/// Printed square and state of a tag of 16 cm, two cells of margin, before a lens of 300 px.
class SweptRowsTest : public ::testing::TestWithParam<Sweep> {
 protected:
  static constexpr double kExposure_s = 0.02;

  SweptRowsTest() {
    MapTag tag;
    tag.key = {"tag36h11", 5};
    tag.size_m = 0.16;
    map_.tags = {tag};
    state_.pose = {Eigen::Quaterniond(Eigen::AngleAxisd(GetParam().turn_rad, Eigen::Vector3d::UnitZ())),
                   GetParam().place_m};
    state_.velocity = GetParam().velocity;
  }

  /// By brute force, 1 where one of 160 x 160 points of the printed square is at one of 20 instants.
  GrayImage passed(const PhotometricWorld& world, int level) const {
    GrayImage pixels(320 >> level, 240 >> level);
    const double half = world.tags[0].half_extent * world.tags[0].half_size_m();
    for (int m = 0; m < 20; ++m) {
      const Pose view = pose_after(state_, kExposure_s * ((m + 0.5) / 20.0 - 0.5));
      for (int i = 0; i < 160; ++i) {
        for (int k = 0; k < 160; ++k) {
          const Eigen::Vector3d point(half * (i / 79.5 - 1.0), half * (k / 79.5 - 1.0), 0.0);
          const auto pixel = camera_.model.project(view * point);
          if (!pixel) continue;
          const double scale = 1 << level;  // pixel centres are whole numbers
          const int x = static_cast<int>(std::floor((pixel->x() + 0.5) / scale));
          const int y = static_cast<int>(std::floor((pixel->y() + 0.5) / scale));
          if (x >= 0 && y >= 0 && x < pixels.width() && y < pixels.height()) pixels(x, y) = 1;
        }
      }
    }
    return pixels;
  }

  Camera camera_{.model =
                     CameraModel({300.0, 300.0, 160.0, 120.0}, RadtanDistortion({-0.2, 0.05, 0.0, 0.0}))};
  TagMap map_;
  MotionState state_;
};

TEST_P(SweptRowsTest, HoldWhatTheSquarePassesAndLittleMore) {
  PhotometricWorld world(camera_, map_, TrackMode::kJoint, 320, 240);
  for (const int level : {0, 2}) {
    const Image<float> image(320 >> level, 240 >> level);
    ViewPath path(state_, kExposure_s, world.mode);
    const TagSight sight(world, world.tags[0], path);
    ASSERT_TRUE(sight.is_visible());
    const SweptArea area = swept_area(world, image, sight, world.tags[0], level);
    ASSERT_FALSE(area.box.isEmpty());
    SweptRows rows;
    rows.find(area);
    int num_passed = 0, num_spanned = 0;
    const GrayImage is_passed = passed(world, level);
    for (int y = 0; y < image.height(); ++y) {
      for (int x = 0; x < image.width(); ++x) {
        if (is_passed(x, y) == 0) continue;
        ++num_passed;
        ASSERT_GE(y, area.box.min().y());
        ASSERT_LE(y, area.box.max().y());
        EXPECT_GE(x, rows[y].first) << "row " << y << ", level " << level;
        EXPECT_LE(x, rows[y].last) << "row " << y << ", level " << level;
      }
    }
    for (int y = area.box.min().y(); y <= area.box.max().y(); ++y)
      num_spanned += std::max(0, rows[y].last - rows[y].first + 1);
    ASSERT_GT(num_passed, 100 >> (2 * level));
    if (level == 0) {
      EXPECT_LT(num_spanned, GetParam().most_spare * num_passed);
    }
  }
}

Vector6d velocity(double x, double y, double z, double roll) {
  Vector6d v = Vector6d::Zero();
  v << x, y, z, 0.0, 0.0, roll;
  return v;
}

constexpr double kEighth = std::numbers::pi / 4.0;

INSTANTIATE_TEST_SUITE_P(
    Sweeps, SweptRowsTest,
    ::testing::Values(Sweep{"still", 0.0, velocity(0, 0, 0, 0), {0.0, 0.0, 0.8}},
                      Sweep{"turned", kEighth, velocity(0, 0, 0, 0), {0.1, 0.0, 0.8}},
                      Sweep{"aslant", kEighth, velocity(5.0, 5.0, 0, 0), {0.0, 0.0, 0.8}},
                      Sweep{"level", 0.0, velocity(12.0, 0.0, 0, 0), {0.0, 0.0, 0.8}},
                      Sweep{"nearer", 0.3, velocity(0, 0, -12.0, 0), {0.1, 0.1, 0.8}},
                      Sweep{"turning", 0.3, velocity(6.0, 0, 0, 30.0), {0.0, 0.0, 0.8}},
                      Sweep{"over the border", 0.5, velocity(6.0, 3.0, 0, 0), {-0.4, -0.25, 0.8}},
                      Sweep{"close", 0.5, velocity(3.0, 3.0, 0, 0), {0.0, 0.0, 0.16}}),
    [](const auto& of) {
      std::string name = of.param.name;
      std::erase(name, ' ');
      return name;
    });

}  // namespace
}  // namespace apriltrack
