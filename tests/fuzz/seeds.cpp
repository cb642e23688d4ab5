// Writes seeds of all fuzzers into folders of their names: what our own writers make, and small files of the
// formats that are only read.
//
//   fuzz_seeds SOURCE-FOLDER OUTPUT-FOLDER

#include <filesystem>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <string>
#include <vector>

#include "apriltrack/base/error.h"
#include "apriltrack/camera/camera_formats.h"
#include "apriltrack/detect/detections_csv.h"
#include "apriltrack/eval/frame_log.h"
#include "apriltrack/eval/trajectory_formats.h"
#include "apriltrack/image/opencv_bridge.h"
#include "apriltrack/io/atomic_file.h"
#include "apriltrack/source/image_file.h"
#include "apriltrack/tags/map_formats.h"
#include "bag/bag_writers.h"
#include "seed_texts.h"

namespace apriltrack::fuzz {
namespace {
namespace fs = std::filesystem;

class Seeds {
 public:
  explicit Seeds(fs::path folder) : folder_(std::move(folder)) {}

  /// The place of a new seed.
  fs::path next(const std::string& target, const std::string& ending = "") {
    fs::create_directories(folder_ / target);
    return folder_ / target / ("seed_" + std::to_string(num_seeds_++) + ending);
  }
  void add(const std::string& target, std::string_view bytes) { write_file_atomically(next(target), bytes); }
  void copy(const std::string& target, const fs::path& file) { add(target, read_file(file)); }

 private:
  fs::path folder_;
  int num_seeds_ = 0;
};

/// Nothing about it is symmetric.
TagMap small_map() {
  TagMap map;
  for (int i = 0; i < 3; ++i) {
    MapTag tag;
    tag.key = {"tag36h11", i};
    tag.size_m = 0.1 + 0.01 * i;
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.3 + i, Eigen::Vector3d(1, 2, 3 + i).normalized()));
    tag.T_map_tag = Pose(turn, Eigen::Vector3d(0.1 * i, 0.2 + i, -0.3));
    map.tags.push_back(tag);
  }
  return map;
}

void add_maps(Seeds& seeds, const fs::path& source) {
  for (const char* name : {"a4_page_6.yaml", "cube_6.yaml"}) seeds.copy("map", source / "maps" / name);
  for (const MapFormatInfo& format : map_formats()) {
    try {
      write_tag_map_as(seeds.next("map"), small_map(), format.format);
    } catch (const Error&) {  // no printed grid, no headings: texts below have them
    }
  }
}

CameraRig small_rig(const Distortion& lens) {
  Camera camera{.name = "cam0",
                .model = CameraModel({410.5, 411.25, 321.5, 239.75}, lens),
                .width = 640,
                .height = 480};
  return {{camera}};
}

void add_cameras(Seeds& seeds) {
  for (const Distortion& lens :
       {Distortion(NoDistortion()), Distortion(RadtanDistortion({0.1, -0.02, 0.001, -0.002, 0.003})),
        Distortion(EquidistantDistortion({0.1, -0.02, 0.001, -0.002}))}) {
    for (const CameraFormatInfo& format : camera_formats()) {
      try {
        write_cameras_as(seeds.next("camera"), small_rig(lens), format.format);
      } catch (const Error&) {  // only read, or without such a lens
      }
    }
  }
}

void add_tables(Seeds& seeds) {
  std::vector<FrameDetections> frames(2);
  for (int i = 0; i < 2; ++i) {
    frames[static_cast<std::size_t>(i)].timestamp = {1000 * (i + 1)};
    Detection detection;
    detection.tag = {"tag36h11", i};
    for (int k = 0; k < 4; ++k) detection.corners_px[static_cast<std::size_t>(k)] = {10.5 * k, 20.25 + i};
    frames[static_cast<std::size_t>(i)].detections.push_back(detection);
  }
  write_detections_csv(seeds.next("detections_csv"), frames);
  const Trajectory trajectory = {{{1'500'000'000}, Pose()}, {{1'600'000'001}, small_map().tags[1].T_map_tag}};
  for (const TrajectoryFormatInfo& info : trajectory_formats())
    write_trajectory_as(seeds.next("trajectory", std::string(info.ending)), trajectory, info.format);
  std::vector<FrameLogRow> rows(3);
  rows[0].status = "lost";
  rows[1].timestamp = {5};
  rows[1].status = "detected";
  rows[1].pose = small_map().tags[2].T_map_tag;
  rows[2].timestamp = {7};
  rows[2].status = "unreadable";
  write_frame_log(seeds.next("frame_log"), rows);
}

