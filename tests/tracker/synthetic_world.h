#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <vector>

#include "apriltrack/base/random.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detection.h"
#include "apriltrack/geometry/rotation.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack::test {

inline constexpr double kTagSize_m = 0.16;
inline constexpr double kDegree = std::numbers::pi / 180.0;

inline Camera camera_with(const Distortion& distortion) {
  Camera camera{.model = CameraModel({520.6, 519.4, 322.4, 237.3}, distortion)};
  camera.width = 640;
  camera.height = 480;
  camera.exposure_s = 0.0;  // corners without blur
  return camera;
}

inline Camera radtan() {
  return camera_with(RadtanDistortion({-0.28, 0.09, 0.0005, -0.0003}));
}

inline MapTag tag_at(int id, const Pose& T_map_tag) {
  MapTag tag;
  tag.key = {"tag36h11", id};
  tag.size_m = kTagSize_m;
  tag.T_map_tag = T_map_tag;
  return tag;
}

/// Seven tags on three surfaces, all of them before a camera at the origin that looks along the map's z axis.
inline TagMap room() {
  TagMap map;
  const auto turned = [](double x_rad, double y_rad, double z_rad) {
    return rotation_exp({x_rad, y_rad, z_rad});
  };
  map.tags = {tag_at(0, {turned(0, 0, 0), {-0.5, -0.3, 2.2}}),
              tag_at(1, {turned(0, 0, 0.3), {0.1, -0.25, 2.2}}),
              tag_at(2, {turned(0, 0.7, 0), {0.8, -0.2, 2.0}}),
              tag_at(3, {turned(0, -0.7, 0.1), {-0.8, 0.3, 1.8}}),
              tag_at(4, {turned(-0.8, 0, 0), {0.0, 0.5, 1.7}}),
              tag_at(5, {turned(-0.8, 0, 1.0), {0.5, 0.45, 1.9}}),
              tag_at(6, {turned(0, 0.2, -0.4), {-0.15, 0.05, 2.2}})};
  return map;
}

/// Exact corners of the given tags, by their definition: T_camera_map * T_map_tag * corner, then the lens.
inline FrameDetections seen(const Camera& camera, const TagMap& map, const Pose& T_camera_map,
                            Timestamp time = {1'000'000'000}) {
  FrameDetections frame;
  frame.timestamp = time;
  const double h = 0.5 * kTagSize_m;
  const std::array<Eigen::Vector3d, 4> corners = {Eigen::Vector3d(-h, h, 0), Eigen::Vector3d(h, h, 0),
                                                  Eigen::Vector3d(h, -h, 0), Eigen::Vector3d(-h, -h, 0)};
  for (const MapTag& tag : map.tags) {
    Detection detection{.tag = tag.key, .corners_px = {}, .hamming = 0, .decision_margin = 100.0};
    bool is_seen = true;
    for (std::size_t i = 0; i < 4; ++i) {
      const auto pixel = camera.model.project(T_camera_map * (tag.T_map_tag * corners[i]));
      is_seen = is_seen && pixel.has_value();
      if (pixel) detection.corners_px[i] = *pixel;
    }
    if (is_seen) frame.detections.push_back(detection);
  }
  return frame;
}

inline FrameDetections with_noise(FrameDetections frame, RandomStream& random, double sigma_px) {
  for (Detection& detection : frame.detections) {
    for (Eigen::Vector2d& corner : detection.corners_px) {
      const double y = random.normal();  // in this order on all compilers
      corner += sigma_px * Eigen::Vector2d(random.normal(), y);
    }
  }
  return frame;
}

/// A camera near the map's origin, looking at the tags.
inline Pose random_T_map_camera(RandomStream& random) {
  Vector6d xi;
  for (int i = 0; i < 3; ++i) xi(i) = random.uniform(-0.25, 0.25);
  for (int i = 3; i < 6; ++i) xi(i) = random.uniform(-0.12, 0.12);
  return Pose::exp(xi);
}

inline TagMap only(const TagMap& map, std::initializer_list<int> ids) {
  TagMap part = map;
  std::erase_if(part.tags, [&](const MapTag& tag) {
    return std::find(ids.begin(), ids.end(), tag.key.id) == ids.end();
  });
  return part;
}

}  // namespace apriltrack::test
