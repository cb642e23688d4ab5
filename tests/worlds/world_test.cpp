#include "world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <set>

#include "apriltrack/base/timestamp.h"
#include "apriltrack/sim/renderer.h"
#include "support/shared_data.h"
#include "truth.h"
#include "write_world.h"

namespace apriltrack::worlds {
namespace {

constexpr std::uint64_t kSeeds[] = {1, 3, 9, 11};  // a body, a desk, a corridor and a hall

/// The lens formulas once more, as OpenCV's documentation has them.
Eigen::Vector2d projected(const nlohmann::json& lens, const Camera& camera, const Eigen::Vector3d& p) {
  double x = p.x() / p.z();
  double y = p.y() / p.z();
  const double r = std::hypot(x, y);
  if (lens["model"] == "equidistant") {
    const auto k = std::get<EquidistantDistortion>(camera.model.distortion()).coefficients();
    const double t = std::atan(r);
    const double bent =
        t + k[0] * std::pow(t, 3) + k[1] * std::pow(t, 5) + k[2] * std::pow(t, 7) + k[3] * std::pow(t, 9);
    x *= bent / r;
    y *= bent / r;
  } else if (lens["model"] == "radtan") {
    const auto k = std::get<RadtanDistortion>(camera.model.distortion()).coefficients();
    const double radial = 1.0 + k[0] * r * r + k[1] * std::pow(r, 4);
    const double x_before = x;
    x = x * radial + 2.0 * k[2] * x * y + k[3] * (r * r + 2.0 * x * x);
    y = y * radial + k[2] * (r * r + 2.0 * y * y) + 2.0 * k[3] * x_before * y;
  }
  const Pinhole& f = camera.model.pinhole();
  return {f.fx * x + f.cx, f.fy * y + f.cy};
}

TEST(World, TrueCornersAreThoseOfMapAndPose) {
  int count = 0;
  for (const std::uint64_t seed : kSeeds) {
    const World world = make_world(seed, FaultKind::kNone);
    for (std::size_t frame = 0; frame < world.scene.num_frames; frame += 7) {
      const Timestamp time = world.scene.timestamp(frame);
      const Pose truth = world.scene.truth_pose(time);
      const Pose T_camera_map = world.scene.truth == TruthKind::kJoint ? truth : truth.inverse();
      for (const TrueView& view : true_views(world, seconds_between(Timestamp{}, time))) {
        const MapTag& tag = *world.scene.map.find(world.tags[view.tag].key);
        const double h = 0.5 * tag.size_m;
        const Eigen::Vector3d corners[] = {{-h, h, 0}, {h, h, 0}, {h, -h, 0}, {-h, -h, 0}};
        for (std::size_t i = 0; i < 4; ++i) {
          const Eigen::Vector3d point = T_camera_map * (tag.T_map_tag * corners[i]);
          const Eigen::Vector2d pixel = projected(world.drawn["lens"], world.scene.camera, point);
          EXPECT_LT((view.corners_px[i] - pixel).norm(), 1e-6);
          ++count;
        }
      }
    }
  }
  EXPECT_GT(count, 1000);
}

/// Black lies inside the corners that truth tells of, and white outside, in what is rendered.
TEST(World, RenderedTagsLieWhereTruthSays) {
  const World world = make_world(9, FaultKind::kNone);
  ASSERT_EQ(world.drawn["tags"]["main_family"], "tag36h11");
  const Renderer renderer(world.scene, {.seed = 9});
  int count = 0;
  for (std::size_t frame = 0; frame < world.scene.num_frames && count < 20; frame += 20) {
    const RenderedFrame rendered = renderer.render(frame);
    for (const TrueView& view : true_views(world, seconds_between(Timestamp{}, rendered.timestamp))) {
      constexpr double kLargeEnough_px = 24.0;  // a cell is three pixels then
      if (!view.is_good() || view.shortest_side_px < kLargeEnough_px || view.blur_px > 1.0) continue;
      const auto& c = view.corners_px;
      const Eigen::Vector2d middle = 0.25 * (c[0] + c[1] + c[2] + c[3]);
      for (const Eigen::Vector2d& corner : c) {
        constexpr double kCell = 0.25;  // of the way from the corner to the middle: four cells
        const auto at = [&](double share) {
          const Eigen::Vector2d p = corner + share * (middle - corner);
          return static_cast<int>(
              rendered.pixels(static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y()))));
        };
        EXPECT_GT(at(-0.5 * kCell), at(0.5 * kCell) + 20);
      }
      ++count;
    }
  }
  EXPECT_GE(count, 5);
}

