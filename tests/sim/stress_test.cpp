#include "apriltrack/sim/stress.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "apriltrack/sim/named_scenes.h"
#include "apriltrack/sim/renderer.h"
#include "apriltrack/sim/streaks.h"

namespace apriltrack {
namespace {

struct Codes {
  double mean = 0.0;
  double variance = 0.0;
  int highest = 0;
};

Codes measure_codes(const GrayImage& image) {
  Codes codes;
  double squares = 0.0;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      codes.mean += image(x, y);
      squares += double{1.0} * image(x, y) * image(x, y);
      codes.highest = std::max(codes.highest, int{image(x, y)});
    }
  }
  const double count = 1.0 * image.width() * image.height();
  codes.mean /= count;
  codes.variance = squares / count - codes.mean * codes.mean;
  return codes;
}

/// An even wall, radiance 0.6, that fills the view of a linear camera.
Scene before_even_wall() {
  Scene scene;
  scene.truth = TruthKind::kJoint;
  scene.camera.model = CameraModel(Pinhole{300, 300, 159.5, 119.5}, NoDistortion{});
  scene.camera.width = 320;
  scene.camera.height = 240;
  scene.camera.response = ResponseCurve::linear();
  scene.lighting = {.lamp_world = {0, 0, -1000}, .ambient = 1.0, .intensity = 0.0, .reach_m = 1.0};
  scene.formation.vignetting = 0.0;
  Body wall{.name = "wall",
            .T_world_body = Motion::fixed(Pose(Eigen::Quaterniond::Identity(), {0, 0, 2.0})),
            .panels = {}};
  add_plate(wall, Pose(), {5.0, 5.0}, 0.6);
  scene.bodies = {wall};
  return scene;
}

TEST(Light, AShareOfItLeavesThatShareOfTheElectronsAndTheirNoise) {
  for (const double share : {1.0, 0.1, 0.03}) {
    Scene scene = before_even_wall();
    const double amplification = 1.0 / share;  // so that rounding to 8 bits stays small beside the noise
    scene.formation.sensor_gain *= share;
    scene.formation.amplification = amplification;
    const Codes codes = measure_codes(Renderer(scene).render(2).pixels);
    const double electrons = 9000.0 * 0.85 * 0.6 * share;
    const double code_per_electron = 255.0 * amplification / 9000.0;
    const double variance = (electrons + 81.0) * code_per_electron * code_per_electron + 1.0 / 12.0;
    EXPECT_NEAR(codes.mean, 255.0 * 0.85 * 0.6, 0.1) << share;
    EXPECT_NEAR(codes.variance / variance, 1.0, 0.02) << share;
  }
}

TEST(Light, WithoutAmplificationTheImageIsAsDarkAsItsLight) {
  Scene scene = before_even_wall();
  scene.formation.sensor_gain *= 0.1;
  EXPECT_NEAR(measure_codes(Renderer(scene).render(0).pixels).mean, 25.5 * 0.85 * 0.6, 0.05);
}

TEST(Blackout, IsBlackInItsFramesAndInNoOther) {
  Scene scene = before_even_wall();
  scene.num_frames = 12;
  scene.blackouts = {{2, 3}, {9, 1}};
  const Renderer renderer(scene);
  int num_black = 0;
  for (std::size_t i = 0; i < scene.num_frames; ++i) {
    const RenderedFrame frame = renderer.render(i);
    const Codes codes = measure_codes(frame.pixels);
    const bool is_black = codes.highest <= 2;  // read noise: 0.26 codes
    num_black += is_black ? 1 : 0;
    EXPECT_EQ(is_black, (i >= 2 && i <= 4) || i == 9) << i;
    if (!is_black) {
      EXPECT_NEAR(codes.mean, 130.05, 0.1);
    }
    EXPECT_EQ(frame.light, 1.0) << "no one tells the camera";
  }
  EXPECT_EQ(num_black, 4);
}

