// glTF: quads where tags hang, and pictures that an independent reader of PNG sees cell by cell.
#include <array>
#include <cstring>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "apriltrack/io/atomic_file.h"
#include "apriltrack/tags/tag_family.h"
#include "outside_judge.h"
#include "placed_map.h"
#include "support/base64.h"

namespace apriltrack::test {
namespace {

using nlohmann::json;

std::string bytes_of_uri(const std::string& uri) {
  return decoded_base64(std::string_view(uri).substr(uri.find(',') + 1));
}

/// A glTF file in memory, of either kind.
struct Scene {
  json root;
  std::string buffer;

  std::string view(std::size_t index) const {
    const json& v = root["bufferViews"][index];
    return buffer.substr(v["byteOffset"].get<std::size_t>(), v["byteLength"].get<std::size_t>());
  }
  std::string image(std::size_t index) const {
    const json& image = root["images"][index];
    return image.contains("uri") ? bytes_of_uri(image["uri"]) : view(image["bufferView"]);
  }
  std::vector<float> floats(std::size_t index) const {
    const std::string bytes = view(index);
    std::vector<float> values(bytes.size() / 4);
    std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
  }
};

Scene scene_of(const TagMap& map, ExportFormat format) {
  const std::string bytes = read_file(written(map, format, "scene"));
  Scene scene;
  if (format == ExportFormat::kGltf) {
    scene.root = json::parse(bytes);
    scene.buffer = bytes_of_uri(scene.root["buffers"][0]["uri"]);
    return scene;
  }
  const auto u32 = [&](std::size_t at) {
    std::uint32_t value;
    std::memcpy(&value, bytes.data() + at, 4);
    return value;
  };
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(u32(4), 2u);
  EXPECT_EQ(u32(8), bytes.size());
  const std::size_t json_size = u32(12);
  scene.root = json::parse(bytes.substr(20, json_size));
  scene.buffer = bytes.substr(20 + json_size + 8);
  EXPECT_EQ(u32(20 + json_size), scene.buffer.size());
  return scene;
}

Eigen::Quaterniond quaternion_of(const json& xyzw) {
  return {xyzw[3].get<double>(), xyzw[0].get<double>(), xyzw[1].get<double>(), xyzw[2].get<double>()};
}

/// Where a vertex is for a viewer of glTF, y up.
Eigen::Vector3d in_scene(const json& root_node, const json& node, const Eigen::Vector3d& vertex) {
  const json &t = node["translation"], &s = node["scale"];
  const Eigen::Vector3d scaled(s[0].get<double>() * vertex.x(), s[1].get<double>() * vertex.y(),
                               s[2].get<double>() * vertex.z());
  const Eigen::Vector3d in_map = quaternion_of(node["rotation"]) * scaled +
                                 Eigen::Vector3d(t[0].get<double>(), t[1].get<double>(), t[2].get<double>());
  return quaternion_of(root_node["rotation"]) * in_map;
}

class GltfExport : public testing::TestWithParam<ExportFormat> {};

TEST_P(GltfExport, QuadsShowEachTagsCellsWhereItHangs) {
  const Scene scene = scene_of(placed_map(), GetParam());
  const json& nodes = scene.root["nodes"];
  ASSERT_EQ(nodes.size(), 4u);
  const auto placed = placed_tags();
  int cells = 0;
  for (std::size_t i = 1; i < nodes.size(); ++i) {
    const json& node = nodes[i];
    const std::string key = node["name"];
    EXPECT_EQ(key, fmt::format("{}/{}", node["extras"]["family"].get<std::string>(),
                               node["extras"]["id"].get<int>()));
    EXPECT_EQ(node["extras"]["size_m"], kSize_m);
    std::string flat = key;
    flat.replace(flat.find('/'), 1, "_");
    const PlacedTag& tag = placed.at(flat);
    const TagPattern pattern =
        TagFamily::get(node["extras"]["family"].get<std::string>()).pattern(node["extras"]["id"].get<int>());
    const json& primitive = scene.root["meshes"][node["mesh"].get<std::size_t>()]["primitives"][0];
    const json& material = scene.root["materials"][primitive["material"].get<std::size_t>()];
    const json& texture =
        scene.root["textures"]
                  [material["pbrMetallicRoughness"]["baseColorTexture"]["index"].get<std::size_t>()];
    const std::string png = scene.image(texture["source"].get<std::size_t>());
    const cv::Mat picture = cv::imdecode(
        cv::Mat(1, static_cast<int>(png.size()), CV_8U, const_cast<char*>(png.data())), cv::IMREAD_UNCHANGED);
    ASSERT_EQ(picture.cols, pattern.cells().width()) << key;
    const auto positions = scene.floats(0), normals = scene.floats(1), texture_uv = scene.floats(2);
    const double edge = 0.5 * kSize_m * pattern.half_extent();
    for (std::size_t v = 0; v < 4; ++v) {
      const Eigen::Vector3d seen =
          in_scene(nodes[0], node, {positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]});
      // The texture's corner (0, 0) is the picture's top left, (1, 1) its bottom right.
      const Eigen::Vector3d map_point = tag.at + edge * ((2.0 * texture_uv[2 * v] - 1.0) * tag.right +
                                                         (2.0 * texture_uv[2 * v + 1] - 1.0) * tag.down);
      EXPECT_LT((seen - Eigen::Vector3d(map_point.x(), map_point.z(), -map_point.y())).norm(), 1e-9)
          << key << " vertex " << v;
      EXPECT_EQ(normals[3 * v + 2], -1.0f);
    }
    for (int row = 0; row < picture.rows; ++row) {
      for (int column = 0; column < picture.cols; ++column, ++cells) {
        const double u = -pattern.half_extent() + (column + 0.5) * pattern.cell_size();
        const double w = -pattern.half_extent() + (row + 0.5) * pattern.cell_size();
        EXPECT_EQ(picture.at<std::uint8_t>(row, column), pattern.brightness(u, w) < 0.5 ? 0 : 255)
            << key << row << column;
      }
    }
  }
  EXPECT_EQ(cells, 100 + 100 + 81);
}

/// For who looks at the face, the triangles run anticlockwise: they are the front.
TEST_P(GltfExport, TrianglesFaceOutwards) {
  const Scene scene = scene_of(placed_map(), GetParam());
  const auto positions = scene.floats(0);
  const std::string indices = scene.view(3);
  ASSERT_EQ(indices.size(), 12u);
  for (std::size_t first = 0; first < 6; first += 3) {
    std::array<Eigen::Vector3d, 3> p;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto at = static_cast<std::size_t>(indices[2 * (first + k)]);
      p[k] = {positions[3 * at], positions[3 * at + 1], positions[3 * at + 2]};
    }
    EXPECT_LT((p[1] - p[0]).cross(p[2] - p[0]).z(), -1.0);
  }
}

TEST_P(GltfExport, KhronosValidatorAccepts) {
  APRILTRACK_NEED_JUDGE(node_judges({"gltf-validator"}));
  const auto path = written(placed_map(), GetParam(), "scene");
  const std::string script =
      "const v=require('gltf-validator'),fs=require('fs');v.validateBytes(new "
      "Uint8Array(fs.readFileSync(process.argv[1])))"
      ".then(r=>{console.log(JSON.stringify(r.issues));process.exit(r.issues.numErrors+r.issues.numWarnings)}"
      ")";
  const JudgeRun run =
      ask_judge(node() + " -e \"" + script + "\" '" + path.string() + "'", path.parent_path());
  EXPECT_TRUE(run.is_content) << run.talk;
  EXPECT_NE(run.talk.find("\"numErrors\":0"), std::string::npos) << run.talk;
}

INSTANTIATE_TEST_SUITE_P(BothKinds, GltfExport, testing::Values(ExportFormat::kGltf, ExportFormat::kGlb),
                         [](const auto& kind) { return std::string(info_of(kind.param).name); });

}  // namespace
}  // namespace apriltrack::test
