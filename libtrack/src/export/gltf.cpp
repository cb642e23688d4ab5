// glTF 2.0 (Khronos): a quad for each tag with its printed cells as texture. glTF is y up; the map, taken for
// z up, hangs under one node that turns it by -90 degrees about x, so that all below it is in the map's
// frame. A node is called as its tag's key, and its extras have family, id and size. Pictures are sampled
// without smoothing near by.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "apriltrack/io/base64.h"
#include "apriltrack/io/byte_order.h"
#include "apriltrack/io/numbers.h"
#include "apriltrack/io/quoted_text.h"
#include "apriltrack/tags/tag_family.h"
#include "png_picture.h"
#include "writers.h"

namespace apriltrack {
namespace {

/// Where bytes of the buffer are.
struct BufferView {
  std::size_t offset, size;
};

void append_float(std::string& bytes, float value) {
  append_little_endian(bytes, std::bit_cast<std::uint32_t>(value), 4);
}

void append_u32(std::string& bytes, std::size_t value) {
  append_little_endian(bytes, value, 4);
}

/// What all tags share: corners in our order (bottom left, bottom right, top right, top left) of a quad from
/// -1 to 1 in the tag's frame, x right and y down, so that they run anticlockwise for who looks at it;
/// normals out of the face; texture coordinates from the picture's top left; two triangles.
struct QuadBuffer {
  std::string bytes;
  std::vector<BufferView> views;

  QuadBuffer() {
    constexpr std::array<std::array<float, 2>, 4> kPlaces = {{{-1, 1}, {1, 1}, {1, -1}, {-1, -1}}};
    for (const auto& [x, y] : kPlaces) {
      for (const float value : {x, y, 0.0f}) append_float(bytes, value);
    }
    end_view();
    for (int i = 0; i < 4; ++i) {
      for (const float value : {0.0f, 0.0f, -1.0f}) append_float(bytes, value);
    }
    end_view();
    for (const auto& [x, y] : kPlaces) {
      for (const float value : {0.5f * (x + 1.0f), 0.5f * (y + 1.0f)}) append_float(bytes, value);
    }
    end_view();
    for (const int corner : {0, 1, 2, 0, 2, 3}) bytes += {static_cast<char>(corner), '\0'};
    end_view();
  }

  void append(const std::string& more) {
    bytes += more;
    end_view();
  }

