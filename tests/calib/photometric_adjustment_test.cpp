#include "photometric/photometric_adjustment.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <vector>

#include "apriltrack/base/parallel.h"
#include "apriltrack/tags/tag_family.h"

// Two cameras on a rig and two tags. What a view looks like is tested elsewhere (photometric_view_test.cpp):
// these are painted by the equations themselves.

namespace apriltrack {
namespace {

constexpr double kHalfTag_m = 0.08;
constexpr double kLensBlur_px = 0.5;

Camera camera_named(const std::string& name, double focal_px) {
  return {.name = name,
          .model = CameraModel({focal_px, focal_px, 160.0, 120.0}, NoDistortion{}),
          .width = 320,
          .height = 240};
}

Pose pose_turned(double angle_rad, const Eigen::Vector3d& axis, const Eigen::Vector3d& translation) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, axis.normalized())), translation};
}

/// All pixels that show printed cells alone.
PhotometricView painted_view(const PhotometricScene& scene, const PhotometricState& truth, int tag,
                             int moment, int camera) {
  PhotometricView view{.tag = tag, .moment = moment, .camera = camera};
  const Camera& lens = scene.cameras[static_cast<std::size_t>(camera)];
  const PrintedTag& print = scene.tags[static_cast<std::size_t>(tag)];
  const Pose T_camera_tag = scene.T_camera_rig[static_cast<std::size_t>(camera)] *
                            truth.T_map_rig[static_cast<std::size_t>(moment)].inverse() *
                            truth.T_map_tag[static_cast<std::size_t>(tag)];
  const PlaneBlur blur =
      *plane_blur(lens.model, T_camera_tag, print.half_size_m, {kLensBlur_px, view.streak_px});
  const BlurredPattern picture(print.pattern);
  const Pose T_tag_camera = T_camera_tag.inverse();
  for (int y = 0; y < lens.height; ++y) {
    for (int x = 0; x < lens.width; ++x) {
      const Eigen::Vector2d pixel(x, y);
      const Eigen::Vector3d ray = *lens.model.unproject(pixel);
      const Eigen::Vector3d eye = T_tag_camera.translation(), direction = T_tag_camera.rotation() * ray;
      const Eigen::Vector2d uv = (eye - eye.z() / direction.z() * direction).head<2>() / print.half_size_m;
      if (uv.cwiseAbs().maxCoeff() > print.pattern.half_extent() - 0.12) continue;
      view.rays.push_back(ray.hnormalized());
      view.light.push_back(0.04 + 0.7 * picture.at(uv.x(), uv.y(), blur.pattern).light);
    }
  }
  view.num_coarse = view.light.size();
  return view;
}

struct TwoCameras {
  PhotometricScene scene;
  PhotometricState truth;

  TwoCameras() {
    scene.cameras = {camera_named("left", 400.0), camera_named("right", 430.0)};
    scene.T_camera_rig = {Pose(), pose_turned(0.25, {0.2, 1.0, -0.3}, {-0.15, 0.03, 0.05})};
    for (const int id : {3, 8}) {
      scene.tags.push_back({TagFamily::get("tag36h11").pattern(id), kHalfTag_m});
      truth.lights.emplace_back(scene.tags.back().pattern.half_extent(),
                                scene.tags.back().pattern.cells().width());
    }
    truth.T_map_tag = {pose_turned(0.3, {0.0, 1.0, 0.2}, {-0.17, 0.05, 1.1}),
                       pose_turned(0.5, {1.0, 0.3, 0.5}, {0.16, -0.06, 1.0})};
    truth.T_map_rig = {pose_turned(0.06, {0.3, 1.0, 0.8}, {0.04, -0.02, 0.03})};
    truth.psf_sigma_px = {kLensBlur_px, kLensBlur_px};
    for (const int camera : {0, 1}) {
      for (const int tag : {0, 1}) scene.views.push_back(painted_view(scene, truth, tag, 0, camera));
    }
  }
};

