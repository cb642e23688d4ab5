// WPILib's layouts, JSON and CSV: frames by its documentation, numbers worked out by hand.
#include "apriltrack/io/atomic_file.h"
#include "apriltrack/io/yaml_reader.h"
#include "hand_made_layout.h"

namespace apriltrack::test {
namespace {

/// x out of the face, y to the viewer's right, z up: turned by 180 degrees about z, then by -10 about x.
std::string rolled_wpilib_quaternion() {
  return fmt::format("\"W\": 0, \"X\": 0, \"Y\": {}, \"Z\": {}", -std::sin(5.0 * kRadPerDeg),
                     std::cos(5.0 * kRadPerDeg));
}

std::string json_layout(const std::string& extra = "") {
  return "{\"tags\": [\n {\"ID\": 7, \"pose\": {\"translation\": {\"x\": 3.0, \"y\": 1, \"z\": 0.5},\n"
         "  \"rotation\": {\"quaternion\": {" +
         rolled_wpilib_quaternion() +
         "}}}},\n {\"ID\": 2, \"pose\": {\"translation\": {\"x\": 0, \"y\": 5.5, \"z\": 1.25},\n"
         "  \"rotation\": {\"quaternion\": {\"W\": 1.0, \"X\": 0.0, \"Y\": 0.0, \"Z\": 0.0}}}}\n],\n"
         " \"field\": {\"length\": 16.541, \"width\": 8.211}" +
         extra + "}\n";
}

TEST(WpilibJson, PosesAreOfOurTagFrame) {
  const MapReading reading = read_layout(json_layout(), with_size(0.1651));
  EXPECT_EQ(reading.format, MapFormat::kWpilibJson);
  EXPECT_EQ(reading.map.frame, "field");
  ASSERT_EQ(reading.map.tags.size(), 2u);
  EXPECT_THAT(*reading.map.find({"tag36h11", 7}), IsAt(rolled_tag()));
  // Zero rotation: upright, facing away from the blue wall, along +x; right of who looks at it is +y.
  EXPECT_THAT(*reading.map.find({"tag36h11", 2}), IsAt(PlacedTag{{0, 5.5, 1.25}, {0, 1, 0}, {0, 0, -1}}));
  EXPECT_EQ(reading.map.tags[0].size_m, 0.1651);
}

TEST(WpilibJson, SaysWhatWasAssumedAndGiven) {
  const MapReading reading = read_layout(json_layout(", \"season\": \"2027\""), with_size(0.1651));
  const ConversionLoss* families = loss_of(reading.losses, LossKind::kFamilies);
  ASSERT_TRUE(families);
  EXPECT_EQ(families->how, LossHow::kAssumed);
  EXPECT_EQ(families->value, "tag36h11");
  ASSERT_TRUE(loss_of(reading.losses, LossKind::kSizes));
  EXPECT_EQ(loss_of(reading.losses, LossKind::kSizes)->how, LossHow::kGiven);
  ASSERT_TRUE(loss_of(reading.losses, LossKind::kForeignKeys));
  EXPECT_EQ(loss_of(reading.losses, LossKind::kForeignKeys)->value, "season");
}

TEST(WpilibJson, WithoutSizesIsRefusedWithTheUsualOnes) {
  const std::string message = complaint_about_layout(json_layout());
  for (const char* part :
       {"layout.txt", "tags 7, 2", "--tag-size", "--tag-sizes", "0.1651", "0.1524", "map convert"})
    EXPECT_NE(message.find(part), std::string::npos) << "no '" << part << "' in: " << message;
}

TEST(WpilibJson, TakesTheFamilyThatIsGiven) {
  MapReadOptions options = with_size(0.1524);
  options.family = "tag16h5";
  const MapReading reading = read_layout(json_layout(), options);
  EXPECT_TRUE(reading.map.find({"tag16h5", 7}));
  EXPECT_EQ(reading.map.default_family, "tag16h5");
  EXPECT_EQ(loss_of(reading.losses, LossKind::kFamilies)->how, LossHow::kGiven);
}

TEST(WpilibJson, WritesWhatWpilibReads) {
  TagMap map = read_layout(json_layout(), with_size(0.1651)).map;
  map.tags[0].T_map_tag = rolled_tag().T_map_tag();  // by geometry, and not as the reader has it
  map.tags[1].covariance = Matrix6d::Zero();
  map.provenance = {{"tool", "apriltrack"}};
  const auto path = temporary_folder() / "out.json";
  const auto losses = write_tag_map_as(path, map, MapFormat::kWpilibJson);
  const YamlNode root = YamlNode::read_json_file(path);
  EXPECT_EQ(root.at("field").at("length").as_double(), 16.541);
  EXPECT_EQ(root.at("field").at("width").as_double(), 8.211);
  const YamlNode tag = root.at("tags").items()[0];
  EXPECT_EQ(tag.at("ID").as_int(), 7);
  EXPECT_EQ(tag.at("pose").at("translation").at("x").as_double(), 3.0);
  const YamlNode q = tag.at("pose").at("rotation").at("quaternion");
  const double sign = q.at("Z").as_double() < 0.0 ? -1.0 : 1.0;
  EXPECT_NEAR(sign * q.at("W").as_double(), 0.0, 1e-15);
  EXPECT_NEAR(sign * q.at("X").as_double(), 0.0, 1e-15);
  EXPECT_NEAR(sign * q.at("Y").as_double(), -std::sin(5.0 * kRadPerDeg), 1e-15);
  EXPECT_NEAR(sign * q.at("Z").as_double(), std::cos(5.0 * kRadPerDeg), 1e-15);
  for (const LossKind kind :
       {LossKind::kSizes, LossKind::kFamilies, LossKind::kCovariance, LossKind::kProvenance})
    EXPECT_TRUE(loss_of(losses, kind)) << to_string(kind);
  EXPECT_FALSE(loss_of(losses, LossKind::kFieldSize));
  EXPECT_FALSE(loss_of(losses, LossKind::kExtensions)) << "x_field is in the file";
  EXPECT_FALSE(loss_of(losses, LossKind::kOrigin));
}

TEST(WpilibJson, AFieldOfUnknownSizeIsTold) {
  TagMap map = read_layout(json_layout(), with_size(0.1651)).map;
  map.extensions.clear();
  const auto path = temporary_folder() / "out.json";
  const auto losses = write_tag_map_as(path, map, MapFormat::kWpilibJson);
  ASSERT_TRUE(loss_of(losses, LossKind::kFieldSize));
  EXPECT_EQ(loss_of(losses, LossKind::kFieldSize)->how, LossHow::kAssumed);
  MapWriteOptions options;
  options.field = FieldSize{16.541, 8.211};
  EXPECT_FALSE(loss_of(write_tag_map_as(path, map, MapFormat::kWpilibJson, options), LossKind::kFieldSize));
  EXPECT_EQ(YamlNode::read_json_file(path).at("field").at("length").as_double(), 16.541);
}

TEST(WpilibJson, RefusesQuaternionsThatAreNoRotation) {
  int refused = 0;
  for (const std::string w : {"2.0", "0.99", "0.0", "-1.01"}) {
    std::string text = json_layout();
    text.replace(text.find("\"W\": 1.0"), 8, "\"W\": " + w);
    const std::string message = complaint_about_layout(text, with_size(0.1651));
    EXPECT_NE(message.find("tags[1].pose.rotation.quaternion: must be a quaternion of length 1"),
              std::string::npos)
        << message;
    ++refused;
  }
  EXPECT_EQ(refused, 4);
}

TEST(WpilibJson, RefusesAnIdInTwoFamilies) {
  TagMap map;
  map.tags = {map_tag("tag36h11", 3, 0.1, Pose()), map_tag("tag25h9", 3, 0.1, Pose())};
  const auto path = temporary_folder() / "out.json";
  const std::string message = message_of([&] { write_tag_map_as(path, map, MapFormat::kWpilibJson); });
  EXPECT_NE(message.find("tag36h11/3 and tag25h9/3"), std::string::npos) << message;
  EXPECT_FALSE(std::filesystem::exists(path));
}

// 593.68 in = 15.079472 m; a heading of 120 degrees.
TEST(WpilibCsv, InchesAndDegreesOf2024) {
  const MapReading reading = read_layout("ID,X,Y,Z,Rotation\n1,593.68,9.68,53.38,120\n", with_size(0.1651));
  EXPECT_EQ(reading.format, MapFormat::kWpilibCsv);
  const double c = std::cos(120.0 * kRadPerDeg), s = std::sin(120.0 * kRadPerDeg);
  // Out of the face (c, s, 0); right of who looks at it is z x out = (-s, c, 0).
  EXPECT_THAT(reading.map.tags[0], IsAt(PlacedTag{{15.079472, 0.245872, 1.355852}, {-s, c, 0}, {0, 0, -1}}));
}

// WPILib turns by the sixth column about y, though the header says X: -20 degrees let the face look up.
TEST(WpilibCsv, SixthColumnIsThePitchWhateverItsName) {
  for (const char* header : {"Z-Rotation,X-Rotation", "Z Rotation,Y Rotation", "Z-Rotation,Y-Rotation"}) {
    const MapReading reading = read_layout(
        fmt::format("ID,X,Y,Z,{}\n4,{},{},{},90,-20\n", header, -2 / 0.0254, 0.25 / 0.0254, 1.5 / 0.0254),
        with_size(0.1651));
    EXPECT_THAT(reading.map.tags[0], IsAt(leaning_tag())) << header;
  }
}

TEST(WpilibCsv, TwoColumnsOfOneAngleAreRefusedAndOthersTold) {
  for (const auto& [first, second] : {std::pair("Rotation", "Z-Rotation"), {"X-Rotation", "Y-Rotation"}}) {
    const bool is_pitch = std::string(second) == "Y-Rotation";
    const std::string message =
        complaint_about_layout(fmt::format("ID,X,Y,Z,{}{},{}\n4,1,2,3,{}20,30\n", is_pitch ? "Rotation," : "",
                                           first, second, is_pitch ? "10," : ""),
                               with_size(0.1651));
    EXPECT_NE(message.find(fmt::format("'{}' and '{}' are both columns of the tags' {}", first, second,
                                       is_pitch ? "pitch" : "heading")),
              std::string::npos)
        << message;
  }
  const MapReading reading =
      read_layout("ID,X,Y,Z,Rotation,Roll,Note\n4,1,2,3,90,5,speaker\n", with_size(0.1651));
  ASSERT_TRUE(loss_of(reading.losses, LossKind::kForeignKeys));
  EXPECT_EQ(loss_of(reading.losses, LossKind::kForeignKeys)->value, "Roll, Note");
  EXPECT_FALSE(loss_of(read_layout("ID,X,Y,Z,Rotation\n4,1,2,3,90\n", with_size(0.1651)).losses,
                       LossKind::kForeignKeys));
}

TEST(WpilibCsv, WritesHeadingAndPitch) {
  TagMap map;
  map.frame = "field";
  map.tags = {map_tag("tag36h11", 4, 0.1651, leaning_tag().T_map_tag())};
  const auto path = temporary_folder() / "out.csv";
  write_tag_map_as(path, map, MapFormat::kWpilibCsv);
  const std::string text = read_file(path);
  EXPECT_TRUE(text.starts_with("ID,X,Y,Z,Z-Rotation,Y-Rotation\n4,-78.74")) << text;
  EXPECT_THAT(read_tag_map(path, with_size(0.1651)).map.tags[0], IsAt(leaning_tag()));
}

TEST(WpilibCsv, RefusesATagThatLeansToASide) {
  TagMap map;
  map.tags = {map_tag("tag36h11", 7, 0.1651, rolled_tag().T_map_tag())};
  const auto path = temporary_folder() / "out.csv";
  const std::string message = message_of([&] { write_tag_map_as(path, map, MapFormat::kWpilibCsv); });
  EXPECT_NE(message.find("tag36h11/7 leans"), std::string::npos) << message;
  EXPECT_NE(message.find("--to wpilib"), std::string::npos) << message;
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(WpilibCsv, NamesTheLineOfAMistake) {
  EXPECT_NE(complaint_about_layout("ID,X,Y,Z,Rotation\n1,0,0,0,90\n1,1,0,0,90\n", with_size(0.1))
                .find("layout.txt:3"),
            std::string::npos);
  EXPECT_NE(
      complaint_about_layout("ID,X,Y,Z,Rotation\n1,0,nan,0,90\n", with_size(0.1)).find("layout.txt:2: Y"),
      std::string::npos);
  EXPECT_NE(complaint_about_layout("ID,X,Y,Z\n1,0,0,0\n", with_size(0.1)).find("heading"), std::string::npos);
}

}  // namespace
}  // namespace apriltrack::test
