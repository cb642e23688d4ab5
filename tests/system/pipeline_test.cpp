// The whole job through the command line, judged against the simulator's exact truth.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "apriltrack/camera/camera.h"
#include "apriltrack/eval/trajectory.h"
#include "program.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;

void simulate(const std::string& scene, int frames, const std::string& folder) {
  run_for_json(
      {"simulate", "--scene", scene, "--frames", std::to_string(frames), "--seed", "3", "--output", folder});
}

/// The whole round of the gentle scene in a fifth of its frames, as sharp as the scene's own.
void simulate_quick_round(const std::string& folder) {
  run_for_json({"simulate", "--scene", "room-gentle", "--frames", "60", "--speed", "5", "--exposure",
                "0.0012", "--seed", "3", "--output", folder});
}

std::size_t num_lines(const fs::path& file) {
  std::ifstream in(file);
  return static_cast<std::size_t>(std::count(std::istreambuf_iterator<char>(in), {}, '\n'));
}

/// As the frame log has it, without the zeros before it.
std::string timestamp_in_name(const fs::path& image) {
  return std::to_string(std::stoll(image.stem().string()));
}

TEST(Pipeline, AnEstimateThatIsOffByOneCentimetreSaysSo) {
  const fs::path folder = temporary_folder() / "single";
  simulate("single", 4, folder);
  std::ifstream truth(folder / "truth.tum");
  std::ofstream shifted(folder / "shifted.tum");
  shifted.precision(12);
  std::string time;
  double x = 0.0;
  for (std::string line; std::getline(truth, line);) {
    if (line.starts_with('#')) continue;
    std::istringstream words(line);
    words >> time >> x;
    std::string rest;
    std::getline(words, rest);
    shifted << time << ' ' << x + 0.01 << rest << '\n';
  }
  shifted.close();
  const json score =
      run_for_json({"evaluate", "--truth", folder, "--estimate", folder / "shifted.tum", "--mode", "joint"});
  EXPECT_NEAR(score["position_rmse_m"].get<double>(), 0.010, 1e-6);
  EXPECT_NEAR(score["position_rmse_mm"].get<double>(), 10.0, 1e-3);  // as 0.1 told it
}

TEST(Pipeline, TheOtherModeIsProposedWhereTheTruthSpeaksForIt) {
  const fs::path folder = temporary_folder();
  const std::string body = folder / "single";
  simulate("single", 4, body);
  const std::vector<std::string> words = {"evaluate", "--truth", body, "--estimate", body + "/truth.tum"};
  EXPECT_THAT(run_program(words), EndsWith(1, "in 4: try --mode joint"));
  const std::string room = folder / "room";
  simulate("room-gentle", 4, room);
  const ProgramRun right = run_program({"evaluate", "--truth", room, "--estimate", room + "/truth.tum"});
  EXPECT_EQ(right.status, 0);
  EXPECT_THAT(right.err, ::testing::Not(::testing::HasSubstr("--mode")));
}

// As poses of a body, a room's truth shows tags in many frames, too: what tells is that nobody can have had
// poses in the others.
TEST(Pipeline, TheOtherModeIsProposedWherePosesWereFoundWithoutATag) {
  const fs::path folder = temporary_folder();
  const std::string room = folder / "room";
  run_for_json({"simulate", "--scene", "room", "--frames", "45", "--speed", "2", "--exposure", "0.005",
                "--output", room});
  const auto evaluate = [&](const std::string& recording, const std::string& mode) {
    return run_program(
        {"evaluate", "--truth", recording, "--estimate", recording + "/truth.tum", "--mode", mode});
  };
  // Counted by another program, of the same definition of a visible tag.
  EXPECT_EQ(evaluate(room, "joint").err,
            "warning: as --mode joint, the truth shows no tag in 6 of the 45 frames that have a pose, as "
            "--mode ego in 0: try --mode ego\n");
  EXPECT_EQ(evaluate(room, "ego").err, "");
  const std::string body = folder / "bundle";
  simulate("bundle", 30, body);
  EXPECT_EQ(evaluate(body, "joint").err, "");
}

