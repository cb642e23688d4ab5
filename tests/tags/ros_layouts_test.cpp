// apriltag_ros and TagSLAM: tags with y up and z out of the face, rotations as quaternions and vectors.
#include "apriltrack/io/atomic_file.h"
#include "apriltrack/io/yaml_reader.h"
#include "hand_made_layout.h"

namespace apriltrack::test {
namespace {

/// Quaternion w x y z of rolled_tag() with y up and z out: 120 degrees about (1, -1, -1), then -10 about z.
struct Quaternion {
  double w, x, y, z;
};
Quaternion rolled_quaternion() {
  const double c = 0.5 * std::cos(5.0 * kRadPerDeg), s = 0.5 * std::sin(5.0 * kRadPerDeg);
  return {c - s, c + s, s - c, -c - s};
}

std::string bundle_tag(int id) {
  const Quaternion q = rolled_quaternion();
  return fmt::format("{{id: {}, size: 0.16, x: 3, y: 1.0, z: 0.5, qw: {}, qx: {}, qy: {}, qz: {}}}", id, q.w,
                     q.x, q.y, q.z);
}

TEST(AprilTagRos, BundleOfRos1) {
  const MapReading reading = read_layout(
      "standalone_tags:\n  [\n    {id: 10, size: 0.15}\n  ]\ntag_bundles:\n  [\n    {\n"
      "      name: 'my_bundle',\n      layout:\n        [\n          " +
      bundle_tag(4) + ",\n          {id: 5, size: 0.05, x: 1, y: 2}\n        ]\n    }\n  ]\n");
  EXPECT_EQ(reading.format, MapFormat::kAprilTagRos);
  EXPECT_EQ(reading.map.frame, "my_bundle");
  ASSERT_EQ(reading.map.tags.size(), 2u);
  EXPECT_THAT(reading.map.tags[0], IsAt(rolled_tag()));
  EXPECT_EQ(reading.map.tags[0].size_m, 0.16);
  // No rotation: face up, its top towards +y.
  EXPECT_THAT(reading.map.tags[1], IsAt(floor_tag()));
  ASSERT_TRUE(loss_of(reading.losses, LossKind::kTags)) << "the standalone tag has no place";
}

TEST(AprilTagRos, SeveralBundlesAreChosenFrom) {
  const std::string text = "tag_bundles:\n- {name: left, layout: [" + bundle_tag(4) +
                           "]}\n- {name: right, layout: [" + bundle_tag(9) + "]}\n";
  const std::string message = complaint_about_layout(text);
  EXPECT_NE(message.find("--bundle"), std::string::npos) << message;
  EXPECT_NE(message.find("left, right"), std::string::npos) << message;
  MapReadOptions options;
  options.bundle = "right";
  const MapReading reading = read_layout(text, options);
  ASSERT_EQ(reading.map.tags.size(), 1u);
  EXPECT_EQ(reading.map.tags[0].key.id, 9);
  EXPECT_EQ(loss_of(reading.losses, LossKind::kTags)->value, "left");
  options.bundle = "middle";
  EXPECT_NE(complaint_about_layout(text, options).find("'middle'"), std::string::npos);
}

TEST(AprilTagRos, FilesWithoutPlacesAreNoLayout) {
  for (const std::string text : {"standalone_tags: [{id: 1, size: 0.1}]\ntag_bundles: []\n",
                                 "apriltag:\n  ros__parameters:\n    family: 36h11\n    tag:\n      ids: [9, "
                                 "14]\n      frames: [base, object]\n"
                                 "      sizes: [0.162, 0.162]\n"}) {
    const std::string message = complaint_about_layout(text);
    EXPECT_NE(message.find("no layout"), std::string::npos) << message;
    EXPECT_NE(message.find("calibrate"), std::string::npos) << message;
  }
}

TEST(AprilTagRos, BundlesOfBothRos2Forms) {
  const Quaternion q = rolled_quaternion();
  const std::string layout = fmt::format(
      "/**:\n  ros__parameters:\n    tag_family: 'tag25h9'\n    tag_bundles:\n      bundle_names: [\"b\"]\n  "
      "    b:\n"
      "        layout:\n          ids: [3]\n          3:\n            size: 0.16\n            x: 3.0\n       "
      "     y: 1.0\n"
      "            z: 0.5\n            qw: {}\n            qx: {}\n            qy: {}\n            qz: {}\n",
      q.w, q.x, q.y, q.z);
  const std::string transform = fmt::format(
      "apriltag:\n  ros__parameters:\n    family: 25h9\n    tag_bundles:\n      bundle_names: ['b']\n      "
      "b:\n"
      "        ids: [3]\n        3:\n          size: 0.16\n          transform: [3.0, 1.0, 0.5, {}, {}, {}, "
      "{}]\n",
      q.w, q.x, q.y, q.z);
  for (const std::string& text : {layout, transform}) {
    const MapReading reading = read_layout(text);
    EXPECT_EQ(reading.format, MapFormat::kAprilTagRos2);
    ASSERT_TRUE(reading.map.find({"tag25h9", 3})) << text;
    EXPECT_THAT(reading.map.tags[0], IsAt(rolled_tag()));
    EXPECT_EQ(reading.map.frame, "b");
  }
}

/// Numbers that PyYAML (rosparam) and rcl take for integers or text would be refused as parameters.
TEST(AprilTagRos, WritesNumbersThatRosTakesForDoubles) {
  TagMap map;
  map.frame = "body 2";
  map.tags = {map_tag("tag36h11", 4, 1.0, Pose(Eigen::Quaterniond::Identity(), {2.0, 1e-7, 0.0}))};
  for (const MapFormat format : {MapFormat::kAprilTagRos, MapFormat::kAprilTagRos2}) {
    const auto path = temporary_folder() / "out.yaml";
    write_tag_map_as(path, map, format);
    const std::string text = read_file(path);
    for (const char* part : {"size: 1.0", "x: 2.0", "y: 1.0e-07", "z: 0.0", "qx: -1.0"})
      EXPECT_NE(text.find(part), std::string::npos) << part << " is not in " << text;
  }
}

/// Rotation by angle about axis, of the quaternion above.
std::string rolled_rotation_vector() {
  const Quaternion q = rolled_quaternion();
  const double n = std::sqrt(1.0 - q.w * q.w), angle = 2.0 * std::acos(q.w);
  return fmt::format("{{x: {}, y: {}, z: {}}}", angle * q.x / n, angle * q.y / n, angle * q.z / n);
}

TEST(TagSlam, BodyWithNoiseOfItsTags) {
  const MapReading reading = read_layout(
      "bodies:\n - room:\n     type: simple\n     is_static: true\n     default_tag_size: 0.2\n     tags:\n"
      "       - id: 4\n         size: 0.16\n         pose:\n           position: {x: 3, y: 1, z: 0.5}\n"
      "           rotation: " +
      rolled_rotation_vector() +
      "\n"
      "           position_noise: {x: 0.01, y: 0.02, z: 0.03}\n           rotation_noise: {x: 0.1, y: 0.2, "
      "z: 0.3}\n"
      "       - id: 5\n         bits: 5\n         pose:\n           position: {x: 1, y: 2, z: 0}\n"
      "           rotation: {x: 0, y: 0, z: 0}\n       - id: 6\n         size: 0.3\n");
  EXPECT_EQ(reading.format, MapFormat::kTagSlam);
  EXPECT_EQ(reading.map.frame, "room");
  ASSERT_EQ(reading.map.tags.size(), 2u);
  EXPECT_THAT(reading.map.tags[0], IsAt(rolled_tag()));
  EXPECT_THAT(reading.map.tags[1], IsAt(floor_tag()));
  EXPECT_EQ(reading.map.tags[1].key.family, "tag25h9");
  EXPECT_EQ(reading.map.tags[1].size_m, 0.2) << "the body's default";
  ASSERT_TRUE(reading.map.tags[0].covariance);
  // Turned by 180 degrees about x: variances stay where they are.
  const Vector6d expected = (Vector6d() << 1e-4, 4e-4, 9e-4, 1e-2, 4e-2, 9e-2).finished();
  EXPECT_LT((reading.map.tags[0].covariance->diagonal() - expected).norm(), 1e-15);
  ASSERT_TRUE(loss_of(reading.losses, LossKind::kTags)) << "tag 6 has no pose";
}

// A body at (10, 0, 0), turned by 90 degrees about z.
TEST(TagSlam, BodiesThatStandAreOneWorld) {
  const std::string tags =
      "     tags: [{id: 4, size: 0.1, pose: {position: {x: 1, y: 2, z: 0}, rotation: {x: 0, y: 0, z: 0}}}]\n";
  const std::string other =
      "     tags: [{id: 5, size: 0.1, center: {x: 1, y: 2, z: 0}, rotvec: {x: 0, y: 0, z: 0}}]\n";
  const std::string pose =
      "     pose: {position: {x: 10, y: 0, z: 0}, rotation: {x: 0, y: 0, z: 1.5707963267948966}}\n";
  const std::string at_origin = "     pose: {position: {x: 0, y: 0, z: 0}, rotation: {x: 0, y: 0, z: 0}}\n";
  const std::string still = "     is_static: true\n";
  const MapReading reading =
      read_layout("bodies:\n - a:\n" + still + pose + tags + " - b:\n" + still + at_origin + other);
  EXPECT_EQ(reading.map.frame, "world");
  // (1, 2) turned is (-2, 1); right was +x, is +y; down was -y, is +x.
  EXPECT_THAT(*reading.map.find({"tag36h11", 4}), IsAt(PlacedTag{{8, 1, 0}, {0, 1, 0}, {1, 0, 0}}));
  EXPECT_THAT(*reading.map.find({"tag36h11", 5}), IsAt(floor_tag()));
  const std::string moving =
      "bodies:\n - a:\n" + still + pose + tags + " - b:\n     is_static: false\n" + other;
  EXPECT_NE(complaint_about_layout(moving).find("a, b"), std::string::npos);
  MapReadOptions options;
  options.bundle = "a";
  EXPECT_THAT(*read_layout(moving, options).map.find({"tag36h11", 4}), IsAt(floor_tag()))
      << "of the body's own frame";
}

// A body that may be turned by 0.1 rad about its z axis moves a tag 0.5 m along its x axis by 50 mm along y.
TEST(TagSlam, NoiseOfABodyIsOfItsTagsToo) {
  const std::string still = "     is_static: true\n";
  const std::string noise =
      ", position_noise: {x: 0.01, y: 0.02, z: 0.03}, rotation_noise: {x: 0, y: 0, z: 0.1}";
  const std::string own =
      ", position_noise: {x: 0.001, y: 0.001, z: 0.001}, rotation_noise: {x: 0.2, y: 0.2, z: 0.2}";
  const auto pose = [](const std::string& x, const std::string& more) {
    return "pose: {position: {x: " + x + ", y: 0, z: 0}, rotation: {x: 0, y: 0, z: 0}" + more + "}";
  };
  const TagMap map = read_layout("bodies:\n - a:\n" + still + "     " + pose("7", noise) +
                                 "\n     tags: [{id: 4, size: 0.1, " + pose("0.5", own) +
                                 "}, {id: 5, size: 0.1, " + pose("0.5", "") + "}]\n")
                         .map;
  ASSERT_TRUE(map.find({"tag36h11", 4})->covariance);
  const Vector6d variances = map.find({"tag36h11", 4})->covariance->diagonal();
  const Vector6d expected =
      (Vector6d() << 1e-4 + 1e-6, 4e-4 + 2.5e-3 + 1e-6, 9e-4 + 1e-6, 0.04, 0.04, 0.04 + 0.01).finished();
  EXPECT_LT((variances - expected).norm(), 1e-12) << variances.transpose();
  EXPECT_FALSE(map.find({"tag36h11", 5})->covariance) << "of which nothing is known";
}

TEST(TagSlam, FullCovariancesComeBack) {
  TagMap map;
  map.frame = "rig";
  map.tags = {map_tag("tag36h11", 4, 0.16, rolled_tag().T_map_tag()),
              map_tag("tag36h11", 5, 0.16, leaning_tag().T_map_tag()),
              map_tag("tag36h11", 6, 0.16, floor_tag().T_map_tag())};
  Matrix6d root;
  for (int i = 0; i < 36; ++i) root(i / 6, i % 6) = std::sin(1.0 + i * i);
  const Vector6d scale = (Vector6d() << 1e-3, 2e-3, 1e-2, 1e-2, 3e-2, 1e-3).finished();
  map.tags[0].covariance = scale.asDiagonal() * (root * root.transpose()) * scale.asDiagonal();
  map.tags[2].covariance = Matrix6d::Zero();
  const auto path = temporary_folder() / "poses.yaml";
  const auto losses = write_tag_map_as(path, map, MapFormat::kTagSlam);
  const TagMap back = read_tag_map(path);
  const Matrix6d difference = *back.tags[0].covariance - *map.tags[0].covariance;
  const Vector6d unit = map.tags[0].covariance->diagonal().cwiseSqrt().cwiseInverse();
  EXPECT_LT((unit.asDiagonal() * difference * unit.asDiagonal()).cwiseAbs().maxCoeff(), 1e-9);
  // What TagSLAM wants and nobody knows is told.
  const ConversionLoss* assumed = loss_of(losses, LossKind::kCovariance);
  ASSERT_TRUE(assumed);
  EXPECT_EQ(assumed->how, LossHow::kAssumed);
  EXPECT_EQ(assumed->which, (std::vector<std::string>{"tag36h11/5", "tag36h11/6"}));
}

TEST(TagSlam, NoiseThatIsNoneIsRefusedWithItsKey) {
  const std::string begin =
      "bodies:\n - room:\n     tags:\n     - id: 4\n       size: 0.16\n       pose:\n         position: {x: "
      "0, y: 0, z: 0}\n"
      "         rotation: {x: 0, y: 0, z: 0}\n";
  const std::string negative =
      "         position_noise: {x: 0.1, y: -0.1, z: 0.1}\n         rotation_noise: {x: 0.1, y: 0.1, z: "
      "0.1}\n";
  EXPECT_NE(complaint_about_layout(begin + negative).find("position_noise.y: is a standard deviation"),
            std::string::npos);
  EXPECT_NE(complaint_about_layout(begin + "         R: [1, 2, 3]\n").find("list of 36 numbers"),
            std::string::npos);
  std::string zeros = "0";
  for (int i = 1; i < 36; ++i) zeros += ", 0";
  EXPECT_NE(complaint_about_layout(begin + "         R: [" + zeros + "]\n").find("inverse"),
            std::string::npos);
}

// R as TagSLAM reads it: column by column, R^T R is the information, rotation before position. Here 1/sigma
// on the diagonal, and one pair, (rotation x, position x), that goes together.
TEST(TagSlam, RIsASquareRootOfTheInformation) {
  Eigen::Matrix<double, 6, 6> R = Eigen::Matrix<double, 6, 6>::Zero();
  R.diagonal() << 10, 20, 40, 100, 200, 400;
  R(0, 3) = 50;  // first row, fourth column: the fourth column begins with number 18
  std::string numbers;
  for (int i = 0; i < 36; ++i) numbers += fmt::format("{}{}", i == 0 ? "" : ", ", R(i % 6, i / 6));
  const MapReading reading = read_layout(
      "bodies:\n - room:\n     tags: [{id: 4, size: 0.16, pose: {position: {x: 0, y: 0, z: 0}, rotation: {x: "
      "0, y: 0, z: 0},"
      " R: [" +
      numbers + "]}}]\n");
  ASSERT_TRUE(reading.map.tags[0].covariance);
  const Matrix6d& cov = *reading.map.tags[0].covariance;
  // Information of (a = rotation x, b = position x): [[100, 500], [500, 12500]]; its inverse by hand,
  // determinant 1e6.
  EXPECT_NEAR(cov(3, 3), 12500.0 / 1e6, 1e-12);
  EXPECT_NEAR(cov(0, 0), 100.0 / 1e6, 1e-12);
  EXPECT_NEAR(cov(0, 3), -500.0 / 1e6, 1e-12);
  EXPECT_NEAR(cov(1, 1), 1.0 / (200.0 * 200.0), 1e-12);
  EXPECT_NEAR(cov(5, 5), 1.0 / (40.0 * 40.0), 1e-12);
}

}  // namespace
}  // namespace apriltrack::test
