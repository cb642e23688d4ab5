// Limelight's .fmap: matrices by rows or by columns, millimetres, a field's centre.
#include "apriltrack/io/yaml_reader.h"
#include "hand_made_layout.h"

namespace apriltrack::test {
namespace {

/// Columns: out of the face, right of who looks at it, up; then the place.
Eigen::Matrix4d fmap_matrix(const PlacedTag& tag) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topRows<3>() << tag.out(), tag.right, tag.up(), tag.at;
  return m;
}

std::string fiducial(int id, const Eigen::Matrix4d& m, const std::string& family = "apriltag3_36h11_classic",
                     double size_mm = 165.1) {
  std::string numbers;
  for (int i = 0; i < 16; ++i) numbers += fmt::format("{}{}", i == 0 ? "" : ", ", m(i / 4, i % 4));
  return fmt::format("{{\"family\": \"{}\", \"id\": {}, \"size\": {}, \"transform\": [{}], \"unique\": 1}}",
                     family, id, size_mm, numbers);
}

std::string fmap(const std::string& fiducials, const std::string& more = ", \"type\": \"frc\"") {
  return "{\"fiducials\": [" + fiducials + "]" + more + "}";
}

TEST(Fmap, PosesSizesAndFamilies) {
  const MapReading reading =
      read_layout(fmap(fiducial(7, fmap_matrix(rolled_tag())) + ", " +
                       fiducial(3, fmap_matrix(leaning_tag()), "apriltag3_41h12_standard", 80.0)));
  EXPECT_EQ(reading.format, MapFormat::kLimelight);
  ASSERT_EQ(reading.map.tags.size(), 2u);
  const MapTag* rolled = reading.map.find({"tag36h11", 7});
  const MapTag* leaning = reading.map.find({"tagStandard41h12", 3});
  ASSERT_TRUE(rolled && leaning);
  EXPECT_EQ(rolled->size_m, 0.1651);
  EXPECT_EQ(leaning->size_m, 0.08);
  EXPECT_THAT(*rolled, IsAt(rolled_tag()));
  EXPECT_THAT(*leaning, IsAt(leaning_tag()));
  EXPECT_EQ(reading.map.frame, "field_centre");
  ASSERT_TRUE(loss_of(reading.losses, LossKind::kOrigin))
      << "the origin stays in the centre, and that is told";
  EXPECT_EQ(loss_of(reading.losses, LossKind::kOrigin)->how, LossHow::kUnknown);
  EXPECT_FALSE(loss_of(reading.losses, LossKind::kMatrixOrder));
}

TEST(Fmap, MatricesByColumnsAreReadRightAndTold) {
  const MapReading reading = read_layout(fmap(fiducial(7, fmap_matrix(rolled_tag()).transpose()) + ", " +
                                              fiducial(8, fmap_matrix(leaning_tag()).transpose())));
  EXPECT_THAT(*reading.map.find({"tag36h11", 7}), IsAt(rolled_tag()));
  EXPECT_THAT(*reading.map.find({"tag36h11", 8}), IsAt(leaning_tag()));
  ASSERT_TRUE(loss_of(reading.losses, LossKind::kMatrixOrder));
}

// A tag in the origin has the same last row and column: the others tell how it is written.
TEST(Fmap, TagInTheOriginFollowsTheOthers) {
  PlacedTag origin = rolled_tag();
  origin.at.setZero();
  const MapReading reading = read_layout(fmap(fiducial(1, fmap_matrix(origin).transpose()) + ", " +
                                              fiducial(8, fmap_matrix(leaning_tag()).transpose())));
  EXPECT_THAT(*reading.map.find({"tag36h11", 1}), IsAt(origin));
  EXPECT_THAT(*read_layout(fmap(fiducial(1, fmap_matrix(origin)))).map.find({"tag36h11", 1}), IsAt(origin));
}

TEST(Fmap, KnownFieldMovesTheOriginToTheCorner) {
  const std::string text = fmap(fiducial(7, fmap_matrix(rolled_tag())));
  PlacedTag expected = rolled_tag();
  expected.at += Eigen::Vector3d(8.0, 4.0, 0.0);
  MapReadOptions options;
  options.field = FieldSize{16.0, 8.0};
  const MapReading given = read_layout(text, options);
  EXPECT_EQ(given.map.frame, "field");
  EXPECT_THAT(given.map.tags[0], IsAt(expected));
  EXPECT_EQ(loss_of(given.losses, LossKind::kOrigin)->numbers, (std::vector<double>{8.0, 4.0, 0.0}));
  const MapReading own =
      read_layout(fmap(fiducial(7, fmap_matrix(rolled_tag())), ", \"fieldlength\": 16, \"fieldwidth\": 8"));
  EXPECT_THAT(own.map.tags[0], IsAt(expected));
  const std::string message = complaint_about_layout(
      fmap(fiducial(7, fmap_matrix(rolled_tag())), ", \"fieldlength\": 16.5, \"fieldwidth\": 8"), options);
  EXPECT_NE(message.find("--field-length"), std::string::npos) << message;
}

// The published map of 2024, tag 1, rounded to six decimals there: WPILib has it at 593.68, 9.68, 53.38
// inches and a heading of 120 degrees, on a field of 16.54175 x 8.21055 m.
TEST(Fmap, PublishedTagIsWhereWpilibHasIt) {
  Eigen::Matrix4d m;
  m << -0.5, -0.866025, 0, 6.808597, 0.866025, -0.5, 0, -3.859403, 0, 0, 1, 1.355852, 0, 0, 0, 1;
  MapReadOptions options;
  options.field = FieldSize{16.54175, 8.21055};
  const Pose limelight = read_layout(fmap(fiducial(1, m)), options).map.tags[0].T_map_tag;
  const Pose wpilib =
      read_layout("ID,X,Y,Z,Rotation\n1,593.68,9.68,53.38,120\n", with_size(0.1651)).map.tags[0].T_map_tag;
  EXPECT_THAT(limelight, PoseNear(wpilib, 1e-6, 1e-6));
}

TEST(Fmap, WritesByRowsAroundTheCentre) {
  TagMap map;
  map.frame = "field";
  map.extensions = {{"x_field", "{length_m: 16, width_m: 8, type: ftc}"}};
  map.tags = {map_tag("tag36h11", 7, 0.1651, rolled_tag().T_map_tag())};
  const auto path = temporary_folder() / "out.fmap";
  const auto losses = write_tag_map_as(path, map, MapFormat::kLimelight);
  PlacedTag centred = rolled_tag();
  centred.at -= Eigen::Vector3d(8.0, 4.0, 0.0);
  const YamlNode root = YamlNode::read_json_file(path);
  EXPECT_EQ(root.at("type").as_string(), "ftc");
  const YamlNode tag = root.at("fiducials").items()[0];
  EXPECT_EQ(tag.at("family").as_string(), "apriltag3_36h11_classic");
  EXPECT_EQ(tag.at("size").as_double(), 165.1);
  const auto numbers = tag.at("transform").as_doubles(16);
  const Eigen::Matrix4d expected = fmap_matrix(centred);
  for (int i = 0; i < 16; ++i)
    EXPECT_NEAR(numbers[static_cast<std::size_t>(i)], expected(i / 4, i % 4), 1e-12) << i;
  ASSERT_TRUE(loss_of(losses, LossKind::kOrigin));
  EXPECT_EQ(loss_of(losses, LossKind::kOrigin)->numbers, (std::vector<double>{-8.0, -4.0, 0.0}));
}

TEST(Fmap, WithoutAFieldTheOriginStaysAndIsTold) {
  TagMap map;
  map.tags = {map_tag("tag36h11", 7, 0.1651, rolled_tag().T_map_tag())};
  const auto losses = write_tag_map_as(temporary_folder() / "out.fmap", map, MapFormat::kLimelight);
  ASSERT_TRUE(loss_of(losses, LossKind::kOrigin));
  EXPECT_EQ(loss_of(losses, LossKind::kOrigin)->how, LossHow::kUnknown);
}

TEST(Fmap, RefusesWhatIsNoPose) {
  Eigen::Matrix4d m = fmap_matrix(rolled_tag());
  m(0, 0) += 0.1;
  EXPECT_NE(complaint_about_layout(fmap(fiducial(7, m))).find("rotation"), std::string::npos);
  m = fmap_matrix(rolled_tag());
  m.col(0) *= -1.0;  // a mirror
  EXPECT_NE(complaint_about_layout(fmap(fiducial(7, m))).find("rotation"), std::string::npos);
  m = fmap_matrix(rolled_tag());
  m(3, 0) = 1.0;
  EXPECT_NE(complaint_about_layout(fmap(fiducial(7, m))).find("last row"), std::string::npos);
  EXPECT_NE(complaint_about_layout(fmap(fiducial(7, fmap_matrix(rolled_tag())) + "," +
                                        fiducial(8, fmap_matrix(leaning_tag()).transpose())))
                .find("by columns"),
            std::string::npos);
  EXPECT_NE(
      complaint_about_layout(fmap(fiducial(7, fmap_matrix(rolled_tag()), "apriltag3_36h11_classic", 0.1651)))
          .find("millimetres"),
      std::string::npos);
  EXPECT_NE(complaint_about_layout(fmap(fiducial(7, fmap_matrix(rolled_tag()), "aruco_4x4")))
                .find("apriltag3_36h11_classic"),
            std::string::npos);
  EXPECT_NE(complaint_about_layout(
                fmap(fiducial(7, fmap_matrix(rolled_tag())) + "," + fiducial(7, fmap_matrix(leaning_tag()))))
                .find("already defined"),
            std::string::npos);
}

TEST(Fmap, HasNoFamilyForKalibrsBorder) {
  TagMap map;
  map.tags = {map_tag("tag36h11b2", 7, 0.1, Pose())};
  EXPECT_NE(message_of([&] {
              write_tag_map_as(temporary_folder() / "o.fmap", map, MapFormat::kLimelight);
            }).find("tag36h11b2"),
            std::string::npos);
}

}  // namespace
}  // namespace apriltrack::test
