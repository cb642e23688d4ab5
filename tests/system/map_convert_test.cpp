// `map convert`, and layouts of other projects where a map is an input.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <opencv2/core/persistence.hpp>
#include <sstream>

#include "program.h"
#include "support/shared_data.h"

namespace apriltrack::test {
namespace {
namespace fs = std::filesystem;

/// Two tags on a wall at x = 3, facing -x: 7 at (3, 1, 0.5), turned by 10 degrees clockwise for who looks at
/// it, 2 upright.
const std::string kWpilibLayout =
    "{\"tags\": [{\"ID\": 7, \"pose\": {\"translation\": {\"x\": 3, \"y\": 1, \"z\": 0.5},"
    "\"rotation\": {\"quaternion\": {\"W\": 0, \"X\": 0, \"Y\": -0.08715574274765817, \"Z\": "
    "0.9961946980917455}}}},"
    "{\"ID\": 2, \"pose\": {\"translation\": {\"x\": 3, \"y\": 0.2, \"z\": 0.9},"
    "\"rotation\": {\"quaternion\": {\"W\": 0, \"X\": 0, \"Y\": 0, \"Z\": 1}}}}],"
    "\"field\": {\"length\": 16.5, \"width\": 8}}";

/// Headings alone, one size, one family, no id 0: what every format but Kalibr's can hold.
const std::string kMap =
    "apriltrack_map: 1\nframe: field\ndefault_family: tag36h11\ntags:\n"
    "  - id: 4\n    size: 0.16\n    pose:\n      position: {x: 1.0, y: 2.0, z: 0.5}\n"
    "      orientation: {x: 0.5, y: -0.5, z: 0.5, w: -0.5}\n"
    "  - id: 9\n    size: 0.16\n    pose:\n      position: {x: -1.25, y: 0.75, z: 1.0}\n"
    "      orientation: {x: 0.7071067811865476, y: 0.0, z: 0.0, w: -0.7071067811865476}\n";

struct Paths {
  fs::path folder = temporary_folder();
  std::string of(const std::string& name) const { return (folder / name).string(); }
  std::string file(const std::string& name, const std::string& text) const {
    write_text(folder / name, text);
    return of(name);
  }
};

nlohmann::json shown(const std::string& path) {
  return run_for_json({"map", "show", path, "--tag-size", "0.16"});
}

void expect_same_tags(const nlohmann::json& a, const nlohmann::json& b, const std::string& way) {
  ASSERT_EQ(a["tags"].size(), b["tags"].size()) << way;
  for (std::size_t i = 0; i < a["tags"].size(); ++i) {
    const auto &p = a["tags"][i], &q = b["tags"][i];
    EXPECT_EQ(p["id"], q["id"]) << way;
    EXPECT_EQ(p["family"], q["family"]) << way;
    EXPECT_NEAR(p["size_m"].get<double>(), q["size_m"].get<double>(), 1e-9) << way;
    double product = 0.0;
    for (const char* axis : {"x", "y", "z", "w"})
      product += p["orientation"][axis].get<double>() * q["orientation"][axis].get<double>();
    EXPECT_NEAR(std::abs(product), 1.0, 1e-12) << way;
    for (const char* axis : {"x", "y", "z"})
      EXPECT_NEAR(p["position_m"][axis].get<double>(), q["position_m"][axis].get<double>(), 1e-9) << way;
  }
}

TEST(MapConvert, EachFormatIsWrittenAndReadWhereverItIsRead) {
  const Paths paths;
  const std::string map = paths.file("map.yaml", kMap);
  const auto own = shown(map);
  for (const std::string format : {"apriltrack", "wpilib", "wpilib-csv", "limelight", "apriltag_ros",
                                   "apriltag_ros2", "tagslam", "aruco", "rtabmap"}) {
    const std::string out = paths.of("out." + format);
    const auto summary = run_for_json({"map", "convert", map, out, "--to", format});
    EXPECT_EQ(summary["from"], "apriltrack");
    EXPECT_EQ(summary["to"], format);
    EXPECT_EQ(summary["tags"], 2);
    expect_same_tags(own, shown(out), format);
  }
  for (const std::string format :
       {"gltf", "glb", "urdf", "sdf", "colmap", "g2o", "corners-csv", "corners-json"}) {
    const auto run = run_program({"map", "convert", map, paths.of("out." + format), "--to", format});
    EXPECT_EQ(run.status, 0) << format << ": " << run.err;
    EXPECT_TRUE(fs::exists(paths.of("out." + format)));
  }
  EXPECT_EQ(names_in(paths.of("out.colmap")),
            (std::set<std::string>{"cameras.txt", "images.txt", "points3D.txt"}));
}

TEST(MapConvert, EndingsThatAreOneFormatsNeedNoTo) {
  const Paths paths;
  const std::string map = paths.file("map.yaml", kMap);
  const std::map<std::string, std::string> formats = {
      {"a.yaml", "apriltrack"}, {"a.fmap", "limelight"}, {"a.ini", "rtabmap"}, {"a.gltf", "gltf"},
      {"a.glb", "glb"},         {"a.urdf", "urdf"},      {"a.sdf", "sdf"},     {"a.g2o", "g2o"}};
  for (const auto& [name, format] : formats)
    EXPECT_EQ(run_for_json({"map", "convert", map, paths.of(name)})["to"], format);
  for (const std::string name : {"a.json", "a.csv", "a"}) {
    const auto run = run_program({"map", "convert", map, paths.of(name)});
    EXPECT_THAT(run, EndsWith(2, "--to"));
    EXPECT_THAT(run, EndsWith(2, "wpilib (field layout of WPILib (JSON)), wpilib-csv ("));
    EXPECT_FALSE(fs::exists(paths.of(name)));
  }
}

TEST(MapConvert, EndingsThatMisleadAreRefusedOrWarnedOf) {
  const Paths paths;
  const std::string map = paths.file("map.yaml", kMap);
  for (const std::string format : {"fmap", "ini", "gltf", "glb", "urdf", "sdf", "g2o"}) {
    const std::string out = paths.of("o." + format);
    EXPECT_THAT(run_program({"map", "convert", map, out, "--to", "wpilib"}),
                EndsWith(2, "wpilib is not what ." + format + " in '" + out + "' says"));
    EXPECT_FALSE(fs::exists(out));
  }
  const auto run = run_program({"map", "convert", map, paths.of("o.yaml"), "--to", "wpilib"});
  EXPECT_EQ(run.status, 0);
  EXPECT_NE(run.err.find("though its name ends in .yaml"), std::string::npos) << run.err;
  for (const char* name : {"o.json", "o.txt", "o"})
    EXPECT_EQ(
        run_program({"map", "convert", map, paths.of(name), "--to", "wpilib"}).err.find("its name ends"),
        std::string::npos);
}

TEST(MapConvert, WhatIsLostIsToldToPeopleAndMachines) {
  const Paths paths;
  const std::string layout = paths.file("field.json", kWpilibLayout);
  const std::vector<std::string> words = {"map",  "convert",      layout,       paths.of("tags.yaml"),
                                          "--to", "apriltag_ros", "--tag-size", "0.1651"};
  const auto run = run_program(words);
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.err.find("warning: " + layout + ": the family is taken to be tag36h11"), std::string::npos)
      << run.err;
  EXPECT_NE(run.err.find("the sizes are those that were given"), std::string::npos) << run.err;
  const auto summary = run_for_json(words);
  std::set<std::string> seen;
  for (const auto& loss : summary["losses"]) {
    seen.insert(fmt::format("{} {} {}", loss["stage"].get<std::string>(), loss["kind"].get<std::string>(),
                            loss["how"].get<std::string>()));
    EXPECT_FALSE(loss["message"].get<std::string>().empty());
    EXPECT_TRUE(loss["which"].is_array());
  }
  EXPECT_EQ(seen, (std::set<std::string>{"read families assumed", "read sizes given",
                                         "write families left_out", "write extensions left_out"}));
}

TEST(MapConvert, CountsTheTagsThatAreWritten) {
  const Paths paths;
  run_for_json(
      {"simulate", "--scene", "room", "--frames", "1", "--speed", "0", "--output", paths.of("room")});
  const auto summary = run_for_json(
      {"map", "convert", paths.of("room") + "/map.yaml", paths.of("priors.txt"), "--to", "rtabmap"});
  EXPECT_EQ(summary["tags"], 13);  // RTAB-Map passes over id 0
}

TEST(MapConvert, MistakesOfTheCommandLineEndWith2) {
  const Paths paths;
  const std::string map = paths.file("map.yaml", kMap);
  const std::string layout = paths.file("field.json", kWpilibLayout);
  EXPECT_THAT(run_program({"map", "convert", map, paths.of("o"), "--to", "dxf"}),
              EndsWith(2, "'dxf' is no known format; there are apriltrack ("));
  EXPECT_THAT(run_program({"map", "convert", map, map}), EndsWith(2, "is an input of this run"));
  EXPECT_EQ(read_text(map), kMap);
  EXPECT_THAT(run_program({"map", "convert", layout, paths.of("o.yaml")}), EndsWith(2, "--tag-size"));
  EXPECT_THAT(run_program({"map", "convert", layout, paths.of("o.yaml"), "--tag-size", "0"}),
              EndsWith(2, "(0, 100]"));
  EXPECT_THAT(
      run_program({"map", "convert", layout, paths.of("o.yaml"), "--tag-size", "0.1", "--family", "x"}),
      EndsWith(2, "tag36h11"));
  EXPECT_THAT(
      run_program({"map", "convert", layout, paths.of("o.yaml"), "--tag-size", "0.1", "--bundle", "x"}),
      EndsWith(2, "no bundles"));
  EXPECT_THAT(run_program({"map", "convert", layout, paths.of("o.yaml"), "--tag-size", "0.1",
                           "--field-length", "16"}),
              EndsWith(2, "--field-width"));
  EXPECT_THAT(run_program({"map", "convert", map, paths.of("o.yaml"), "--tag-size", "0.2"}),
              EndsWith(2, "0.16 m here, and 0.2 m"));
  EXPECT_THAT(run_program({"map", "convert", map, paths.of("o.yaml"), "--to", "kalibr"}),
              EndsWith(2, "printed grid"));
  EXPECT_THAT(run_program({"map", "convert", paths.file("x", "no layout\n"), paths.of("o.yaml")}),
              EndsWith(2, "Limelight"));
  EXPECT_FALSE(fs::exists(paths.of("o.yaml")));
}

TEST(MapConvert, FilesThatCannotBeReadOrWrittenEndWith3) {
  const Paths paths;
  const std::string map = paths.file("map.yaml", kMap);
  EXPECT_THAT(run_program({"map", "convert", paths.of("missing.json"), paths.of("o.yaml")}),
              EndsWith(3, "missing.json"));
  EXPECT_THAT(run_program({"map", "convert", map, paths.of("no/o.fmap")}), EndsWith(3, "o.fmap"));
  EXPECT_THAT(run_program({"map", "convert", map, paths.folder.string(), "--to", "wpilib"}),
              EndsWith(3, "is a folder"));
  EXPECT_THAT(run_program({"map", "convert", map, paths.of("map.yaml/x"), "--to", "colmap"}),
              EndsWith(3, "no folder"));
  EXPECT_EQ(run_program_on_full_disk({"map", "convert", map, paths.of("o.gltf")}, 1000).status, 3);
  EXPECT_FALSE(fs::exists(paths.of("o.gltf")));
}

TEST(MapConvert, FieldSizeMovesTheOrigin) {
  const Paths paths;
  const std::string layout = paths.file("field.json", kWpilibLayout);
  const std::string fmap = paths.of("o.fmap");
  EXPECT_EQ(run_program({"map", "convert", layout, fmap, "--tag-size", "0.1651"}).status, 0);
  const auto numbers = nlohmann::json::parse(read_text(fmap))["fiducials"][0]["transform"];
  EXPECT_NEAR(numbers[3].get<double>(), 3 - 8.25, 1e-12);
  EXPECT_NEAR(numbers[7].get<double>(), 1 - 4, 1e-12);
  const auto run = run_program({"map", "convert", fmap, paths.of("o.json"), "--to", "wpilib"});
  EXPECT_NE(run.err.find("the field's corner: 8.25 and 4 m"), std::string::npos) << run.err;
  const auto back = nlohmann::json::parse(read_text(paths.of("o.json")))["tags"][0]["pose"]["translation"];
  EXPECT_NEAR(back["x"].get<double>(), 3.0, 1e-12);
}

// Two maps of which one states no size: the option is for that one.
TEST(MapConvert, DiffTakesASizeForTheLayoutThatHasNone) {
  const Paths paths;
  const std::string layout = paths.file("field.json", kWpilibLayout);
  const std::string map = paths.of("map.yaml");
  ASSERT_EQ(run_program({"map", "convert", layout, map, "--tag-size", "0.16"}).status, 0);
  const auto diff = run_for_json({"map", "diff", map, layout, "--tag-size", "0.1651"});
  EXPECT_EQ(diff["compared"], 2);
  EXPECT_NEAR(diff["tags"][0]["size_difference_mm"].get<double>(), 5.1, 1e-6);
  EXPECT_THAT(run_program({"map", "diff", map, map, "--tag-size", "0.1651"}),
              EndsWith(2, "both maps state their sizes"));
}

/// A pinhole camera of focal length 500 at (0, 1, 0.6), looking along +x: x right is -y, y down is -z.
std::string pixel_of(const Eigen::Vector3d& p) {
  const double depth = p.x();
  return fmt::format("{},{}", 320.0 + 500.0 * (1.0 - p.y()) / depth, 240.0 + 500.0 * (0.6 - p.z()) / depth);
}

/// Corners from bottom left, anticlockwise, as who looks along +x sees them.
std::string detection_of(int id, const Eigen::Vector3d& at, double clockwise_rad) {
  const Eigen::Vector3d right(0, -std::cos(clockwise_rad), -std::sin(clockwise_rad));
  const Eigen::Vector3d down(0, std::sin(clockwise_rad), -std::cos(clockwise_rad));
  std::string text = fmt::format("1000000000,cam0,tag36h11,{}", id);
  const double h = 0.5 * 0.1651;
  for (const auto& [u, v] : std::vector<std::pair<double, double>>{{-h, h}, {h, h}, {h, -h}, {-h, -h}})
    text += "," + pixel_of(at + u * right + v * down);
  return text + "\n";
}

TEST(MapConvert, TrackLocalisesInAFieldLayout) {
  const Paths paths;
  const std::string layout = paths.file("field.json", kWpilibLayout);
  const std::string camera = paths.file(
      "camera.yaml",
      "cam0:\n  camera_model: pinhole\n  intrinsics: [500, 500, 320, 240]\n  distortion_model: none\n"
      "  distortion_coeffs: []\n  resolution: [640, 480]\n");
  const std::string detections =
      paths.file("detections.csv", "timestamp_ns,camera,family,id,c0x,c0y,c1x,c1y,c2x,c2y,c3x,c3y\n" +
                                       detection_of(7, {3, 1, 0.5}, 10.0 * M_PI / 180.0) +
                                       detection_of(2, {3, 0.2, 0.9}, 0.0));
  const std::string out = paths.of("out.tum");
  const auto run = run_program({"track", "--detections", detections, "--camera", camera, "--map", layout,
                                "--tag-size", "0.1651", "--output", out});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.err.find("taken to be tag36h11"), std::string::npos) << run.err;
  std::istringstream line(read_text(out));
  double time, x, y, z, qx, qy, qz, qw;
  line >> time >> x >> y >> z >> qx >> qy >> qz >> qw;
  EXPECT_NEAR(x, 0.0, 1e-6);
  EXPECT_NEAR(y, 1.0, 1e-6);
  EXPECT_NEAR(z, 0.6, 1e-6);
  // Columns (0 -1 0), (0 0 -1), (1 0 0): all four numbers are 0.5 but for their signs.
  const double sign = qw < 0.0 ? -1.0 : 1.0;
  EXPECT_NEAR(sign * qw, 0.5, 1e-6);
  EXPECT_NEAR(sign * qx, -0.5, 1e-6);
  EXPECT_NEAR(sign * qy, 0.5, 1e-6);
  EXPECT_NEAR(sign * qz, -0.5, 1e-6);
  EXPECT_THAT(run_program({"track", "--detections", detections, "--camera", camera, "--map", layout,
                           "--output", out}),
              EndsWith(2, "--tag-size"));
}

