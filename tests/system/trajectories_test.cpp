// `trajectory convert`, and trajectories of other formats where `track` writes and `evaluate` reads them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "apriltrack/eval/trajectory_formats.h"
#include "bag/bag_writers.h"
#include "program.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;

const std::string kTum =
    "0.5 1 -2 0.25 0 0 0.6 0.8\n"
    "0.75 2 -2.5 0.5 0.5 0.5 0.5 0.5\n";

class Trajectories : public ::testing::Test {
 protected:
  std::string of(const std::string& name) const { return (folder_ / name).string(); }
  std::string file(const std::string& name, const std::string& text) const {
    write_text(folder_ / name, text);
    return of(name);
  }
  const fs::path folder_ = temporary_folder();
};

TEST_F(Trajectories, AreConvertedByTheEndingOrByTo) {
  const std::string tum = file("a.tum", kTum);
  const auto csv = run_for_json({"trajectory", "convert", tum, of("a.csv")});
  EXPECT_EQ(csv["from"], "tum");
  EXPECT_EQ(csv["to"], "euroc");
  EXPECT_EQ(csv["poses"], 2);
  EXPECT_NE(read_text(of("a.csv")).find("\n500000000,1,-2,0.25,0.8,0,0,0.6,4,-2,1,0,0,0,0,0,0\n"),
            std::string::npos)
      << read_text(of("a.csv"));
  const auto kitti = run_for_json({"trajectory", "convert", of("a.csv"), of("poses"), "--to", "kitti"});
  EXPECT_EQ(kitti["from"], "euroc");
  EXPECT_EQ(read_text(of("poses.times.txt")), "0.500000000\n0.750000000\n");
  const auto back = run_for_json({"trajectory", "convert", of("poses"), of("b.tum")});
  EXPECT_EQ(back["from"], "kitti");
  const Trajectory trajectory = read_tum(of("b.tum"));
  ASSERT_EQ(trajectory.size(), 2u);
  EXPECT_EQ(trajectory[0].timestamp.ns, 500'000'000);
  EXPECT_EQ(trajectory[0].pose.translation(), Eigen::Vector3d(1, -2, 0.25));
  EXPECT_LT(rotation_angle_rad(trajectory[0].pose.rotation(), Eigen::Quaterniond(0.8, 0, 0, 0.6)), 1e-7);
  run_for_json({"trajectory", "convert", tum, of("my_kitti.txt")});
  EXPECT_TRUE(fs::exists(of("my_kitti.times.txt")));
}

TEST_F(Trajectories, TellWhatIsLostToPeopleAndMachines) {
  const std::string tum = file("a.tum", kTum);
  const auto run = run_program({"trajectory", "convert", tum, of("a.csv")});
  EXPECT_NE(run.err.find("warning: " + of("a.csv") + ": a EuRoC trajectory (.csv) wants velocities"),
            std::string::npos)
      << run.err;
  EXPECT_NE(run.err.find("they are 0"), std::string::npos) << run.err;
  std::set<std::string> losses;
  const auto summary = run_for_json({"trajectory", "convert", of("a.csv"), of("a.kitti")});
  for (const auto& loss : summary["losses"]) {
    losses.insert(fmt::format("{} {}", loss["kind"].get<std::string>(), loss["how"].get<std::string>()));
    EXPECT_FALSE(loss["message"].get<std::string>().empty());
  }
  EXPECT_EQ(losses, (std::set<std::string>{"velocities left_out", "biases left_out", "times converted"}));
}

TEST_F(Trajectories, MistakesOfTheCommandLineEndWith2) {
  const std::string tum = file("a.tum", kTum);
  const std::string kitti = file("00.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  const auto convert = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"trajectory", "convert"});
    return run_program(words);
  };
  EXPECT_THAT(convert({tum, of("out")}), EndsWith(2, "--to: is required"));
  EXPECT_THAT(convert({tum, of("out"), "--to", "evo"}), EndsWith(2, "'evo' is no known format"));
  EXPECT_THAT(convert({tum, tum}), EndsWith(2, "is an input of this run"));
  EXPECT_EQ(read_text(tum), kTum);
  EXPECT_THAT(convert({tum, of("b.tum"), "--rate", "10"}), EndsWith(2, "is of KITTI's poses"));
  EXPECT_THAT(convert({kitti, of("b.tum")}), EndsWith(2, "00.times.txt"));
  EXPECT_THAT(convert({kitti, of("b.tum"), "--rate", "10", "--times", tum}), EndsWith(2, "--rate"));
  EXPECT_THAT(convert({kitti, of("b.tum"), "--times", of("none")}), EndsWith(3, "none"));
  EXPECT_THAT(convert({of("none"), of("b.tum")}), EndsWith(3, "none"));
  EXPECT_THAT(convert({tum, "/dev/stdout", "--to", "kitti"}), EndsWith(2, "/dev/stdout"));
  fs::create_directory(of("c.times.txt"));
  EXPECT_THAT(convert({tum, of("c.kitti")}), EndsWith(3, "c.times.txt"));
  EXPECT_FALSE(fs::exists(of("b.tum")));
  EXPECT_FALSE(fs::exists(of("c.kitti")));
}