 private:
  void end_view() {
    const std::size_t begin = views.empty() ? 0 : (views.back().offset + views.back().size + 3) / 4 * 4;
    views.push_back({begin, bytes.size() - begin});
    bytes.resize((bytes.size() + 3) / 4 * 4);
  }
};

std::string png_of(const MapTag& tag) {
  return png_of_cells(TagFamily::get(tag.key.family).pattern(tag.key.id).cells());
}

std::string joined(const std::vector<std::string>& items) {
  return fmt::format("\n  {}\n ", fmt::join(items, ",\n  "));
}

std::string node_of(const MapTag& tag, std::size_t mesh) {
  const Eigen::Vector3d& p = tag.T_map_tag.translation();
  const Eigen::Quaterniond& q = tag.T_map_tag.rotation();
  const double scale = 0.5 * tag.size_m * TagFamily::get(tag.key.family).pattern(tag.key.id).half_extent();
  return fmt::format(
      "{{\"name\": {}, \"mesh\": {}, \"translation\": [{}, {}, {}], \"rotation\": [{}, {}, {}, {}], "
      "\"scale\": [{}, {}, {}], "
      "\"extras\": {{\"family\": {}, \"id\": {}, \"size_m\": {}}}}}",
      quoted_text(to_string(tag.key)), mesh, format_exact(p.x()), format_exact(p.y()), format_exact(p.z()),
      format_exact(q.x()), format_exact(q.y()), format_exact(q.z()), format_exact(q.w()), format_exact(scale),
      format_exact(scale), format_exact(scale), quoted_text(tag.key.family), tag.key.id,
      format_exact(tag.size_m));
}

/// The node above all tags.
std::string root_node(const TagMap& map) {
  const std::string half = format_exact(std::sqrt(0.5));
  std::string children;
  for (std::size_t i = 0; i < map.tags.size(); ++i)
    children += fmt::format("{}{}", i == 0 ? "" : ", ", i + 1);
  return fmt::format("{{\"name\": {}, \"rotation\": [-{}, 0, 0, {}], \"children\": [{}]}}",
                     quoted_text(map.frame), half, half, children);
}

std::string gltf_json(const TagMap& map, const QuadBuffer& buffer, const std::vector<std::string>& images,
                      const std::string& buffer_uri) {
  std::vector<std::string> nodes = {root_node(map)}, meshes, materials, textures, views;
  for (std::size_t i = 0; i < map.tags.size(); ++i) {
    nodes.push_back(node_of(map.tags[i], i));
    meshes.push_back(fmt::format(
        "{{\"primitives\": [{{\"attributes\": {{\"POSITION\": 0, \"NORMAL\": 1, \"TEXCOORD_0\": 2}}, "
        "\"indices\": 3, \"material\": {}}}]}}",
        i));
    materials.push_back(fmt::format(
        "{{\"pbrMetallicRoughness\": {{\"baseColorTexture\": {{\"index\": {}}}, \"metallicFactor\": "
        "0, \"roughnessFactor\": 1}}, \"extensions\": {{\"KHR_materials_unlit\": {{}}}}}}",
        i));
    textures.push_back(fmt::format("{{\"sampler\": 0, \"source\": {}}}", i));
  }
  constexpr int kVertices = 34962, kIndices = 34963;
  for (std::size_t i = 0; i < buffer.views.size(); ++i)
    views.push_back(
        fmt::format("{{\"buffer\": 0, \"byteOffset\": {}, \"byteLength\": {}{}}}", buffer.views[i].offset,
                    buffer.views[i].size,
                    i < 4 ? fmt::format(", \"target\": {}", i < 3 ? kVertices : kIndices) : std::string()));
  return fmt::format(
      "{{\n \"asset\": {{\"version\": \"2.0\", \"generator\": \"AprilTrack\"}},\n \"extensionsUsed\": "
      "[\"KHR_materials_unlit\"],\n \"scene\": 0,\n \"scenes\": [{{\"nodes\": [0]}}],\n \"nodes\": [{}],\n "
      "\"meshes\": "
      "[{}],\n \"materials\": [{}],\n \"textures\": [{}],\n \"images\": [{}],\n \"samplers\": "
      "[{{\"magFilter\": 9728, "
      "\"minFilter\": 9987, \"wrapS\": 33071, \"wrapT\": 33071}}],\n \"accessors\": [\n  {{\"bufferView\": "
      "0, "
      "\"componentType\": 5126, \"count\": 4, \"type\": \"VEC3\", \"min\": [-1, -1, 0], \"max\": [1, 1, "
      "0]}},\n  "
      "{{\"bufferView\": 1, \"componentType\": 5126, \"count\": 4, \"type\": \"VEC3\"}},\n  "
      "{{\"bufferView\": 2, "
      "\"componentType\": 5126, \"count\": 4, \"type\": \"VEC2\"}},\n  {{\"bufferView\": 3, "
      "\"componentType\": 5123, "
      "\"count\": 6, \"type\": \"SCALAR\"}}],\n \"bufferViews\": [{}],\n \"buffers\": [{{\"byteLength\": "
      "{}{}}}]\n}}\n",
      joined(nodes), joined(meshes), joined(materials), joined(textures), joined(images), joined(views),
      buffer.bytes.size(), buffer_uri.empty() ? "" : fmt::format(", \"uri\": \"{}\"", buffer_uri));
}

std::string glb_chunk(std::string data, std::string_view type, char padding) {
  data.resize((data.size() + 3) / 4 * 4, padding);
  std::string chunk;
  append_u32(chunk, data.size());
  return chunk + std::string(type) + data;
}

}  // namespace

std::string gltf_text(const TagMap& map) {
  const QuadBuffer buffer;
  std::vector<std::string> images;
  for (const MapTag& tag : map.tags)
    images.push_back(fmt::format("{{\"uri\": \"data:image/png;base64,{}\"}}", base64(png_of(tag))));
  return gltf_json(map, buffer, images, "data:application/octet-stream;base64," + base64(buffer.bytes));
}

std::string glb_bytes(const TagMap& map) {
  QuadBuffer buffer;
  std::vector<std::string> images;
  for (const MapTag& tag : map.tags) {
    images.push_back(fmt::format("{{\"bufferView\": {}, \"mimeType\": \"image/png\"}}", buffer.views.size()));
    buffer.append(png_of(tag));
  }
  const std::string body = glb_chunk(gltf_json(map, buffer, images, ""), "JSON", ' ') +
                           glb_chunk(buffer.bytes, std::string_view("BIN\0", 4), '\0');
  std::string out = "glTF";
  append_u32(out, 2);
  append_u32(out, 12 + body.size());
  return out + body;
}

}  // namespace apriltrack
