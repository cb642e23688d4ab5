#include "synthetic_world.h"

#include <Eigen/LU>
#include <cmath>
#include <map>

#include "apriltrack/base/check.h"

namespace apriltrack::test {
namespace {

constexpr double kMaxViewAngle_rad = 75.0 * std::numbers::pi / 180.0;
constexpr double kMargin_px = 5.0;

MapTag make_tag(int id, double size_m, const Pose& T_map_tag) {
  MapTag tag;
  tag.key.id = id;
  tag.size_m = size_m;
  tag.T_map_tag = T_map_tag;
  return tag;
}

bool is_inside(const Eigen::Vector2d& pixel) {
  return pixel.x() > kMargin_px && pixel.y() > kMargin_px && pixel.x() < kImageWidth - kMargin_px &&
         pixel.y() < kImageHeight - kMargin_px;
}

bool faces(const Pose& T_camera_tag) {
  const Eigen::Vector3d normal = T_camera_tag.rotation() * Eigen::Vector3d::UnitZ();  // into the tag
  return normal.dot(T_camera_tag.translation().normalized()) > std::cos(kMaxViewAngle_rad);
}

std::optional<Detection> project_tag(const MapTag& tag, const Pose& T_camera_world,
                                     const CameraModel& model) {
  const Pose T_camera_tag = T_camera_world * tag.T_map_tag;
  if (!faces(T_camera_tag)) return std::nullopt;
  Detection detection;
  detection.tag = tag.key;
  const auto corners = tag_corners(tag.size_m);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto pixel = model.project(T_camera_tag * corners[i]);
    if (!pixel || !is_inside(*pixel)) return std::nullopt;
    detection.corners_px[i] = *pixel;
  }
  return detection;
}

}  // namespace

TagSizes SyntheticWorld::sizes() const {
  TagSizes sizes;
  for (const MapTag& tag : map.tags) sizes.set(tag.key, tag.size_m);
  return sizes;
}

Camera perspective_camera(const std::string& name) {
  Camera camera{
      .name = name,
      .model = CameraModel({600.0, 598.0, 503.0, 396.0}, RadtanDistortion({-0.1, 0.03, 4e-4, -3e-4}))};
  camera.width = kImageWidth;
  camera.height = kImageHeight;
  return camera;
}

Camera equidistant_camera(const std::string& name) {
  Camera camera{.name = name,
                .model = CameraModel({330.0, 331.0, 498.0, 402.0},
                                     EquidistantDistortion({-0.018, 0.004, -0.003, 0.0007}))};
  camera.width = kImageWidth;
  camera.height = kImageHeight;
  return camera;
}

Pose looking_along(const Eigen::Vector3d& position, const Eigen::Vector3d& forward, double roll_rad) {
  const Eigen::Vector3d z = forward.normalized();
  const Eigen::Vector3d up = std::abs(z.z()) > 0.99 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitZ();
  Eigen::Matrix3d R;
  R.col(2) = z;
  R.col(0) = z.cross(up).normalized();
  R.col(1) = z.cross(R.col(0));
  return {R * Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix(), position};
}

SyntheticWorld make_room(int num_tags, int num_frames, const Camera& camera) {
  SyntheticWorld world;
  RandomStream random(71, static_cast<std::uint64_t>(num_tags));
  for (int i = 0; i < num_tags; ++i) {
    // Along the walls' 18 m circumference, at two heights, hung a little askew.
    const double along_m = 18.0 * (i + 0.3 * random.uniform()) / num_tags;
    const double height_m = 1.2 + 0.8 * (i % 2) + 0.1 * random.normal();
    Eigen::Vector3d position, outward;
    if (along_m < 5.0) {
      position = {along_m, 0.0, height_m}, outward = {0.0, -1.0, 0.0};
    } else if (along_m < 9.0) {
      position = {5.0, along_m - 5.0, height_m}, outward = {1.0, 0.0, 0.0};
    } else if (along_m < 14.0) {
      position = {14.0 - along_m, 4.0, height_m}, outward = {0.0, 1.0, 0.0};
    } else {
      position = {0.0, 18.0 - along_m, height_m}, outward = {-1.0, 0.0, 0.0};
    }
    outward += 0.05 * Eigen::Vector3d{random.normal(), random.normal(), random.normal()};
    world.map.tags.push_back(make_tag(3 + 2 * i, i % 3 == 0 ? 0.2 : 0.16,
                                      looking_along(position, outward, 0.1 * random.normal())));
  }
  world.rig.cameras.push_back(camera);
  for (int k = 0; k < num_frames; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / num_frames;
    const Eigen::Vector3d position(2.5 + 0.9 * std::cos(angle), 2.0 + 0.7 * std::sin(angle),
                                   1.5 + 0.3 * std::sin(3 * angle));
    const double gaze = 2.0 * angle + 2.6;
    world.T_world_rig.push_back(looking_along(
        position, {std::cos(gaze), std::sin(gaze), 0.15 * std::cos(5 * angle)}, 0.2 * std::sin(2 * angle)));
  }
  return world;
}