TEST(World, IsTheSameForTheSameSeed) {
  const World first = make_world(3, FaultKind::kNone);
  const World second = make_world(3, FaultKind::kNone);
  EXPECT_EQ(describe(first).dump(), describe(second).dump());
  EXPECT_NE(describe(first).dump(), describe(make_world(5, FaultKind::kNone)).dump());
  const GrayImage a = Renderer(first.scene, {.seed = 3}).render(4).pixels;
  const GrayImage b = Renderer(second.scene, {.seed = 3}).render(4).pixels;
  for (int y = 0; y < a.height(); ++y) ASSERT_TRUE(std::equal(a.row(y), a.row(y) + a.width(), b.row(y)));
}

/// Tags that truth calls visible belong to keys that are there once, at sizes that the user is told.
TEST(World, StatesTheTruthWhereThereIsNoFault) {
  for (const std::uint64_t seed : kSeeds) {
    const World world = make_world(seed, FaultKind::kNone);
    EXPECT_EQ(world.scene.map.tags.size(), world.tags.size());
    for (const PlacedTag& tag : world.tags) EXPECT_EQ(world.stated_sizes_m.at(tag.key), tag.size_m);
    EXPECT_EQ(world.stated_camera.model.pinhole().fx, world.scene.camera.model.pinhole().fx);
    EXPECT_TRUE(world.culprits.empty());
  }
}

const PlacedTag& culprit_of(const World& world) {
  return *std::ranges::find(world.tags, world.culprits.at(0), &PlacedTag::key);
}

Pose moved_between(const World& world, const PlacedTag& tag) {
  const auto at = [&](std::size_t frame) {
    return world.T_world_tag(tag, seconds_between(Timestamp{}, world.scene.timestamp(frame)));
  };
  return at(0).inverse() * at(world.scene.num_frames - 1);
}

TEST(World, IsWrittenWithAllThatProgramsRead) {
  World world = make_world(3, FaultKind::kNone);
  world.scene.num_frames = 2;
  const std::filesystem::path folder = test::temporary_folder();
  write_world(world, folder / "film");
  write_without_pictures(world, folder / "numbers");
  for (const char* name : {"camera.yaml", "map.yaml", "tag_sizes.yaml", "world.json"}) {
    EXPECT_TRUE(std::filesystem::exists(folder / "film" / name)) << name;
    EXPECT_TRUE(std::filesystem::exists(folder / "numbers" / name)) << name;
  }
  EXPECT_TRUE(std::filesystem::exists(folder / "film" / "truth.tum"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder / "film" / "frames"), {}), 2);
}

TEST(PlantedFault, WrongSizeIsStatedOfOneTag) {
  const World world = make_world(9, FaultKind::kWrongSize);
  const double share = world.drawn["fault"]["share"];
  EXPECT_GE(std::abs(share), 0.03);
  int wrong = 0;
  for (const PlacedTag& tag : world.tags) wrong += world.stated_sizes_m.at(tag.key) == tag.size_m ? 0 : 1;
  EXPECT_EQ(wrong, 1);
  EXPECT_NEAR(world.stated_sizes_m.at(culprit_of(world).key), (1.0 + share) * culprit_of(world).size_m,
              1e-12);
}

TEST(PlantedFault, MovedTagIsElsewhereAtTheEnd) {
  int shifted = 0, turned = 0;
  for (const std::uint64_t seed : {9, 17, 21, 37, 41}) {
    const World world = make_world(seed, FaultKind::kMoved);
    const Pose moved = moved_between(world, culprit_of(world));
    EXPECT_NEAR(moved.translation().norm(), world.drawn["fault"]["moved_m"].get<double>(), 1e-9);
    EXPECT_NEAR(moved.translation().z(), 0.0, 1e-9);  // in its own plane
    EXPECT_NEAR(std::abs(moved.log()[5]), std::abs(world.drawn["fault"]["turned_rad"].get<double>()), 1e-9);
    shifted += moved.translation().norm() > 0.0 ? 1 : 0;
    turned += std::abs(moved.log()[5]) > 0.0 ? 1 : 0;
    for (const PlacedTag& tag : world.tags) {
      if (tag.key == world.culprits[0]) continue;
      EXPECT_LT(moved_between(world, tag).log().norm(), 1e-12);
    }
  }
  EXPECT_GT(shifted, 0);
  EXPECT_GT(turned, 0);
}

