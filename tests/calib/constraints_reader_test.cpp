#include <gmock/gmock.h>

#include <filesystem>

#include "apriltrack/calib/map_constraints.h"
#include "apriltrack/io/atomic_file.h"
#include "calibrating.h"
#include "support/shared_data.h"

namespace apriltrack {
namespace {

using test::error_of;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string kHead = "apriltrack_constraints: 1\nconstraints:\n";

std::vector<MapConstraint> read_constraint_text(const std::string& text) {
  const std::filesystem::path path = test::temporary_folder() / "measured.yaml";
  write_file_atomically(path, text);
  return read_map_constraints(path);
}

std::string complaint(const std::string& text) {
  return error_of(ErrorKind::kInvalidInput, [&] { read_constraint_text(text); });
}

TEST(ConstraintsReader, ReadsEveryType) {
  const auto constraints = read_constraint_text(kHead + R"(
  - {type: position, tag: 3, position_m: {x: 1.5, z: -2}, sigma_m: 0.002, x_by: "total station"}
  - {type: distance, name: door, tags: [3, tag36h11/4], distance_m: 0.512, sigma_m: 0.001}
  - type: relative_pose
    tags: [5, 6]
    position_m: {x: 0.1, y: 0.2, z: 0.3}
    orientation: {x: 0, y: 0, z: 0.6, w: 0.8}
    sigma_m: 0.0005
    sigma_rad: 0.002
  - {type: coplanar, tags: [1, 2, 3, 4], sigma_m: 0.001}
  - {type: upright, tags: [7, 8], sigma_rad: 0.01}
  - {type: floor, name: hall, tags: [9, 10], sigma_m: 0.003, sigma_rad: 0.01}
  - {type: gravity, tag: 3, direction: {x: 0, y: 9.7, z: 0.3}, sigma_rad: 0.005}
  - {type: gravity, camera: cam1, timestamp_ns: 1403636579763555584, direction: {x: 0, y: 1, z: 0}, sigma_rad: 0.1}
)");
  std::vector<std::string> titles;
  for (const MapConstraint& one : constraints) titles.push_back(title_of(one));
  EXPECT_THAT(titles, ElementsAre("position 3", "door", "relative_pose 5-6", "coplanar 1-2-3-4", "upright 7",
                                  "upright 8", "hall (floor 9)", "hall (floor 10)", "gravity 3",
                                  "gravity cam1 at 1403636579763555584"));
  const auto& position = std::get<PositionConstraint>(constraints[0].what);
  EXPECT_EQ(position.position_m[0], 1.5);
  EXPECT_FALSE(position.position_m[1].has_value());
  EXPECT_EQ(position.position_m[2], -2.0);
  EXPECT_EQ(position.sigma_m, 0.002);
  EXPECT_EQ(position.tag.family, "");
  const auto& distance = std::get<DistanceConstraint>(constraints[1].what);
  EXPECT_EQ(distance.b, test::tag36h11(4));
  EXPECT_EQ(distance.distance_m, 0.512);
  EXPECT_THAT(constraints[1].where, HasSubstr("measured.yaml:5"));
  const auto& board = std::get<RelativePoseConstraint>(constraints[2].what);
  EXPECT_EQ(board.position_m, Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(board.orientation->z(), 0.6);
  EXPECT_EQ(board.sigma_rad, 0.002);
  EXPECT_FALSE(std::get<CoplanarConstraint>(constraints[3].what).sigma_rad.has_value());
  EXPECT_EQ(std::get<UprightConstraint>(constraints[5].what).tag.id, 8);
  EXPECT_EQ(std::get<FloorConstraint>(constraints[6].what).sigma_rad, 0.01);
  EXPECT_EQ(std::get<GravityConstraint>(constraints[8].what).direction_tag, Eigen::Vector3d(0.0, 9.7, 0.3));
  EXPECT_EQ(std::get<CameraGravityConstraint>(constraints[9].what).timestamp.ns, 1403636579763555584);
}

TEST(ConstraintsReader, NamesLineKeyAndValueOfWhatIsWrong) {
  EXPECT_THAT(complaint("constraints: []\n"), HasSubstr("begins with 'apriltrack_constraints: 1'"));
  EXPECT_THAT(complaint("apriltrack_constraints: 2\nconstraints: []\n"),
              HasSubstr("this program reads schema version 1 (is 2)"));
  EXPECT_THAT(complaint("apriltrack_constraints: 1\nconstraints: []\n"), HasSubstr("names no constraint"));
  EXPECT_THAT(complaint(kHead + "  - {type: length, tags: [1, 2]}\n"),
              AllOf(HasSubstr("measured.yaml:3: constraints[0].type"), HasSubstr("(is 'length')")));
  EXPECT_THAT(complaint(kHead + "  - {type: distance, tags: [1, 2], distance: 1, sigma_m: 0.1}\n"),
              AllOf(HasSubstr("measured.yaml:3"), HasSubstr("distance")));
  EXPECT_THAT(complaint(kHead + "  - {type: distance, tags: [1, 2], distance_m: 1}\n"), HasSubstr("sigma_m"));
  EXPECT_THAT(complaint(kHead + "  - {type: distance, tags: [1, 2], distance_m: -1, sigma_m: 0.1}\n"),
              HasSubstr("measured.yaml:3: distance 1-2: distance_m: must be in (0, 1e7] m (is -1)"));
  EXPECT_THAT(complaint(kHead + "  - {type: distance, tags: [1, 2], distance_m: 1, sigma_m: 0}\n"),
              HasSubstr("sigma_m: must be in [1e-6, 1000] m (is 0)"));
  EXPECT_THAT(complaint(kHead + "  - {type: distance, tags: [1, 1], distance_m: 1, sigma_m: 0.1}\n"),
              HasSubstr("different tags (is 1 twice)"));
  EXPECT_THAT(complaint(kHead + "  - {type: distance, tags: [1, 2, 3], distance_m: 1, sigma_m: 0.1}\n"),
              HasSubstr("must name two tags (names 3)"));
  EXPECT_THAT(
      complaint(kHead + "  - {type: distance, tags: [1, wall/2], distance_m: 1, sigma_m: 0.1}\n"),
      HasSubstr("measured.yaml:3: constraints[0].tags[1]: unknown tag family 'wall' (known: tag16h5"));
  EXPECT_THAT(
      complaint(kHead + "  - {type: distance, tags: [1, tag36h11/587], distance_m: 1, sigma_m: 0.1}\n"),
      HasSubstr("measured.yaml:3: constraints[0].tags[1]: tag36h11 has ids 0 to 586 (is 587)"));
  EXPECT_THAT(complaint(kHead + "  - {type: distance, tags: [1, -2], distance_m: 1, sigma_m: 0.1}\n"),
              HasSubstr("'-2' is no tag"));
  EXPECT_THAT(complaint(kHead + "  - {type: position, tag: 1, position_m: {}, sigma_m: 0.1}\n"),
              HasSubstr("one coordinate or more"));
  EXPECT_THAT(complaint(kHead + "  - {type: position, tag: 1, position_m: {x: .nan}, sigma_m: 0.1}\n"),
              HasSubstr("position_m.x"));
  EXPECT_THAT(complaint(kHead + "  - {type: coplanar, tags: [1, 2, 3], sigma_m: 0.1}\n"),
              HasSubstr("four tags or more"));
  EXPECT_THAT(
      complaint(kHead + "  - {type: gravity, tag: 1, direction: {x: 0, y: 0, z: 0}, sigma_rad: 0.1}\n"),
      HasSubstr("direction: must be finite, and not zero"));
  EXPECT_THAT(complaint(kHead + "  - {type: relative_pose, tags: [1, 2], position_m: {x: 0, y: 0, z: 0}, "
                                "sigma_m: 0.1, sigma_rad: 0.1}\n"),
              HasSubstr("given where 'orientation' is"));
  EXPECT_THAT(complaint(kHead + "  - {type: relative_pose, tags: [1, 2], position_m: {x: 0, y: 0, z: 0}, "
                                "orientation: {x: 1, y: 1, z: 0, w: 0}, sigma_m: 0.1, sigma_rad: 0.1}\n"),
              HasSubstr("a quaternion of length 1"));
}

TEST(ConstraintsReader, AMissingFileIsAnErrorOfInput) {
  error_of(ErrorKind::kIo, [] { read_map_constraints("/nowhere/measured.yaml"); });
}

}  // namespace
}  // namespace apriltrack
