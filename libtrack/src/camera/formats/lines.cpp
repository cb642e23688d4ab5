#include "lines.h"

#include <fmt/format.h>

#include <cmath>
#include <sstream>

#include "../camera_fields.h"
#include "apriltrack/base/error.h"
#include "apriltrack/io/numbers.h"

namespace apriltrack {

std::vector<TextLine> content_lines(const std::string& text, const std::string& name) {
  constexpr std::string_view kBlanks = " \t\r";
  std::vector<TextLine> lines;
  std::istringstream stream(text);
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    line.erase(std::min(line.find('#'), line.size()));
    const std::size_t first = line.find_first_not_of(kBlanks);
    if (first == std::string::npos) continue;
    lines.push_back(
        {fmt::format("{}:{}", name, number), line.substr(first, line.find_last_not_of(kBlanks) + 1 - first)});
  }
  return lines;
}

std::vector<std::string> words_of(std::string_view line) {
  std::vector<std::string> words;
  std::istringstream stream{std::string(line)};
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

double number_of(const std::string& word, const TextLine& line, std::string_view what) {
  const auto value = parse_double(word);
  if (value && std::isfinite(*value)) return *value;
  throw invalid_input(line.where, fmt::format("{} must be a finite number (is '{}')", what, word));
}

int side_of(const std::string& word, const TextLine& line, std::string_view what) {
  const auto value = parse_integer(word);
  if (value && *value >= 1 && *value <= kMaxResolution) return static_cast<int>(*value);
  throw invalid_input(line.where, fmt::format("{} must be a whole number in [1, {}] pixels (is '{}')", what,
                                              kMaxResolution, word));
}

CameraModel model_at(const std::string& where, const Pinhole& pinhole, const Distortion& distortion) {
  try {
    return CameraModel(pinhole, distortion);
  } catch (const Error& error) {
    throw Error(error.kind(), where, error.cause());
  }
}

}  // namespace apriltrack
