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
#include "bag/protobuf_bytes.h"
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

const std::string kPixels("\x01\x20\x40\x60\x80\xff", 6);
const std::string kPicture = "P5 2 1 255\nab";

/// Position and quaternion of a message, and what follows in those with covariances.
void add_pose(test::MessageBytes& bytes, int num_covariances = 0) {
  for (const double value : {1.5, -2.25, 3.125, 0.5, -0.5, 0.5, 0.5}) bytes.real(value);
  for (int i = 0; i < num_covariances; ++i) bytes.real(0.01 * i);
}

std::string pose_message(test::Wire wire) {
  test::MessageBytes bytes(wire);
  bytes.header(5);
  add_pose(bytes, 36);
  return bytes.done();
}
std::string odometry_message(test::Wire wire) {
  test::MessageBytes bytes(wire);
  bytes.header(5).text("base");
  add_pose(bytes, 36);
  return bytes.done();
}
std::string path_message(test::Wire wire) {
  test::MessageBytes bytes(wire);
  bytes.header(5).u32(2);
  for (const std::int64_t stamp_ns : {7, 9}) {
    bytes.header(stamp_ns);
    add_pose(bytes);
  }
  return bytes.done();
}
std::string tf_message(test::Wire wire) {
  test::MessageBytes bytes(wire);
  bytes.u32(2);
  for (const std::string child : {"/base", "camera"}) {
    bytes.header(11).text(child);
    add_pose(bytes);
  }
  return bytes.done();
}

/// The first byte is the fuzzer's choice of type and encoding.
void add_ros_messages(Seeds& seeds) {
  for (const auto& [wire, choice] : {std::pair(test::Wire::kRos1, '\0'), std::pair(test::Wire::kCdr, '\1')}) {
    const auto add = [&, number = choice](char type, const std::string& message) {
      seeds.add("ros_message", std::string(1, static_cast<char>(2 * type + number)) + message);
    };
    for (const char* encoding : {"mono8", "mono16", "rgb8", "bayer_rggb8", "yuv422"})
      add(0, test::image_message(
                 wire,
                 {.stamp_ns = 5, .width = 2, .height = 1, .encoding = encoding, .step = 6, .data = kPixels}));
    add(1, test::compressed_image_message(wire, 5, "jpeg", kPicture));
    add(2, test::camera_info_message(wire, {.width = 640, .height = 480, .d = {0.1, 0.2, 0.0, 0.0, 0.3}}));
    add(3, pose_message(wire));
    add(4, odometry_message(wire));
    add(5, path_message(wire));
    add(6, tf_message(wire));
  }
}

/// As foxglove/foxglove-sdk has it (schemas/proto, schemas/jsonschema).
struct FoxgloveMessage {
  std::string type;
  std::string protobuf;
  std::string json;
};

/// In the order of the numbers of types that fuzzers know.
std::vector<FoxgloveMessage> foxglove_messages() {
  using namespace test;
  const std::string time = time_field(1, 5),
                    json_time = R"("timestamp": {"sec": 1, "nsec": 5}, "frame_id": "c")";
  return {
      {"foxglove.RawImage",
       time + fixed32_field(2, 3) + fixed32_field(3, 2) + bytes_field(4, "mono8") + fixed32_field(5, 3) +
           bytes_field(6, kPixels) + bytes_field(7, "c"),
       "{" + json_time + R"(, "width": 3, "height": 2, "encoding": "mono8", "step": 3, "data": "AAECCQoL"})"},
      {"foxglove.CompressedImage",
       time + bytes_field(2, kPicture) + bytes_field(3, "pgm") + bytes_field(4, "c"),
       "{" + json_time + R"(, "format": "pgm", "data": "UDUgMiAxIDI1NQoB/g=="})"},
      {"foxglove.CameraCalibration",
       time + fixed32_field(2, 640) + fixed32_field(3, 480) + bytes_field(4, "kannala_brandt") +
           doubles_field(5, {0.1, -0.02, 0.003, -0.0004}) +
           doubles_field(6, {400.5, 0, 321.25, 0, 410.25, 242.75, 0, 0, 1}) +
           doubles_field(8, {390, 0, 318, -40, 0, 395, 238, 0, 0, 0, 1, 0}, false),
       "{" + json_time +
           R"(, "width": 640, "height": 480, "distortion_model": "plumb_bob", "D": [0.1, -0.02, 0, 0, 0.003],)"
           R"( "K": [400.5, 0, 321.25, 0, 410.25, 242.75, 0, 0, 1], "R": [1, 0, 0, 0, 1, 0, 0, 0, 1],)"
           R"( "P": [390, 0, 318, -40, 0, 395, 238, 0, 0, 0, 1, 0]})"},
      {"foxglove.Log", time, "{" + json_time + "}"},
      {"foxglove.PoseInFrame", "",
       "{" + json_time +
           R"(, "pose": {"position": {"x": 1, "y": -2, "z": 3.5}, "orientation": {"x": 0, "y": 0, "z": 0.6, "w": 0.8}}})"},
  };
}