TEST(Pipeline, PosesOfAnotherRecordingAreDoubtedByTheNamesOfBothFiles) {
  const fs::path folder = temporary_folder();
  const std::string room = folder / "room", other = folder / "other";
  simulate("room", 20, room);
  run_for_json({"simulate", "--scene", "room-gentle", "--frames", "20", "--rate", "30", "--speed", "10",
                "--output", other});
  const auto score = [&](const std::string& estimate) {
    return run_program({"evaluate", "--truth", room, "--estimate", estimate});
  };
  const ProgramRun run = score(other + "/truth.tum");
  EXPECT_THAT(run, EndsWith(0, "poses are over 100 px off: does " + other + "/truth.tum belong to " + room +
                                   "/truth.tum?"));
  EXPECT_EQ(score(room + "/truth.tum").err, "");
  const json summary = run_for_json({"evaluate", "--truth", room, "--estimate", other + "/truth.tum"});
  ASSERT_EQ(summary["warnings"].size(), 1U) << summary.dump(1);
  EXPECT_EQ(run.err, "warning: " + summary["warnings"][0].get<std::string>() + "\n");
  EXPECT_EQ(run_for_json({"evaluate", "--truth", room, "--estimate", room + "/truth.tum"})["warnings"],
            json::array());

  // Half of the poses are the right ones: bad, and yet of this recording.
  Trajectory half = read_tum(room + "/truth.tum");
  const Trajectory wrong = read_tum(other + "/truth.tum");
  ASSERT_EQ(half.size(), wrong.size());
  for (std::size_t i = 0; i < half.size() / 2; ++i) half[i] = wrong[i];
  write_tum(folder / "half.tum", half);
  EXPECT_EQ(score(folder / "half.tum").err, "");
}

TEST(Pipeline, RecordingsThatDoNotMeetAreNamedWithTheirTimes) {
  const fs::path folder = temporary_folder();
  const std::string truth = folder / "truth.tum";
  const std::string later = folder / "later.tum";
  write_text(truth, "100.0 0 0 0 0 0 0 1\n101.0 0 0 0 0 0 0 1\n");
  write_text(later, "200.25 0 0 0 0 0 0 1\n203.5 0 0 0 0 0 0 1\n");
  const ProgramRun apart = run_program({"evaluate", "--truth", truth, "--estimate", later});
  for (const std::string& part : {truth, later, std::string("from 100.000000000 to 101.000000000 s"),
                                  std::string("from 200.250000000 to 203.500000000 s")})
    EXPECT_THAT(apart, EndsWith(1, part));
  const std::string log = folder / "frames.csv";
  write_text(log,
             "timestamp_ns,status,tx,ty,tz,qx,qy,qz,qw,tags_detected,tags_tracked,sigma_position_m,"
             "sigma_rotation_rad,latency_ms,second_mode_odds\n200250000000,lost,,,,,,,,0,0,,,1.0,0\n");
  const ProgramRun other_log =
      run_program({"evaluate", "--truth", truth, "--estimate", truth, "--frames-csv", log});
  for (const std::string& part : {truth, log, std::string("from 200250000000 to 200250000000 ns"),
                                  std::string("from 100000000000 to 101000000000 ns")})
    EXPECT_THAT(other_log, EndsWith(1, part));
}

TEST(Pipeline, ACameraWithoutResolutionTakesThatOfTheImages) {
  const fs::path folder = temporary_folder();
  const std::string room = folder / "room";
  simulate("room-gentle", 12, room);
  const CameraRig rig = read_cameras(room + "/camera.yaml");
  const Pinhole& pinhole = rig.cameras.front().model.pinhole();
  const auto& lens = std::get<RadtanDistortion>(rig.cameras.front().model.distortion());
  const json camera = {
      {"camera_matrix", {{pinhole.fx, 0, pinhole.cx}, {0, pinhole.fy, pinhole.cy}, {0, 0, 1}}},
      {"distortion_coefficients", lens.coefficients()}};
  const std::string file = folder / "wpilib.json";
  write_text(file, camera.dump());

  const std::string tum = folder / "camera.tum";
  const std::string map = folder / "map.yaml";
  run_for_json({"detect", room, "--camera", file, "--output", folder / "corners.csv"});
  run_for_json({"calibrate", room, "--camera", file, "--tag-size", "0.16", "--output", map});
  run_for_json({"track", room, "--camera", file, "--output", tum});
  const json score = run_for_json({"evaluate", "--truth", room, "--camera", file, "--estimate", tum});
  const json full = run_for_json({"evaluate", "--truth", room, "--estimate", tum});
  EXPECT_EQ(score["median_px"], full["median_px"]);  // the size decides which tags are in view
  EXPECT_EQ(score["frames"], full["frames"]);
  EXPECT_GT(score["median_px"].get<double>(), 0.0);
}

