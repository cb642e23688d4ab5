// How many tags are found and how far their corners are from the exact truth, by blur: the AprilTag library
// with its own defaults (decimate 1, refine_edges, raw image, no margin limit) against apriltrack::Detector.
//
//   bench_detector_accuracy [--step N] RECORDING...
//
// A recording with truth.tum and map.yaml is judged against them; of any other only frames, tags and time are
// told.

#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/base/error.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detector.h"
#include "apriltrack/eval/trajectory.h"
#include "apriltrack/source/frame_source.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack {
namespace {

using Corners = std::array<Eigen::Vector2d, kNumCorners>;

constexpr std::array<double, 5> kBlurBins_px = {0.0, 2.0, 5.0, 10.0, 1e9};
constexpr std::size_t kNumBins = kBlurBins_px.size() - 1;
/// A detection further off than this, and than half an edge, is of something else.
constexpr double kWrongPlace_px = 15.0;

/// The library as it comes, called directly so that nothing of ours is in its figures.
class StockDetector {
 public:
  StockDetector() : family_(tag36h11_create()), detector_(apriltag_detector_create()) {
    detector_->nthreads = 1;
    detector_->quad_decimate = 1.0F;
    apriltag_detector_add_family(detector_, family_);
  }
  ~StockDetector() {
    apriltag_detector_destroy(detector_);
    tag36h11_destroy(family_);
  }
  StockDetector(const StockDetector&) = delete;
  StockDetector& operator=(const StockDetector&) = delete;

  std::vector<Detection> detect(const GrayView& image) {
    image_u8_t native = {image.width(), image.height(), static_cast<int32_t>(image.stride()),
                         const_cast<std::uint8_t*>(image.data())};
    zarray_t* found = apriltag_detector_detect(detector_, &native);
    std::vector<Detection> detections;
    for (int i = 0; i < zarray_size(found); ++i) {
      apriltag_detection_t* one = nullptr;
      zarray_get(found, i, &one);
      Detection detection;
      detection.tag = {"tag36h11", one->id};
      for (std::size_t k = 0; k < kNumCorners;
           ++k)  // version 3.3 has (0, 0) at the first pixel's outer corner
        detection.corners_px[k] = Eigen::Vector2d(one->p[k][0] - 0.5, one->p[k][1] - 0.5);
      detections.push_back(detection);
    }
    apriltag_detections_destroy(found);
    return detections;
  }

 private:
  apriltag_family_t* family_;
  apriltag_detector_t* detector_;
};

struct Errors {
  std::vector<double> radial;
  std::vector<double> distance;

