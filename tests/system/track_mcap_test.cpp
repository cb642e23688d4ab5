// `track --output x.mcap`: a run as Foxglove shows it, read by our reader of bags and, where they are
// installed, by MCAP's own and Foxglove's.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "apriltrack/bag/bag_reader.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/eval/frame_log.h"
#include "apriltrack/eval/trajectory.h"
#include "apriltrack/tags/tag_map.h"
#include "program.h"
#include "support/base64.h"
#include "support/judge_output.h"
#include "support/judges.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kFrames = 12;

struct Message {
  Timestamp time;
  std::string bytes;
  json parsed;
};

/// By topic, in the order of time.
std::map<std::string, std::vector<Message>> messages_of(const fs::path& path) {
  const auto reader = open_bag(path);
  std::set<std::size_t> all;
  for (std::size_t i = 0; i < reader->topics().size(); ++i) all.insert(i);
  reader->choose(all);
  std::map<std::string, std::vector<Message>> messages;
  while (const auto message = reader->next()) {
    EXPECT_EQ(message->error, "");
    const BagTopic& topic = reader->topics()[message->topic];
    Message one{message->log_time, std::string(message->bytes), {}};
    if (topic.encoding == "json") one.parsed = json::parse(one.bytes);
    messages[topic.name].push_back(std::move(one));
  }
  EXPECT_EQ(reader->damage(), "");
  return messages;
}

Eigen::Vector3d vector_of(const json& v) {
  return {v["x"].get<double>(), v["y"].get<double>(), v["z"].get<double>()};
}

Pose pose_of(const json& position, const json& q) {
  return {Eigen::Quaterniond(q["w"].get<double>(), q["x"].get<double>(), q["y"].get<double>(),
                             q["z"].get<double>()),
          vector_of(position)};
}

/// A fast film of a room, tracked twice: as TUM's lines and as MCAP.
class TrackMcapTest : public ::testing::Test {
 protected:
  /// Made by the test that comes first.
  void SetUp() override {
    if (!run_) make_files();
  }
  static void make_files() {
    run_ = new Run;
    run_for_json(
        {"simulate", "--scene", "room", "--frames", std::to_string(kFrames), "--output", run_->film});
    run_for_json(
        {"track", run_->film, "--output", run_->tum, "--frames-csv", run_->log, "--tags-csv", run_->tags});
    run_->summary = run_for_json({"track", run_->film, "--output", run_->mcap, "--output-images"});
    run_->messages = messages_of(run_->mcap);
  }
  static void TearDownTestSuite() {
    delete run_;
    run_ = nullptr;
  }

  struct Run {
    const fs::path folder = temporary_folder();
    const std::string film = folder / "film", tum = folder / "out.tum", log = folder / "frames.csv",
                      tags = folder / "tags.csv", mcap = folder / "out.mcap";
    json summary;
    std::map<std::string, std::vector<Message>> messages;
  };
  static inline Run* run_ = nullptr;
  /// An empty folder of the running test's own; temporary_folder() would be the files' of the first one.
  static fs::path fresh_folder() {
    const fs::path folder = run_->folder / ::testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::create_directories(folder);
    return folder;
  }
  static const std::vector<Message>& topic(const std::string& name) { return run_->messages[name]; }
};

TEST_F(TrackMcapTest, HasAMessageOfEachTopicForEachFrame) {
  EXPECT_EQ(run_->summary["output"], run_->mcap);
  const std::vector<FrameLogRow> log = read_frame_log(run_->log);
  ASSERT_EQ(log.size(), static_cast<std::size_t>(kFrames));
  for (const std::string name : {"/tags", "/status", "/camera/annotations", "/camera/image"}) {
    ASSERT_EQ(topic(name).size(), log.size()) << name;
    for (std::size_t i = 0; i < log.size(); ++i) EXPECT_EQ(topic(name)[i].time, log[i].timestamp) << name;
  }
  for (std::size_t i = 0; i < log.size(); ++i) {
    EXPECT_EQ(topic("/status")[i].parsed["status"], log[i].status);
    EXPECT_EQ(topic("/status")[i].parsed["tags_tracked"], log[i].tags_tracked);
  }
  for (const std::string name : {"/map", "/camera/calibration", "/camera/frustum"})
    EXPECT_EQ(topic(name).size(), 1u) << name;
}