TEST(Pipeline, ARoomIsCalibratedAndACameraLocalisedInIt) {
  const fs::path folder = temporary_folder();
  const std::string gentle = folder / "gentle";
  simulate_quick_round(gentle);
  const std::string map = folder / "map.yaml";
  run_for_json({"calibrate", gentle, "--tag-size", "0.16", "--output", map});

  // The limits of a whole recording; a tag that is seldom seen whole may well be the worst by far.
  const json difference = run_for_json({"map", "diff", gentle + "/map.yaml", map});
  EXPECT_EQ(difference["compared"].get<int>(), 14) << difference.dump(1);
  EXPECT_TRUE(difference["extra"].empty());
  EXPECT_LT(difference["position_mm"]["rms"].get<double>(), 4.0) << difference.dump(1);
  EXPECT_LT(difference["rotation_deg"]["rms"].get<double>(), 0.5) << difference.dump(1);

  const std::string tum = folder / "camera.tum";
  const std::string log = folder / "frames.csv";
  run_for_json({"track", gentle, "--method", "pnp", "--output", tum, "--frames-csv", log});
  EXPECT_EQ(num_lines(log), 61U);
  const json score = run_for_json({"evaluate", "--truth", gentle, "--estimate", tum, "--frames-csv", log});
  EXPECT_GE(score["success_5px"].get<double>(), 0.95) << score.dump(1);
  EXPECT_LT(score["median_px"].get<double>(), 0.3) << score.dump(1);
  EXPECT_EQ(score["claimed_good_but_over_10px"], 0);
}

TEST(Pipeline, CornersFromAFileGiveTheSameMapAsImages) {
  const fs::path folder = temporary_folder();
  const std::string gentle = folder / "gentle";
  simulate("room-gentle", 30, gentle);
  run_for_json({"detect", gentle, "--camera", gentle + "/camera.yaml", "--output", folder / "corners.csv"});
  const json refined =
      run_for_json({"calibrate", gentle, "--tag-size", "0.16", "--output", folder / "refined.yaml"});
  const json plain = run_for_json(
      {"calibrate", gentle, "--tag-size", "0.16", "--no-refine", "--output", folder / "from_images.yaml"});
  EXPECT_FALSE(plain.contains("refinement"));
  // Whether pictures add to what these corners say already is theirs to tell, but the map follows the
  // verdict.
  const bool is_refined = refined.at("refinement").at("accepted").get<bool>();
  EXPECT_NE(is_refined, refined["refinement"].contains("reason")) << refined.dump(1);
  const json moved = run_for_json({"map", "diff", folder / "from_images.yaml", folder / "refined.yaml"});
  EXPECT_EQ(is_refined, moved["position_mm"]["max"].get<double>() > 0.0) << moved.dump(1);
  run_for_json({"calibrate", "--detections", folder / "corners.csv", "--camera", gentle + "/camera.yaml",
                "--tag-size", "0.16", "--output", folder / "from_corners.yaml"});
  const json difference =
      run_for_json({"map", "diff", folder / "from_images.yaml", folder / "from_corners.yaml"});
  EXPECT_TRUE(difference["missing"].empty());
  EXPECT_LT(difference["position_mm"]["max"].get<double>(), 0.01);  // corners are written with six decimals
}

TEST(Pipeline, ResultsDoNotDependOnTheNumberOfThreads) {
  const fs::path folder = temporary_folder();
  std::vector<std::string> outputs[2];
  for (const int threads : {1, 2}) {
    const std::string run = folder / std::to_string(threads);
    const std::string count = std::to_string(threads);
    run_for_json(
        {"simulate", "--scene", "room-gentle", "--frames", "12", "--output", run, "--threads", count});
    run_for_json({"calibrate", run, "--tag-size", "0.16", "--output", run + "/new.yaml", "--threads", count});
    run_for_json({"track", run, "--output", run + "/camera.tum", "--threads", count});
    for (const char* file : {"/truth.tum", "/camera.tum", "/new.detections.csv"})
      outputs[threads - 1].push_back(read_text(run + file));
    for (const auto& entry : fs::directory_iterator(run + "/frames"))
      outputs[threads - 1].push_back(entry.path().filename().string() + read_text(entry.path()));
    std::sort(outputs[threads - 1].begin(), outputs[threads - 1].end());
  }
  ASSERT_EQ(outputs[0].size(), 15U);
  EXPECT_TRUE(outputs[0] == outputs[1]) << "bytes differ";
}

