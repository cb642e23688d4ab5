// Bags as INPUT: what is filmed is the same, whatever it is kept in.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <set>

#include "apriltrack/camera/camera.h"
#include "apriltrack/source/sequence_writer.h"
#include "bag/bag_writers.h"
#include "program.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

/// A simulated recording, and bags with its pictures.
class Bags : public ::testing::Test {
 protected:
  static constexpr int kFrames = 12;

  void SetUp() override { folder_ = temporary_folder(); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  void simulate(const std::string& scene, int frames = kFrames) const {
    run_for_json({"simulate", "--scene", scene, "--frames", std::to_string(frames), "--exposure", "0.004",
                  "--output", path(scene)});
  }

  std::set<std::int64_t> times_of(const std::string& scene) const {
    std::set<std::int64_t> times_ns;
    for (const auto& image : fs::directory_iterator(path(scene) + "/frames"))
      times_ns.insert(std::stoll(image.path().stem()));
    return times_ns;
  }

  static std::string bytes_of(const cv::Mat& picture) {
    return {reinterpret_cast<const char*>(picture.data), picture.total() * picture.elemSize()};
  }

  /// The pictures of a scene, logged 30 ms late, their stamps moved by shift_ns.
  std::vector<TestMessage> pictures_of(const std::string& scene, const std::string& topic, Wire wire,
                                       std::int64_t shift_ns = 0) const {
    std::vector<TestMessage> messages;
    for (const std::int64_t time_ns : times_of(scene)) {
      const cv::Mat picture =
          cv::imread(path(scene) + "/frames/" + sequence_frame_name({time_ns}), cv::IMREAD_GRAYSCALE);
      const ImageFields fields{.stamp_ns = time_ns + shift_ns,
                               .width = picture.cols,
                               .height = picture.rows,
                               .encoding = "mono8",
                               .step = picture.cols,
                               .data = bytes_of(picture)};
      messages.push_back({topic, "sensor_msgs/Image", time_ns + 30'000'000, image_message(wire, fields)});
    }
    return messages;
  }

  TestMessage camera_info_of(const std::string& scene, const std::string& topic, Wire wire) const {
    const Camera camera = read_cameras(path(scene) + "/camera.yaml").cameras.front();
    const Pinhole& p = camera.model.pinhole();
    const CameraInfoFields fields{
        .width = camera.width,
        .height = camera.height,
        .model = "plumb_bob",
        .d = std::visit([](const auto& lens) { return lens.coefficients(); }, camera.model.distortion()),
        .k = {p.fx, 0, p.cx, 0, p.fy, p.cy, 0, 0, 1}};
    return {topic, "sensor_msgs/CameraInfo", 1, camera_info_message(wire, fields)};
  }

  /// Tracks and gives the trajectory, byte for byte.
  std::string track(const std::string& input, std::vector<std::string> more = {}) const {
    std::vector<std::string> words = {"track",    input,          "--map", path("single/map.yaml"),
                                      "--output", path("out.tum")};
    words.insert(words.end(), more.begin(), more.end());
    const nlohmann::json answer = run_for_json(words);
    EXPECT_GT(answer.value("poses", answer.value("frames", 0)), 0);
    return read_text(path("out.tum"));
  }

  fs::path folder_;
};

TEST_F(Bags, OfEachFormatGiveTheTrajectoryOfTheFolder) {
  simulate("single");
  const std::vector<std::string> camera = {"--camera", path("single/camera.yaml")};
  const std::string expected = track(path("single"));
  ASSERT_NE(expected, "");
  write_ros1_bag(path("a.bag"), pictures_of("single", "/camera/image_raw", Wire::kRos1));
  write_mcap(path("a.mcap"), Wire::kCdr, pictures_of("single", "/camera/image_raw", Wire::kCdr));
  write_db3(path("a.db3"), pictures_of("single", "/camera/image_raw", Wire::kCdr));
  for (const char* name : {"a.bag", "a.mcap", "a.db3"})
    EXPECT_EQ(track(path(name), camera), expected) << name;
  fs::create_directories(path("rosbag2"));
  fs::rename(path("a.db3"), path("rosbag2/rosbag2_0.db3"));
  write_text(path("rosbag2/metadata.yaml"),
             "rosbag2_bagfile_information:\n  storage_identifier: sqlite3\n"
             "  relative_file_paths: [rosbag2_0.db3]\n");
  EXPECT_EQ(track(path("rosbag2"), camera), expected);
}

TEST_F(Bags, BringTheirCamera) {
  simulate("single");
  // A CameraInfo tells neither exposure nor response.
  std::string camera = read_text(path("single/camera.yaml"));
  std::string bare;
  for (std::size_t begin = 0; begin < camera.size();) {
    const std::size_t end = camera.find('\n', begin);
    const std::string line = camera.substr(begin, end - begin);
    if (line.find("exposure_time") == std::string::npos && line.find("response") == std::string::npos)
      bare += line + "\n";
    if (end == std::string::npos) break;
    begin = end + 1;
  }
  write_text(path("bare.yaml"), bare);
  const std::string expected = track(path("single"), {"--camera", path("bare.yaml")});
  auto messages = pictures_of("single", "/camera/image_raw", Wire::kCdr);
  messages.push_back(camera_info_of("single", "/camera/camera_info", Wire::kCdr));
  write_mcap(path("a.mcap"), Wire::kCdr, messages);
  EXPECT_EQ(track(path("a.mcap")), expected);

  write_mcap(path("b.mcap"), Wire::kCdr, pictures_of("single", "/camera/image_raw", Wire::kCdr));
  EXPECT_THAT(
      run_program({"track", path("b.mcap"), "--map", path("single/map.yaml"), "--output", path("o.tum")}),
      EndsWith(2, "no sensor_msgs/CameraInfo"));
}

TEST_F(Bags, HaveTheirStampsMovedToTheMiddle) {
  simulate("single");
  const std::string expected = track(path("single"));
  // exposure_time is 4 ms.
  write_mcap(path("start.mcap"), Wire::kCdr, pictures_of("single", "/image", Wire::kCdr, -2'000'000));
  write_mcap(path("end.mcap"), Wire::kCdr, pictures_of("single", "/image", Wire::kCdr, 2'000'000));
  const std::string camera = path("single/camera.yaml");
  EXPECT_EQ(track(path("start.mcap"), {"--camera", camera, "--stamp-is", "start"}), expected);
  EXPECT_EQ(track(path("end.mcap"), {"--camera", camera, "--stamp-is", "end"}), expected);
  EXPECT_THAT(run_program({"detect", path("end.mcap"), "--stamp-is", "end", "--output", path("o.csv")}),
              EndsWith(2, "--stamp-is: 'end' moves times by half the exposure, which nothing tells"));
}

TEST_F(Bags, AreReadByDetectAndDoctor) {
  simulate("single");
  write_ros1_bag(path("a.bag"), pictures_of("single", "/camera/image_raw", Wire::kRos1));
  const auto detected = run_for_json(
      {"detect", path("a.bag"), "--camera", path("single/camera.yaml"), "--output", path("o.csv")});
  EXPECT_EQ(detected["frames"], kFrames);
  run_for_json({"detect", path("single"), "--output", path("expected.csv")});
  EXPECT_EQ(read_text(path("o.csv")), read_text(path("expected.csv")));
  const ProgramRun looked = run_program({"doctor", path("a.bag"), "--json"});
  EXPECT_EQ(nlohmann::json::parse(looked.out)["recordings"][0]["frames"], kFrames) << looked.err;
}

TEST_F(Bags, AskForTheTopic) {
  simulate("single", 3);
  auto messages = pictures_of("single", "/left/image_raw", Wire::kCdr);
  for (const TestMessage& one : pictures_of("single", "/right/image_raw", Wire::kCdr))
    messages.push_back(one);
  write_db3(path("two.db3"), messages);
  const std::vector<std::string> detect = {"detect", path("two.db3"), "--output", path("o.csv")};
  EXPECT_THAT(run_program(detect), EndsWith(2,
                                            "/left/image_raw (sensor_msgs/msg/Image, 3 messages), "
                                            "/right/image_raw (sensor_msgs/msg/Image, 3 messages)"));
  auto with_topic = detect;
  with_topic.insert(with_topic.end(), {"--topic", "/right/image_raw"});
  EXPECT_EQ(run_for_json(with_topic)["frames"], 3);
  EXPECT_THAT(run_program({"detect", path("single"), "--topic", "/image", "--output", path("o.csv")}),
              EndsWith(2, "--topic: is of a bag, and no INPUT is one"));
}

TEST_F(Bags, WhoseTopicIsAnotherCamerasIsWarnedOf) {
  simulate("single", 3);
  const std::string camera = read_text(path("single/camera.yaml"));
  write_text(path("rig.yaml"), camera + "\n  rostopic: /left/image_raw\ncam1" + camera.substr(4) +
                                   "\n  T_cn_cnm1: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n"
                                   "  rostopic: /right/image_raw\n");
  std::vector<TestMessage> messages;
  for (const char* topic : {"/left/image_raw", "/right/image_raw", "/renamed"})
    for (const TestMessage& one : pictures_of("single", topic, Wire::kCdr)) messages.push_back(one);
  write_mcap(path("three.mcap"), Wire::kCdr, messages);
  write_mcap(path("renamed.mcap"), Wire::kCdr, pictures_of("single", "/renamed", Wire::kCdr));
  const auto told = [&](const std::string& bag, const std::string& name, const std::string& topic) {
    const ProgramRun run =
        run_program({"track", path(bag), "--camera", path("rig.yaml"), "--camera-name", name, "--map",
                     path("single/map.yaml"), "--topic", topic, "--output", path("o.tum")});
    EXPECT_EQ(run.status, 0) << run.err;
    return run.err;
  };
  EXPECT_THAT(told("three.mcap", "cam1", "/left/image_raw"),
              HasSubstr("/left/image_raw is read for cam1, but rostopic of cam1 in the camera file is "
                        "/right/image_raw, and /left/image_raw is that of cam0"));
  EXPECT_THAT(told("three.mcap", "cam1", "/renamed"), HasSubstr("/renamed is read for cam1, but rostopic"));
  EXPECT_THAT(told("three.mcap", "cam1", "/right/image_raw"), Not(HasSubstr("but rostopic")));
  EXPECT_THAT(told("three.mcap", "cam0", "cam0=/left/image_raw"), Not(HasSubstr("but rostopic")));
  EXPECT_THAT(told("renamed.mcap", "cam1", "/renamed"), Not(HasSubstr("but rostopic")));
}

/// By the wrong lens of a rig, poses are wrong.
TEST_F(Bags, AreReadByTheCameraWhoseTopicTheyHave) {
  simulate("single", 3);
  const std::string camera = read_text(path("single/camera.yaml"));
  std::string other = camera.substr(4);
  const std::size_t intrinsics = other.find("intrinsics: [");
  ASSERT_NE(intrinsics, std::string::npos);
  other.insert(intrinsics + 13, "1");  // another focal length
  write_text(path("rig.yaml"), "cam0" + other + "\n  rostopic: /left/image_raw\ncam1" + camera.substr(4) +
                                   "\n  T_cn_cnm1: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n"
                                   "  rostopic: /right/image_raw\n");
  const auto track = [&](const std::string& input, const std::string& camera_file,
                         const std::vector<std::string>& more) {
    std::vector<std::string> words = {
        "track", input, "--camera", camera_file, "--map", path("single/map.yaml"), "--output", path("o.tum")};
    words.insert(words.end(), more.begin(), more.end());
    const ProgramRun run = run_program(words);
    EXPECT_EQ(run.status, 0) << run.err;
    return std::pair(read_text(path("o.tum")), run.err);
  };
  const std::string expected = track(path("single"), path("single/camera.yaml"), {}).first;
  for (const std::string topic : {"/right/image_raw", "/right/image_raw/compressed"}) {
    write_mcap(path("right.mcap"), Wire::kCdr, pictures_of("single", topic, Wire::kCdr));
    const auto [poses, told] = track(path("right.mcap"), path("rig.yaml"), {});
    EXPECT_EQ(poses, expected) << topic;
    EXPECT_THAT(told, HasSubstr(topic + " is of camera cam1, by rostopic"));
  }
  EXPECT_THAT(run_program({"track", path("right.mcap"), "--camera", path("rig.yaml"), "--camera-name", "cam0",
                           "--map", path("single/map.yaml"), "--output", path("o.tum")})
                  .err,
              HasSubstr("is read for cam0, but rostopic of cam0 in the camera file is /left/image_raw"));
}

TEST_F(Bags, GiveTheirCameraAsAFile) {
  simulate("single", 3);
  auto messages = pictures_of("single", "/left/image_raw", Wire::kCdr);
  messages.push_back(camera_info_of("single", "/left/camera_info", Wire::kCdr));
  for (const TestMessage& one : pictures_of("single", "/right/image_raw", Wire::kCdr))
    messages.push_back(one);
  write_mcap(path("two.mcap"), Wire::kCdr, messages);
  EXPECT_THAT(run_program({"camera", "convert", path("two.mcap"), path("o.yaml")}),
              EndsWith(2, "/right/image_raw (sensor_msgs/msg/Image, 3 messages)"));
  EXPECT_THAT(
      run_program({"camera", "convert", path("two.mcap"), path("o.yaml"), "--topic", "/right/image_raw"}),
      EndsWith(2, "that can be read (it has /left/camera_info)"));
  const auto converted =
      run_for_json({"camera", "convert", path("two.mcap"), path("o.yaml"), "--topic", "/left/image_raw"});
  EXPECT_TRUE(converted["losses"].empty());
  const auto of_bag = run_for_json({"camera", "show", path("o.yaml")})["cameras"][0],
             of_folder = run_for_json({"camera", "show", path("single/camera.yaml")})["cameras"][0];
  for (const char* key : {"fx", "fy", "cx", "cy", "distortion_model", "distortion_coeffs", "resolution"}) {
    ASSERT_TRUE(of_folder.contains(key)) << of_folder;
    EXPECT_EQ(of_bag[key], of_folder[key]) << key;
  }
  EXPECT_THAT(run_program({"camera", "show", path("o.yaml"), "--topic", "/x"}),
              EndsWith(2, "--topic: is of a bag"));
}

TEST_F(Bags, WithoutPosesOrFramesSaySoOnce) {
  simulate("single", 3);
  write_mcap(path("a.mcap"), Wire::kCdr, pictures_of("single", "/image", Wire::kCdr));
  EXPECT_THAT(run_program({"trajectory", "convert", path("a.mcap"), path("o.tum")}),
              EndsWith(2, path("a.mcap") + ": has no topic with poses (geometry_msgs/PoseStamped"));
  EXPECT_THAT(run_program({"trajectory", "convert", path("a.mcap"), path("o.tum"), "--topic", "/pose"}),
              EndsWith(2, path("a.mcap") + " has no topic '/pose' with poses"));
  for (const std::string command : {"track", "detect"}) {
    std::vector<std::string> words = {command,    path("a.mcap"), "--skip",   "100",
                                      "--output", path("o.out"),  "--camera", path("single/camera.yaml")};
    if (command == "track") words.insert(words.end(), {"--map", path("single/map.yaml")});
    EXPECT_THAT(run_program(words), EndsWith(2, "--skip: leaves out 100 frames, and " + path("a.mcap")));
  }
}

/// Both cameras at one place: the same pictures.
TEST_F(Bags, OfSeveralCamerasCalibrateAsTheirFolders) {
  simulate("room-small", 24);
  const std::string camera = read_text(path("room-small/camera.yaml"));
  const std::string apart = "\n  T_cn_cnm1: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n";
  write_text(path("rig.yaml"), camera + "\ncam1" + camera.substr(4) + apart);
  write_text(path("rig_with_topics.yaml"), camera + "\n  rostopic: /left/image_raw\ncam1" + camera.substr(4) +
                                               apart + "  rostopic: /right/image_raw\n");
  auto messages = pictures_of("room-small", "/left/image_raw", Wire::kCdr);
  for (const TestMessage& one : pictures_of("room-small", "/right/image_raw", Wire::kCdr))
    messages.push_back(one);
  write_mcap(path("two.mcap"), Wire::kCdr, messages);
  const auto calibrate = [&](const std::vector<std::string>& words) {
    std::vector<std::string> all = {"calibrate",   "--tag-size", "0.096",
                                    "--no-refine", "--output",   path("map.yaml")};
    all.insert(all.end(), words.begin(), words.end());
    run_for_json(all);
    return read_text(path("map.detections.csv"));
  };
  const std::string frames = path("room-small");
  const std::string expected = calibrate({"cam0=" + frames, "cam1=" + frames, "--camera", path("rig.yaml")});
  EXPECT_EQ(calibrate({path("two.mcap"), "--camera", path("rig.yaml"), "--topic", "cam0=/left/image_raw",
                       "--topic", "cam1=/right/image_raw"}),
            expected);
  EXPECT_EQ(calibrate({path("two.mcap"), "--camera", path("rig_with_topics.yaml")}), expected);
  EXPECT_THAT(run_program({"calibrate", path("two.mcap"), "--tag-size", "0.096", "--output", path("map.yaml"),
                           "--topic", "cam0=/left/image_raw", "--topic", "cam1=/right/image_raw"}),
              EndsWith(2, "--camera: is required: CameraInfo messages do not say where several cameras sit"));
}

TEST_F(Bags, OfSeveralCamerasAreLookedAtOneByOne) {
  simulate("single", 4);
  auto messages = pictures_of("single", "/left/image_raw", Wire::kCdr);
  for (const TestMessage& one : pictures_of("single", "/right/image_raw", Wire::kCdr))
    messages.push_back(one);
  write_mcap(path("two.mcap"), Wire::kCdr, messages);
  const ProgramRun run = run_program({"doctor", path("two.mcap"), "--topic", "cam0=/left/image_raw",
                                      "--topic", "cam1=/right/image_raw", "--no-other-families", "--json"});
  const nlohmann::json answer = nlohmann::json::parse(run.out);
  ASSERT_EQ(answer["recordings"].size(), 2u) << run.err;
  EXPECT_EQ(answer["recordings"][0]["input"], path("two.mcap") + " /left/image_raw");
  EXPECT_EQ(answer["recordings"][1]["frames"], 4);
}

TEST_F(Bags, CalibrateByTheirOwnCamera) {
  simulate("room-small", 24);
  auto messages = pictures_of("room-small", "/left/image_raw", Wire::kRos1);
  messages.push_back(camera_info_of("room-small", "/left/camera_info", Wire::kRos1));
  write_ros1_bag(path("one.bag"), messages);
  const std::vector<std::string> words = {"--tag-size", "0.096", "--no-refine", "--output", path("map.yaml")};
  std::vector<std::string> of_bag = {"calibrate", path("one.bag")},
                           of_folder = {"calibrate", path("room-small")};
  of_bag.insert(of_bag.end(), words.begin(), words.end());
  of_folder.insert(of_folder.end(), words.begin(), words.end());
  run_for_json(of_bag);
  // By the same lens and the same response: sRGB, which the pictures tell, and the folder's camera file
  // states.
  const std::string detections = read_text(path("map.detections.csv"));
  run_for_json(of_folder);
  EXPECT_EQ(detections, read_text(path("map.detections.csv")));
}

TEST_F(Bags, ThatAreCutGiveWhatIsThere) {
  simulate("single");
  write_mcap(path("a.mcap"), Wire::kCdr, pictures_of("single", "/image", Wire::kCdr));
  fs::resize_file(path("a.mcap"), fs::file_size(path("a.mcap")) * 5 / 6);
  const ProgramRun run = run_program({"detect", path("a.mcap"), "--output", path("o.csv"), "--json"});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("a.mcap: the bag is cut off or damaged: it ends within the record at byte"));
  const nlohmann::json answer = nlohmann::json::parse(run.out);
  EXPECT_GE(answer["frames"], 8);
  EXPECT_LT(answer["frames"], kFrames);
}

TEST_F(Bags, ThatAreStubsAreRefused) {
  write_text(path("stub.bag"), "#ROSBAG V2.0\n" + std::string(2000, '\0'));
  EXPECT_THAT(run_program({"detect", path("stub.bag"), "--output", path("o.csv")}),
              EndsWith(3, "stub.bag: is a bag without a topic or a message"));
  EXPECT_FALSE(fs::exists(path("o.csv")));
}

}  // namespace
}  // namespace apriltrack::test
