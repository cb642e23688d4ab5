// How far the detector's corners are from exact truth, one line a detection, for bench/corners to judge.
//
//   bench_corner_errors [--no-lens] rendered FIRST_SEED NUM_PICTURES    tags seen in random ways, rendered
//   bench_corner_errors [--no-lens] RECORDING...                       folders with truth.tum and map.yaml
//
// --no-lens: the detector is not told the camera. Columns: see kHeader; errors are found less true, px.

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/base/error.h"
#include "apriltrack/base/random.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detector.h"
#include "apriltrack/eval/trajectory.h"
#include "apriltrack/sim/renderer.h"
#include "apriltrack/source/frame_source.h"
#include "apriltrack/tags/tag_family.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack {
namespace {

constexpr const char* kHeader =
    "source,picture,family,id,is_found,side_px,cell_px,angle_deg,blur_px,lens_sigma_px,"
    "e0x,e0y,e1x,e1y,e2x,e2y,e3x,e3y,along_tilt_px,across_tilt_px,nees_over_8,sigma_px,seconds";
/// A detection further off than this, and than half an edge, is of something else.
constexpr double kWrongPlace_px = 15.0;

using Corners = std::array<Eigen::Vector2d, kNumCorners>;
using std::numbers::pi;

/// How a tag is truly seen.
struct TrueView {
  TagKey tag;
  Corners corners_px;
  double side_px = 0.0;
  double cell_px = 0.0;  ///< The lesser width of a cell at the tag's middle.
  double angle_deg = 0.0;
  Eigen::Vector2d tilt = Eigen::Vector2d::Zero();  ///< Unit, image: along it the tag looks shortest.
};

std::optional<TrueView> true_view(const Camera& camera, const Pose& T_camera_map, const MapTag& tag) {
  TrueView view;
  view.tag = tag.key;
  const Pose T_camera_tag = T_camera_map * tag.T_map_tag;
  for (std::size_t k = 0; k < kNumCorners; ++k) {
    const auto pixel = camera.model.project(T_camera_map * corners_in_map(tag)[k]);
    if (!pixel) return std::nullopt;
    view.corners_px[k] = *pixel;
  }
  for (std::size_t k = 0; k < kNumCorners; ++k)
    view.side_px += (view.corners_px[(k + 1) % kNumCorners] - view.corners_px[k]).norm() / kNumCorners;
  Eigen::Matrix<double, 2, 3> by_point;
  if (!camera.model.project(T_camera_tag.translation(), &by_point)) return std::nullopt;
  const Eigen::Matrix2d by_plane = by_point * T_camera_tag.rotation_matrix().leftCols<2>();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(by_plane * by_plane.transpose());
  view.tilt = axes.eigenvectors().col(0);
  view.cell_px = std::sqrt(std::max(0.0, axes.eigenvalues()[0])) * tag.size_m /
                 TagFamily::get(tag.key.family).width_at_border();
  const double cosine = T_camera_tag.rotation_matrix().col(2).dot(T_camera_tag.translation().normalized());
  view.angle_deg = std::acos(std::clamp(cosine, -1.0, 1.0)) * 180.0 / pi;
  return view;
}

/// The detection of the tag that is truly there.
const Detection* find(const std::vector<Detection>& detections, const TrueView& view) {
  const double edge = (view.corners_px[1] - view.corners_px[0]).norm();
  for (const Detection& detection : detections) {
    if (detection.tag == view.tag &&
        (detection.corners_px[0] - view.corners_px[0]).norm() < std::max(kWrongPlace_px, 0.5 * edge))
      return &detection;
  }
  return nullptr;
}

struct Circumstances {
  std::string source, picture;
  double blur_px = 0.0, lens_sigma_px = 0.0, seconds = 0.0;
};

void print(const Circumstances& of, const TrueView& view, const Detection* found) {
  fmt::print("{},{},{},{},{},{:.2f},{:.3f},{:.2f},{:.2f},{:.2f}", of.source, of.picture, view.tag.family,
             view.tag.id, found ? 1 : 0, view.side_px, view.cell_px, view.angle_deg, of.blur_px,
             of.lens_sigma_px);
  Eigen::Matrix<double, 8, 1> errors = Eigen::Matrix<double, 8, 1>::Constant(std::nan(""));
  double along = std::nan(""), across = along, nees = along, sigma = along;
  if (found) {
    const Eigen::Vector2d middle =
        0.25 * (view.corners_px[0] + view.corners_px[1] + view.corners_px[2] + view.corners_px[3]);
    const Eigen::Vector2d tilt = view.tilt, other(-tilt.y(), tilt.x());
    along = across = 0.0;
    for (std::size_t k = 0; k < kNumCorners; ++k) {
      const Eigen::Vector2d error = found->corners_px[k] - view.corners_px[k];
      const Eigen::Vector2d outwards = view.corners_px[k] - middle;
      errors.segment<2>(2 * static_cast<Eigen::Index>(k)) = error;
      along += (outwards.dot(tilt) > 0.0 ? 1.0 : -1.0) * error.dot(tilt) / kNumCorners;
      across += (outwards.dot(other) > 0.0 ? 1.0 : -1.0) * error.dot(other) / kNumCorners;
    }
    if (found->covariance_px2) {
      nees = errors.dot(found->covariance_px2->ldlt().solve(errors)) / 8.0;
      sigma = std::sqrt(found->covariance_px2->trace() / 8.0);
    }
  }
  for (const double error : errors) fmt::print(",{:.4f}", error);
  fmt::print(",{:.4f},{:.4f},{:.4f},{:.4f},{:.5f}\n", along, across, nees, sigma, of.seconds);
}

DetectorOptions options_for(const Camera& camera, const TagMap& map, bool is_lens_told) {
  DetectorOptions options;
  options.families.clear();
  for (const MapTag& tag : map.tags)
    if (std::ranges::find(options.families, tag.key.family) == options.families.end())
      options.families.push_back(tag.key.family);
  options.response = camera.response;
  if (is_lens_told) options.camera_model = camera.model;
  return options;
}

// ---- recordings

void measure_recording(const std::filesystem::path& folder, bool is_lens_told) {
  const Camera camera = read_cameras(folder / "camera.yaml").cameras.front();
  const TagMap map = read_tag_map(folder / "map.yaml");
  const Trajectory poses = read_tum(folder / "truth.tum");
  const bool is_joint = map.frame != "world";
  Detector detector(options_for(camera, map, is_lens_told));
  const std::unique_ptr<FrameSource> source = open_source(folder.string(), {});
  while (const std::optional<SourceFrame> frame = source->next()) {
    if (!frame->is_readable()) continue;
    const auto at = std::ranges::find_if(poses, [&](const TimedPose& p) {
      return std::abs(p.timestamp.ns - frame->timestamp.ns) < 1'000'000;
    });
    if (at == poses.end()) continue;
    const auto T_camera_map = [&](const TimedPose& p) { return is_joint ? p.pose : p.pose.inverse(); };
    const auto begin = std::chrono::steady_clock::now();
    const std::vector<Detection> detections = detector.detect(frame->pixels.view());
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    const TimedPose& before = at == poses.begin() ? *at : *(at - 1);
    const TimedPose& after = at + 1 == poses.end() ? *at : *(at + 1);
    for (const MapTag& tag : map.tags) {
      const auto view = true_view(camera, T_camera_map(*at), tag);
      if (!view) continue;
      const Detection* found = find(detections, *view);
      if (!found) continue;
      double blur_px = 0.0;
      const auto a = true_view(camera, T_camera_map(before), tag),
                 b = true_view(camera, T_camera_map(after), tag);
      if (a && b)
        for (std::size_t k = 0; k < kNumCorners; ++k)
          blur_px += (b->corners_px[k] - a->corners_px[k]).norm() / kNumCorners /
                     seconds_between(before.timestamp, after.timestamp) * camera.exposure_s.value_or(0.0);
      print({folder.filename().string(), std::to_string(frame->timestamp.ns), blur_px, 0.0, seconds}, *view,
            found);
    }
  }
}

// ---- rendered

constexpr double kDistance_m = 1.0;
constexpr int kColumns = 4, kRows = 3;

Camera random_camera(RandomStream& random) {
  Camera camera{.name = "cam0", .model = CameraModel(Pinhole{700.0, 699.0, 640.3, 479.6}, NoDistortion{})};
  camera.width = 1280;
  camera.height = 960;
  const double kind = random.uniform();
  if (kind > 0.7) {  // 110 degrees across
    camera.model =
        CameraModel(Pinhole{660.0, 661.0, 636.3, 484.6}, EquidistantDistortion({-0.02, 0.01, -0.008, 0.002}));
  } else if (kind > 0.35) {
    camera.model =
        CameraModel(Pinhole{700.0, 699.0, 643.3, 476.6}, RadtanDistortion({-0.28, 0.09, 0.0004, -0.0003}));
  }
  return camera;
}

/// A board before each of 4 x 3 places of the picture, turned and tilted anyhow, as far as the lens shows.
Scene random_scene(std::uint64_t seed) {
  RandomStream random(seed);
  Scene scene;
  scene.camera = random_camera(random);
  scene.formation.lens_blur_sigma_px = random.uniform(0.3, 0.9);
  scene.exposure_s = 0.01;
  scene.num_frames = 1;
  const double path_px = random.uniform() < 0.5 ? 0.0 : random.uniform(0.0, 3.0);
  const double way = random.uniform(0.0, 2.0 * pi);
  const double speed = path_px / scene.camera.model.pinhole().fx * kDistance_m / scene.exposure_s;
  scene.T_world_camera = Motion::fixed(Pose());
  const double middle_s = 1e-9 * static_cast<double>(scene.timestamp(0).ns);
  for (const auto& [axis, v] : {std::pair(0, speed * std::cos(way)), std::pair(1, speed * std::sin(way))}) {
    scene.T_world_camera.position_m[static_cast<std::size_t>(axis)].rate_per_s = v;
    scene.T_world_camera.position_m[static_cast<std::size_t>(axis)].offset = -v * middle_s;
  }
  scene.lighting = {
      .lamp_world = {random.uniform(-1.0, 1.0), random.uniform(-1.0, 0.5), random.uniform(-0.5, 0.6)},
      .ambient = random.uniform(0.2, 0.6),
      .intensity = random.uniform(0.3, 0.6),
      .reach_m = random.uniform(1.0, 3.0)};
  Body boards{.name = "world", .T_world_body = {}, .panels = {}};
  scene.map.frame = "world";
  for (int i = 0; i < kColumns * kRows; ++i) {
    const Eigen::Vector2d place(
        scene.camera.width * (i % kColumns + 0.5) / kColumns + random.uniform(-20.0, 20.0),
        scene.camera.height * (i / kColumns + 0.5) / kRows + random.uniform(-20.0, 20.0));
    const auto ray = scene.camera.model.unproject(place);
    if (!ray) continue;
    const double side_px = 12.0 * std::pow(10.0, random.uniform());
    MapTag tag;
    tag.key = {"tag36h11", static_cast<int>(random.uniform() * 587.0)};
    while (scene.map.find(tag.key)) tag.key.id = (tag.key.id + 1) % 587;
    const double focal_px = scene.camera.model.pinhole().fx;
    tag.size_m = side_px / focal_px * kDistance_m;
    const double axis = random.uniform(0.0, 2.0 * pi), tilt = random.uniform(0.0, 75.0) * pi / 180.0;
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), *ray) *
        Eigen::AngleAxisd(tilt, Eigen::Vector3d(std::cos(axis), std::sin(axis), 0.0)) *
        Eigen::AngleAxisd(random.uniform(0.0, 2.0 * pi), Eigen::Vector3d::UnitZ());
    tag.T_map_tag = Pose(turn, Eigen::Vector3d(kDistance_m * *ray));
    scene.map.tags.push_back(tag);
    Panel board;
    board.T_body_panel = tag.T_map_tag;
    board.half_size_m.setConstant(tag.size_m * random.uniform(0.9, 1.4));
    board.reflectance = random.uniform(0.03, 0.8);
    board.is_decal = true;
    boards.panels.push_back(board);
    TagMap one = scene.map;
    one.tags = {tag};
    add_tags(boards, one, {.margin_cells = random.uniform(0.0, 1.0)});
  }
  scene.bodies.push_back(boards);
  return scene;
}

