#include "image_names.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <system_error>

#include "apriltrack/io/lower_case.h"

namespace apriltrack {
namespace fs = std::filesystem;
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// Takes a run of digits off the front, without its leading zeros.
std::string_view take_number(std::string_view& text) {
  std::size_t end = 0;
  while (end < text.size() && is_digit(text[end])) ++end;
  std::string_view number = text.substr(0, end);
  text.remove_prefix(end);
  number.remove_prefix(std::min(number.find_first_not_of('0'), number.size()));
  return number;
}

}  // namespace

bool has_image_ending(const fs::path& path) {
  constexpr std::array<std::string_view, 10> kEndings = {".png", ".jpg", ".jpeg", ".pgm",  ".ppm",
                                                         ".pnm", ".bmp", ".tif",  ".tiff", ".webp"};
  return std::ranges::find(kEndings, lower_case_ending(path)) != kEndings.end();
}

std::vector<fs::path> list_images(const fs::path& folder) {
  std::vector<fs::path> images;
  std::error_code ignored;  // what cannot be looked at becomes an unreadable frame
  for (const auto& entry : fs::directory_iterator(folder)) {
    const bool is_hidden = entry.path().filename().string().starts_with('.');
    if (!is_hidden && has_image_ending(entry.path()) && !entry.is_directory(ignored))
      images.push_back(entry.path());
  }
  std::ranges::sort(images, natural_less, [](const fs::path& path) { return path.string(); });
  return images;
}

bool natural_less(std::string_view a, std::string_view b) {
  const std::string_view whole_a = a;
  const std::string_view whole_b = b;
  while (!a.empty() && !b.empty()) {
    if (is_digit(a.front()) && is_digit(b.front())) {
      const std::string_view number_a = take_number(a);
      const std::string_view number_b = take_number(b);
      if (number_a.size() != number_b.size()) return number_a.size() < number_b.size();
      if (number_a != number_b) return number_a < number_b;
    } else if (a.front() != b.front()) {
      return a.front() < b.front();
    } else {
      a.remove_prefix(1);
      b.remove_prefix(1);
    }
  }
  if (a.empty() != b.empty()) return a.empty();
  return whole_a < whole_b;  // "01" and "1": the same number, told apart by text
}

bool is_named_by_digits(const fs::path& path) {
  const std::string stem = path.stem().string();
  return !stem.empty() && std::ranges::all_of(stem, is_digit);
}

bool is_named_by_seconds(const fs::path& path) {
  constexpr std::size_t kMostDecimals = 9;  // more are no whole nanoseconds
  const std::string stem = path.stem().string();
  const std::size_t point = stem.find('.');
  if (point == 0 || point == std::string::npos) return false;
  const std::string_view whole = std::string_view(stem).substr(0, point),
                         decimals = std::string_view(stem).substr(point + 1);
  return std::ranges::all_of(whole, is_digit) && std::ranges::all_of(decimals, is_digit) &&
         !decimals.empty() && decimals.size() <= kMostDecimals;
}

std::optional<Timestamp> time_in_name(const fs::path& path) {
  if (is_named_by_digits(path)) return parse_nanoseconds(path.stem().string());
  if (is_named_by_seconds(path)) return parse_seconds(path.stem().string());
  return std::nullopt;
}

}  // namespace apriltrack
