#pragma once

#include <array>
#include <vector>

#include "calibrating.h"

namespace apriltrack::test {

/// Corners as the true world shows them, with noise; and the world as a wrong camera file has it.
struct Filmed {
  SyntheticWorld truth, stated;
  std::vector<FrameDetections> frames;
};

inline Filmed film(const Camera& camera, double sigma_px = 0.1, int num_frames = 120) {
  Filmed result;
  result.truth = test::make_room(14, num_frames, camera);
  result.stated = result.truth;
  result.frames = test::exact_detections(result.truth);
  RandomStream random(41);
  test::add_edge_noise(result.frames, sigma_px, -0.45, random);
  return result;
}

inline void scale_focal_length(Camera& camera, double factor) {
  Pinhole pinhole = camera.model.pinhole();
  pinhole.fx *= factor;
  pinhole.fy *= factor;
  camera.model = CameraModel(pinhole, camera.model.distortion());
}

/// By hand: every edge moves along its normal, corners are where neighbours meet.
inline void move_edges_inward(double inward_px, std::vector<FrameDetections>& frames) {
  for (FrameDetections& frame : frames) {
    for (Detection& detection : frame.detections) {
      auto corners = detection.corners_px;
      std::array<Eigen::Vector2d, 4> normals;
      std::array<double, 4> offsets{};
      const Eigen::Vector2d middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
      for (std::size_t e = 0; e < 4; ++e) {
        const Eigen::Vector2d along = (corners[(e + 1) % 4] - corners[e]).normalized();
        normals[e] = {-along.y(), along.x()};
        if (normals[e].dot(middle - corners[e]) < 0.0) normals[e] = -normals[e];
        offsets[e] = normals[e].dot(corners[e]) + inward_px;
      }
      for (std::size_t c = 0; c < 4; ++c) {
        Eigen::Matrix2d lines;
        lines << normals[c].transpose(), normals[(c + 3) % 4].transpose();
        detection.corners_px[c] = lines.inverse() * Eigen::Vector2d(offsets[c], offsets[(c + 3) % 4]);
      }
    }
  }
}

inline Pose by(double x_m, double y_m, double z_m) {
  return {Eigen::Matrix3d(Eigen::Matrix3d::Identity()), Eigen::Vector3d(x_m, y_m, z_m)};
}

inline Filmed film_with_two_cameras(const Pose& T_cam1_cam0) {
  Filmed filmed;
  filmed.truth = test::make_room(14, 120, test::perspective_camera());
  Camera second = test::perspective_camera("cam1");
  second.T_this_previous = T_cam1_cam0;
  filmed.truth.rig.cameras.push_back(second);
  filmed.frames = test::exact_detections(filmed.truth);
  RandomStream random(42);
  test::add_edge_noise(filmed.frames, 0.1, -0.45, random);
  filmed.stated = filmed.truth;
  return filmed;
}

}  // namespace apriltrack::test