TEST_F(Trajectories, WithoutPosesOrWithoutAFileSaySo) {
  for (const char* text : {"", "# timestamp tx ty tz qx qy qz qw\n"}) {
    const std::string empty = file("empty.tum", text);
    EXPECT_THAT(run_program({"trajectory", "convert", empty, of("b.csv")}),
                EndsWith(2, "empty.tum: has no poses"));
  }
  EXPECT_FALSE(fs::exists(of("b.csv")));
  EXPECT_THAT(run_program({"trajectory", "convert", of("none.bag"), of("b.tum"), "--topic", "/pose"}),
              EndsWith(3, "none.bag: no such file"));
}

TEST_F(Trajectories, WhoseNameMisleadsEndWith2) {
  const std::string tum = file("a.tum", kTum);
  EXPECT_THAT(run_program({"trajectory", "convert", tum, of("b.tum"), "--to", "euroc"}),
              EndsWith(2, "which is tum's alone"));
  EXPECT_THAT(run_program({"trajectory", "convert", tum, of("b.kitti"), "--to", "tum"}),
              EndsWith(2, "which is kitti's alone"));
  EXPECT_FALSE(fs::exists(of("b.tum")));
  const ProgramRun run = run_program({"trajectory", "convert", tum, of("b.csv"), "--to", "tum"});
  EXPECT_EQ(run.status, 0);
  EXPECT_NE(run.err.find("though its name ends in .csv"), std::string::npos) << run.err;
}

/// A quarter turn about z at (1, -2, 3 + k) in a message of that type; its header's time is 50 ms before it
/// is logged.
TestMessage pose_message(Wire wire, const std::string& topic, const std::string& type, int k) {
  constexpr std::int64_t kStart_ns = 1'700'000'000'250'000'000, kStep_ns = 100'000'000;
  const std::int64_t stamp_ns = kStart_ns + k * kStep_ns;
  MessageBytes bytes(wire);
  bytes.header(stamp_ns);
  if (type == "nav_msgs/Odometry" || type == "geometry_msgs/TransformStamped") bytes.text("head");
  for (const double value : {1.0, -2.0, 3.0 + k, 0.0, 0.0, 0.7071067811865476, 0.7071067811865476})
    bytes.real(value);
  if (type == "nav_msgs/Odometry" || type == "geometry_msgs/PoseWithCovarianceStamped")
    for (int i = 0; i < 36; ++i) bytes.real(100.0 + i);
  return {topic, type, stamp_ns + 50'000'000, bytes.done()};
}

void expect_quarter_turns(const std::string& tum, const std::string& what) {
  const Trajectory trajectory = read_tum(tum);
  ASSERT_EQ(trajectory.size(), 3u) << what;
  const Eigen::Matrix3d turn = (Eigen::Matrix3d() << 0, -1, 0, 1, 0, 0, 0, 0, 1).finished();
  for (int k = 0; k < 3; ++k) {
    const TimedPose& pose = trajectory[static_cast<std::size_t>(k)];
    EXPECT_EQ(pose.timestamp.ns, 1'700'000'000'250'000'000 + k * 100'000'000) << what;
    EXPECT_EQ(pose.pose.translation(), Eigen::Vector3d(1, -2, 3 + k)) << what;
    EXPECT_LT((pose.pose.rotation_matrix() - turn).norm(), 1e-15) << what;
  }
}

