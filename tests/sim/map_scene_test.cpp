#include "apriltrack/sim/map_scene.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "apriltrack/geometry/rotation.h"
#include "apriltrack/sim/renderer.h"
#include "apriltrack/sim/streaks.h"
#include "support/error_message.h"

namespace apriltrack::test {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

constexpr double kStep_s = 0.05;

MapTag tag_at(int id, const Vector3d& position, double size_m) {
  MapTag tag;
  tag.key = {"tag36h11", id};
  tag.size_m = size_m;
  tag.T_map_tag = Pose(Eigen::Quaterniond::Identity(), position);
  return tag;
}

/// A camera that looks along +z of the map at two tags in line, the nearer one twice as small in the map.
MapSceneOptions two_tags_in_line() {
  std::vector<SampledPath::Sample> samples;
  for (int i = 0; i < 9; ++i)
    samples.push_back(
        {kStep_s * i, Pose(rotation_exp({0.0, 0.01 * i, 0.0}), Vector3d(0.01 * i, 0.002 * i, 0.0))});
  MapSceneOptions options{.map = {},
                          .camera = {.model = CameraModel(Pinhole{400, 405, 161, 118}, NoDistortion{})},
                          .path = SampledPath(samples)};
  options.camera.width = 320;
  options.camera.height = 240;
  options.map.tags = {tag_at(1, {0.0, 0.0, 1.0}, 0.1), tag_at(2, {0.0, 0.0, 2.0}, 0.1)};
  return options;
}

TEST(MapScene, HasTheTruthOfItsPath) {
  const MapSceneOptions options = two_tags_in_line();
  const Scene scene = make_map_scene(options);
  EXPECT_NEAR(scene.rate_hz, 1.0 / kStep_s, 1e-9);
  EXPECT_EQ(scene.exposure_s, 0.016);
  EXPECT_EQ(scene.num_frames, 8u);  // (0.4 s - 0.016 s) at 20 Hz, and the first
  const Timestamp last = scene.timestamp(scene.num_frames - 1);
  EXPECT_EQ(scene.timestamp(0).ns, 8'000'000);
  EXPECT_EQ(last.ns, 358'000'000);
  const Pose error = options.path.at(0.358).inverse() * scene.truth_pose(last);
  EXPECT_LT(error.translation().norm() + rotation_log(error.rotation()).norm(), 1e-12);
}

TEST(MapScene, OfABodyHasItsPathBeforeTheCamera) {
  MapSceneOptions options = two_tags_in_line();
  options.truth = TruthKind::kJoint;
  options.speed = 2.0;
  const Scene scene = make_map_scene(options);
  EXPECT_EQ(scene.num_frames, 4u);  // (0.2 s - 0.016 s) at 20 Hz, and the first
  const Timestamp time = scene.timestamp(2);
  const Pose error = options.path.at(2.0 * 0.108).inverse() * scene.truth_pose(time);
  EXPECT_LT(error.translation().norm() + rotation_log(error.rotation()).norm(), 1e-12);
  EXPECT_LT((scene.T_camera_map(0.108).translation() - options.path.at(0.216).translation()).norm(), 1e-12);
}

TEST(MapScene, TakesExposureAndResponseOfTheCamera) {
  MapSceneOptions options = two_tags_in_line();
  options.camera.exposure_s = 0.004;
  options.camera.response = ResponseCurve::linear();
  const Scene scene = make_map_scene(options);
  EXPECT_EQ(scene.exposure_s, 0.004);
  EXPECT_EQ(scene.camera.response.name(), "linear");
  EXPECT_EQ(scene.timestamp(0).ns, 2'000'000);
}

TEST(MapScene, ShowsTheNearerOfTwoTagsWhicheverIsListedFirst) {
  for (const bool is_nearer_first : {true, false}) {
    MapSceneOptions options = two_tags_in_line();
    options.map.tags[0].size_m = 0.2;  // hides the other one wholly
    if (!is_nearer_first) std::swap(options.map.tags[0], options.map.tags[1]);
    const Scene scene = make_map_scene(options);
    const Image<float> seen = Renderer(scene).radiance({100'000'000}, 0.0);
    Scene alone = scene;  // in the same room, by the same light
    std::erase_if(alone.bodies, [](const Body& body) { return body.name == "tag36h11/2"; });
    ASSERT_EQ(alone.bodies.size() + 1, scene.bodies.size());
    const Image<float> expected = Renderer(alone).radiance({100'000'000}, 0.0);
    const auto pixel = scene.camera.model.project(scene.T_camera_map(0.1) * Vector3d(0.0, 0.0, 1.0));
    ASSERT_TRUE(pixel);
    double least = 1e9, greatest = 0.0;
    for (int y = -35; y <= 35; y += 5) {  // of a print some 80 px wide
      for (int x = -35; x <= 35; x += 5) {
        const int u = static_cast<int>(pixel->x()) + x;
        const int v = static_cast<int>(pixel->y()) + y;
        EXPECT_EQ(seen.row(v)[u], expected.row(v)[u]) << u << " " << v;
        least = std::min<double>(least, seen.row(v)[u]);
        greatest = std::max<double>(greatest, seen.row(v)[u]);
      }
    }
    EXPECT_GT(greatest, 8.0 * least);  // ink and paper are seen
  }
}

TEST(MapScene, RefusesAPathShorterThanAnExposure) {
  MapSceneOptions options = two_tags_in_line();
  Scene scene = make_map_scene(options);
  scene.exposure_s = 0.5;
  EXPECT_THAT(message_of([&] { fit_to_path(scene); }),
              HasSubstr("takes 0.4 s at this speed, less than one exposure"));
}

}  // namespace
}  // namespace apriltrack::test
