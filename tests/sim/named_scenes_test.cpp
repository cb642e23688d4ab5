#include "apriltrack/sim/named_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "apriltrack/base/error.h"
#include "apriltrack/base/parallel.h"
#include "apriltrack/sim/renderer.h"
#include "apriltrack/sim/streaks.h"
#include "apriltrack/tags/tag_corners.h"

namespace apriltrack {
namespace {

constexpr double kCoarseTexel_m = 0.02;

struct Seen {
  int num_frames = 0;
  int num_with_tags = 0;
  int num_over_10_px = 0;
  double max_px = 0.0;
  std::set<int> ids;
};

/// Blur as the scorer of the recordings has it: twice the way of a corner to the end of the exposure, the
/// motion taken from this frame's and the next one's truth alone.
double blur_from_truth_px(const Scene& scene, const TagView& view, std::size_t index) {
  const Timestamp now = scene.timestamp(index);
  const Timestamp next = scene.timestamp(index + 1);
  const Pose end = interpolate(scene.truth_pose(now), scene.truth_pose(next),
                               0.5 * scene.exposure_s / seconds_between(now, next));
  const Pose T_camera_map = scene.truth == TruthKind::kEgo ? end.inverse() : end;
  const auto corners = corners_in_map(*scene.map.find(view.key));
  double longest = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto pixel = scene.camera.model.project(T_camera_map * corners[i]);
    if (pixel) longest = std::max(longest, 2.0 * (*pixel - view.corners_px[i]).norm());
  }
  return longest;
}

Seen look(const Scene& scene) {
  Seen seen;
  for (std::size_t i = 0; i < scene.num_frames; ++i) {
    const auto views = tag_views(scene, scene.timestamp(i));
    double blur = 0.0;
    for (const TagView& view : views) {
      seen.ids.insert(view.key.id);
      blur = std::max(blur, blur_from_truth_px(scene, view, i));
    }
    ++seen.num_frames;
    seen.num_with_tags += views.empty() ? 0 : 1;
    seen.num_over_10_px += blur > 10.0 ? 1 : 0;
    seen.max_px = std::max(seen.max_px, blur);
  }
  return seen;
}

TEST(NamedScenes, RoomIsBlurredAsPromised) {
  const Scene scene = make_scene("room", {.texel_m = kCoarseTexel_m});
  const Seen seen = look(scene);
  EXPECT_EQ(scene.map.tags.size(), 14U);
  for (const MapTag& tag : scene.map.tags) EXPECT_EQ(tag.size_m, 0.16);
  EXPECT_EQ(scene.camera.width, 640);
  EXPECT_EQ(seen.num_frames, 360);
  EXPECT_GE(seen.num_with_tags, 350);
  EXPECT_GE(seen.num_over_10_px, 0.40 * seen.num_frames);
  EXPECT_GT(seen.max_px, 50.0);
  EXPECT_LT(seen.max_px, 90.0);
}

TEST(NamedScenes, RoomGentleSeesEveryTagSharply) {
  const Scene scene = make_scene("room-gentle", {.texel_m = kCoarseTexel_m});
  const Seen seen = look(scene);
  EXPECT_EQ(seen.ids.size(), 14U);
  EXPECT_EQ(seen.num_with_tags, 300);
  EXPECT_LT(seen.max_px, 2.0);
  // The loop is closed: the frame after the last would be the first again.
  const Pose gap = scene.truth_pose(scene.timestamp(0)).inverse() * scene.truth_pose(scene.timestamp(300));
  EXPECT_LT(gap.log().norm(), 1e-6);
  const Scene violent = make_scene("room", {.texel_m = kCoarseTexel_m});
  for (std::size_t i = 0; i < 14; ++i) {
    EXPECT_EQ(scene.map.tags[i].T_map_tag.matrix(), violent.map.tags[i].T_map_tag.matrix());
  }
}

TEST(NamedScenes, BundleAndSingleAreBlurredAndShowTheirTags) {
  const Seen bundle = look(make_scene("bundle", {.texel_m = kCoarseTexel_m}));
  EXPECT_EQ(bundle.ids.size(), 6U);
  EXPECT_GE(bundle.num_with_tags, 290);
  EXPECT_GE(bundle.num_over_10_px, 0.3 * bundle.num_frames);
  const Seen single = look(make_scene("single", {.texel_m = kCoarseTexel_m}));
  EXPECT_EQ(single.num_with_tags, single.num_frames);
  EXPECT_GE(single.num_over_10_px, 0.3 * single.num_frames);
}

TEST(NamedScenes, SpeedGoesFasterAlongTheSamePath) {
  const Scene slow = make_scene("bundle", {.texel_m = kCoarseTexel_m});
  const Scene fast = make_scene("bundle", {.speed = 3.0, .texel_m = kCoarseTexel_m});
  const Pose gap = slow.truth_pose({1'500'000'000}).inverse() * fast.truth_pose({500'000'000});
  EXPECT_LT(gap.log().norm(), 1e-12);
}

TEST(NamedScenes, UnknownNameListsTheKnownOnes) {
  try {
    make_scene("attic");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInvalidInput);
    for (const SceneName& scene : named_scenes()) {
      EXPECT_NE(std::string(error.what()).find(scene.name), std::string::npos) << scene.name;
    }
  }
}

double rms_difference(const GrayImage& a, const GrayImage& b) {
  double sum = 0.0;
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) sum += std::pow(double{1.0} * a(x, y) - b(x, y), 2);
  }
  return std::sqrt(sum / a.width() / a.height());
}

