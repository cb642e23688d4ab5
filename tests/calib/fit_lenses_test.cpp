#include "apriltrack/calib/fit_lenses.h"

#include <gtest/gtest.h>

#include "apriltrack/base/random.h"
#include "synthetic_world.h"

// Lenses by views that no map explains: every picture shows the tags under other names.

namespace apriltrack {
namespace {

const RadtanDistortion kStrong({-0.28, 0.09, 5e-4, -3e-4});

std::vector<FrameDetections> film(const Camera& camera, double sigma_px) {
  const test::SyntheticWorld world = test::make_room(14, 120, camera);
  std::vector<FrameDetections> frames = test::exact_detections(world);
  RandomStream random(43);
  test::add_edge_noise(frames, sigma_px, -0.45, random);
  int turn = 0;
  for (FrameDetections& frame : frames) {
    ++turn;
    for (Detection& detection : frame.detections)
      detection.tag = world.map.tags[static_cast<std::size_t>(detection.tag.id / 2 + turn) % 14].key;
  }
  return frames;
}

std::optional<CameraRig> lens_by(const std::vector<FrameDetections>& frames, const Camera& stated) {
  CameraRig rig;
  rig.cameras = {stated};
  return fit_lenses(frames, rig);
}

TEST(FitLenses, LetsARightFileBe) {
  for (const Camera& camera : {test::perspective_camera(), test::equidistant_camera()}) {
    for (const double sigma_px : {0.02, 0.15, 0.5})
      EXPECT_FALSE(lens_by(film(camera, sigma_px), camera)) << sigma_px;
  }
}

TEST(FitLenses, LetsAFileBeThatIsAboutRight) {
  Camera stated = test::perspective_camera();
  const Pinhole pinhole = stated.model.pinhole();
  stated.model = CameraModel({1.01 * pinhole.fx, 1.01 * pinhole.fy, pinhole.cx + 2.0, pinhole.cy},
                             stated.model.distortion());
  EXPECT_FALSE(lens_by(film(test::perspective_camera(), 0.15), stated));
}

/// What tags and detectors do is no lens.
TEST(FitLenses, LetsARightFileBeThatFilmedBiasedEdges) {
  const Camera camera = test::perspective_camera();
  for (const double bias_px : {0.1, 0.3}) {
    std::vector<FrameDetections> frames = film(camera, 0.1);
    RandomStream random(44);
    test::add_edge_biases(frames, bias_px, -0.45, random);
    EXPECT_FALSE(lens_by(frames, camera)) << bias_px;
  }
}

TEST(FitLenses, SaysNothingOfAFilmAtRest) {
  std::vector<FrameDetections> frames = film(test::perspective_camera(), 0.1);
  frames.resize(1);
  for (std::int64_t i = 1; i < 300; ++i) {
    frames.push_back(frames.front());
    frames.back().timestamp.ns += i * 33'000'000;
  }
  RandomStream random(45);
  test::add_edge_biases(frames, 0.3, -0.45, random);
  test::add_edge_noise(frames, 0.05, -0.45, random);
  EXPECT_FALSE(lens_by(frames, test::perspective_camera()));
}

TEST(FitLenses, SaysNothingOfTooLittle) {
  std::vector<FrameDetections> frames = film(test::perspective_camera(), 0.1);
  Camera stated = test::perspective_camera();
  stated.model = CameraModel({1200.0, 1200.0, 500.0, 400.0}, RadtanDistortion({0.0, 0.0, 0.0, 0.0}));
  EXPECT_TRUE(lens_by(frames, stated));
  frames.resize(1);
  EXPECT_FALSE(lens_by(frames, stated));
  EXPECT_FALSE(lens_by({}, stated));
}

TEST(FitLenses, FindsTheLensWithoutAMap) {
  Camera camera = test::perspective_camera();
  const Pinhole pinhole = camera.model.pinhole();
  camera.model = CameraModel(pinhole, kStrong);
  const std::vector<FrameDetections> frames = film(camera, 0.05);
  for (const double factor : {1.0, 0.5, 2.0}) {
    Camera stated = camera;
    stated.model = CameraModel({factor * pinhole.fx, factor * pinhole.fx, 500.0, 400.0},
                               RadtanDistortion({0.0, 0.0, 0.0, 0.0}));
    const auto rig = lens_by(frames, stated);
    ASSERT_TRUE(rig) << factor;
    const CameraModel& found = rig->cameras.front().model;
    EXPECT_NEAR(found.pinhole().fx / pinhole.fx, 1.0, 0.03) << factor;
    EXPECT_NEAR(found.pinhole().fy / found.pinhole().fx, pinhole.fy / pinhole.fx, 0.01) << factor;
    // By what it does to pixels, not by its numbers, which trade against each other.
    for (const Eigen::Vector2d& px :
         {Eigen::Vector2d(60.0, 60.0), {900.0, 700.0}, {500.0, 60.0}, {700.0, 400.0}}) {
      const auto ray = camera.model.unproject(px);
      ASSERT_TRUE(ray);
      const auto seen = found.unproject(px);
      ASSERT_TRUE(seen);
      const double angle = std::acos(std::min(1.0, ray->normalized().dot(seen->normalized())));
      EXPECT_LT(angle, 0.02) << factor << ", " << px.transpose();  // as of 12 of 1000 pixels
    }
  }
}

}  // namespace
}  // namespace apriltrack