void measure_rendered(std::uint64_t first_seed, int num_pictures, bool is_lens_told) {
  for (int i = 0; i < num_pictures; ++i) {
    const std::uint64_t seed = first_seed + 2 * static_cast<std::uint64_t>(i);
    const Scene scene = random_scene(seed);
    const Renderer renderer(scene, {.seed = seed});
    const RenderedFrame frame = renderer.render(0);
    Detector detector(options_for(scene.camera, scene.map, is_lens_told));
    const auto begin = std::chrono::steady_clock::now();
    const std::vector<Detection> detections = detector.detect(frame.pixels.view());
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    const double speed = std::hypot(scene.T_world_camera.position_m[0].rate_per_s,
                                    scene.T_world_camera.position_m[1].rate_per_s);
    const double blur_px = speed * scene.exposure_s * scene.camera.model.pinhole().fx / kDistance_m;
    for (const MapTag& tag : scene.map.tags) {
      const auto view = true_view(scene.camera, frame.truth.inverse(), tag);
      if (view)
        print({"rendered", std::to_string(seed), blur_px, scene.formation.lens_blur_sigma_px, seconds}, *view,
              find(detections, *view));
    }
  }
}

}  // namespace
}  // namespace apriltrack

int main(int argc, char** argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  const bool is_lens_told = words.empty() || words.front() != "--no-lens";
  if (!is_lens_told) words.erase(words.begin());
  try {
    fmt::print("{}\n", apriltrack::kHeader);
    if (words.size() == 3 && words[0] == "rendered")
      apriltrack::measure_rendered(std::stoull(words[1]), std::stoi(words[2]), is_lens_told);
    else
      for (const std::string& folder : words) apriltrack::measure_recording(folder, is_lens_told);
  } catch (const apriltrack::Error& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return static_cast<int>(error.kind());
  }
  return 0;
}