/// The residuals of all views, after a step of the rig or of a tag (-1: none).
std::vector<LinearView> views_after(const TwoCameras& world, int tag, const Vector6d& step) {
  PhotometricAdjustment adjustment(world.scene, world.truth, parallel_for(1));
  Pose& pose =
      tag < 0 ? adjustment.state().T_map_rig[0] : adjustment.state().T_map_tag[static_cast<std::size_t>(tag)];
  pose = pose * Pose::exp(step);
  return adjustment.linear_views();
}

/// At the truth, where residuals are small: their derivatives are those of least squares there.
TEST(PhotometricAdjustment, LinearisesViewsOfSeveralCameras) {
  const TwoCameras world;
  const std::vector<LinearView> views = views_after(world, -1, Vector6d::Zero());
  ASSERT_EQ(views.size(), 4U);
  constexpr double kStep = 3e-6;  // 0.001 px
  for (const int moved : {-1, 0, 1}) {
    std::vector<LinearView::ByPose> numeric(views.size(), LinearView::ByPose::Zero(6, 6));
    for (int k = 0; k < 6; ++k) {
      const auto above = views_after(world, moved, kStep * Vector6d::Unit(k));
      const auto below = views_after(world, moved, -kStep * Vector6d::Unit(k));
      ASSERT_EQ(above.size(), views.size());
      ASSERT_EQ(below.size(), views.size());
      for (std::size_t i = 0; i < views.size(); ++i)
        numeric[i].col(k) = (above[i].residual - below[i].residual) / (2.0 * kStep);
    }
    for (std::size_t i = 0; i < views.size(); ++i) {
      LinearView::ByPose expected = LinearView::ByPose::Zero(6, 6);
      if (moved < 0) expected = views[i].by_rig;
      if (moved == views[i].tag) expected = views[i].by_tag;
      const double size = views[i].by_rig.norm();
      EXPECT_LT((numeric[i] - expected).norm(), 0.03 * size) << "view " << i << ", moved " << moved;
    }
  }
}

/// Tags that nobody saw twice stay, and so does what is held in place of a tag without views.
TEST(PhotometricAdjustment, HoldsWhatIsSeenAndMovesTheRest) {
  TwoCameras world;
  PhotometricState start = world.truth;
  start.T_map_rig.push_back(pose_turned(-0.05, {0.1, 1.0, 0.3}, {-0.03, 0.02, 0.01}));
  world.truth.T_map_rig = start.T_map_rig;
  for (const int tag : {0, 1}) world.scene.views.push_back(painted_view(world.scene, world.truth, tag, 1, 0));
  // One more tag, without a view.
  world.scene.tags.push_back(world.scene.tags.front());
  start.lights.push_back(start.lights.front());
  start.T_map_tag.push_back(pose_turned(0.1, {1.0, 0.0, 0.0}, {0.0, 0.5, 1.0}));
  Vector6d off;
  off << 4e-4, -3e-4, 5e-4, 1e-3, -2e-3, 1e-3;
  start.T_map_tag[1] = start.T_map_tag[1] * Pose::exp(off);
  for (const int held : {2, 0}) {
    PhotometricAdjustment adjustment(world.scene, start, parallel_for(1));
    ASSERT_TRUE(adjustment.run({.held_tag = held}, 30)) << held;
    EXPECT_EQ(adjustment.held_tag(), 0);
    EXPECT_EQ(adjustment.state().T_map_tag[0].matrix(), start.T_map_tag[0].matrix());
    EXPECT_EQ(adjustment.state().T_map_tag[2].matrix(), start.T_map_tag[2].matrix());
    const Vector6d left = (world.truth.T_map_tag[1].inverse() * adjustment.state().T_map_tag[1]).log();
    EXPECT_LT(left.norm(), 0.1 * off.norm());
    EXPECT_EQ(adjustment.linear_views().size(), world.scene.views.size());
  }
}

}  // namespace
}  // namespace apriltrack
