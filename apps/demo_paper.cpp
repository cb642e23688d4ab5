#include "demo_paper.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apriltrack/report/chart.h"
#include "apriltrack/report/patch_sheet.h"
#include "apriltrack/source/frame_source.h"
#include "apriltrack/tracker/paper_tracker.h"

namespace apriltrack::app {
namespace {

constexpr int kNumFrames = 30;  // enough to show the body's tags one after another

PaperTracker tracked_bundle(const std::filesystem::path& recording, const TagMap& map, std::uint64_t seed) {
  const Camera camera = read_cameras(recording / "camera.yaml").cameras.front();
  PaperTrackerOptions options = PaperTrackerOptions::published(PaperVariant::kPrinted);
  options.localizer.mode = TrackMode::kJoint;
  options.filter.seed = seed;
  options.num_threads = 0;
  PaperTracker tracker(camera, map, options);
  const auto source = open_source(recording.string(), {.max_frames = kNumFrames});
  while (const auto frame = source->next()) {
    if (frame->is_readable()) tracker.track(frame->frame());
  }
  return tracker;
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

void draw_cloud(const std::filesystem::path& picture, const PaperFilter& filter) {
  const Eigen::Vector3d best = filter.particles()[filter.best()].position;
  const double highest = filter.weights()[filter.best()];
  ChartSeries cloud{.name = fmt::format("{} particles", filter.particles().size()),
                    .mark = ChartMark::kPoints};
  for (std::size_t i = 0; i < filter.particles().size(); ++i) {
    const Eigen::Vector3d offset_m = filter.particles()[i].position - best;
    cloud.x.push_back(1e3 * offset_m.x());
    cloud.y.push_back(1e3 * offset_m.y());
    cloud.shade.push_back(filter.weights()[i] / highest);
  }
  Chart chart;
  chart.title = "The paper's particle cloud in x and y, about the best particle";
  chart.x = {.label = "x, mm", .has_equal_scale = true};
  chart.y = {.label = "y, mm", .has_equal_scale = true};
  chart.series = {cloud};
  chart.shade_label = "weight / highest weight";
  write_chart(picture, chart);
}

}  // namespace

void draw_paper_pictures(const DemoFiles& files, std::uint64_t seed, const std::filesystem::path& patches,
                         const std::filesystem::path& cloud) {
  const std::filesystem::path recording = files.recording(kDemoScenes[1]);
  const TagMap map = read_tag_map(recording / "map.yaml");
  const PaperTracker tracker = tracked_bundle(recording, map, seed);
  draw_patches(patches, tracker, map);
  draw_cloud(cloud, tracker.filter());
}

}  // namespace apriltrack::app