TEST_F(Trajectories, AreReadFromBags) {
  for (const std::string type : {"geometry_msgs/PoseStamped", "geometry_msgs/PoseWithCovarianceStamped",
                                 "geometry_msgs/TransformStamped", "nav_msgs/Odometry"}) {
    for (const Wire wire : {Wire::kRos1, Wire::kCdr, Wire::kCdrBigEndian}) {
      std::vector<TestMessage> messages;
      for (int k = 0; k < 3; ++k) messages.push_back(pose_message(wire, "/head", type, k));
      const std::string bag = of("poses.any");
      if (wire == Wire::kRos1)
        write_ros1_bag(bag, messages);
      else
        write_mcap(bag, wire, messages);
      const auto summary = run_for_json({"trajectory", "convert", bag, of("out.tum")});
      EXPECT_EQ(summary["from"], "bag");
      EXPECT_EQ(summary["poses"], 3);
      expect_quarter_turns(of("out.tum"), type);
    }
  }
}

TEST_F(Trajectories, OfSeveralTopicsOfABagOneIsNamed) {
  std::vector<TestMessage> messages;
  for (int k = 0; k < 3; ++k) {
    messages.push_back(pose_message(Wire::kCdr, "/head", "nav_msgs/Odometry", k));
    messages.push_back(pose_message(Wire::kCdr, "/hand", "geometry_msgs/PoseStamped", 10 + k));
  }
  messages.push_back({"/note", "std_msgs/String", 1'700'000'000'000'000'000, "x"});
  write_mcap(of("two.mcap"), Wire::kCdr, messages);
  const auto convert = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"trajectory", "convert", of("two.mcap"), of("out.tum")});
    return run_program(options);
  };
  EXPECT_THAT(convert({}), EndsWith(2, "--topic"));
  EXPECT_THAT(convert({}), EndsWith(2, "/hand (geometry_msgs"));
  EXPECT_EQ(convert({"--topic", "/head"}).status, 0);
  expect_quarter_turns(of("out.tum"), "named");
  EXPECT_THAT(convert({"--topic", "/note"}), EndsWith(2, "has no topic '/note' with poses"));
  EXPECT_THAT(convert({"--topic", "/head", "--rate", "5"}), EndsWith(2, "--rate"));
  EXPECT_THAT(run_program({"trajectory", "convert", file("a.tum", kTum), of("b.csv"), "--topic", "/head"}),
              EndsWith(2, "--topic"));
  messages.resize(1);
  messages.push_back(messages.front());
  write_mcap(of("two.mcap"), Wire::kCdr, messages);
  EXPECT_THAT(convert({}), EndsWith(2, "two poses of the time 1700000000.250000000 s"));
  messages.resize(1);
  messages.front().bytes.resize(60);  // in its position
  write_mcap(of("two.mcap"), Wire::kCdr, messages);
  EXPECT_THAT(convert({}), EndsWith(2, "/head message 0: ends too soon"));
}

TEST_F(Trajectories, OfTransformsOnePairIsNamed) {
  std::vector<TestMessage> messages;
  for (int k = 0; k < 3; ++k) {
    MessageBytes bytes(Wire::kCdr);
    bytes.u32(2);
    for (const std::string child : {"head", "hand"}) {
      bytes.header(1'700'000'000'250'000'000 + k * 100'000'000).text(child);  // in the frame "camera"
      for (const double value :
           {1.0, -2.0, (child == "head" ? 3.0 : 8.0) + k, 0.0, 0.0, 0.7071067811865476, 0.7071067811865476})
        bytes.real(value);
    }
    messages.push_back({"/tf", "tf2_msgs/TFMessage", 1'700'000'000'300'000'000 + k, bytes.done()});
  }
  write_mcap(of("tf.mcap"), Wire::kCdr, messages);
  EXPECT_THAT(run_program({"trajectory", "convert", of("tf.mcap"), of("out.tum")}),
              EndsWith(2, "camera:hand (3 poses), camera:head (3 poses)"));
  run_for_json({"trajectory", "convert", of("tf.mcap"), of("out.tum"), "--transform", "camera:head"});
  expect_quarter_turns(of("out.tum"), "named");
  EXPECT_THAT(
      run_program({"trajectory", "convert", of("out.tum"), of("b.csv"), "--transform", "camera:head"}),
      EndsWith(2, "--transform: is of a bag"));
}

