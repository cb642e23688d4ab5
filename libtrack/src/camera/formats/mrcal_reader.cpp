#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "../camera_fields.h"
#include "formats.h"

namespace apriltrack {
namespace {

struct MrcalModel {
  std::string_view name;
  std::size_t num_coefficients;
};
/// After fx fy cx cy, in OpenCV's order (dkogan/mrcal: doc/lensmodels.org). OPENCV12 ends in the thin prism.
constexpr std::array<MrcalModel, 5> kMrcalModels = {
    {{"PINHOLE", 0}, {"OPENCV4", 4}, {"OPENCV5", 5}, {"OPENCV8", 8}, {"OPENCV12", 12}}};

std::size_t first_of_content(const std::string& text) {
  std::size_t at = 0;
  while ((at = text.find_first_not_of(" \t\r\n", at)) != std::string::npos && text[at] == '#') {
    at = text.find('\n', at);
    if (at == std::string::npos) break;
  }
  return at;
}

/// The inputs of the optimization are bytes in base85, of megabytes, which YAML would not take for a text.
/// Neither quotes nor backslashes occur in them; lines keep their numbers.
std::string without_bytes(std::string text) {
  for (std::size_t at = 0; (at = text.find(" b'", at)) != std::string::npos;) {
    const std::size_t end = text.find('\'', at + 3);
    if (end == std::string::npos) return text;
    const auto num_lines = std::count(text.begin() + static_cast<std::ptrdiff_t>(at),
                                      text.begin() + static_cast<std::ptrdiff_t>(end), '\n');
    const std::string instead = " null" + std::string(static_cast<std::size_t>(num_lines), '\n');
    text.replace(at, end + 1 - at, instead);
    at += instead.size();
  }
  return text;
}

/// "OPENCV8" of LENSMODEL_OPENCV8, or of what mrcal called DISTORTION_OPENCV8 before its version 1.
std::string model_name(const YamlNode& node) {
  std::string name = node.as_string();
  for (const std::string_view prefix : {"LENSMODEL_", "DISTORTION_"}) {
    if (name.starts_with(prefix)) name.erase(0, prefix.size());
  }
  return name == "NONE" ? "PINHOLE" : name;
}

CameraModel read_lens_of_mrcal(const YamlNode& root, const Resolution& size, BeyondOurLenses beyond,
                               std::vector<ConversionLoss>& lost) {
  const YamlNode model = root.find("lensmodel") ? root.at("lensmodel") : root.at("distortion_model");
  const auto known = std::ranges::find(kMrcalModels, model_name(model), &MrcalModel::name);
  if (known == kMrcalModels.end()) {
    model.fail(fmt::format(
        "'{}' is not supported; supported are LENSMODEL_PINHOLE and LENSMODEL_OPENCV4, 5 and 8: fit one of "
        "them with mrcal-convert-lensmodel LENSMODEL_OPENCV8",
        model.as_string()));
  }
  const YamlNode node = root.at("intrinsics");
  const std::vector<double> values = node.as_doubles();
  if (values.size() != 4 + known->num_coefficients) {
    node.fail(fmt::format("{} has {} numbers, fx fy cx cy and {} of the lens (there are {})",
                          model.as_string(), 4 + known->num_coefficients, known->num_coefficients,
                          values.size()));
  }
  const Pinhole pinhole = checked_pinhole(values[0], values[1], values[2], values[3], node);
  if (known->num_coefficients == 0) return {pinhole, NoDistortion()};
  const std::vector<double> coefficients(values.begin() + 4, values.end());
  if (has_further_terms(coefficients))
    return lens_of_further_terms(pinhole, coefficients, node, size, beyond, lost);
  return {pinhole, RadtanDistortion(without_zero_tail(coefficients, node))};
}

/// mrcal's place of a lone camera is relative to whatever its calibration took for the reference.
void note_place_in_reference(const YamlNode& root, std::vector<ConversionLoss>& lost) {
  for (const char* key : {"extrinsics", "rt_cam_ref"}) {
    const auto place = root.find(key);
    if (!place || !place->is_list()) continue;
    const std::vector<double> rt = place->as_doubles(6);
    if (std::ranges::all_of(rt, [](double value) { return value == 0.0; })) continue;
    lost.push_back({.kind = LossKind::kExtrinsics,
                    .which = {"cam0"},
                    .value = fmt::format("{}: [{}]", key, fmt::join(rt, ", "))});
  }
}

}  // namespace

bool is_mrcal(const CameraText& file) {
  const std::size_t first = first_of_content(file.text);
  if (first == std::string::npos || file.text[first] != '{') return false;
  const auto has = [&](std::string_view key) { return file.text.find(key) != std::string::npos; };
  return has("imagersize") && (has("lensmodel") || has("distortion_model"));
}

CameraRig read_mrcal(const CameraText& file, CameraReading& reading) {
  const YamlNode root = YamlNode::read_text(without_bytes(file.text), file.name);
  const Resolution size = read_resolution_list(root.at("imagersize"));
  const Camera camera{.model = read_lens_of_mrcal(root, size, reading.beyond, reading.lost),
                      .width = size.width,
                      .height = size.height,
                      .response_origin = ResponseOrigin::kAssumed};
  note_place_in_reference(root, reading.lost);
  return {{camera}};
}

}  // namespace apriltrack
