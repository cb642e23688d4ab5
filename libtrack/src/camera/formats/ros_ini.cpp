// What ROS's camera_calibration_parsers call the Videre .ini format (ros-perception/image_common,
// camera_calibration_parsers/src/parse_ini.cpp): [image] with width and height, then [<camera's name>] with
// matrices whose names stand on lines of their own.

#include <fmt/format.h>

#include <map>
#include <set>

#include "../camera_fields.h"
#include "apriltrack/base/error.h"
#include "apriltrack/io/numbers.h"
#include "formats.h"
#include "lines.h"
#include "rectification.h"

namespace apriltrack {
namespace {

bool is_section(const std::string& text) {
  return text.front() == '[' && text.back() == ']';
}

struct IniValue {
  TextLine key;
  std::vector<std::string> words;  ///< Of all lines below the key.
};

/// Section and key ("image", "width") to value.
using IniValues = std::map<std::pair<std::string, std::string>, IniValue>;

struct IniFile {
  IniValues values;
  std::vector<std::string> cameras;  ///< Sections that are neither image nor externals.
};

IniFile read_sections(const CameraText& file) {
  IniFile ini;
  std::string section;
  IniValue* value = nullptr;
  for (const TextLine& line : content_lines(file.text, file.name)) {
    const std::vector<std::string> words = words_of(line.text);
    if (is_section(line.text)) {
      section = line.text.substr(1, line.text.size() - 2);
      value = nullptr;
      if (section != "image" && section != "externals") ini.cameras.push_back(section);
    } else if (parse_double(words.front())) {
      if (value == nullptr) throw invalid_input(line.where, "a number without a name on the line above");
      value->words.insert(value->words.end(), words.begin(), words.end());
    } else {
      const auto [entry, is_new] = ini.values.try_emplace({section, line.text}, IniValue{line, {}});
      if (!is_new)
        throw invalid_input(line.where, fmt::format("'{}' stands twice in [{}]", line.text, section));
      value = &entry->second;
    }
  }
  return ini;
}

IniValue value_at(const IniFile& ini, const CameraText& file, const std::string& section,
                  const std::string& key) {
  const auto found = ini.values.find({section, key});
  if (found != ini.values.end()) return found->second;
  throw invalid_input(file.name, fmt::format("'{}' is missing in [{}]", key, section));
}

/// As a YAML list, whose readers know all that can be wrong with a camera; `key` goes into messages.
YamlNode list_of(const IniValue& value) {
  std::vector<double> numbers;
  for (const std::string& word : value.words) numbers.push_back(number_of(word, value.key, value.key.text));
  std::string text;
  for (const double number : numbers) text += (text.empty() ? "" : ", ") + format_exact(number);
  return YamlNode::read_text("\"" + value.key.text + "\": [" + text + "]", value.key.where)
      .at(value.key.text);
}

int read_side(const IniFile& ini, const CameraText& file, const std::string& key) {
  const IniValue value = value_at(ini, file, "image", key);
  if (value.words.size() != 1)
    throw invalid_input(value.key.where, fmt::format("{} must be one number", key));
  return side_of(value.words[0], value.key, key);
}

Camera read_ini_camera(const IniFile& ini, const CameraText& file, const std::string& section,
                       std::vector<ConversionLoss>& lost) {
  const YamlNode matrix = list_of(value_at(ini, file, section, "camera matrix"));
  const YamlNode distortion = list_of(value_at(ini, file, section, "distortion"));
  const SkewedPinhole lens = read_pinhole_matrix(matrix);
  Camera camera{.model = CameraModel(lens.pinhole, read_distortion("plumb_bob", &distortion, distortion)),
                .width = read_side(ini, file, "width"),
                .height = read_side(ini, file, "height"),
                .response_origin = ResponseOrigin::kAssumed};
  pass_over_skew(lens.skew_px, camera, matrix, lost);
  note_name(section, lost);
  const auto list_named = [&](const char* key) {
    const auto found = ini.values.find({section, key});
    return found == ini.values.end() ? std::nullopt : std::optional(list_of(found->second));
  };
  note_rectification(list_named("rectification"), list_named("projection"), lens.pinhole, lost);
  return camera;
}

}  // namespace

bool is_ros_ini(const CameraText& file) {
  const auto lines = content_lines(file.text, file.name);
  return !lines.empty() && is_section(lines.front().text) &&
         file.text.find("camera matrix") != std::string::npos;
}

CameraRig read_ros_ini(const CameraText& file, CameraReading& reading) {
  const IniFile ini = read_sections(file);
  if (ini.cameras.size() != 1) {
    throw invalid_input(
        file.name, fmt::format("must be of one camera, [image] and a section with its name (there are {})",
                               ini.cameras.size()));
  }
  return {{read_ini_camera(ini, file, ini.cameras.front(), reading.lost)}};
}

}  // namespace apriltrack