// OpenCV's FileStorage is what the aruco library reads and writes with.
TEST(MapConvert, OpenCvReadsMarkerMapsAndItsOwnAreRead) {
  const Paths paths;
  const std::string map = paths.file("map.yaml", kMap);
  const std::string out = paths.of("markers.yml");
  ASSERT_EQ(run_program({"map", "convert", map, out, "--to", "aruco"}).status, 0);
  cv::FileStorage read(out, cv::FileStorage::READ);
  ASSERT_TRUE(read.isOpened());
  EXPECT_EQ(static_cast<int>(read["aruco_bc_nmarkers"]), 2);
  EXPECT_EQ(static_cast<int>(read["aruco_bc_mInfoType"]), 1);
  EXPECT_EQ(static_cast<std::string>(read["aruco_bc_dict"]), "TAG36h11");
  const cv::FileNode marker = read["aruco_bc_markers"][0];
  EXPECT_EQ(static_cast<int>(marker["id"]), 4);
  std::vector<std::vector<double>> corners;
  for (const cv::FileNode& node : marker["corners"]) {
    corners.emplace_back();
    node >> corners.back();
  }
  ASSERT_EQ(corners.size(), 4u);
  for (const auto& corner : corners) EXPECT_EQ(corner.size(), 3u);

  const std::string again = paths.of("again.yml");
  {
    cv::FileStorage write(again, cv::FileStorage::WRITE);  // as MarkerMap::saveToFile does
    write << "aruco_bc_dict"
          << "TAG36h11"
          << "aruco_bc_nmarkers" << 1 << "aruco_bc_mInfoType" << 1 << "aruco_bc_markers"
          << "[";
    write << "{:"
          << "id" << 4 << "corners"
          << "[:";
    for (const auto& corner : corners) write << cv::Point3d(corner[0], corner[1], corner[2]);
    write << "]"
          << "}"
          << "]";
  }
  const auto once = shown(map), twice = shown(again);
  for (const char* axis : {"x", "y", "z"})
    EXPECT_NEAR(once["tags"][0]["position"][axis].get<double>(),
                twice["tags"][0]["position"][axis].get<double>(), 1e-9);
  EXPECT_NEAR(twice["tags"][0]["size_m"].get<double>(), 0.16, 1e-9);
}

TEST(MapConvert, FilesOfUsersAreReadOrTellTheWayOut) {
  APRILTRACK_SHARED_OR_SKIP(cases, "cases/map_formats");
  const std::map<std::string, std::size_t> tags = {{"2023-chargedup.json", 8},
                                                   {"frc2024_first3.fmap", 3},
                                                   {"kalibr_target.yaml", 36},
                                                   {"tags_ros.yaml", 5},
                                                   {"wpilib2024.csv", 2}};
  for (const auto& [name, count] : tags) {
    const bool has_sizes = !name.starts_with("2023") && !name.starts_with("wpilib");
    std::vector<std::string> words = {"map", "show", (cases / name).string()};
    if (!has_sizes) {
      EXPECT_THAT(run_program(words), EndsWith(2, "--tag-size"));
      words.insert(words.end(), {"--tag-size", "0.1651"});
    }
    EXPECT_EQ(run_for_json(words)["tags"].size(), count) << name;
  }
  EXPECT_THAT(run_program({"map", "show", (cases / "ros2_bundle.yaml").string()}),
              EndsWith(2, "it is no layout"));
}

}  // namespace
}  // namespace apriltrack::test
