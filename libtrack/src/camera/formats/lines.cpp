#include "lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "../camera_fields.h"
#include "apriltrack/base/error.h"
#include "apriltrack/io/numbers.h"
#include "apriltrack/io/trimmed.h"

namespace apriltrack {

std::vector<TextLine> content_lines(const std::string& text, const std::string& name) {
  std::vector<TextLine> lines;
  std::istringstream stream(text);
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    line.erase(std::min(line.find('#'), line.size()));
    const std::string_view content = trimmed(line);
    if (!content.empty()) lines.push_back({fmt::format("{}:{}", name, number), std::string(content)});
  }
  return lines;
}

std::vector<std::string> words_of(std::string_view text) {
  constexpr std::string_view kSeparators = " \t\r\n";  // those of trimmed(), and ends of lines
  std::vector<std::string> words;
  for (std::size_t begin = text.find_first_not_of(kSeparators); begin != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(kSeparators, begin), text.size());
    words.emplace_back(text.substr(begin, end - begin));
    begin = text.find_first_not_of(kSeparators, end);
  }
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