TEST_F(TrackMcapTest, PosesAreThoseOfTheTrajectoryToTheLastBit) {
  const Trajectory trajectory = read_tum(run_->tum);
  ASSERT_GT(trajectory.size(), 8u);
  for (const std::string name : {"/tf", "/pose", "/pose_with_covariance"})
    ASSERT_EQ(topic(name).size(), trajectory.size()) << name;
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const json& tf = topic("/tf")[i].parsed;
    EXPECT_EQ(topic("/tf")[i].time, trajectory[i].timestamp);
    EXPECT_EQ(tf["parent_frame_id"], "world");
    EXPECT_EQ(tf["child_frame_id"], "cam0");
    const json& pose = topic("/pose")[i].parsed["pose"];
    for (const Pose& told :
         {pose_of(tf["translation"], tf["rotation"]), pose_of(pose["position"], pose["orientation"])}) {
      EXPECT_EQ(told.translation(), trajectory[i].pose.translation());
      EXPECT_EQ(told.rotation().coeffs(), trajectory[i].pose.rotation().coeffs());
    }
  }
}

TEST_F(TrackMcapTest, TagsHangWhereTheMapHasThemAndAreOutlinedWhereTheyAreSeen) {
  const TagMap map = read_tag_map(run_->film + "/map.yaml");
  const Camera camera = read_cameras(run_->film + "/camera.yaml").cameras.front();
  const json& drawn = topic("/map")[0].parsed["entities"][0];
  EXPECT_EQ(drawn["frame_id"], "world");
  ASSERT_EQ(drawn["lines"].size(), map.tags.size());
  const auto corners = corners_in_map(map.tags[3]);
  for (std::size_t i = 0; i < corners.size(); ++i)
    EXPECT_LT((vector_of(drawn["lines"][3]["points"][i]) - corners[i]).norm(), 1e-12);
  // The true path tells where tags are seen.
  std::map<std::int64_t, Pose> truth;
  for (const TimedPose& pose : read_tum(run_->film + "/truth.tum")) truth[pose.timestamp.ns] = pose.pose;
  int num_outlines = 0;
  for (const Message& message : topic("/camera/annotations")) {
    const Pose T_camera_world = truth.at(message.time.ns).inverse();
    const json& outlines = message.parsed["points"];
    for (std::size_t k = 0; k < outlines.size(); ++k) {
      const int id = std::stoi(message.parsed["texts"][k]["text"].get<std::string>());
      const MapTag* tag = map.find({"tag36h11", id});
      ASSERT_NE(tag, nullptr);
      const auto corners_map = corners_in_map(*tag);
      for (std::size_t i = 0; i < corners_map.size(); ++i) {
        const Eigen::Vector2d expected = *camera.model.project(T_camera_world * corners_map[i]);
        const json& p = outlines[k]["points"][i];
        const Eigen::Vector2d shown(p["x"].get<double>() - 0.5, p["y"].get<double>() - 0.5);
        EXPECT_LT((shown - expected).norm(), 3.0) << "tag " << id;
      }
      ++num_outlines;
    }
  }
  EXPECT_GT(num_outlines, 20);
}