  void add(const Corners& corners, const Corners& truth) {
    const Eigen::Vector2d middle = 0.25 * (truth[0] + truth[1] + truth[2] + truth[3]);
    for (std::size_t k = 0; k < kNumCorners; ++k) {
      const Eigen::Vector2d error = corners[k] - truth[k];
      radial.push_back(error.dot((truth[k] - middle).normalized()));
      distance.push_back(error.norm());
    }
  }
};

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

double rms_per_axis(const std::vector<double>& distances) {
  double sum = 0.0;
  for (const double value : distances) sum += value * value;
  return std::sqrt(sum / (2.0 * static_cast<double>(distances.size())));
}

double quantile(std::vector<double> values, double share) {
  const auto place =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

struct Tally {
  std::string name;
  std::array<Errors, kNumBins> by_blur;
  int frames_with_detection = 0;
  int tags = 0;
  int false_tags = 0;
  double cpu_seconds = 0.0;  ///< Of the process: other programs on the machine do not count.
};

/// Where the tags of a recording truly are.
class Truth {
 public:
  static std::optional<Truth> of(const std::filesystem::path& folder) {
    if (!std::filesystem::exists(folder / "truth.tum")) return std::nullopt;
    return Truth(read_cameras(folder / "camera.yaml").cameras.front(), read_tag_map(folder / "map.yaml"),
                 read_tum(folder / "truth.tum"));
  }

  const TagMap& map() const { return map_; }

  /// nullopt when the pose or the projection is not known.
  std::optional<Corners> corners(Timestamp time, const TagKey& tag) const {
    const std::size_t i = index_of(time);
    return i < poses_.size() ? project(poses_[i].pose, tag) : std::nullopt;
  }

  /// Mean length of the corners' paths during the exposure, from the poses before and after.
  double blur_px(Timestamp time, const TagKey& tag) const {
    const std::size_t i = index_of(time);
    const TimedPose& before = poses_[i > 0 ? i - 1 : i];
    const TimedPose& after = poses_[std::min(i + 1, poses_.size() - 1)];
    const std::optional<Corners> a = project(before.pose, tag);
    const std::optional<Corners> b = project(after.pose, tag);
    if (!a || !b) return 0.0;
    double path = 0.0;
    for (std::size_t k = 0; k < kNumCorners; ++k) path += ((*b)[k] - (*a)[k]).norm() / kNumCorners;
    return path / seconds_between(before.timestamp, after.timestamp) * camera_.exposure_s.value_or(0.0);
  }

 private:
  Truth(Camera camera, TagMap map, Trajectory poses)
      : camera_(std::move(camera)),
        map_(std::move(map)),
        poses_(std::move(poses)),
        is_joint_(map_.frame != "world") {}

  std::size_t index_of(Timestamp time) const {
    constexpr std::int64_t kSame_ns = 1'000'000;
    for (std::size_t i = 0; i < poses_.size(); ++i)
      if (std::abs(poses_[i].timestamp.ns - time.ns) <= kSame_ns) return i;
    return poses_.size();
  }

  std::optional<Corners> project(const Pose& truth, const TagKey& key) const {
    const MapTag* tag = map_.find(key);
    if (!tag) return std::nullopt;
    const Pose T_camera_map = is_joint_ ? truth : truth.inverse();
    Corners corners;
    for (std::size_t k = 0; k < kNumCorners; ++k) {
      const std::optional<Eigen::Vector2d> pixel =
          camera_.model.project(T_camera_map * corners_in_map(*tag)[k]);
      if (!pixel) return std::nullopt;
      corners[k] = *pixel;
    }
    return corners;
  }

  Camera camera_;
  TagMap map_;
  Trajectory poses_;
  bool is_joint_;
};

void judge(const Truth& truth, Timestamp time, const Detection& detection, Tally* tally) {
  const std::optional<Corners> corners = truth.corners(time, detection.tag);
  const double edge = corners ? ((*corners)[1] - (*corners)[0]).norm() : 0.0;
  const bool is_there =
      corners && (detection.corners_px[0] - (*corners)[0]).norm() < std::max(kWrongPlace_px, 0.5 * edge);
  if (!is_there) {
    ++tally->false_tags;
    return;
  }
  const double blur = truth.blur_px(time, detection.tag);
  std::size_t bin = 0;
  while (bin + 1 < kNumBins && blur >= kBlurBins_px[bin + 1]) ++bin;
  tally->by_blur[bin].add(detection.corners_px, *corners);
}

template <class AnyDetector>
void run(AnyDetector& detector, const SourceFrame& frame, const std::optional<Truth>& truth, Tally* tally) {
  const std::clock_t start = std::clock();
  const std::vector<Detection> detections = detector.detect(frame.pixels.view());
  tally->cpu_seconds += static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  if (!detections.empty()) ++tally->frames_with_detection;
  tally->tags += static_cast<int>(detections.size());
  if (!truth) return;
  for (const Detection& detection : detections) judge(*truth, frame.timestamp, detection, tally);
}

void print(const Tally& tally, int frames, bool has_truth) {
  fmt::print("  {:<6} frames with a tag {:4} of {:4}, tags {:5}, false {:3}, {:6.2f} ms/frame\n", tally.name,
             tally.frames_with_detection, frames, tally.tags,
             has_truth ? std::to_string(tally.false_tags) : "?", 1e3 * tally.cpu_seconds / frames);
  for (std::size_t bin = 0; bin < kNumBins; ++bin) {
    const Errors& errors = tally.by_blur[bin];
    if (errors.distance.empty()) continue;
    fmt::print(
        "    blur {:>2}..{:<3} n {:5}  radial bias {:+.3f}  rms/axis {:.3f}  median {:.3f}  95 % {:.3f} px\n",
        kBlurBins_px[bin], kBlurBins_px[bin + 1] > 1e3 ? "" : fmt::format("{}", kBlurBins_px[bin + 1]),
        errors.distance.size() / kNumCorners, mean(errors.radial), rms_per_axis(errors.distance),
        quantile(errors.distance, 0.5), quantile(errors.distance, 0.95));
  }
}

void measure(const std::string& input, std::size_t step) {
  const std::optional<Truth> truth = Truth::of(input);
  SourceOptions source_options;
  source_options.step = step;
  source_options.rate_hz = 30.0;
  const std::unique_ptr<FrameSource> source = open_source(input, source_options);
  StockDetector stock;
  Detector ours({});
  std::array<Tally, 2> tallies;
  tallies[0].name = "stock";
  tallies[1].name = "ours";
  int frames = 0;
  while (const std::optional<SourceFrame> frame = source->next()) {
    if (!frame->is_readable()) continue;
    ++frames;
    run(stock, *frame, truth, &tallies[0]);
    run(ours, *frame, truth, &tallies[1]);
  }
  fmt::print("{}\n", input);
  for (const Tally& tally : tallies) print(tally, frames, truth.has_value());
  fmt::print("  time of ours over stock, CPU: {:.3f}\n", tallies[1].cpu_seconds / tallies[0].cpu_seconds);
}

}  // namespace
}  // namespace apriltrack

int main(int argc, char** argv) {
  std::vector<std::string> inputs(argv + 1, argv + argc);
  std::size_t step = 1;
  if (inputs.size() >= 2 && inputs[0] == "--step") {
    step = std::stoul(inputs[1]);
    inputs.erase(inputs.begin(), inputs.begin() + 2);
  }
  try {
    for (const std::string& input : inputs) apriltrack::measure(input, step);
  } catch (const apriltrack::Error& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return static_cast<int>(error.kind());
  }
  return 0;
}