TEST(PlantedFault, LooseTagSwingsAboutItsPlace) {
  const World world = make_world(9, FaultKind::kLoose);
  const World clean = make_world(9, FaultKind::kNone);
  const PlacedTag& tag = culprit_of(world);
  const Pose rest = clean.T_world_tag(*std::ranges::find(clean.tags, tag.key, &PlacedTag::key), 0.0);
  double sum = 0.0;
  constexpr int kTimes = 2000;
  for (int i = 0; i < kTimes; ++i)
    sum += std::pow((rest.inverse() * world.T_world_tag(tag, 0.05 * i)).log()[3], 2);
  const double swing_rad = world.drawn["fault"]["swing_rad"];
  EXPECT_NEAR(std::sqrt(sum / kTimes), swing_rad, 0.1 * swing_rad);  // two sines of that amplitude
}

TEST(PlantedFault, BentPrintIsRenderedAsStripsAndItsCornersLeaveTheirPlane) {
  const World world = make_world(9, FaultKind::kBent);
  const PlacedTag& tag = culprit_of(world);
  ASSERT_TRUE(tag.bend);
  const double h = 0.5 * tag.size_m;
  EXPECT_GT(std::abs((*tag.bend).at(h, h).z()) + std::abs((*tag.bend).at(-h, h).z()), 0.01 * tag.size_m);
  EXPECT_EQ(std::ranges::count(world.scene.bodies, "bent print", &Body::name), 1);
}

TEST(PlantedFault, DuplicateHangsTwiceUnderOneKey) {
  const World world = make_world(9, FaultKind::kDuplicate);
  std::vector<Eigen::Vector3d> places;
  for (const PlacedTag& tag : world.tags) {
    if (tag.key == world.culprits.at(0)) places.push_back(world.T_world_tag(tag, 0.0).translation());
  }
  ASSERT_EQ(places.size(), 2U);
  EXPECT_GT((places[0] - places[1]).norm(), 0.3);
  EXPECT_EQ(world.scene.map.tags.size(), world.tags.size() - 1);
}

TEST(PlantedFault, CameraFilesTellOtherNumbersThanTheLens) {
  const World focal = make_world(9, FaultKind::kFocalLength);
  const double share = focal.drawn["fault"]["share"];
  EXPECT_NEAR(focal.stated_camera.model.pinhole().fx, (1.0 + share) * focal.scene.camera.model.pinhole().fx,
              1e-9);
  EXPECT_NEAR(focal.stated_camera.model.pinhole().fy, (1.0 + share) * focal.scene.camera.model.pinhole().fy,
              1e-9);
  const World crop = make_world(9, FaultKind::kCameraFile);
  const Pinhole& stated = crop.stated_camera.model.pinhole();
  const Pinhole& true_one = crop.scene.camera.model.pinhole();
  EXPECT_NEAR(std::hypot(stated.cx - true_one.cx, stated.cy - true_one.cy),
              crop.drawn["fault"]["off_px"].get<double>(), 1e-9);
}

TEST(JoinedTags, AreTheLargestPartThatTwoFramesLink) {
  World world;
  world.tags.resize(5);
  const auto frame = [](std::initializer_list<std::size_t> tags) {
    std::vector<TrueView> views;
    for (const std::size_t tag : tags) {
      TrueView view;
      view.tag = tag;
      view.shortest_side_px = 30.0;
      view.visible_fraction = 1.0;
      views.push_back(view);
    }
    return views;
  };
  // 2 and 3 meet in one frame only, and 4 is alone.
  const auto joined = joined_tags(world, {frame({0, 1}), frame({0, 1}), frame({1, 2}), frame({1, 2}),
                                          frame({2, 3}), frame({4}), frame({4})});
  EXPECT_EQ(std::set<std::size_t>(joined.begin(), joined.end()), (std::set<std::size_t>{0, 1, 2}));
}

}  // namespace
}  // namespace apriltrack::worlds