void add_foxglove_messages(Seeds& seeds) {
  char type = 0;
  for (const FoxgloveMessage& message : foxglove_messages()) {
    if (!message.protobuf.empty())
      seeds.add("foxglove_message", std::string(1, static_cast<char>(2 * type)) + message.protobuf);
    seeds.add("foxglove_message", std::string(1, static_cast<char>(2 * type + 1)) + message.json);
    ++type;
  }
}

/// With a camera beside the pictures.
void add_bags_of_foxglove(Seeds& seeds) {
  const std::vector<FoxgloveMessage> messages = foxglove_messages();
  for (const test::Wire wire : {test::Wire::kProtobuf, test::Wire::kJson}) {
    const auto message = [&](std::size_t i, const std::string& topic) {
      const std::string& bytes = wire == test::Wire::kJson ? messages[i].json : messages[i].protobuf;
      return test::TestMessage{topic, messages[i].type, 1'000'000'005, bytes};
    };
    for (const std::size_t picture : {0u, 1u})
      test::write_mcap(
          seeds.next("bag_pictures"), wire,
          {message(picture, "/a/image"), message(picture, "/a/image"), message(2, "/a/calibration")});
    if (wire == test::Wire::kJson)
      test::write_mcap(seeds.next("bag_poses"), wire, {message(4, "/pose"), message(4, "/pose")});
  }
}

void add_bags_of_poses(Seeds& seeds) {
  using test::TestMessage;
  for (const test::Wire wire : {test::Wire::kRos1, test::Wire::kCdr}) {
    const std::vector<TestMessage> messages = {
        {"/pose", "geometry_msgs/PoseWithCovarianceStamped", 5, pose_message(wire)},
        {"/odom", "nav_msgs/Odometry", 5, odometry_message(wire)},
        {"/path", "nav_msgs/Path", 9, path_message(wire)},
        {"/tf", "tf2_msgs/TFMessage", 11, tf_message(wire)}};
    for (const TestMessage& one : messages) test::write_mcap(seeds.next("bag_poses"), wire, {one, one});
    test::write_mcap(seeds.next("bag_poses"), wire, messages);
    if (wire == test::Wire::kRos1) test::write_ros1_bag(seeds.next("bag_poses"), messages);
    if (wire == test::Wire::kCdr) test::write_db3(seeds.next("bag_poses"), messages);
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
    seeds.copy("bag_poses", entry.path());
  }
}

void write_seeds(const fs::path& source, const fs::path& output) {
  Seeds seeds(output);
  for (const SeedText& text : seed_texts()) seeds.add(std::string(text.target), text.bytes);
  add_maps(seeds, source);
  add_cameras(seeds);
  add_tables(seeds);
  add_pictures(seeds);
  add_ros_messages(seeds);
  add_foxglove_messages(seeds);
  add_videos(seeds);
  add_bags(seeds, source);
  add_bags_of_foxglove(seeds);
  add_bags_of_poses(seeds);
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
