// Several cameras, and several recordings of one: whose lens, and whose clock.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <tuple>

#include "apriltrack/detect/detections_csv.h"
#include "apriltrack/eval/trajectory.h"
#include "filmed_wall.h"
#include "program.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;
using Words = std::vector<std::string>;

constexpr const char* kSamePlace = "  T_cn_cnm1: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n";
constexpr long long kPeriod_ns = 100'000'000;

class SeveralCameras : public ::testing::Test {
 protected:
  void SetUp() override { folder_ = temporary_folder(); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  static ProgramRun run(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words);
  }

  fs::path folder_;
};

// ---- Whose lens

class LensOfDetections : public SeveralCameras {
 protected:
  static constexpr double kFocal0_px = 300.0;
  static constexpr double kFocal1_px = 500.0;

  /// Rows of cam1 only, and cameras that are mistaken for each other at a price.
  void SetUp() override {
    SeveralCameras::SetUp();
    std::string rows = kDetectionsHeader;
    for (int view = 0; view < 10; ++view) {
      for (const int id : {0, 1, 2})
        rows += wall_row(kPeriod_ns * view, camera_from_wall(view), id, "cam1", kFocal1_px);
    }
    write_text(path("d.csv"), rows);
    write_text(path("rig.yaml"),
               pinhole_entry("cam0", kFocal0_px) + pinhole_entry("cam1", kFocal1_px) + kSamePlace);
    write_text(path("single.yaml"), pinhole_entry("cam0", kFocal1_px));
    run_for_json({"calibrate", "--detections", path("d.csv"), "--camera", path("single.yaml"), "--tag-size",
                  "0.16", "--output", path("map.yaml")});
    expect_distances_of_wall(read_tag_map(path("map.yaml")));
  }

  Words track(const std::string& camera) const {
    return {"track",          "--detections", path("d.csv"),   "--camera",     path(camera),      "--map",
            path("map.yaml"), "--output",     path("out.tum"), "--frames-csv", path("frames.csv")};
  }

  /// Distances between poses do not depend on where the map has its origin.
  void expect_exact_path() const {
    const Trajectory poses = read_tum(path("out.tum"));
    ASSERT_EQ(poses.size(), 10U);
    for (int view = 1; view < 10; ++view) {
      const Eigen::Vector3d step_m = poses[view].pose.translation() - poses[0].pose.translation();
      const Eigen::Vector3d true_step_m =
          camera_from_wall(view).inverse().translation() - camera_from_wall(0).inverse().translation();
      EXPECT_NEAR(step_m.norm(), true_step_m.norm(), 1e-3) << view;
    }
  }
};

TEST_F(LensOfDetections, AnotherNameIsRefusedWhereTheCameraFileHasSeveral) {
  const ProgramRun wrong = run_program(track("rig.yaml"));
  EXPECT_THAT(wrong, EndsWith(2, "d.csv: has no detections of camera 'cam0'; it has: cam1"));
  EXPECT_THAT(wrong, EndsWith(2, "--camera-name"));
  EXPECT_FALSE(fs::exists(path("out.tum")));
  EXPECT_EQ(run(track("rig.yaml"), {"--camera-name", "cam1"}).status, 0);
  expect_exact_path();
}

TEST_F(LensOfDetections, AnotherNameIsTakenWhereTheCameraFileHasOne) {
  EXPECT_EQ(run_program(track("single.yaml")).status, 0);
  expect_exact_path();
}

