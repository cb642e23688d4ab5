// What viewers and simulators are given: places by geometry, pictures cell by cell, and the word of their own
// programs where these are installed.
#include "apriltrack/export/export_map.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "apriltrack/io/atomic_file.h"
#include "apriltrack/tags/tag_family.h"
#include "outside_judge.h"
#include "placed_map.h"

namespace apriltrack::test {
namespace {

using nlohmann::json;

std::vector<double> numbers_of(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<double>(stream), {}};
}

Eigen::Matrix3d turned_by_rpy(double roll, double pitch, double yaw) {
  return (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

void expect_axes(const Eigen::Matrix3d& R, const Eigen::Vector3d& at, const PlacedTag& placed,
                 const std::string& name) {
  EXPECT_LT((R.col(0) - placed.right).norm(), 1e-9) << name;
  EXPECT_LT((R.col(1) - placed.down).norm(), 1e-9) << name;
  EXPECT_LT((at - placed.at).norm(), 1e-9) << name;
}

TEST(CornersExport, MillimetresInOrderAndNamed) {
  const std::string csv = read_file(written(placed_map(), ExportFormat::kCornersCsv, "corners.csv"));
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "family,id,size_mm,corner,name,x_mm,y_mm,z_mm");
  const double h = 0.5 * kSize_m;
  const PlacedTag t = floor_tag();
  const std::pair<std::string, Eigen::Vector3d> expected[] = {{"bottom_left", t.at + h * (t.down - t.right)},
                                                              {"bottom_right", t.at + h * (t.down + t.right)},
                                                              {"top_right", t.at + h * (t.up() + t.right)},
                                                              {"top_left", t.at + h * (t.up() - t.right)}};
  int found = 0;
  while (std::getline(lines, line)) {
    if (!line.starts_with("tag36h11,2,160,")) continue;
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    std::string family, name;
    int id, corner;
    double size, x, y, z;
    fields >> family >> id >> size >> corner >> name >> x >> y >> z;
    ASSERT_EQ(corner, found);
    EXPECT_EQ(name, expected[corner].first);
    EXPECT_LT((Eigen::Vector3d(x, y, z) - 1e3 * expected[corner].second).norm(), 1e-9);
    ++found;
  }
  EXPECT_EQ(found, 4);
  const json tables =
      json::parse(read_file(written(placed_map(), ExportFormat::kCornersJson, "corners.json")));
  EXPECT_EQ(tables["frame"], "lab \"2\" <a&b>");
  const json corner = tables["tags"][1]["corners_mm"]["top_left"];
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(corner[k].get<double>(), 1e3 * expected[3].second[k], 1e-9);
  EXPECT_EQ(tables["tags"][1]["size_mm"], 160);
}

// sigma 2 mm along x, 0.1 rad about z; g2o's error has half angles, so that information is four times 1 /
// 0.1^2.
TEST(G2oExport, VerticesPriorsAndHalfAngles) {
  TagMap map = placed_map();
  Matrix6d covariance = Matrix6d::Identity();
  covariance(0, 0) = 4e-6;
  covariance(5, 5) = 0.01;
  map.tags[1].covariance = covariance;
  map.tags[0].covariance = Matrix6d::Zero();
  const std::string text = read_file(written(map, ExportFormat::kG2o, "map.g2o"));
  std::smatch match;
  ASSERT_TRUE(std::regex_search(text, match, std::regex("EDGE_SE3:QUAT 8 2 ([^\\n]*)"))) << text;
  const auto numbers = numbers_of(match[1]);
  ASSERT_EQ(numbers.size(), 7u + 21u);
  EXPECT_EQ((std::vector<double>(numbers.begin(), numbers.begin() + 3)), (std::vector<double>{1, 2, 0}));
  const double diagonal[] = {250'000, 1, 1, 4, 4, 400};
  for (int row = 0, at = 7; row < 6; ++row) {
    for (int column = row; column < 6; ++column, ++at)
      EXPECT_NEAR(numbers[static_cast<std::size_t>(at)], row == column ? diagonal[row] : 0.0, 1e-6)
          << row << column;
  }
  EXPECT_NE(text.find("FIX 7\n"), std::string::npos) << "a tag that is held";
  EXPECT_NE(text.find("FIX 8\n"), std::string::npos) << "the map's frame";
  // The quaternion is x y z w: the floor tag's top is towards +y, a half turn about x.
  ASSERT_TRUE(std::regex_search(text, match, std::regex("VERTEX_SE3:QUAT 2 ([^\\n]*)")));
  const auto vertex = numbers_of(match[1]);
  EXPECT_NEAR(std::abs(vertex[3]), 1.0, 1e-12);
  EXPECT_NEAR(vertex[6], 0.0, 1e-12);
}

// Known along five axes, and not at all free along the sixth: neither an edge nor a fixed vertex says that.
TEST(G2oExport, CovariancesWithoutAnInverseAreToldToBeLeftOut) {
  TagMap map = placed_map();
  map.tags[0].covariance = Matrix6d::Zero();
  map.tags[1].covariance = Matrix6d::Identity();
  EXPECT_FALSE(loss_of(export_tag_map(map, ExportFormat::kG2o).losses, LossKind::kCovariance));
  (*map.tags[1].covariance)(5, 5) = 0.0;
  const MapExport exported = export_tag_map(map, ExportFormat::kG2o);
  const ConversionLoss* loss = loss_of(exported.losses, LossKind::kCovariance);
  ASSERT_TRUE(loss);
  EXPECT_EQ(loss->how, LossHow::kLeftOut);
  EXPECT_EQ(loss->which, std::vector<std::string>{to_string(map.tags[1].key)});
  EXPECT_EQ(exported.files.front().contents.find("EDGE"), std::string::npos);
}

TEST(UrdfExport, LinksAreOurTagFrames) {
  const std::string text = read_file(written(placed_map(), ExportFormat::kUrdf, "map.urdf"));
  const std::regex joint(R"re(<child link="([^"]*)"/>\s*<origin xyz="([^"]*)" rpy="([^"]*)"/>)re");
  const auto placed = placed_tags();
  int joints = 0;
  for (auto it = std::sregex_iterator(text.begin(), text.end(), joint); it != std::sregex_iterator();
       ++it, ++joints) {
    const auto xyz = numbers_of((*it)[2]), rpy = numbers_of((*it)[3]);
    expect_axes(turned_by_rpy(rpy[0], rpy[1], rpy[2]), {xyz[0], xyz[1], xyz[2]}, placed.at((*it)[1]),
                (*it)[1]);
  }
  EXPECT_EQ(joints, 3);
}

TEST(UrdfExport, NamesOfItsLinksAreDistinctAndAChangedFrameIsTold) {
  TagMap map = placed_map();
  const auto root_and_loss = [&](const std::string& frame) {
    map.frame = frame;
    const MapExport result = export_tag_map(map, ExportFormat::kUrdf);
    std::smatch root;
    const std::string& text = result.files.at(0).contents;
    EXPECT_TRUE(std::regex_search(text, root, std::regex("<link name=\"([^\"]*)\"/>")));
    std::string told = "nothing";
    for (const ConversionLoss& loss : result.losses)
      if (loss.kind == LossKind::kFrameName && loss.how == LossHow::kConverted) told = loss.value;
    return std::pair(root[1].str(), told);
  };
  EXPECT_EQ(root_and_loss("hall"), std::pair(std::string("hall"), std::string("nothing")));
  EXPECT_EQ(root_and_loss("tag36h11_2"),
            std::pair(std::string("tag36h11_2_frame"), std::string("tag36h11_2_frame")));
  EXPECT_EQ(root_and_loss("hall <2>"), std::pair(std::string("hall__2_"), std::string("hall__2_")));
}

TEST(UrdfExport, CheckUrdfAccepts) {
  APRILTRACK_NEED_JUDGE(program_judge("check_urdf", "liburdfdom-tools"));
  const auto path = written(placed_map(), ExportFormat::kUrdf, "map.urdf");
  const JudgeRun run = ask_judge("check_urdf '" + path.string() + "'", path.parent_path());
  EXPECT_TRUE(run.is_content) << run.talk;
  for (const auto& [name, tag] : placed_tags()) EXPECT_NE(run.talk.find(name), std::string::npos) << run.talk;
}

struct Box {
  Eigen::Vector3d centre, size;
  bool is_black;
};

/// Of one link of the model.
std::vector<Box> sdf_boxes(const std::string& link) {
  const std::regex visual(
      R"re(<pose>([^<]*)</pose>\s*<geometry>\s*<box>\s*<size>([^<]*)</size>[\s\S]*?<ambient>([01]))re");
  std::vector<Box> boxes;
  for (auto it = std::sregex_iterator(link.begin(), link.end(), visual); it != std::sregex_iterator(); ++it) {
    const auto at = numbers_of((*it)[1]), size = numbers_of((*it)[2]);
    boxes.push_back({{at[0], at[1], at[2]}, {size[0], size[1], size[2]}, (*it)[3] == "0"});
  }
  return boxes;
}

bool is_black_at(const std::vector<Box>& boxes, double x, double y) {
  return std::ranges::any_of(boxes, [&](const Box& box) {
    return box.is_black && std::abs(x - box.centre.x()) < 0.5 * box.size.x() &&
           std::abs(y - box.centre.y()) < 0.5 * box.size.y();
  });
}

TEST(SdfExport, LinksAreOurTagFramesAndBoxesTheirCells) {
  const std::string text = read_file(written(placed_map(), ExportFormat::kSdf, "map.sdf"));
  const auto placed = placed_tags();
  const std::regex link(R"re(<link name="([^"]*)">\s*<pose>([^<]*)</pose>([\s\S]*?)</link>)re");
  int links = 0, cells_seen = 0, black = 0;
  for (auto it = std::sregex_iterator(text.begin(), text.end(), link); it != std::sregex_iterator();
       ++it, ++links) {
    const std::string name = (*it)[1];
    const auto pose = numbers_of((*it)[2]);
    expect_axes(turned_by_rpy(pose[3], pose[4], pose[5]), {pose[0], pose[1], pose[2]}, placed.at(name), name);
    const auto slash = name.rfind('_');
    const TagPattern pattern =
        TagFamily::get(name.substr(0, slash)).pattern(std::stoi(name.substr(slash + 1)));
    const std::vector<Box> boxes = sdf_boxes((*it)[3]);
    const double cell_m = 0.5 * kSize_m * pattern.cell_size(), edge_m = 0.5 * kSize_m * pattern.half_extent();
    for (int row = 0; row < pattern.cells().height(); ++row) {
      for (int column = 0; column < pattern.cells().width(); ++column, ++cells_seen) {
        const double x = -edge_m + (column + 0.5) * cell_m, y = -edge_m + (row + 0.5) * cell_m;
        const bool expected = pattern.brightness(2.0 * x / kSize_m, 2.0 * y / kSize_m) < 0.5;
        EXPECT_EQ(is_black_at(boxes, x, y), expected) << name << " row " << row << ", column " << column;
        black += expected;
      }
    }
    // Faces of the bars lie in the tag's plane, and the sheet behind them.
    for (const Box& box : boxes) {
      if (box.is_black)
        EXPECT_NEAR(box.centre.z() - 0.5 * box.size.z(), 0.0, 1e-12);
      else
        EXPECT_GT(box.centre.z() - 0.5 * box.size.z(), 1e-5);
    }
  }
  EXPECT_EQ(links, 3);
  EXPECT_EQ(cells_seen, 100 + 100 + 81);
  EXPECT_GT(black, 100);
}

/// libsdformat's own, by the name that it has here: ign of Ignition, gz of the later Gazebo; empty: none.
std::string sdf_program() {
  for (const std::string program : {"gz sdf", "ign sdf"})
    if (succeeds(program + " --help")) return program;
  return "";
}

TEST(SdfExport, SdformatAccepts) {
  const std::string program = sdf_program();
  APRILTRACK_NEED_JUDGE(Judge{"gz sdf", "ignition-tools, libsdformat-dev", !program.empty()});
  const auto path = written(placed_map(), ExportFormat::kSdf, "map.sdf");
  const JudgeRun run = ask_judge(program + " -k '" + path.string() + "'", path.parent_path());
  EXPECT_TRUE(run.is_content) << run.talk;
  EXPECT_NE(run.talk.find("Valid"), std::string::npos) << run.talk;
}

TEST(ColmapExport, CornersArePoints) {
  const auto folder = written(placed_map(), ExportFormat::kColmap, "sparse");
  const std::string text = read_file(folder / "points3D.txt");
  std::istringstream lines(text);
  std::vector<Eigen::Vector3d> points;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with('#')) continue;
    const auto numbers = numbers_of(line);
    ASSERT_EQ(numbers.size(), 8u) << line;
    EXPECT_EQ(numbers[0], static_cast<double>(points.size() + 1));
    points.emplace_back(numbers[1], numbers[2], numbers[3]);
  }
  ASSERT_EQ(points.size(), 12u);
  const PlacedTag t = rolled_tag();
  EXPECT_LT((points[2] - (t.at + 0.5 * kSize_m * (t.up() + t.right))).norm(), 1e-12);
}

TEST(ColmapExport, ModelAnalyzerAccepts) {
  APRILTRACK_NEED_JUDGE(program_judge("colmap", "colmap"));
  const auto folder = written(placed_map(), ExportFormat::kColmap, "sparse");
  const JudgeRun run =
      ask_judge("QT_QPA_PLATFORM=offscreen colmap model_analyzer --path '" + folder.string() + "'",
                folder.parent_path());
  EXPECT_TRUE(run.is_content) << run.talk;
  EXPECT_TRUE(std::regex_search(run.talk, std::regex("Points: 12\\b"))) << run.talk;
}

TEST(ColmapExport, AnothersModelIsKept) {
  // As colmap 3.8 writes a model of one camera, one image and one point, and names of newer versions.
  const std::pair<std::string, std::string> files[] = {
      {"cameras.txt", "# Camera list with one line of data per camera:\n1 PINHOLE 640 480 600 600 320 240\n"},
      {"images.txt", "# Image list with two lines of data per image:\n1 1 0 0 0 0 0 0 1 a.png\n12.5 7 1\n"},
      {"points3D.txt", "# 3D point list with one line of data per point:\n1 0 0 1 9 9 9 0.5 1 0\n"},
      {"points3D.txt", "1 0 0 1 0 0 0 0 1 0 2 0\n"},
      {"points3D.bin", std::string(8, '\0')},
      {"rigs.txt", "# Rig calib list\n"}};
  for (const auto& [name, text] : files) {
    const auto file = layout_file(text, name);
    const auto folder = file.parent_path();
    EXPECT_NE(
        message_of([&] { write_exported_map(folder, placed_map(), ExportFormat::kColmap); }).find("(" + name),
        std::string::npos);
    EXPECT_EQ(read_file(file), text);
    std::filesystem::remove(file);
    EXPECT_TRUE(std::filesystem::is_empty(folder)) << name;
  }
}

TEST(ColmapExport, AModelOfOursIsReplaced) {
  const auto folder = written(placed_map(), ExportFormat::kColmap, "sparse");
  TagMap map = placed_map();
  map.tags.resize(1);
  write_exported_map(folder, map, ExportFormat::kColmap);
  EXPECT_NE(read_file(folder / "points3D.txt").find("points: 4,"), std::string::npos);
}

TEST(MapExport, LossesAreTold) {
  TagMap map = placed_map();
  map.tags[0].covariance = Matrix6d::Zero();
  map.provenance = {{"tool", "x"}};
  const MapExport csv = export_tag_map(map, ExportFormat::kCornersCsv);
  EXPECT_TRUE(loss_of(csv.losses, LossKind::kCovariance));
  EXPECT_TRUE(loss_of(csv.losses, LossKind::kFrameName));
  EXPECT_TRUE(loss_of(csv.losses, LossKind::kProvenance));
  EXPECT_FALSE(loss_of(csv.losses, LossKind::kSizes));
  EXPECT_TRUE(loss_of(export_tag_map(map, ExportFormat::kG2o).losses, LossKind::kSizes));
}

TEST(MapExport, AFileInPlaceOfTheFolderIsAnOutputError) {
  const auto path = layout_file("in the way", "sparse");
  EXPECT_NE(message_of([&] { write_exported_map(path, placed_map(), ExportFormat::kColmap); }, ErrorKind::kIo)
                .find("sparse"),
            std::string::npos);
  EXPECT_EQ(read_file(path), "in the way");
}

TEST(MapExport, RefusesAMapThatIsNone) {
  const auto path = temporary_folder() / "map.gltf";
  TagMap map = placed_map();
  map.tags[1].size_m = -1.0;
  EXPECT_NE(message_of([&] { write_exported_map(path, map, ExportFormat::kGltf); }).find("size_m"),
            std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace apriltrack::test
