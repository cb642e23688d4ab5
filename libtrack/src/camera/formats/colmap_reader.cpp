#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "apriltrack/base/error.h"
#include "apriltrack/io/numbers.h"
#include "colmap.h"
#include "formats.h"
#include "lines.h"

namespace apriltrack {
namespace {

constexpr std::size_t kFirstParameter = 4;  // after CAMERA_ID MODEL WIDTH HEIGHT

bool is_model_word(const std::string& word) {
  const auto is_fitting = [](unsigned char c) {
    return std::isupper(c) != 0 || std::isdigit(c) != 0 || c == '_';
  };
  return std::isupper(static_cast<unsigned char>(word[0])) != 0 && std::ranges::all_of(word, is_fitting);
}

const ColmapModel& model_named(const std::string& name, const TextLine& line) {
  const auto found = std::ranges::find(kColmapModels, name, &ColmapModel::name);
  if (found != kColmapModels.end()) return *found;
  std::string names;
  for (const ColmapModel& model : kColmapModels)
    names += fmt::format("{}{}", names.empty() ? "" : ", ", model.name);
  throw invalid_input(
      line.where, fmt::format("the model '{}' is not supported; supported are {}: run COLMAP's "
                              "feature_extractor with --ImageReader.camera_model OPENCV, or OPENCV_FISHEYE",
                              name, names));
}

Distortion lens_of(const ColmapModel& model, std::vector<double> coefficients) {
  if (model.num_coefficients == 0) return NoDistortion();
  if (coefficients.size() < 4) coefficients.resize(4, 0.0);
  if (model.is_fisheye) return EquidistantDistortion(coefficients);
  return RadtanDistortion(coefficients);
}

Camera read_camera_line(const TextLine& line) {
  const std::vector<std::string> words = words_of(line.text);
  if (words.size() < kFirstParameter) {
    throw invalid_input(line.where, "must be CAMERA_ID MODEL WIDTH HEIGHT PARAMS, as COLMAP writes it");
  }
  const ColmapModel& model = model_named(words[1], line);
  std::vector<double> values;
  for (std::size_t i = kFirstParameter; i < words.size(); ++i)
    values.push_back(number_of(words[i], line, fmt::format("parameter {}", i - kFirstParameter + 1)));
  const int expected = model.num_focal_lengths + 2 + model.num_coefficients;
  if (values.size() != static_cast<std::size_t>(expected)) {
    throw invalid_input(
        line.where, fmt::format("{} has {} parameters (there are {})", model.name, expected, values.size()));
  }
  const auto center = values.begin() + model.num_focal_lengths;
  const Pinhole pinhole{values[0], *(center - 1), center[0] - kColmapPixelOffset_px,
                        center[1] - kColmapPixelOffset_px};
  return {.model = model_at(line.where, pinhole, lens_of(model, {center + 2, values.end()})),
          .width = side_of(words[2], line, "the width"),
          .height = side_of(words[3], line, "the height"),
          .response_origin = ResponseOrigin::kAssumed};
}

}  // namespace

bool is_colmap(const CameraText& file) {
  const auto lines = content_lines(file.text, file.name);
  if (lines.empty())
    return file.text.find("# Camera list with one line of data per camera") != std::string::npos;
  const auto words = words_of(lines.front().text);
  return words.size() >= 3 && parse_integer(words[0]) && is_model_word(words[1]) && parse_integer(words[2]);
}

CameraRig read_colmap(const CameraText& file, CameraReading&) {
  CameraRig rig;
  for (const TextLine& line : content_lines(file.text, file.name)) {
    rig.cameras.push_back(read_camera_line(line));
    rig.cameras.back().name = fmt::format("cam{}", rig.cameras.size() - 1);
  }
  if (rig.cameras.empty()) throw invalid_input(file.name, "there is no camera in this list");
  return rig;
}

}  // namespace apriltrack