/// 30 detections, none with a covariance; then one with.
TEST_F(LensOfDetections, AssumedCornerErrorsAreTold) {
  const Words calibrate = {"calibrate",  "--detections", path("d.csv"), "--camera",      path("single.yaml"),
                           "--tag-size", "0.16",         "--output",    path("map.yaml")};
  for (const auto& [words, sigma_px, result] :
       {std::tuple(track("single.yaml"), 0.1, "the poses"), std::tuple(calibrate, 0.05, "the map")}) {
    const nlohmann::json claims = run_for_json(words).at("corner_claims");
    EXPECT_EQ(claims.at("detections"), 30);
    EXPECT_EQ(claims.at("without_covariance"), 30);
    EXPECT_EQ(claims.at("assumed_sigma_px"), sigma_px);
    EXPECT_THAT(
        run_program(words).err,
        testing::HasSubstr(fmt::format("the sigmas of {} rest on an assumed error of {}", result, sigma_px)));
  }
  std::vector<FrameDetections> frames = read_detections_csv(path("d.csv"));
  for (FrameDetections& frame : frames)
    for (Detection& detection : frame.detections)
      detection.covariance_px2 = 0.01 * CornerCovariance::Identity();
  write_detections_csv(path("d.csv"), frames);
  for (const Words& words : {track("single.yaml"), calibrate}) {
    EXPECT_TRUE(run_for_json(words).at("corner_claims").at("assumed_sigma_px").is_null());
    EXPECT_THAT(run_program(words).err, testing::Not(testing::HasSubstr("assumed error")));
  }
}

class OwnCameraFiles : public SeveralCameras {
 protected:
  /// A sequence folder with one image without a tag: past the camera file, calibrate ends with status 1.
  void write_sequence(const std::string& name, const std::string& camera) const {
    write_text(path(name) + "/frames/1000000000.pgm",
               "P5\n640 480\n255\n" + std::string(640 * 240, '\x80') + std::string(640 * 240, '\x60'));
    write_text(path(name) + "/camera.yaml", camera);
  }
  ProgramRun calibrate(const Words& inputs) const {
    return run({"calibrate", "--tag-size", "0.16", "--output", path("map.yaml")}, inputs);
  }
};

TEST_F(OwnCameraFiles, ThatDifferAreRefusedByName) {
  write_sequence("a", pinhole_entry("cam0", 500.0));
  write_sequence("b", pinhole_entry("cam0", 501.0));
  const std::string differ =
      "--camera: is required: '" + path("a") + "/camera.yaml' and '" + path("b") + "/camera.yaml' differ";
  EXPECT_THAT(calibrate({path("a"), path("b")}), EndsWith(2, differ));
  EXPECT_THAT(calibrate({"cam0=" + path("a"), "cam0=" + path("b")}), EndsWith(2, differ));
  EXPECT_THAT(calibrate({path("a"), path("b"), "--camera", path("a") + "/camera.yaml"}),
              EndsWith(1, "no tags were seen in 2 frames"));
  for (const std::string& other :
       {pinhole_entry("cam0", 500.0) + "  line_delay: 1.0e-5\n",
        pinhole_entry("cam0", 500.0) + "  response: linear\n",
        pinhole_entry("cam0", 500.0) + pinhole_entry("cam1", 500.0) + kSamePlace}) {
    write_sequence("b", other);
    EXPECT_THAT(calibrate({path("a"), path("b")}), EndsWith(2, differ)) << other;
  }
}

TEST_F(OwnCameraFiles, AreNotLentToOtherInputs) {
  write_sequence("a", pinhole_entry("cam0"));
  write_sequence("b", pinhole_entry("cam0"));
  fs::remove(path("b") + "/camera.yaml");
  for (const std::string& other : {path("b"), path("a") + "/frames"}) {  // one is a folder of images
    const std::string asked =
        "--camera: is required: '" + other + "' is no sequence folder with a camera.yaml";
    EXPECT_THAT(calibrate({path("a"), other}), EndsWith(2, asked));
    EXPECT_THAT(calibrate({other, path("a")}), EndsWith(2, asked));
    EXPECT_THAT(calibrate({path("a"), other, "--camera", path("a") + "/camera.yaml"}),
                EndsWith(1, "no tags"));
  }
}

TEST_F(OwnCameraFiles, ThatSayTheSameAreTaken) {
  write_sequence("a", pinhole_entry("cam0") + "  exposure_time: 0.003\n");
  write_sequence("b", "# made later\n" + pinhole_entry("cam0") + "  exposure_time: 0.016\n");
  EXPECT_THAT(calibrate({path("a"), path("b")}), EndsWith(1, "no tags were seen in 2 frames"));
}