TEST(Pipeline, ACorruptImageIsLeftOutCountedAndNoFailure) {
  const fs::path folder = temporary_folder();
  const std::string room = folder / "room";
  simulate("room-gentle", 12, room);
  const fs::path image = fs::directory_iterator(room + "/frames")->path();
  write_text(image, "no image");
  const std::vector<std::vector<std::string>> commands = {
      {"detect", room, "--output", folder / "corners.csv"},
      {"calibrate", room, "--tag-size", "0.16", "--output", folder / "map.yaml"},
      {"track", room, "--output", folder / "camera.tum", "--frames-csv", folder / "frames.csv"}};
  for (std::vector<std::string> words : commands) {
    words.emplace_back("--json");
    const ProgramRun run = run_program(words);
    EXPECT_THAT(run, EndsWith(0, "warning: 1 of 12 frames")) << words[0];
    EXPECT_THAT(run, EndsWith(0, image.string())) << words[0];
    const json summary = json::parse(run.out);
    EXPECT_EQ(summary["unreadable"], 1) << words[0];
    EXPECT_THAT(summary["warnings"].dump(), ::testing::HasSubstr("1 of 12 frames")) << words[0];
  }
  EXPECT_EQ(num_lines(folder / "frames.csv"), 13U);
  EXPECT_THAT(read_text(folder / "frames.csv"),
              ::testing::HasSubstr(timestamp_in_name(image) + ",unreadable,"));
}

/// The pinhole and lens of a recording's camera as WPILib's JSON, which names no resolution.
void write_camera_without_resolution(const fs::path& json_file, const fs::path& recording) {
  const CameraModel model = read_cameras(recording / "camera.yaml").cameras.front().model;
  const Pinhole& pinhole = model.pinhole();
  const json camera = {
      {"camera_matrix", {{pinhole.fx, 0, pinhole.cx}, {0, pinhole.fy, pinhole.cy}, {0, 0, 1}}},
      {"distortion_coefficients", std::get<RadtanDistortion>(model.distortion()).coefficients()}};
  write_text(json_file, camera.dump());
}

TEST(Pipeline, AnImageOfAnotherSizeIsLeftOutThoughTheCameraFileNamesNone) {
  const fs::path folder = temporary_folder();
  const std::string room = folder / "room";
  simulate("room-gentle", 12, room);
  write_camera_without_resolution(folder / "camera.json", room);
  std::vector<fs::path> images;
  for (const auto& entry : fs::directory_iterator(room + "/frames")) images.push_back(entry.path());
  std::ranges::sort(images, {}, [](const fs::path& image) { return std::stoll(image.stem().string()); });
  const fs::path odd = images.at(6);
  fs::remove(odd);
  write_text(fs::path(odd).replace_extension(".pgm"), "P5\n64 48\n255\n" + std::string(64 * 48, '\x80'));
  const std::string words = odd.stem().string() + ".pgm: is 64 x 48 pixels, but the first image, " +
                            images.front().string() + ", is 640 x 480";
  const std::vector<std::vector<std::string>> commands = {
      {"detect", room, "--output", folder / "corners.csv"},
      {"calibrate", room, "--tag-size", "0.16", "--output", folder / "map.yaml"},
      {"track", room, "--output", folder / "camera.tum", "--frames-csv", folder / "frames.csv"}};
  for (std::vector<std::string> command : commands) {
    command.insert(command.end(), {"--camera", folder / "camera.json", "--json"});
    const ProgramRun run = run_program(command);
    EXPECT_THAT(run, EndsWith(0, "warning: 1 of 12 frames are left out")) << command[0];
    EXPECT_THAT(run, EndsWith(0, words)) << command[0];
    ASSERT_EQ(run.status, 0) << run.err;
    EXPECT_EQ(json::parse(run.out)["unreadable"], 1) << command[0];
  }
  EXPECT_EQ(num_lines(folder / "camera.tum"), 11U);
  EXPECT_THAT(read_text(folder / "frames.csv"),
              ::testing::HasSubstr(timestamp_in_name(odd) + ",unreadable,"));
}

TEST(Pipeline, AFullDiskIsStatus3AndKeepsTheOldFile) {
  const fs::path folder = temporary_folder();
  const std::string room = folder / "room";
  simulate("room-gentle", 20, room);
  const std::string tum = folder / "camera.tum";
  write_text(tum, "old\n");
  EXPECT_THAT(run_program_on_full_disk({"track", room, "--output", tum, "--quiet"}, 1000),
              EndsWith(3, "camera.tum"));
  EXPECT_EQ(read_text(tum), "old\n");
  EXPECT_THAT(run_program_on_full_disk(
                  {"calibrate", room, "--tag-size", "0.16", "--output", folder / "map.yaml", "--quiet"}, 500),
              EndsWith(3, (folder / "map").string()));
  EXPECT_FALSE(fs::exists(folder / "map.yaml"));
  EXPECT_THAT(run_program_on_full_disk({"map", "show", room + "/map.yaml", "--json"}, 1000),
              EndsWith(3, "standard output"));
  EXPECT_THAT(
      run_program_on_full_disk(
          {"simulate", "--scene", "single", "--frames", "2", "--output", folder / "s", "--quiet"}, 2000),
      EndsWith(3, (folder / "s").string()));
}

}  // namespace
}  // namespace apriltrack::test