TEST_F(Trajectories, OfTrackAreOfAllFormatsAndScoredAlike) {
  const std::string film = of("film");
  run_for_json({"simulate", "--scene", "room", "--frames", "6", "--output", film});
  const std::vector<std::string> track = {"track", film, "--method", "pnp", "--output"};
  const auto tracked = [&](const std::string& name, const std::vector<std::string>& options) {
    std::vector<std::string> words = track;
    words.push_back(of(name));
    words.insert(words.end(), options.begin(), options.end());
    const auto summary = run_for_json(words);
    EXPECT_EQ(summary["with_pose"], 6) << name;
    return summary;
  };
  EXPECT_TRUE(tracked("a.tum", {})["losses"].empty());
  EXPECT_EQ(tracked("a.csv", {})["losses"].size(), 2u);
  EXPECT_EQ(tracked("a.kitti", {})["losses"].size(), 1u);
  EXPECT_TRUE(tracked("a.mcap", {})["losses"].empty());
  tracked("B.CSV", {});
  EXPECT_EQ(read_text(of("B.CSV")), read_text(of("a.csv")));
  tracked("plain", {});
  tracked("euroc.out", {"--output-format", "euroc"});
  EXPECT_EQ(read_text(of("plain")), read_text(of("a.tum")));
  EXPECT_EQ(read_text(of("euroc.out")), read_text(of("a.csv")));
  nlohmann::json first;
  for (const std::string estimate : {"a.tum", "a.csv", "a.kitti", "a.mcap"}) {
    auto score = run_for_json({"evaluate", "--truth", film, "--estimate", of(estimate)});
    if (first.is_null()) first = score;
    EXPECT_EQ(score["frames"], first["frames"]);
    EXPECT_NEAR(score["position_rmse_mm"].get<double>(), first["position_rmse_mm"].get<double>(), 1e-9);
    EXPECT_GT(score["position_rmse_mm"].get<double>(), 0.0);
  }
  for (const std::string truth : {"truth.csv", "truth.kitti"}) {
    run_for_json({"trajectory", "convert", film + "/truth.tum", of(truth)});
    const auto score = run_for_json({"evaluate", "--truth", of(truth), "--estimate", of("a.tum"), "--camera",
                                     film + "/camera.yaml", "--map", film + "/map.yaml"});
    EXPECT_NEAR(score["position_rmse_mm"].get<double>(), first["position_rmse_mm"].get<double>(), 1e-9);
  }
  EXPECT_THAT(run_program({"track", film, "--output", "/dev/null", "--output-format", "kitti"}),
              EndsWith(2, "/dev/null"));
  EXPECT_THAT(run_program({"track", film, "--output", of("b.kitti"), "--frames-csv", of("b.times.txt")}),
              EndsWith(2, "is the file of"));
}

/// Motion capture at 100 Hz, a camera at 30: frames 0, 3, 6 and 9 of ten meet a pose within 1 ms.
TEST_F(Trajectories, WarnOfATruthThatHasNoPoseAtTheTimesOfFrames) {
  const auto at_hz = [](double rate_hz, int count) {
    std::string text;
    for (int i = 0; i < count; ++i) text += fmt::format("{:.9f} {} 0 0 0 0 0 1\n", i / rate_hz, i / rate_hz);
    return text;
  };
  const auto score = run_for_json({"evaluate", "--truth", file("mocap.tum", at_hz(100.0, 31)), "--estimate",
                                   file("film.tum", at_hz(30.0, 10))});
  EXPECT_EQ(score["unmatched_estimates"], 6);
  ASSERT_EQ(score["warnings"].size(), 1u);
  EXPECT_THAT(score["warnings"][0].get<std::string>(),
              AllOf(HasSubstr("6 of the 10 poses of"), HasSubstr("the truth's 31 poses")));
}

// Poses of bags where other commands read them.

/// /head in the first three tenths of a second, /hand a second later.
void write_head_and_hand(const std::string& bag) {
  std::vector<TestMessage> messages;
  for (int k = 0; k < 3; ++k) {
    messages.push_back(pose_message(Wire::kCdr, "/head", "nav_msgs/Odometry", k));
    messages.push_back(pose_message(Wire::kCdr, "/hand", "geometry_msgs/PoseStamped", 10 + k));
  }
  write_mcap(bag, Wire::kCdr, messages);
}