TEST_F(OwnCameraFiles, AreFoundInAFolderWithAnEqualsSign) {
  write_sequence("run=3", pinhole_entry("cam0"));
  EXPECT_THAT(calibrate({path("run=3")}), EndsWith(1, "no tags were seen in 1 frames"));
  EXPECT_THAT(calibrate({"cam0=" + path("run=3")}), EndsWith(1, "no tags were seen in 1 frames"));
}

// ---- Whose clock

using Times_ns = std::set<long long>;

/// Recordings of two cameras at one place, so that what they see at one moment is the same.
class SeveralTakes : public SeveralCameras {
 protected:
  void SetUp() override {
    SeveralCameras::SetUp();
    write_text(path("rig.yaml"), pinhole_entry("cam0") + pinhole_entry("cam1") + kSamePlace);
  }

  static std::string rows(const std::string& camera, int first_view, int num_views, long long start_ns) {
    std::string text;
    for (int i = 0; i < num_views; ++i) {
      for (const int id : {0, 1, 2})
        text += wall_row(start_ns + kPeriod_ns * i, camera_from_wall(first_view + i), id, camera);
    }
    return text;
  }

  void film_wall(const std::string& file, const std::string& camera, int first_view, int num_views,
                 long long start_ns = 0) const {
    write_text(path(file), kDetectionsHeader + rows(camera, first_view, num_views, start_ns));
  }

  ProgramRun calibrate(const Words& files) const {
    Words words = {"calibrate", "--camera", path("rig.yaml"), "--tag-size",
                   "0.16",      "--output", path("map.yaml")};
    for (const std::string& file : files) words.insert(words.end(), {"--detections", path(file)});
    return run_program(words);
  }

  static Times_ns times_from(long long start_ns, int num_views) {
    Times_ns times_ns;
    for (int i = 0; i < num_views; ++i) times_ns.insert(start_ns + kPeriod_ns * i);
    return times_ns;
  }

  static Times_ns joined(Times_ns a, const Times_ns& b) {
    a.insert(b.begin(), b.end());
    return a;
  }

  /// When the calibration took a camera to have seen tags.
  Times_ns times_of(const std::string& camera) const {
    Times_ns times_ns;
    for (const FrameDetections& frame : read_detections_csv(path("map.detections.csv"))) {
      if (frame.camera != camera) continue;
      EXPECT_TRUE(times_ns.insert(frame.timestamp.ns).second) << camera << " twice at " << frame.timestamp.ns;
    }
    return times_ns;
  }

  /// In every order of the files these times, and moments that are shared are those of the truth.
  void expect_times(const std::vector<Words>& orders, const Times_ns& cam0_ns, const Times_ns& cam1_ns,
                    const Words& warnings) const {
    for (const Words& files : orders) {
      SCOPED_TRACE(::testing::PrintToString(files));
      const ProgramRun run = calibrate(files);
      ASSERT_EQ(run.status, 0) << run.err;
      EXPECT_EQ(times_of("cam0"), cam0_ns);
      EXPECT_EQ(times_of("cam1"), cam1_ns);
      expect_distances_of_wall(read_tag_map(path("map.yaml")));
      for (const std::string& warning : warnings) EXPECT_THAT(run.err, ::testing::HasSubstr(warning));
      EXPECT_EQ(run.err.find("clocks began anew") == std::string::npos, warnings.empty()) << run.err;
    }
  }

  void expect_refused(const std::vector<Words>& orders, const std::string& words) const {
    for (const Words& files : orders) {
      EXPECT_THAT(calibrate(files), EndsWith(2, words)) << ::testing::PrintToString(files);
      EXPECT_FALSE(fs::exists(path("map.yaml")));
    }
  }
};

constexpr long long kSecond_ns = 1'000'000'000;
constexpr long long kApart_ns = 60 * kSecond_ns;  // docs/file_formats.md: takes that are moved

