#include <fmt/format.h>

#include <cmath>

#include "apriltrack/base/error.h"
#include "apriltrack/io/input_file.h"
#include "apriltrack/io/numbers.h"
#include "camera_fields.h"

namespace apriltrack {
namespace {

constexpr std::string_view kBetweenNumbers = " \t\r,;";

struct TableEntry {
  double value = 0.0;
  std::size_t line = 0;
};

std::vector<TableEntry> read_entries(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  std::string_view rest = text;
  std::vector<TableEntry> entries;
  for (std::size_t line = 1; !rest.empty(); ++line) {
    const std::size_t end = rest.find('\n');
    std::string_view content = rest.substr(0, end);
    content = content.substr(0, content.find('#'));
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    for (;;) {
      const std::size_t begin = content.find_first_not_of(kBetweenNumbers);
      if (begin == std::string_view::npos) break;
      content.remove_prefix(begin);
      const std::string_view word = content.substr(0, content.find_first_of(kBetweenNumbers));
      const auto value = parse_double(word);
      if (!value || !std::isfinite(*value) || *value < 0.0) {
        throw invalid_input(fmt::format("{}:{}", path.string(), line),
                            fmt::format("a response table holds finite numbers >= 0 (is '{}')", word));
      }
      entries.push_back({*value, line});
      content.remove_prefix(word.size());
    }
  }
  return entries;
}

void check_entries(const std::vector<TableEntry>& entries, const std::filesystem::path& path) {
  if (entries.size() != 256) {
    throw invalid_input(path.string(),
                        fmt::format("a response table holds 256 numbers, the light of each grey level "
                                    "from 0 to 255 (there are {})",
                                    entries.size()));
  }
  for (std::size_t i = 1; i < entries.size(); ++i) {
    if (entries[i].value >= entries[i - 1].value) continue;
    throw invalid_input(fmt::format("{}:{}", path.string(), entries[i].line),
                        fmt::format("a response table must never decrease (grey level {} has {} after {})", i,
                                    entries[i].value, entries[i - 1].value));
  }
  if (!(entries.back().value > entries.front().value)) {
    throw invalid_input(
        path.string(), fmt::format("a response table must rise (all numbers are {})", entries.front().value));
  }
}

}  // namespace

ResponseCurve read_response_table(const std::filesystem::path& path) {
  const auto entries = read_entries(path);
  check_entries(entries, path);
  const double full_scale = std::max(1.0, entries.back().value);
  std::array<float, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = static_cast<float>(entries[i].value / full_scale);
  return ResponseCurve(table);
}

std::string format_response_table(const ResponseCurve& response) {
  std::string text = "# linear light (full scale 1) of the grey levels 0 to 255\n";
  for (const float light : response.linear_light()) text += fmt::format("{}\n", light);
  return text;
}

ResponseCurve read_response(const YamlNode& node, const std::filesystem::path& folder) {
  const std::string text = node.as_string();
  if (text == "srgb") return ResponseCurve::srgb();
  if (text == "linear") return ResponseCurve::linear();
  constexpr std::string_view kChoices =
      "srgb, linear, gamma:G (such as gamma:2.2) or the path of a 256-entry table";
  if (text == "auto") {
    node.fail(fmt::format(
        "'auto': `apriltrack calibrate` estimates the response from images of tags and writes it to "
        "<output>.camera.yaml: run it first and use that file, or write {}",
        kChoices));
  }
  if (text.starts_with("gamma:")) {
    const auto exponent = parse_double(std::string_view(text).substr(6));
    if (!exponent || !(*exponent >= 0.2 && *exponent <= 5.0)) {
      node.fail(fmt::format("the G of gamma:G must be a number in [0.2, 5] (is '{}')", text.substr(6)));
    }
    return ResponseCurve::gamma(*exponent);
  }
  const std::filesystem::path table = folder / text;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(table, ignored)) {
    node.fail(
        fmt::format("'{}' is unknown, and there is no file {}; write {}", text, table.string(), kChoices));
  }
  return read_response_table(table);
}

}  // namespace apriltrack