/// The same poses, those of /head moved by 2 m, those of /hand by 5 m.
std::string moved_by_2_and_5_m() {
  std::string text;
  for (const int k : {0, 1, 2, 10, 11, 12}) {
    const int tenths_s = 2 + k;
    text += fmt::format("{}.{}5 1 -2 {} 0 0 0.7071067811865476 0.7071067811865476\n",
                        1'700'000'000 + tenths_s / 10, tenths_s % 10, 3 + k + (k < 10 ? 2 : 5));
  }
  return text;
}

TEST_F(Trajectories, OfBagsAreScoredByTheNameOfTheirTopic) {
  write_head_and_hand(of("two.mcap"));
  const std::string truth = file("truth.tum", moved_by_2_and_5_m());
  const auto words = [&](const std::string& truth_file, const std::string& estimate,
                         std::vector<std::string> options) {
    options.insert(options.begin(), {"evaluate", "--truth", truth_file, "--estimate", estimate});
    return options;
  };
  const auto rmse_m = [&](const std::string& truth_file, const std::string& estimate,
                          const std::vector<std::string>& options) {
    return run_for_json(words(truth_file, estimate, options))["position_rmse_m"].get<double>();
  };
  const std::string bag = of("two.mcap");
  EXPECT_NEAR(rmse_m(truth, bag, {"--topic", "/head"}), 2.0, 1e-12);
  EXPECT_NEAR(rmse_m(truth, bag, {"--topic", "estimate=/hand"}), 5.0, 1e-12);
  EXPECT_NEAR(rmse_m(bag, truth, {"--topic", "truth=/hand"}), 5.0, 1e-12);
  EXPECT_NEAR(rmse_m(bag, bag, {"--topic", "/hand"}), 0.0, 1e-12);
  EXPECT_NEAR(rmse_m(bag, bag, {"--topic", "/hand", "--topic", "truth=/head", "--topic", "estimate=/head"}),
              0.0, 1e-12);

  const auto refusal = [&](const std::string& truth_file, const std::string& estimate,
                           const std::vector<std::string>& options) {
    return run_program(words(truth_file, estimate, options));
  };
  EXPECT_THAT(refusal(truth, bag, {}), EndsWith(2, "--topic names one of them"));
  EXPECT_THAT(refusal(truth, bag, {"--topic", "hand=/hand"}), EndsWith(2, "must be NAME, truth=NAME or"));
  EXPECT_THAT(refusal(truth, bag, {"--topic", "/hand", "--topic", "/head"}), EndsWith(2, "is given twice"));
  EXPECT_THAT(refusal(truth, bag, {"--topic", "/head", "--topic", "truth=/head"}),
              EndsWith(2, "truth.tum' is none: leave it out"));
  EXPECT_THAT(refusal(truth, truth, {"--transform", "a:b"}), EndsWith(2, "neither --truth nor --estimate"));
}

TEST_F(Trajectories, OfTransformsOfABagAreScoredByTheirFrames) {
  std::vector<TestMessage> messages;
  for (int k = 0; k < 3; ++k) {
    const TestMessage pose = pose_message(Wire::kRos1, "/p", "geometry_msgs/TransformStamped", k);
    MessageBytes count(Wire::kRos1);
    count.u32(1);
    messages.push_back({"/tf", "tf2_msgs/TFMessage", pose.log_time_ns, count.done() + pose.bytes});
  }
  messages.push_back({"/p", "geometry_msgs/PoseStamped", 0,
                      pose_message(Wire::kRos1, "/p", "geometry_msgs/PoseStamped", 0).bytes});
  write_ros1_bag(of("tf.bag"), messages);
  const auto summary = run_for_json({"evaluate", "--truth", file("truth.tum", moved_by_2_and_5_m()),
                                     "--estimate", of("tf.bag"), "--transform", "camera:head"});
  EXPECT_NEAR(summary["position_rmse_m"].get<double>(), 2.0, 1e-12);
}

TEST_F(Trajectories, OfABagAreFilmedByTheNameOfTheirTopic) {
  write_head_and_hand(of("two.mcap"));
  const std::string camera =
      file("camera.yaml", R"(cam0: {camera_model: pinhole, intrinsics: [60, 60, 32, 24],
  distortion_model: none, distortion_coeffs: [], resolution: [64, 48], exposure_time: 0.001}
)");
  const auto film = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"simulate", "--output", of("film"), "--frames", "2"});
    return run_program(options);
  };
  const std::vector<std::string> own = {
      "--map", source_path("maps/cube_6.yaml").string(), "--camera", camera, "--trajectory", of("two.mcap")};
  std::vector<std::string> named = own;
  named.insert(named.end(), {"--topic", "/head"});
  EXPECT_THAT(film(own), EndsWith(2, "--topic names one of them"));
  EXPECT_THAT(film({"--scene", "room", "--topic", "/head"}), EndsWith(2, "--trajectory: is missing"));
  EXPECT_EQ(film(named).status, 0);
  const Trajectory truth = read_tum(of("film/truth.tum"));
  ASSERT_EQ(truth.size(), 2u);
  EXPECT_LT((truth[0].pose.translation() - Eigen::Vector3d(1, -2, 3)).norm(), 0.3);  // mid-exposure
}

}  // namespace
}  // namespace apriltrack::test
