#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <numeric>

#include "apriltrack/sim/named_scenes.h"
#include "apriltrack/sim/renderer.h"
#include "apriltrack/sim/streaks.h"
#include "apriltrack/tracker/localizer.h"

// Pictures with true motion blur, of scenes and seeds that no constant was fitted to.

namespace apriltrack {
namespace {

struct SceneFilm {
  const char* name;
  const char* scene;
  double speed;
  std::size_t first_frame;
  std::uint64_t seed;
};

void PrintTo(const SceneFilm& film, std::ostream* out) {
  *out << film.name;
}

struct Judged {
  std::vector<double> nees_over_6;
  double longest_blur_px = 0.0;
};

Judged localise(const SceneFilm& film, std::size_t num_frames) {
  const Scene scene = make_scene(film.scene, {.speed = film.speed, .texel_m = 0.02});
  const Renderer renderer(scene, {.seed = film.seed});
  LocalizerOptions options;
  options.mode = scene.truth == TruthKind::kEgo ? TrackMode::kEgo : TrackMode::kJoint;
  Localizer localizer(scene.camera, scene.map, options);
  Judged judged;
  for (std::size_t i = 0; i < num_frames; ++i) {
    const RenderedFrame rendered = renderer.render(film.first_frame + i);
    const TrackResult result = localizer.localize(rendered.frame());
    if (!result.pose) continue;
    judged.longest_blur_px =
        std::max(judged.longest_blur_px, frame_blur_px(scene, rendered.timestamp).value_or(0.0));
    const Vector6d xi = (result.pose->inverse() * rendered.truth).log();
    judged.nees_over_6.push_back(xi.dot(result.covariance->llt().solve(xi)) / 6.0);
  }
  return judged;
}

class SimulatedFilm : public testing::TestWithParam<SceneFilm> {};
INSTANTIATE_TEST_SUITE_P(Films, SimulatedFilm,
                         testing::Values(SceneFilm{"Room", "room", 1.0, 60, 612},
                                         SceneFilm{"Bundle", "bundle", 1.0, 40, 613}),
                         [](const auto& film) { return film.param.name; });

TEST_P(SimulatedFilm, CovarianceIsTheScatterUnderBlur) {
  const Judged judged = localise(GetParam(), 30);
  ASSERT_GE(judged.nees_over_6.size(), 14U);
  EXPECT_GT(judged.longest_blur_px, 8.0) << "no test of blur";
  const double mean = std::accumulate(judged.nees_over_6.begin(), judged.nees_over_6.end(), 0.0) /
                      static_cast<double>(judged.nees_over_6.size());
  // Measured: 0.49 and 1.1. Light in the room is even over each tag, and uneven light is counted.
  EXPECT_GT(mean, 0.4);
  EXPECT_LT(mean, 2.0);
}

}  // namespace
}  // namespace apriltrack
