#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <regex>

#include "apriltrack/camera/camera.h"
#include "apriltrack/detect/detector.h"
#include "apriltrack/eval/trajectory.h"
#include "apriltrack/source/frame_source.h"
#include "apriltrack/source/image_file.h"
#include "apriltrack/tags/tag_map.h"
#include "corner_statistics.h"
#include "library_detector.h"
#include "support/shared_data.h"

// Recordings that others made: photoreal renderings with exact truth, and photographs with golden corners.

namespace apriltrack {
namespace {

using test::CornerStatistics;

struct JudgedRecording {
  CornerStatistics sharp;  ///< Under 2 px of blur.
  int frames = 0;
  int frames_with_tag = 0;
  int false_tags = 0;
};

std::array<Eigen::Vector2d, kNumCorners> corners_px(const Camera& camera, const Pose& T_camera_map,
                                                    const MapTag& tag) {
  std::array<Eigen::Vector2d, kNumCorners> corners;
  const auto in_map = corners_in_map(tag);
  for (std::size_t k = 0; k < kNumCorners; ++k)
    corners[k] = camera.model.project(T_camera_map * in_map[k]).value_or(Eigen::Vector2d::Constant(-1e6));
  return corners;
}

JudgedRecording judge(const std::filesystem::path& folder, bool is_joint, std::size_t step) {
  const Camera camera = read_cameras(folder / "camera.yaml").cameras.front();
  const TagMap map = read_tag_map(folder / "map.yaml");
  const Trajectory truth = read_tum(folder / "truth.tum");
  const auto pose_at = [&](std::size_t i) { return is_joint ? truth[i].pose : truth[i].pose.inverse(); };
  SourceOptions options;
  options.step = step;
  const auto source = open_source(folder.string(), options);
  Detector detector({});
  JudgedRecording judged;
  while (const auto frame = source->next()) {
    const auto near = std::find_if(truth.begin(), truth.end(), [&](const TimedPose& pose) {
      return std::abs(pose.timestamp.ns - frame->timestamp.ns) < 1'000'000;
    });
    if (near == truth.end()) continue;
    const auto i = static_cast<std::size_t>(near - truth.begin());
    const std::size_t before = i > 0 ? i - 1 : i;
    const std::size_t after = std::min(i + 1, truth.size() - 1);
    const double exposures =
        *camera.exposure_s / seconds_between(truth[before].timestamp, truth[after].timestamp);
    const auto detections = detector.detect(frame->pixels.view());
    ++judged.frames;
    judged.frames_with_tag += detections.empty() ? 0 : 1;
    for (const Detection& detection : detections) {
      const MapTag* tag = map.find(detection.tag);
      if (!tag) {
        ++judged.false_tags;
        continue;
      }
      const auto expected = corners_px(camera, pose_at(i), *tag);
      if ((detection.corners_px[0] - expected[0]).norm() > 0.3 * (expected[1] - expected[0]).norm())
        ++judged.false_tags;
      const double path_px =
          (corners_px(camera, pose_at(after), *tag)[0] - corners_px(camera, pose_at(before), *tag)[0]).norm();
      if (path_px * exposures < 2.0) judged.sharp.add(detection.corners_px, expected);
    }
  }
  return judged;
}

void expect_accurate(const JudgedRecording& judged, int min_sharp_tags) {
  EXPECT_EQ(judged.false_tags, 0);
  ASSERT_GE(judged.sharp.num_tags(), min_sharp_tags);
  EXPECT_LE(std::abs(judged.sharp.radial_bias_px()), test::kMaxBias_px);
  EXPECT_LE(judged.sharp.rms_per_axis_px(), test::kMaxRms_px);
}

TEST(DetectRecordings, RoomGentle) {
  APRILTRACK_SHARED_OR_SKIP(folder, "data/room_gentle");
  const JudgedRecording judged = judge(folder, false, 5);
  expect_accurate(judged, 200);
  EXPECT_EQ(judged.frames_with_tag, judged.frames);
}

TEST(DetectRecordings, SingleBlur) {
  APRILTRACK_SHARED_OR_SKIP(folder, "data/single_blur");
  const JudgedRecording judged = judge(folder, true, 1);
  expect_accurate(judged, 10);
  EXPECT_GE(judged.frames_with_tag, 102);  // stock: 102 of 120
}

TEST(DetectRecordings, BundleBlur) {
  APRILTRACK_SHARED_OR_SKIP(folder, "data/bundle_blur");
  const JudgedRecording judged = judge(folder, true, 1);
  expect_accurate(judged, 40);
  EXPECT_GE(judged.frames_with_tag, 103);  // stock: 103 of 150
}

TEST(DetectRecordings, RoomBlurIsSeenMoreOftenThanByTheLibraryAlone) {
  APRILTRACK_SHARED_OR_SKIP(folder, "data/room_blur");
  const JudgedRecording judged = judge(folder, false, 2);
  EXPECT_EQ(judged.false_tags, 0);
  EXPECT_GE(judged.frames_with_tag, 100);  // stock: 183 of all 360
}

/// "id, (x y), (x y), (x y), (x y)" per line; corners from the outer corner of the first pixel.
std::vector<Detection> read_golden(const std::filesystem::path& path) {
  const std::regex number(R"(-?\d+(\.\d+)?)");
  std::ifstream file(path);
  std::vector<Detection> detections;
  for (std::string line; std::getline(file, line);) {
    std::vector<double> values;
    for (auto it = std::sregex_iterator(line.begin(), line.end(), number); it != std::sregex_iterator(); ++it)
      values.push_back(std::stod(it->str()));
    if (values.size() != 9) continue;
    Detection detection;
    detection.tag.id = static_cast<int>(values[0]);
    for (std::size_t k = 0; k < kNumCorners; ++k)
      detection.corners_px[k] = {values[2 * k + 1] - 0.5, values[2 * k + 2] - 0.5};
    detections.push_back(detection);
  }
  return detections;
}

TEST(DetectRecordings, NasaCubesHaveTheirGoldenCorners) {
  APRILTRACK_SHARED_OR_SKIP(folder, "data/nasa_cubes");
  constexpr double kMaxDifference_px = 0.2;  // what image decoders differ by
  DetectorOptions options;
  options.refine_edges = false;
  options.response = ResponseCurve::linear();
  options.min_decision_margin = 0.0;
  Detector detector(options);
  LibraryDetector library({{"tag36h11", 2}}, options.refine_edges);
  int golden_tags = 0;
  for (const char* name :
       {"33369213973_9d9bb4cc96_c", "34085369442_304b6bafd9_c", "34139872896_defdb2f8d9_c"}) {
    const auto golden = read_golden(folder / (std::string(name) + ".txt"));
    const GrayImage image = read_image(folder / (std::string(name) + ".jpg"));
    const auto detections = detector.detect(image.view());
    // The library finds these and no others; an sRGB picture of the same light shows the detector more of
    // them.
    EXPECT_EQ(library.detect(image.view(), 1.0, LibraryDetector::kLibrarysLeastContrast).size(),
              golden.size())
        << name;
    EXPECT_GE(detections.size(), golden.size()) << name;
    for (const Detection& expected : golden) {
      double nearest = 1e9;
      for (const Detection& detection : detections) {
        double largest = detection.tag.id == expected.tag.id ? 0.0 : 1e9;
        for (std::size_t k = 0; k < kNumCorners; ++k)
          largest =
              std::max(largest, (detection.corners_px[k] - expected.corners_px[k]).cwiseAbs().maxCoeff());
        nearest = std::min(nearest, largest);
      }
      EXPECT_LE(nearest, kMaxDifference_px) << name << " at " << expected.corners_px[0].transpose();
      ++golden_tags;
    }
  }
  EXPECT_EQ(golden_tags, 47);
}

}  // namespace
}  // namespace apriltrack