TEST_F(SeveralTakes, OfOneClockKeepTheirTimes) {
  film_wall("mono.csv", "cam0", 0, 10, 1000 * kSecond_ns);
  film_wall("st0.csv", "cam0", 40, 10, 2000 * kSecond_ns);
  film_wall("st1.csv", "cam1", 40, 10, 2000 * kSecond_ns);
  expect_times({{"mono.csv", "st0.csv", "st1.csv"},
                {"st1.csv", "mono.csv", "st0.csv"},
                {"st0.csv", "st1.csv", "mono.csv"}},
               joined(times_from(1000 * kSecond_ns, 10), times_from(2000 * kSecond_ns, 10)),
               times_from(2000 * kSecond_ns, 10), {});
}

// The second take begins behind the longer one of the first.
TEST_F(SeveralTakes, WhoseClockBeganAnewAreKeptApart) {
  film_wall("a0.csv", "cam0", 0, 10);
  film_wall("a1.csv", "cam0", 40, 10);
  film_wall("b0.csv", "cam1", 0, 30);
  film_wall("b1.csv", "cam1", 40, 5);
  constexpr long long kBehind_ns = 29 * kPeriod_ns + kApart_ns;
  expect_times({{"a0.csv", "a1.csv", "b0.csv", "b1.csv"},
                {"b0.csv", "b1.csv", "a0.csv", "a1.csv"},
                {"a0.csv", "b0.csv", "b1.csv", "a1.csv"}},
               joined(times_from(0, 10), times_from(kBehind_ns, 10)),
               joined(times_from(0, 30), times_from(kBehind_ns, 5)),
               {path("a1.csv") + " (cam0) by 62.900000000 s", path("b1.csv") + " (cam1) by 62.900000000 s"});
}

TEST_F(SeveralTakes, OfWhichACameraFilmedFewerAreRefusedWhereItsTimesDoNotTell) {
  film_wall("a0.csv", "cam0", 0, 10);
  film_wall("a1.csv", "cam0", 40, 10);
  film_wall("b1.csv", "cam1", 40, 10);
  const std::vector<Words> orders = {
      {"a0.csv", "a1.csv", "b1.csv"}, {"b1.csv", "a0.csv", "a1.csv"}, {"a0.csv", "b1.csv", "a1.csv"}};
  const std::string untold = path("b1.csv") + ": with which take it goes cannot be told";
  expect_refused(orders, untold);
  expect_refused(orders, "its own times fall into 2 of the takes; shift the time stamps");
  film_wall("b1.csv", "cam1", 40, 10, 100 * kSecond_ns);
  expect_refused(orders, untold);
  expect_refused(orders, "its own times fall into none of the takes");

  // The way out that it names.
  write_text(path("take1.csv"), kDetectionsHeader + rows("cam0", 0, 10, 0));
  write_text(path("take2.csv"), kDetectionsHeader + rows("cam0", 40, 10, 0) + rows("cam1", 40, 10, 0));
  const Times_ns second_ns = times_from(9 * kPeriod_ns + kApart_ns, 10);
  expect_times({{"take1.csv", "take2.csv"}}, joined(times_from(0, 10), second_ns), second_ns,
               {path("take2.csv") + " (cam0, cam1) by 60.900000000 s"});
}

TEST_F(SeveralTakes, OfWhichACameraFilmedFewerAreToldByItsTimes) {
  film_wall("a0.csv", "cam0", 0, 10);
  film_wall("a1.csv", "cam0", 40, 10, 5 * kPeriod_ns);
  film_wall("b1.csv", "cam1", 45, 5, 10 * kPeriod_ns);
  constexpr long long kBehind_ns = 9 * kPeriod_ns + kApart_ns;
  expect_times(
      {{"a0.csv", "a1.csv", "b1.csv"}, {"b1.csv", "a0.csv", "a1.csv"}, {"a0.csv", "b1.csv", "a1.csv"}},
      joined(times_from(0, 10), times_from(kBehind_ns, 10)), times_from(kBehind_ns + 5 * kPeriod_ns, 5),
      {path("a1.csv") + " (cam0) by 60.400000000 s", path("b1.csv") + " (cam1) by 60.400000000 s"});
}