/// Share of the picture that is not the wall, in light; the hand's own light is known.
double hidden_px(const Scene& scene, Timestamp time) {
  const Image<float> light = Renderer(scene).radiance(time, 0.0);
  double hidden = 0.0;
  for (int y = 0; y < light.height(); ++y) {
    for (int x = 0; x < light.width(); ++x) hidden += (0.6 - light(x, y)) / (0.6 - 0.42);
  }
  return hidden;
}

TEST(PassingHand, HidesAsMuchAsItsOutlineCovers) {
  constexpr double kShare = 0.3;
  Scene scene = before_even_wall();
  add_passing_hand(scene, kShare);
  ASSERT_EQ(scene.bodies.size(), 2U);
  // In the middle of its way, upright. Drawn here as rectangles in pixels, at 0.25 m and f = 300: the palm is
  // as wide as it is high, above it four fingers, below it a forearm to the image's lower border.
  Motion& motion = scene.bodies[1].T_world_body;
  motion.yaw_rad = {};
  motion.position_m[0] = {};
  const double knuckles_m = motion.position_m[1].offset;
  motion.position_m[1] = {.offset = knuckles_m, .rate_per_s = 0.0, .waves = {}, .bursts = {}};
  const double width_px = kShare * 320.0;
  const double knuckles_px = 119.5 + 300.0 * knuckles_m / 0.25;
  double expected = 0.0;
  for (const double length : {0.70, 0.85, 0.90, 0.80}) expected += 0.19 * width_px * length * width_px;
  const double palm_end_px = knuckles_px + width_px;
  expected += width_px * width_px + 0.7 * width_px * (239.5 - palm_end_px);
  ASSERT_LT(palm_end_px, 239.5);
  ASSERT_GT(knuckles_px - 0.9 * width_px, 0.0);
  EXPECT_NEAR(hidden_px(scene, {0}) / expected, 1.0, 2e-3);
}

TEST(PassingHand, ComesAndGoes) {
  Scene scene = before_even_wall();
  add_passing_hand(scene, 0.3);
  int num_free = 0, num_hidden = 0;
  for (std::int64_t ms = 0; ms < 3000; ms += 100) {
    const double hidden = hidden_px(scene, {1'000'000 * ms});
    num_free += hidden < 1.0 ? 1 : 0;
    num_hidden += hidden > 0.15 * 320 * 240 ? 1 : 0;
  }
  EXPECT_GE(num_free, 8);
  EXPECT_GE(num_hidden, 8);
}

TEST(PassingHand, GoesWithTheCamera) {
  Scene still = before_even_wall();
  add_passing_hand(still, 0.3);
  Scene moving = still;
  moving.T_world_camera = Motion::fixed(Pose(Eigen::Quaterniond::Identity(), {0.3, -0.2, 0.4}));
  const Timestamp time{900'000'000};
  const double hidden = hidden_px(still, time);
  EXPECT_GT(hidden, 1000.0);
  EXPECT_NEAR(hidden_px(moving, time) / hidden, 1.0, 1e-4);
}

TEST(Take, ShakesOtherwiseAlongTheSameWay) {
  const Scene first = make_scene("room", {.texel_m = 0.02});
  Scene second = first;
  vary_motion(second, 7);
  Scene again = first;
  vary_motion(again, 7);
  double furthest_m = 0.0, most_rad = 0.0;
  for (std::size_t i = 0; i < first.num_frames; ++i) {
    const Timestamp time = first.timestamp(i);
    const Pose gap = first.truth_pose(time).inverse() * second.truth_pose(time);
    furthest_m = std::max(furthest_m, gap.translation().norm());
    most_rad = std::max(most_rad, gap.log().tail<3>().norm());
    EXPECT_EQ(second.truth_pose(time).matrix(), again.truth_pose(time).matrix());
  }
  // Twice the amplitudes that may change: position 0.05, 0.04, 0.03 + 0.04 and bursts of 0.14, 0, 0.12 m by
  // axis; yaw 0.14 + 0.38, pitch 0.09 + 0.22, roll 0.07 + 0.25 rad.
  EXPECT_GT(furthest_m, 0.05);
  EXPECT_LT(furthest_m, 2.0 * std::hypot(0.19, 0.04, 0.19));
  EXPECT_GT(most_rad, 0.2);
  EXPECT_LT(most_rad, 2.0 * (0.52 + 0.31 + 0.32));
  const Pose loop =
      second.truth_pose(second.timestamp(0)).inverse() * second.truth_pose(second.timestamp(360));
  EXPECT_LT(loop.log().norm(), 1e-6) << "the path closes still";
}

