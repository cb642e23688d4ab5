#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "apriltrack/base/check.h"
#include "apriltrack/io/numbers.h"
#include "apriltrack/report/scene_view.h"
#include "svg_inks.h"

namespace apriltrack {
namespace {

using nlohmann::json;

double rounded(double value, double step) {
  APRILTRACK_CHECK(std::isfinite(value), "a scene's numbers are finite");
  const double steps = std::round(value / step);
  return steps == 0.0 ? 0.0 : steps / std::round(1.0 / step);
}

double with_four_digits(double value) {
  APRILTRACK_CHECK(std::isfinite(value), "a scene's covariances are finite");
  return value == 0.0 ? 0.0 : *parse_double(fmt::format("{:.3e}", value));
}

constexpr double kLengthStep_m = 1e-5, kRotationStep = 1e-5, kTimeStep_s = 1e-4;

void add_position(json& list, const Eigen::Vector3d& position_m) {
  for (const double value : position_m) list.push_back(rounded(value, kLengthStep_m));
}

void add_rotation(json& list, const Eigen::Quaterniond& q) {
  for (const double value : {q.x(), q.y(), q.z(), q.w()}) list.push_back(rounded(value, kRotationStep));
}

/// Row by row, four cells to a hexadecimal digit, the first one highest.
std::string hexadecimal(const Image<float>& cells, bool (*is_set)(float)) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  unsigned digit = 0, bits = 0;
  const auto add = [&](bool bit) {
    digit = digit << 1 | static_cast<unsigned>(bit);
    if (++bits % 4 != 0) return;
    text += kDigits[digit];
    digit = 0;
  };
  for (int row = 0; row < cells.height(); ++row) {
    for (int column = 0; column < cells.width(); ++column) add(is_set(cells(column, row)));
  }
  while (bits % 4 != 0) add(false);
  return text;
}

json states_of(const std::vector<SceneState>& states) {
  json list = json::array();
  for (const SceneState& state : states) {
    list.push_back({{"name", state.name}, {"colour", ink_variable(state.ink)}});
    if (state.is_crossed) list.back()["is_crossed"] = true;
  }
  return list;
}

/// The family's place in the list, to which it is added where it is new.
std::size_t family_of(const SceneTag& tag, json& families) {
  for (std::size_t i = 0; i < families.size(); ++i) {
    if (families[i]["name"] != tag.family) continue;
    APRILTRACK_CHECK(families[i]["cells"] == tag.cells.width(), "tags of a family have as many cells");
    return i;
  }
  families.push_back(
      {{"name", tag.family}, {"cells", tag.cells.width()}, {"cells_across_size", tag.width_at_border}});
  return families.size() - 1;
}

json to_json(const SceneTag& tag, json& families) {
  APRILTRACK_CHECK(tag.cells.width() > 0 && tag.cells.width() == tag.cells.height(),
                   "a tag has as many rows as columns of cells");
  json out = {{"name", tag.name},
              {"label", tag.label},
              {"notes", tag.notes},
              {"state", tag.state},
              {"family", family_of(tag, families)},
              {"black", hexadecimal(tag.cells, [](float cell) { return cell < 0.5F; })},
              {"size_m", rounded(tag.size_m, kLengthStep_m)},
              {"position_m", json::array()},
              {"orientation_xyzw", json::array()}};
  add_position(out["position_m"], tag.pose.position_m);
  add_rotation(out["orientation_xyzw"], tag.pose.rotation);
  if (tag.covariance_m2) {
    out["covariance_m2"] = json::array();
    for (Eigen::Index row = 0; row < 3; ++row) {
      for (Eigen::Index column = row; column < 3; ++column)
        out["covariance_m2"].push_back(with_four_digits((*tag.covariance_m2)(row, column)));
    }
  }
  return out;
}

json to_json(const std::string& name, const std::vector<ScenePoint>& points) {
  json out = {{"name", name},
              {"time_s", json::array()},
              {"state", json::array()},
              {"position_m", json::array()},
              {"orientation_xyzw", json::array()}};
  const std::size_t stride = path_stride(points.size());
  for (std::size_t i = 0; i < points.size(); i += stride) {
    const ScenePoint& point = points[i];
    out["time_s"].push_back(rounded(point.time_s, kTimeStep_s));
    out["state"].push_back(point.state);
    if (point.pose) {
      add_position(out["position_m"], point.pose->position_m);
      add_rotation(out["orientation_xyzw"], point.pose->rotation);
    } else {
      for (int k = 0; k < 3; ++k) out["position_m"].push_back(nullptr);
      for (int k = 0; k < 4; ++k) out["orientation_xyzw"].push_back(nullptr);
    }
  }
  return out;
}

const char* word_of(SceneMotion motion) {
  switch (motion) {
    case SceneMotion::kNothing:
      return "nothing";
    case SceneMotion::kCamera:
      return "camera";
    case SceneMotion::kTags:
      return "tags";
  }
  return "nothing";
}

/// Neither `<` nor `&` mean anything in JSON but within strings, where they may be written by their numbers.
std::string safe_in_page(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '<' || c == '>' || c == '&') {
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    } else {
      out += c;
    }
  }
  return out;
}

void check_states(const SceneView& scene) {
  for (const SceneTag& tag : scene.tags)
    APRILTRACK_CHECK(tag.state < scene.tag_states.size(), "a tag's state is one of the scene's");
  for (const ScenePoint& point : scene.path)
    APRILTRACK_CHECK(point.state < scene.path_states.size(), "a frame's state is one of the scene's");
  APRILTRACK_CHECK(scene.ellipsoid_scale > 0.0, "ellipsoids have a scale");
}

}  // namespace

std::size_t path_stride(std::size_t num_frames) {
  return num_frames <= kMostPathFrames ? 1 : (num_frames + kMostPathFrames - 1) / kMostPathFrames;
}

std::string scene_json(const SceneView& scene) {
  check_states(scene);
  json out = {{"moving", word_of(scene.motion)},
              {"up", json::array()},
              {"ellipsoid_scale", with_four_digits(scene.ellipsoid_scale)},
              {"families", json::array()},
              {"tag_states", states_of(scene.tag_states)},
              {"path_states", states_of(scene.path_states)},
              {"tags", json::array()},
              {"view_tangents",
               {with_four_digits(scene.view_tangents.x()), with_four_digits(scene.view_tangents.y())}}};
  add_position(out["up"], scene.up);
  if (scene.from) {
    out["view_from"] = json::array();
    add_position(out["view_from"], *scene.from);
  }
  for (const SceneTag& tag : scene.tags) out["tags"].push_back(to_json(tag, out["families"]));
  if (!scene.path.empty()) out["path"] = to_json(scene.path_name, scene.path);
  if (!scene.true_path.empty()) out["true_path"] = to_json(scene.true_path_name, scene.true_path);
  return safe_in_page(out.dump(-1, ' ', true, json::error_handler_t::replace));
}

}  // namespace apriltrack
