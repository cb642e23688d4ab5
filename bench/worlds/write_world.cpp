#include "write_world.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "apriltrack/io/atomic_file.h"
#include "apriltrack/io/numbers.h"
#include "apriltrack/sim/renderer.h"
#include "apriltrack/source/sequence_writer.h"
#include "truth.h"

namespace apriltrack::worlds {
namespace {

double rounded(double value, double step) {
  return step * std::round(value / step);
}

nlohmann::json told(const Pose& pose) {
  const Eigen::Vector3d& p = pose.translation();
  const Eigen::Quaterniond& q = pose.rotation();
  return {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()};
}

nlohmann::json told(const World& world, const TrueView& view) {
  nlohmann::json corners = nlohmann::json::array();
  for (const Eigen::Vector2d& corner : view.corners_px) {
    for (const double value : corner) corners.push_back(rounded(value, 1e-5));
  }
  return {{"tag", view.tag},
          {"key", to_string(world.tags[view.tag].key)},
          {"corners_px", corners},
          {"view_angle_deg", rounded(view.view_angle_rad * 180.0 / std::numbers::pi, 0.01)},
          {"mean_side_px", rounded(view.mean_side_px, 0.01)},
          {"shortest_side_px", rounded(view.shortest_side_px, 0.01)},
          {"blur_px", rounded(view.blur_px, 0.001)},
          {"visible_fraction", rounded(view.visible_fraction, 0.001)}};
}

/// Where the tag is in the map's frame at the start and at the end: two places of one that moved.
nlohmann::json told(const World& world, const PlacedTag& tag) {
  const Scene& scene = world.scene;
  const auto T_map_tag = [&](std::size_t frame) {
    const double time_s = seconds_between(Timestamp{}, scene.timestamp(frame));
    const Pose T_world_tag = world.T_world_tag(tag, time_s);
    if (scene.truth == TruthKind::kEgo) return T_world_tag;
    return scene.T_world_body(scene.bodies[scene.truth_body], time_s).inverse() * T_world_tag;
  };
  return {{"key", to_string(tag.key)},
          {"size_m", tag.size_m},
          {"surface", tag.surface},
          {"is_copy", tag.is_copy},
          {"cells_across", TagFamily::get(tag.key.family).width_at_border()},
          {"T_map_tag_first", told(T_map_tag(0))},
          {"T_map_tag_last", told(T_map_tag(scene.num_frames - 1))}};
}

std::string sizes_text(const World& world) {
  std::string text = "sizes:\n";
  for (const auto& [key, size_m] : world.stated_sizes_m)
    text += fmt::format("  {}: {}\n", to_string(key), format_exact(size_m));
  return text;
}

std::string truth_line(const RenderedFrame& frame) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  std::string line =
      fmt::format("{}.{:09}", frame.timestamp.ns / kSecond_ns, frame.timestamp.ns % kSecond_ns);
  const nlohmann::json pose = told(frame.truth);
  for (const double value : pose) line += fmt::format(" {}", format_exact(value));
  return line + "\n";
}

}  // namespace

nlohmann::json describe(const World& world) {
  nlohmann::json tags = nlohmann::json::array();
  for (const PlacedTag& tag : world.tags) tags.push_back(told(world, tag));
  nlohmann::json frames = nlohmann::json::array();
  const auto all = all_views(world);
  for (std::size_t i = 0; i < all.size(); ++i) {
    nlohmann::json views = nlohmann::json::array();
    for (const TrueView& view : all[i]) views.push_back(told(world, view));
    frames.push_back({{"timestamp_ns", world.scene.timestamp(i).ns}, {"views", views}});
  }
  nlohmann::json culprits = nlohmann::json::array();
  for (const TagKey& key : world.culprits) culprits.push_back(to_string(key));
  return {{"seed", world.seed},
          {"kind", to_string(world.kind)},
          {"fault", to_string(world.fault)},
          {"culprits", culprits},
          {"drawn", world.drawn},
          {"tags", tags},
          {"frames", frames},
          {"is_joint", world.scene.truth == TruthKind::kJoint}};
}

namespace {

SequenceWriter write_all_but_frames(const World& world, const std::filesystem::path& folder) {
  SequenceWriter writer(folder, true);
  CameraRig rig;
  rig.cameras.push_back(world.stated_camera);
  writer.write_camera(rig);
  writer.write_map(world.scene.map);
  write_file_atomically(folder / "tag_sizes.yaml", sizes_text(world));
  write_file_atomically(folder / "world.json", describe(world).dump() + "\n");
  return writer;
}

}  // namespace

void write_without_pictures(const World& world, const std::filesystem::path& folder) {
  write_all_but_frames(world, folder);
}

void write_world(const World& world, const std::filesystem::path& folder) {
  const SequenceWriter writer = write_all_but_frames(world, folder);
  const Renderer renderer(world.scene, {.seed = world.seed, .min_instants = 1});
  std::string truth;
  std::vector<Frame> rows;
  double first_light = 0.0;
  for (std::size_t i = 0; i < world.scene.num_frames; ++i) {
    const RenderedFrame frame = renderer.render(i);
    writer.write_frame(frame.frame());
    if (i == 0) first_light = frame.light;
    truth += truth_line(frame);
    Frame row;
    row.timestamp = frame.timestamp;
    row.exposure_s = frame.exposure_s;
    row.gain = frame.light / first_light;
    rows.push_back(row);
  }
  write_file_atomically(folder / "truth.tum", truth);
  if (world.scene.flicker.depth > 0.0) writer.write_frames_csv(rows);
}

}  // namespace apriltrack::worlds