/// Mean edge of every tag seen, in pixels.
std::vector<double> edges_px(const Scene& scene) {
  std::vector<double> edges;
  for (std::size_t i = 0; i < scene.num_frames; ++i) {
    for (const TagView& view : tag_views(scene, scene.timestamp(i))) {
      double around = 0.0;
      for (std::size_t k = 0; k < 4; ++k)
        around += (view.corners_px[(k + 1) % 4] - view.corners_px[k]).norm();
      edges.push_back(0.25 * around);
    }
  }
  return edges;
}

TEST(SmallTags, Have15To25PixelsAlmostAllAndNoneManyMore) {
  const std::vector<double> edges = edges_px(make_scene("room-small", {.texel_m = 0.02}));
  const auto fits = [](double edge) { return edge >= 15.0 && edge <= 25.0; };
  EXPECT_GT(edges.size(), 700U);
  EXPECT_GE(std::ranges::count_if(edges, fits), std::ssize(edges) * 85 / 100);
  EXPECT_GT(*std::ranges::min_element(edges), 14.0);
  EXPECT_LT(*std::ranges::max_element(edges), 27.0);
}

TEST(Wall, ShowsAllItsTagsAtMostTimesAndAlwaysOne) {
  for (const auto& [name, num_tags] :
       {std::pair("wall", std::size_t{14}), std::pair("wall-one", std::size_t{1})}) {
    const Scene scene = make_scene(name, {.texel_m = 0.02});
    std::size_t num_full = 0, num_blurred = 0;
    for (std::size_t i = 0; i < scene.num_frames; ++i) {
      const std::size_t seen = tag_views(scene, scene.timestamp(i)).size();
      EXPECT_GE(seen, 1U) << name << ' ' << i;
      num_full += seen == num_tags ? 1 : 0;
      num_blurred += frame_blur_px(scene, scene.timestamp(i)).value_or(0.0) > 10.0 ? 1 : 0;
    }
    EXPECT_GE(num_full, scene.num_frames * 6 / 10) << name;
    EXPECT_GE(num_blurred, scene.num_frames * 3 / 10) << name;
  }
}

TEST(Speed, ZeroHoldsTheCameraStill) {
  for (const auto& [name, num_tags] :
       {std::pair("wall", std::size_t{14}), std::pair("wall-one", std::size_t{1})}) {
    Scene scene = make_scene(name, {.speed = 0.0, .texel_m = 0.02});
    scene.formation.noise = 0.0;
    EXPECT_TRUE(scene.T_world_camera.is_fixed());
    EXPECT_EQ(tag_views(scene, scene.timestamp(0)).size(), num_tags);
    const Renderer renderer(scene);
    const RenderedFrame first = renderer.render(0), last = renderer.render(200);
    EXPECT_EQ(first.truth.matrix(), last.truth.matrix());
    int num_differing = 0;
    for (int y = 0; y < first.pixels.height(); ++y) {
      for (int x = 0; x < first.pixels.width(); ++x) num_differing += first.pixels(x, y) != last.pixels(x, y);
    }
    EXPECT_EQ(num_differing, 0);
  }
}

}  // namespace
}  // namespace apriltrack