void add_pictures(Seeds& seeds) {
  GrayImage picture(17, 9);
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x) picture(x, y) = static_cast<std::uint8_t>(9 * x + 5 * y);
  const auto add_encoded = [&](const std::string& ending, const cv::Mat& pixels,
                               const std::vector<int>& options) {
    std::vector<unsigned char> bytes;
    if (cv::imencode(ending, pixels, bytes, options))
      seeds.add("image", {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  };
  const cv::Mat grey = mat_of(picture.view());
  cv::Mat deep;
  grey.convertTo(deep, CV_16U, 257.0);
  for (const char* ending : {".png", ".jpg", ".pgm", ".bmp", ".tiff", ".webp"}) add_encoded(ending, grey, {});
  for (const char* ending : {".png", ".pgm", ".tiff"}) add_encoded(ending, deep, {});
  add_encoded(".jpg", grey, {cv::IMWRITE_JPEG_PROGRESSIVE, 1, cv::IMWRITE_JPEG_RST_INTERVAL, 1});
}

/// The first byte is the fuzzer's choice of type and encoding.
void add_messages(Seeds& seeds) {
  const std::string pixels("\x01\x20\x40\x60\x80\xff", 6);
  for (const auto& [wire, choice] : {std::pair(test::Wire::kRos1, '\0'), std::pair(test::Wire::kCdr, '\1')}) {
    const auto add = [&, number = choice](char type, const std::string& message) {
      seeds.add("ros_message", std::string(1, static_cast<char>(2 * type + number)) + message);
    };
    for (const char* encoding : {"mono8", "mono16", "rgb8", "bayer_rggb8", "yuv422"})
      add(0, test::image_message(
                 wire,
                 {.stamp_ns = 5, .width = 2, .height = 1, .encoding = encoding, .step = 6, .data = pixels}));
    add(1, test::compressed_image_message(wire, 5, "jpeg", "P5 2 1 255\nab"));
    add(2, test::camera_info_message(wire, {.width = 640, .height = 480, .d = {0.1, 0.2, 0.0, 0.0, 0.3}}));
  }
}

void add_videos(Seeds& seeds) {
  for (const auto& [ending, code] :
       {std::pair(".avi", "MJPG"), std::pair(".mp4", "mp4v"), std::pair(".mkv", "MJPG")}) {
    const fs::path path = seeds.next("video", ending);
    cv::VideoWriter writer(path, cv::VideoWriter::fourcc(code[0], code[1], code[2], code[3]), 30.0, {32, 16},
                           false);
    for (int i = 0; i < 3; ++i) writer.write(cv::Mat(16, 32, CV_8UC1, cv::Scalar(40 * i)));
  }
}

void add_bags(Seeds& seeds, const fs::path& source) {
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(source / "tests/bag/data")) {
    if (!entry.is_regular_file() || entry.path().extension() == ".csv") continue;
    seeds.copy("bag", entry.path());
    seeds.copy("bag_pictures", entry.path());
  }
}

void write_seeds(const fs::path& source, const fs::path& output) {
  Seeds seeds(output);
  for (const SeedText& text : seed_texts()) seeds.add(std::string(text.target), text.bytes);
  add_maps(seeds, source);
  add_cameras(seeds);
  add_tables(seeds);
  add_pictures(seeds);
  add_messages(seeds);
  add_videos(seeds);
  add_bags(seeds, source);
}

}  // namespace
}  // namespace apriltrack::fuzz

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::cerr << "fuzz_seeds SOURCE-FOLDER OUTPUT-FOLDER\n";
    return 2;
  }
  apriltrack::fuzz::write_seeds(argv[1], argv[2]);
  return 0;
} catch (const std::exception& error) {
  std::cerr << "fuzz_seeds: " << error.what() << "\n";
  return 1;
}