std::size_t most_blurred_frame(const Scene& scene) {
  std::size_t worst = 0;
  double longest = 0.0;
  for (std::size_t i = 0; i < scene.num_frames; ++i) {
    const double blur = frame_blur_px(scene, scene.timestamp(i)).value_or(0.0);
    if (blur > longest) worst = i;
    longest = std::max(longest, blur);
  }
  return worst;
}

TEST(NamedScenes, TwiceAsManyInstantsChangeLittle) {
  constexpr double kMaxChange_grey = 0.5;
  for (const SceneName& name : named_scenes()) {
    Scene scene = make_scene(name.name);
    scene.formation.noise = 0.0;
    const Renderer once(scene);
    const Renderer twice(scene, {.instants_factor = 2});
    for (const std::size_t index : {most_blurred_frame(scene), std::size_t{47}, std::size_t{200}}) {
      const RenderedFrame a = once.render(index);
      const RenderedFrame b = twice.render(index);
      EXPECT_EQ(b.num_instants, 2 * a.num_instants);
      EXPECT_LT(rms_difference(a.pixels, b.pixels), kMaxChange_grey) << name.name << " frame " << index;
    }
  }
}

TEST(NamedScenes, FramesDoNotDependOnThreads) {
  Scene scene = make_scene("room", {.texel_m = kCoarseTexel_m});
  const Renderer renderer(scene, {.seed = 5});
  constexpr std::size_t kFrames = 4;
  std::array<RenderedFrame, kFrames> serial, threaded;
  parallel_for(1)(kFrames, [&](std::size_t i) { serial[i] = renderer.render(i); });
  parallel_for(2)(kFrames, [&](std::size_t i) { threaded[i] = renderer.render(i); });
  for (std::size_t i = 0; i < kFrames; ++i) {
    EXPECT_EQ(rms_difference(serial[i].pixels, threaded[i].pixels), 0.0);
    EXPECT_EQ(serial[i].timestamp, threaded[i].timestamp);
  }
  const Renderer other(scene, {.seed = 6});
  EXPECT_GT(rms_difference(serial[0].pixels, other.render(0).pixels), 0.5);
}

/// Black must be where the truth says: read the tag's cells off the picture.
TEST(NamedScenes, TagsStandWhereTheTruthSays) {
  int num_cells = 0;
  for (const char* name : {"room-gentle", "single"}) {
    Scene scene = make_scene(name, {.texel_m = kCoarseTexel_m});
    scene.formation.noise = 0.0;
    const Timestamp time = scene.timestamp(30);
    const Image<float> light = Renderer(scene).sensor_light(time, 0.0);
    for (const TagView& view : tag_views(scene, time)) {
      if ((view.corners_px[0] - view.corners_px[1]).norm() < 40.0) continue;
      const MapTag& tag = *scene.map.find(view.key);
      const TagPattern pattern = TagFamily::get(tag.key.family).pattern(tag.key.id);
      const auto light_at = [&](double u, double v) -> std::optional<double> {
        const Eigen::Vector3d point =
            tag.T_map_tag * Eigen::Vector3d(0.5 * tag.size_m * u, 0.5 * tag.size_m * v, 0.0);
        const auto pixel =
            scene.camera.model.project(scene.T_camera_map(seconds_between(Timestamp{}, time)) * point);
        const int x = static_cast<int>(std::lround((*pixel).x()));
        const int y = static_cast<int>(std::lround((*pixel).y()));
        if (!light.view().contains(x, y)) return std::nullopt;
        return light(x, y);
      };
      const auto black = light_at(0.875, 0.0);
      const auto white = light_at(1.125, 0.0);
      if (!black || !white) continue;
      for (int row = 0; row < 10; ++row) {
        for (int column = 0; column < 10; ++column) {
          const double u = (column - 4.5) / 4.0;
          const double v = (row - 4.5) / 4.0;
          const auto seen = light_at(u, v);
          if (!seen) continue;
          EXPECT_EQ(*seen > 0.5 * (*black + *white), pattern.brightness(u, v) > 0.5)
              << view.key.id << ' ' << u << ' ' << v;
          ++num_cells;
        }
      }
    }
  }
  EXPECT_GE(num_cells, 100);
}

}  // namespace
}  // namespace apriltrack