TEST_F(TrackMcapTest, PicturesAreThoseOfTheFilm) {
  std::map<std::int64_t, fs::path> frames;
  for (const auto& entry : fs::directory_iterator(run_->film + "/frames"))
    frames[std::stoll(entry.path().stem().string())] = entry.path();
  for (const Message& message : topic("/camera/image")) {
    const std::string bytes = decoded_base64(message.parsed["data"].get<std::string>());
    const cv::Mat shown =
        cv::imdecode(std::vector<unsigned char>(bytes.begin(), bytes.end()), cv::IMREAD_GRAYSCALE);
    const cv::Mat filmed = cv::imread(frames.at(message.time.ns).string(), cv::IMREAD_GRAYSCALE);
    ASSERT_EQ(shown.size(), filmed.size());
    EXPECT_LT(cv::norm(shown, filmed, cv::NORM_L1) / static_cast<double>(filmed.total()),
              2.5);  // JPEG, noise
    EXPECT_EQ(message.parsed["frame_id"], "cam0");
    EXPECT_EQ(message.parsed["timestamp"]["nsec"].get<std::int64_t>(), message.time.ns % 1'000'000'000);
  }
}

/// A line of read_mcap.mjs each.
std::vector<json> judged(const std::string& file, const std::string& what = "") {
  const std::string command =
      fmt::format("{} '{}' '{}' {}", node(), source_path("tests/bag/read_mcap.mjs").string(), file, what);
  std::istringstream stream(judge_output(command));
  std::vector<json> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(json::parse(line));
  return lines;
}

std::vector<Judge> mcap_judges() {
  std::vector<Judge> judges = node_judges(
      {"@mcap/core", "@foxglove/schemas", "@foxglove/rosmsg", "@foxglove/rosmsg2-serialization", "ajv"});
  judges.push_back(program_judge("zstd", "zstd"));
  return judges;
}

TEST_F(TrackMcapTest, FoxglovesOwnSchemasHoldOfEveryMessage) {
  APRILTRACK_NEED_JUDGE(mcap_judges());
  const std::vector<json> lines = judged(run_->mcap);  // the judge fails where one does not hold
  std::map<std::string, int> counts;
  std::size_t num_ros = 0;
  const std::vector<FrameLogRow> log = read_frame_log(run_->log);
  std::map<std::int64_t, FrameLogRow> rows;
  for (const FrameLogRow& row : log) rows[row.timestamp.ns] = row;
  for (const json& line : lines) {
    if (!line.contains("schema")) continue;
    ++counts[line["schema"].get<std::string>()];
    if (line["encoding"] != "cdr") continue;
    ++num_ros;
    const FrameLogRow& row = rows.at(std::stoll(line["time"].get<std::string>()));
    const json& message = line["json"];
    EXPECT_EQ(message["header"]["frame_id"], "world");
    const json& pose = message["pose"]["pose"];
    EXPECT_LT((vector_of(pose["position"]) - row.pose->translation()).norm(), 1e-8);
    const Eigen::Matrix3d R = row.pose->rotation_matrix();
    for (int i = 0; i < 2; ++i) {  // blocks of position and rotation
      const Eigen::Matrix3d expected = R * row.covariance->block<3, 3>(3 * i, 3 * i) * R.transpose();
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
          EXPECT_NEAR(message["pose"]["covariance"][static_cast<std::size_t>(6 * (3 * i + r) + 3 * i + c)]
                          .get<double>(),
                      expected(r, c), 1e-6 * expected.norm());
    }
  }
  EXPECT_GT(num_ros, 8u);
  for (const std::string type :
       {"foxglove.FrameTransform", "foxglove.PoseInFrame", "foxglove.SceneUpdate", "foxglove.CompressedImage",
        "foxglove.CameraCalibration", "foxglove.ImageAnnotations", "apriltrack.FrameStatus"})
    EXPECT_GT(counts[type], 0) << type;
  EXPECT_GE(lines.back()["crcs"].get<int>(), 3);
  for (const json& schema : judged(run_->mcap, "schemas"))
    EXPECT_TRUE(schema["same"].get<bool>()) << schema["schema"];
}

TEST_F(TrackMcapTest, SaysWhyThereIsNoPose) {
  const std::string film = fresh_folder() / "film", out = fresh_folder() / "out.mcap";
  run_for_json({"simulate", "--scene", "room", "--frames", "40", "--speed", "3", "--output", film});
  const auto summary = run_for_json({"track", film, "--method", "pnp", "--output", out});
  ASSERT_GT(summary["lost"].get<int>(), 0) << "choose a faster film";
  auto messages = messages_of(out);
  ASSERT_FALSE(messages["/log"].empty());
  EXPECT_EQ(messages["/log"][0].parsed["level"], 3);
  EXPECT_THAT(messages["/log"][0].parsed["message"].get<std::string>(), ::testing::StartsWith("lost: "));
  EXPECT_EQ(messages["/tf"].size(), summary["with_pose"].get<std::size_t>());
  EXPECT_EQ(messages["/status"].size(), summary["frames"].get<std::size_t>());
  APRILTRACK_NEED_JUDGE(mcap_judges());
  const std::vector<json> schemas = judged(out, "schemas");
  EXPECT_EQ(schemas.size(), 6u);  // all but the picture's
  for (const json& schema : schemas) EXPECT_TRUE(schema["same"].get<bool>()) << schema["schema"];
  judged(out);
}

TEST_F(TrackMcapTest, ABodyMovesBeforeTheCamera) {
  const fs::path folder = fresh_folder();
  run_for_json({"simulate", "--scene", "bundle", "--frames", "5", "--output", folder / "film"});
  const auto run = run_program(
      {"track", folder / "film", "--mode", "joint", "--output", folder / "x", "--output-format", "mcap"});
  ASSERT_EQ(run.status, 0) << run.err;
  auto messages = messages_of(folder / "x");
  const std::string body = read_tag_map(folder / "film/map.yaml").frame;
  ASSERT_FALSE(messages["/tf"].empty());
  EXPECT_EQ(messages["/tf"][0].parsed["parent_frame_id"], "cam0");
  EXPECT_EQ(messages["/tf"][0].parsed["child_frame_id"], body);
  EXPECT_EQ(messages["/map"][0].parsed["entities"][0]["frame_id"], body);
  EXPECT_EQ(messages["/path"].back().parsed["entities"][0]["frame_id"], "cam0");
  EXPECT_EQ(messages.count("/camera/image"), 0u);
}

TEST_F(TrackMcapTest, NothingHalfWrittenIsLeft) {
  const fs::path folder = fresh_folder();
  const std::vector<std::string> words = {"track",    run_->film,        "--method",       "pnp",
                                          "--output", folder / "x.mcap", "--output-images"};
  const auto full = run_program_on_full_disk(words, 200'000);
  EXPECT_THAT(full, EndsWith(3, "x.mcap"));
  EXPECT_TRUE(names_in(folder).empty());
  write_text(folder / "x.mcap", "old");
  EXPECT_EQ(run_program_on_full_disk(words, 200'000).status, 3);
  EXPECT_EQ(read_text(folder / "x.mcap"), "old");
  EXPECT_EQ(run_program(words).status, 0);
  EXPECT_TRUE(is_bag(folder / "x.mcap"));
  EXPECT_EQ(names_in(folder), (std::set<std::string>{"x.mcap"}));
}

TEST_F(TrackMcapTest, MistakesOfTheCommandLineEndWith2) {
  const fs::path folder = fresh_folder();
  EXPECT_THAT(run_program({"track", run_->film, "--output", folder / "a.tum", "--output-images"}),
              EndsWith(2, "--output-images"));
  EXPECT_THAT(run_program({"track", run_->film, "--output", folder / "a.tum", "--output-format", "bag"}),
              EndsWith(2, "--output-format"));
  EXPECT_TRUE(names_in(folder).empty());
}

TEST_F(TrackMcapTest, TheTagLogAndTheSummaryTellOfEachTag) {
  const TagMap map = read_tag_map(run_->film + "/map.yaml");
  std::istringstream lines(read_text(run_->tags));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line,
            "timestamp_ns,family,id,status,is_read,log_odds,expected_share,found_share,shift_px,residual_px,"
            "sigma_px,projected_c0x,projected_c0y,projected_c1x,projected_c1y,projected_c2x,projected_c2y,"
            "projected_c3x,projected_c3y");
  std::map<int, std::map<std::string, int>> counts;
  int num_residuals = 0;
  while (std::getline(lines, line)) {
    std::vector<std::string> fields;
    std::istringstream columns(line);
    for (std::string field; std::getline(columns, field, ',');) fields.push_back(field);
    ASSERT_EQ(fields.size(), 19u) << line;
    EXPECT_NE(map.find({fields[1], std::stoi(fields[2])}), nullptr);
    ++counts[std::stoi(fields[2])][fields[3]];
    EXPECT_GT(std::stod(fields[10]), 0.0);
    if (fields[9].empty()) continue;
    EXPECT_LT(std::stod(fields[9]), 5.0);
    EXPECT_EQ(fields[4], "1");
    ++num_residuals;
  }
  EXPECT_GT(num_residuals, 10);
  ASSERT_FALSE(counts.empty());
  ASSERT_EQ(run_->summary["tags"].size(), counts.size());
  for (const json& tag : run_->summary["tags"]) {
    auto& expected = counts.at(tag["id"].get<int>());
    for (const std::string status :
         {"detected", "tracked", "occluded", "hidden", "elsewhere", "suspect", "unjudged", "unmapped"})
      EXPECT_EQ(tag[status].get<int>(), expected[status]) << tag;
    EXPECT_EQ(tag["used"].get<int>(), expected["detected"] + expected["tracked"]);
    if (tag["used"] == 0) continue;
    EXPECT_LE(tag["first_used_timestamp_ns"].get<std::int64_t>(),
              tag["last_used_timestamp_ns"].get<std::int64_t>());
  }
}

/// The pictures of a run, taken out one by one and tracked as a folder, are those that the run itself gives,
/// and its calibration is the camera's: the trajectories are the same, byte for byte.
TEST_F(TrackMcapTest, IsAnInputWithItsOwnPicturesAndCamera) {
  const fs::path folder = fresh_folder();
  const std::string pictures = folder / "pictures", of_pictures = folder / "pictures.tum",
                    of_mcap = folder / "mcap.tum", camera_file = folder / "camera.yaml";
  fs::create_directories(pictures);
  for (const Message& message : topic("/camera/image"))
    std::ofstream(fs::path(pictures) / fmt::format("{}.jpg", message.time.ns), std::ios::binary)
        << decoded_base64(message.parsed["data"].get<std::string>());
  const Camera camera = read_cameras(run_->film + "/camera.yaml").cameras.front();
  const Pinhole& p = camera.model.pinhole();
  ASSERT_EQ(camera.model.distortion_name(), "radtan");
  std::ofstream(camera_file) << fmt::format(
      "cam0:\n  camera_model: pinhole\n  intrinsics: [{}, {}, {}, {}]\n  distortion_model: radtan\n"
      "  distortion_coeffs: [{}]\n  resolution: [{}, {}]\n",
      p.fx, p.fy, p.cx, p.cy,
      fmt::join(std::get<RadtanDistortion>(camera.model.distortion()).coefficients(), ", "), camera.width,
      camera.height);
  const std::string map = run_->film + "/map.yaml";
  run_for_json({"track", pictures, "--camera", camera_file, "--map", map, "--output", of_pictures});
  run_for_json({"track", run_->mcap, "--map", map, "--output", of_mcap});
  ASSERT_GT(read_tum(of_mcap).size(), 8u);
  EXPECT_EQ(read_text(of_mcap), read_text(of_pictures));
}

}  // namespace
}  // namespace apriltrack::test
