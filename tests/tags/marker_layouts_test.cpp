// Corners of the aruco library and angles of RTAB-Map.
#include "apriltrack/tags/tag_family.h"
#include "hand_made_layout.h"

namespace apriltrack::test {
namespace {

std::string corner_text(const Eigen::Vector3d& p) {
  return fmt::format("[ {:.17e}, {:.17e}, {:.17e} ]", p.x(), p.y(), p.z());
}

/// As OpenCV writes it: no blank behind `id:` and `corners:`.
std::string marker_map(const PlacedTag& tag, double size_m, const std::string& info = "1",
                       const std::string& dictionary = "TAG36h11") {
  const double h = 0.5 * size_m;
  return "%YAML:1.0\n---\naruco_bc_dict: " + dictionary +
         "\naruco_bc_nmarkers: 1\naruco_bc_mInfoType: " + info +
         "\naruco_bc_markers:\n   - { id:4, corners:[ " + corner_text(tag.at + h * (tag.up() - tag.right)) +
         ", " + corner_text(tag.at + h * (tag.up() + tag.right)) + ",\n       " +
         corner_text(tag.at + h * (tag.down + tag.right)) + ", " +
         corner_text(tag.at + h * (tag.down - tag.right)) + " ] }\n";
}

TEST(ArucoMarkerMap, CornersFromTopLeftClockwise) {
  const MapReading reading = read_layout(marker_map(rolled_tag(), 0.16));
  EXPECT_EQ(reading.format, MapFormat::kArucoMarkerMap);
  ASSERT_TRUE(reading.map.find({"tag36h11", 4}));
  EXPECT_THAT(reading.map.tags[0], IsAt(rolled_tag()));
  EXPECT_NEAR(reading.map.tags[0].size_m, 0.16, 1e-15);
}

TEST(ArucoMarkerMap, RefusesPixelsOtherDictionariesAndOtherShapes) {
  EXPECT_NE(complaint_about_layout(marker_map(rolled_tag(), 0.16, "0")).find("pixels"), std::string::npos);
  EXPECT_NE(complaint_about_layout(marker_map(rolled_tag(), 0.16, "1", "ARUCO_MIP_36h12")).find("TAG36h11"),
            std::string::npos);
  std::string bent = marker_map(floor_tag(), 0.16);
  const auto at = bent.rfind("0.00000000000000000e+00");
  ASSERT_NE(at, std::string::npos);
  bent.replace(at, 23, "5.00000000000000000e-03");
  EXPECT_EQ(complaint_about_layout(bent), "nothing was thrown")
      << "a corner 5 mm out of the plane of 160 mm: within a hundredth";
  bent.replace(at, 23, "1.00000000000000000e-01");
  EXPECT_NE(complaint_about_layout(bent).find("no square"), std::string::npos);
  std::string more = marker_map(floor_tag(), 0.16);
  more.replace(more.find("nmarkers: 1"), 11, "nmarkers: 2");
  EXPECT_NE(complaint_about_layout(more).find("complete"), std::string::npos);
}

/// Turned in the plane of its print.
PlacedTag upside_down(const PlacedTag& tag) {
  return {tag.at, -tag.right, -tag.down};
}

/// Tag 3 as OpenCV 4.6 draws it: cv2.aruco.drawMarker(cv2.aruco.getPredefinedDictionary(number), 3, cells).
struct OpenCvPicture {
  int dictionary = 0;
  std::vector<std::string> rows;  ///< From top to bottom; '#' is black.
};

const std::vector<OpenCvPicture> kOpenCvPictures = {
    {17, {"######", "#.##.#", "#..#.#", "#.#.##", "###.##", "######"}},
    {18, {"#######", "#.#..##", "##...##", "##.##.#", "#.#.#.#", "##....#", "#######"}},
    {19, {"########", "#..#..##", "##..#..#", "#..#.#.#", "#..##..#", "###.#..#", "##.#.###", "########"}},
    {20, {"########", "####..##", "##.##..#", "#.##.#.#", "#...##.#", "#...####", "#.##...#", "########"}}};

// Of zero rotation, with x to the right and y up in OpenCV's picture.
TEST(Rtabmap, PosesAreOfThePictureThatOpenCvDraws) {
  for (const OpenCvPicture& picture : kOpenCvPictures) {
    const MapReading reading = read_layout(
        fmt::format("[Core]\nMarker\\Dictionary = {}\nMarker\\Length = 2\nMarker\\Priors = 3 0 0 0 0 0 0\n",
                    picture.dictionary));
    ASSERT_EQ(reading.map.tags.size(), 1u);
    const MapTag& tag = reading.map.tags[0];
    const TagPattern pattern = TagFamily::get(tag.key.family).pattern(3);
    const auto cells = static_cast<double>(picture.rows.size());
    for (std::size_t row = 0; row < picture.rows.size(); ++row) {
      for (std::size_t column = 0; column < picture.rows.size(); ++column) {
        const Eigen::Vector3d at(2.0 * (static_cast<double>(column) + 0.5) / cells - 1.0,
                                 1.0 - 2.0 * (static_cast<double>(row) + 0.5) / cells, 0.0);
        const Eigen::Vector3d on_tag = tag.T_map_tag.inverse() * at;
        EXPECT_EQ(pattern.brightness(on_tag.x(), on_tag.y()), picture.rows[row][column] == '#' ? 0.0 : 1.0)
            << tag.key.family << " row " << row << " column " << column;
      }
    }
    EXPECT_GT((tag.T_map_tag.rotation() * Eigen::Vector3d::UnitZ()).dot(-Eigen::Vector3d::UnitZ()), 0.99)
        << "z out of the face";
  }
}

// Rz(-90) Ry(10) Rx(90) in degrees.
TEST(Rtabmap, PriorsAsStringLinesAndIni) {
  const std::string prior =
      fmt::format("4 3 1 0.5 {} {} {}", 0.5 * std::numbers::pi, 10 * kRadPerDeg, -0.5 * std::numbers::pi);
  const std::string floor = "5 1 2 0 0 0 0";
  for (const std::string& text :
       {prior + "|" + floor, prior + "\n" + floor + "\n", "# priors\n" + prior + "|\n" + floor,
        "Marker/Priors: \"" + prior + "|" + floor + "\"\n",
        "--Marker/Priors \"" + prior + " | " + floor + "\"",
        "[Core]\nMarker\\Length = 0.16\nMarker\\Priors = " + prior + "|" + floor + "\n",
        prior + "|5 1 2 0 0 0 0 1", prior + "|5 1 0 0 1 0 1 0 2 0 0 1 0"}) {
    MapReadOptions options = with_size(0.16);
    const MapReading reading = read_layout(text, options);
    EXPECT_EQ(reading.format, MapFormat::kRtabmap) << text;
    ASSERT_EQ(reading.map.tags.size(), 2u) << text;
    EXPECT_THAT(reading.map.tags[0], IsAt(upside_down(rolled_tag()))) << text;
    EXPECT_THAT(reading.map.tags[1], IsAt(upside_down(floor_tag()))) << text;
  }
}

TEST(Rtabmap, IniHoldsSizeFamilyAndVariances) {
  const MapReading reading = read_layout(
      "[Core]\nVersion = 0.21.0\nMarker\\Dictionary = 18\nMarker\\Length = 0.2\nMarker\\Priors = 5 1 2 0 0 0 "
      "0\n"
      "Marker\\PriorsVarianceAngular = 0.003\nMarker\\PriorsVarianceLinear = 0.002\n");
  ASSERT_TRUE(reading.map.find({"tag25h9", 5}));
  EXPECT_EQ(reading.map.tags[0].size_m, 0.2);
  ASSERT_TRUE(reading.map.tags[0].covariance);
  EXPECT_EQ((*reading.map.tags[0].covariance)(0, 0), 0.002);
  EXPECT_EQ((*reading.map.tags[0].covariance)(5, 5), 0.003);
}

TEST(Rtabmap, LeavesOutId0WhichItPassesOver) {
  TagMap map;
  map.tags = {map_tag("tag36h11", 0, 0.16, Pose()), map_tag("tag36h11", 5, 0.16, floor_tag().T_map_tag())};
  const auto path = temporary_folder() / "priors.ini";
  const auto losses = write_tag_map_as(path, map, MapFormat::kRtabmap);
  ASSERT_TRUE(loss_of(losses, LossKind::kTags));
  EXPECT_EQ(loss_of(losses, LossKind::kTags)->which, std::vector<std::string>{"tag36h11/0"});
  const TagMap back = read_tag_map(path);
  ASSERT_EQ(back.tags.size(), 1u);
  EXPECT_THAT(back.tags[0], IsAt(floor_tag()));
  map.tags.pop_back();
  EXPECT_NE(message_of([&] { write_tag_map_as(path, map, MapFormat::kRtabmap); }).find("id 0"),
            std::string::npos);
}

TEST(Rtabmap, CommonVarianceIsTheLargestInAnyDirection) {
  TagMap map;
  map.tags = {map_tag("tag36h11", 5, 0.16, floor_tag().T_map_tag())};
  Matrix6d covariance = Matrix6d::Identity() * 1e-4;
  covariance(0, 1) = covariance(1, 0) = 0.9e-4;  // along (1, 1): (1 + .9) 1e-4
  covariance(4, 5) = covariance(5, 4) = -0.5e-4;
  map.tags[0].covariance = covariance;
  const auto path = temporary_folder() / "priors.ini";
  write_tag_map_as(path, map, MapFormat::kRtabmap);
  const TagMap back = read_tag_map(path);
  EXPECT_NEAR((*back.tags.at(0).covariance)(2, 2), 1.9e-4, 1e-12);
  EXPECT_NEAR((*back.tags.at(0).covariance)(3, 3), 1.5e-4, 1e-12);
}

TEST(Rtabmap, NamesTheLineOfAMistake) {
  EXPECT_NE(complaint_about_layout("5 1 2 0 0 0 0\n6 1 2 0 0 0\n", with_size(0.1)).find("layout.txt:2"),
            std::string::npos);
  EXPECT_NE(complaint_about_layout("5 1 2 0 0 0 0\n6 1 nan 0 0 0 0\n", with_size(0.1)).find("finite"),
            std::string::npos);
  EXPECT_NE(complaint_about_layout("5 1 2 0 0 0 0|5 1 2 0 0 0 0", with_size(0.1)).find("already"),
            std::string::npos);
  EXPECT_NE(complaint_about_layout("Marker/Priors: \"5 1 2 0 0 0 0\"\nMarker/Dictionary: 3\n", with_size(0.1))
                .find("layout.txt:2"),
            std::string::npos);
}

}  // namespace
}  // namespace apriltrack::test
