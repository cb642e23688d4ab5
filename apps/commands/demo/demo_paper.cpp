#include "demo_paper.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "apriltrack/report/chart.h"
#include "apriltrack/report/patch_sheet.h"
#include "apriltrack/source/frame_source.h"
#include "apriltrack/tracker/paper_tracker.h"

namespace apriltrack::app {
namespace {

constexpr int kNumFrames = 30;  // enough to show the body's tags one after another

/// A copy of the filter as one frame left it.
struct Cloud {
  int frame = 0;  ///< Counted from 1.
  double blur_px = 0.0;
  TrackStatus status = TrackStatus::kLost;
  PaperFilter filter;
};

struct TrackedBundle {
  PaperTracker tracker;
  int num_frames = 0;
  std::optional<Cloud> cloud;  ///< Of the most blurred frame whose pose is the filter's own.
};

/// A start puts all particles at one pose: no cloud.
bool is_cloud(const PaperFilter& filter) {
  const auto particles = filter.particles();
  return std::any_of(particles.begin(), particles.end(), [&](const PaperState& particle) {
    return particle.position != particles.front().position;
  });
}

std::map<std::int64_t, double> blur_by_time(const std::vector<DemoScore>& scores, const DemoScene& scene) {
  std::map<std::int64_t, double> blur_px;
  for (const DemoScore& score : scores) {
    if (score.scene != &scene) continue;
    for (const FrameScore& frame : score.evaluation.frames) blur_px[frame.timestamp.ns] = frame.blur_px;
  }
  return blur_px;
}

TrackedBundle track_bundle(const DemoFiles& files, const std::vector<DemoScore>& scores, const TagMap& map,
                           std::uint64_t seed) {
  const DemoScene& scene = kDemoScenes[1];
  const std::filesystem::path recording = files.recording(scene);
  const Camera camera = read_cameras(recording / "camera.yaml").cameras.front();
  const std::map<std::int64_t, double> blur_px = blur_by_time(scores, scene);
  PaperTrackerOptions options = PaperTrackerOptions::published(PaperVariant::kPrinted);
  options.localizer.mode = TrackMode::kJoint;
  options.filter.seed = seed;
  options.num_threads = 0;
  TrackedBundle bundle{PaperTracker(camera, map, options), 0, std::nullopt};
  const auto source = open_source(recording.string(), {.max_frames = kNumFrames});
  while (const auto frame = source->next()) {
    ++bundle.num_frames;
    if (!frame->is_readable()) continue;
    const TrackResult result = bundle.tracker.track(frame->frame());
    const bool is_evident = result.status == TrackStatus::kDetected || result.status == TrackStatus::kTracked;
    const auto blur = blur_px.find(result.timestamp.ns);
    if (!is_evident || blur == blur_px.end() || !is_cloud(bundle.tracker.filter())) continue;
    if (bundle.cloud && bundle.cloud->blur_px >= blur->second) continue;
    bundle.cloud = Cloud{bundle.num_frames, blur->second, result.status, bundle.tracker.filter()};
  }
  return bundle;
}

Image<float> square(std::span<const double> patch) {
  const int side = static_cast<int>(std::lround(std::sqrt(static_cast<double>(patch.size()))));
  Image<float> cells(side, side);
  std::transform(patch.begin(), patch.end(), cells.row(0),
                 [](double grey) { return static_cast<float>(grey); });
  return cells;
}

void draw_patches(const std::filesystem::path& picture, const PaperTracker& tracker, const TagMap& map) {
  std::vector<LabelledPatch> patches;
  for (std::size_t i = 0; i < map.tags.size(); ++i) {
    const auto patch = tracker.reference_patch(i);
    if (!patch.empty()) patches.push_back({square(patch), fmt::format("tag {}", map.tags[i].key.id)});
  }
  write_patch_sheet(picture, "Reference patches: each tag as last detected, sampled on the tag's own grid",
                    patches);
}

/// Nearly square, as the cloud is; so translucent that a few points on each other are told from many.
Chart cloud_chart() {
  Chart chart;
  chart.title = "The paper's particle cloud in x and y";
  chart.x = {.label = "x from the best particle, mm", .has_equal_scale = true};
  chart.y = {.label = "y from the best particle, mm", .has_equal_scale = true};
  chart.shade_label = "weight / highest";
  chart.width = 800;
  chart.plot_height = 600;
  return chart;
}

void draw_cloud(const std::filesystem::path& picture, const PaperFilter& filter) {
  const Eigen::Vector3d best = filter.particles()[filter.best()].position;
  const double highest = filter.weights()[filter.best()];
  ChartSeries cloud{.name = fmt::format("{} particles", filter.particles().size()),
                    .mark = ChartMark::kPoints,
                    .opacity = 0.4};
  for (std::size_t i = 0; i < filter.particles().size(); ++i) {
    const Eigen::Vector3d offset_m = filter.particles()[i].position - best;
    cloud.x.push_back(1e3 * offset_m.x());
    cloud.y.push_back(1e3 * offset_m.y());
    cloud.shade.push_back(filter.weights()[i] / highest);
  }
  Chart chart = cloud_chart();
  chart.series = {cloud};
  write_chart(picture, chart);
}

}  // namespace

std::string draw_paper_pictures(const DemoFiles& files, const std::vector<DemoScore>& scores,
                                std::uint64_t seed, const std::filesystem::path& patches,
                                const std::filesystem::path& cloud) {
  const TagMap map = read_tag_map(files.recording(kDemoScenes[1]) / "map.yaml");
  const TrackedBundle bundle = track_bundle(files, scores, map, seed);
  draw_patches(patches, bundle.tracker, map);
  draw_cloud(cloud, bundle.cloud ? bundle.cloud->filter : bundle.tracker.filter());
  if (!bundle.cloud) return "after the last frame: none left a cloud behind, each started the filter anew";
  return fmt::format(
      "in frame {} ({}, {:.0f} px of blur), the most blurred of the first {} that weighed them",
      bundle.cloud->frame, to_string(bundle.cloud->status), bundle.cloud->blur_px, bundle.num_frames);
}

}  // namespace apriltrack::app