// Its times alone leave the first and the third take to b2: but it was filmed after b1, of the second.
TEST_F(SeveralTakes, OfWhichACameraFilmedFewerAreToldByTheirOrder) {
  film_wall("a0.csv", "cam0", 0, 10);
  film_wall("a1.csv", "cam0", 20, 10, 10 * kSecond_ns);
  film_wall("a2.csv", "cam0", 40, 10);
  film_wall("b1.csv", "cam1", 20, 10, 10 * kSecond_ns);
  film_wall("b2.csv", "cam1", 40, 10);
  constexpr long long kBehind_ns = 10 * kSecond_ns + 9 * kPeriod_ns + kApart_ns;
  const Times_ns later_ns = joined(times_from(10 * kSecond_ns, 10), times_from(kBehind_ns, 10));
  expect_times({{"a0.csv", "a1.csv", "a2.csv", "b1.csv", "b2.csv"},
                {"b1.csv", "a0.csv", "b2.csv", "a1.csv", "a2.csv"}},
               joined(times_from(0, 10), later_ns), later_ns,
               {path("a2.csv") + " (cam0) by 70.900000000 s", path("b2.csv") + " (cam1) by 70.900000000 s"});
}

TEST_F(SeveralTakes, OfImagesAreKeptApartInAnyOrderOfTheArguments) {
  constexpr int kFrames = 12;
  run_for_json(
      {"simulate", "--scene", "room-gentle", "--frames", std::to_string(kFrames), "--output", path("room")});
  std::set<fs::path> images;
  for (const auto& entry : fs::directory_iterator(path("room") + "/frames")) images.insert(entry.path());
  const std::vector<fs::path> frames(images.begin(), images.end());
  const auto copy = [&](const std::string& folder, int i, const fs::path& image) {
    fs::create_directories(path(folder));
    fs::copy(image, path(folder) + "/image" + std::to_string(i) + ".png");
  };
  for (int i = 0; i < kFrames; ++i) copy("b0", i, frames[i]);
  for (int i = 0; i < 8; ++i) copy("a0", i, frames[i]);
  for (const std::string folder : {"a1", "b1"}) {
    for (int i = 0; i < 6; ++i) copy(folder, i, frames[kFrames - 1 - i]);  // backwards
  }

  const std::string camera = read_text(path("room") + "/camera.yaml");
  write_text(path("rig.yaml"), camera + "\ncam1" + camera.substr(4) + "\n" + kSamePlace);
  const Words words = {"calibrate", "--camera", path("rig.yaml"), "--tag-size",    "0.16",
                       "--rate",    "1",        "--output",       path("map.yaml")};
  const Words a = {"cam0=" + path("a0"), "cam0=" + path("a1")};
  const Words b = {"cam1=" + path("b0"), "cam1=" + path("b1")};
  Times_ns second_ns;
  for (int i = 0; i < 6; ++i) second_ns.insert((kFrames - 1 + i) * kSecond_ns + kApart_ns);
  std::string first_written;
  for (const Words& order : {Words{a[0], a[1], b[0], b[1]}, Words{b[0], a[0], b[1], a[1]}}) {
    const ProgramRun done = run(words, order);
    EXPECT_EQ(done.status, 0);
    EXPECT_THAT(done.err, ::testing::HasSubstr(path("a1") + " (cam0) by 71.000000000 s"));
    for (const std::string name : {"cam0", "cam1"}) {
      Times_ns late_ns = times_of(name);
      late_ns.erase(late_ns.begin(), late_ns.lower_bound(kFrames * kSecond_ns));
      EXPECT_EQ(late_ns, second_ns) << name;
    }
    EXPECT_THAT(read_text(path("map.yaml")), ::testing::HasSubstr("rate 1 Hz"));
    const std::string written = read_text(path("map.detections.csv"));
    if (first_written.empty()) first_written = written;
    EXPECT_EQ(written, first_written);
  }
  EXPECT_THAT(run(words, {a[0], a[1], b[0]}), EndsWith(2, path("b0") + ": with which take it goes"));
}

}  // namespace
}  // namespace apriltrack::test