SyntheticWorld make_facing_walls() {
  SyntheticWorld world;
  world.map.tags.push_back(make_tag(1, 0.2, looking_along({2.0, 0.0, 0.5}, {1.0, 0.0, 0.0})));
  world.map.tags.push_back(make_tag(2, 0.2, looking_along({-2.0, 0.0, 0.5}, {-1.0, 0.0, 0.0})));
  world.map.tags.push_back(make_tag(3, 0.2, looking_along({0.0, 0.0, 0.0}, {0.0, 0.0, -1.0})));
  world.rig.cameras.push_back(equidistant_camera());
  for (int k = 0; k < 16; ++k) {
    const double side = 0.6 * std::cos(0.9 * k);
    world.T_world_rig.push_back(
        looking_along({side, 0.4 * std::sin(0.7 * k), 1.4 + 0.2 * std::sin(1.3 * k)},
                      {0.8 * (k % 2 == 0 ? 1.0 : -1.0) - 0.3 * side, 0.1 * std::cos(k), -1.0}));
  }
  return world;
}

std::vector<FrameDetections> exact_detections(const SyntheticWorld& world) {
  std::vector<FrameDetections> frames;
  for (std::size_t k = 0; k < world.T_world_rig.size(); ++k) {
    for (std::size_t c = 0; c < world.rig.cameras.size(); ++c) {
      const Camera& camera = world.rig.cameras[c];
      FrameDetections frame{
          .timestamp = {static_cast<std::int64_t>(k) * 50'000'000}, .camera = camera.name, .detections = {}};
      const Pose T_camera_world =
          (c == 0 ? Pose() : world.rig.T_camera_rig(c)) * world.T_world_rig[k].inverse();
      for (const MapTag& tag : world.map.tags) {
        if (auto detection = project_tag(tag, T_camera_world, camera.model))
          frame.detections.push_back(*detection);
      }
      frames.push_back(std::move(frame));
    }
  }
  return frames;
}

void add_noise(std::vector<FrameDetections>& frames, double sigma_px, RandomStream& random) {
  for (FrameDetections& frame : frames) {
    for (Detection& detection : frame.detections) {
      for (Eigen::Vector2d& corner : detection.corners_px)
        corner += sigma_px * Eigen::Vector2d{random.normal(), random.normal()};
    }
  }
}

namespace {

/// Of the edge that starts at each corner: the errors normal to it at its start and at its end.
using EdgeEndErrors = std::array<Eigen::Vector2d, 4>;

EdgeEndErrors draw_edge_errors(double sigma_px, double end_correlation, RandomStream& random) {
  EdgeEndErrors errors;
  for (Eigen::Vector2d& ends : errors) {
    const double first = random.normal();
    const double second =
        end_correlation * first + std::sqrt(1.0 - end_correlation * end_correlation) * random.normal();
    ends = sigma_px * Eigen::Vector2d(first, second);
  }
  return errors;
}

void displace_edges(const EdgeEndErrors& errors, std::array<Eigen::Vector2d, 4>& corners_px) {
  std::array<Eigen::Vector2d, 4> normals;  // of the edge that starts at each corner
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d along = (corners_px[(i + 1) % 4] - corners_px[i]).normalized();
    normals[i] = {-along.y(), along.x()};
  }
  for (std::size_t i = 0; i < 4; ++i) {  // a corner lies on its two displaced edges
    const std::size_t before = (i + 3) % 4;
    Eigen::Matrix2d N;
    N.row(0) = normals[before].transpose();
    N.row(1) = normals[i].transpose();
    corners_px[i] += N.inverse() * Eigen::Vector2d(errors[before][1], errors[i][0]);
  }
}

}  // namespace

void add_edge_noise(std::vector<FrameDetections>& frames, double sigma_px, double end_correlation,
                    RandomStream& random) {
  for (FrameDetections& frame : frames) {
    for (Detection& detection : frame.detections)
      displace_edges(draw_edge_errors(sigma_px, end_correlation, random), detection.corners_px);
  }
}

void add_edge_biases(std::vector<FrameDetections>& frames, double sigma_px, double end_correlation,
                     RandomStream& random) {
  std::map<TagKey, EdgeEndErrors> errors;
  for (FrameDetections& frame : frames) {
    for (Detection& detection : frame.detections) {
      const auto [own, is_new] = errors.try_emplace(detection.tag);
      if (is_new) own->second = draw_edge_errors(sigma_px, end_correlation, random);
      displace_edges(own->second, detection.corners_px);
    }
  }
}

void add_tag(SyntheticWorld& world, double size_m, const Pose& T_map_tag) {
  world.map.tags.push_back(make_tag(static_cast<int>(world.map.tags.size()), size_m, T_map_tag));
}

Pose T_origin_tag(const TagMap& truth, const TagKey& origin, const TagKey& tag) {
  const MapTag* a = truth.find(origin);
  const MapTag* b = truth.find(tag);
  APRILTRACK_CHECK(a != nullptr && b != nullptr, "the world has both tags");
  return a->T_map_tag.inverse() * b->T_map_tag;
}

}  // namespace apriltrack::test
