#include "image_times.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "apriltrack/base/error.h"
#include "apriltrack/io/csv.h"
#include "image_names.h"

namespace apriltrack {
namespace fs = std::filesystem;
namespace {

constexpr std::int64_t kLeastFramePeriod_ns = 1000;

std::vector<ImageEntry> entries_by_rate(const std::vector<fs::path>& images, double rate_hz) {
  std::vector<ImageEntry> entries;
  for (const fs::path& path : images) {
    const double time_ns = std::round(static_cast<double>(entries.size()) * 1e9 / rate_hz);
    entries.push_back({.path = path, .timestamp = {static_cast<std::int64_t>(time_ns)}});
  }
  return entries;
}

Timestamp require_time(const fs::path& path) {
  const auto time = time_in_name(path);
  if (!time)
    throw invalid_input(path.string(), "its name is no time in nanoseconds: the number is beyond 64 bits");
  return *time;
}

std::vector<ImageEntry> entries_by_name(const std::vector<fs::path>& images) {
  std::vector<ImageEntry> entries;
  for (const fs::path& path : images) entries.push_back({.path = path, .timestamp = require_time(path)});
  std::ranges::stable_sort(entries, {}, &ImageEntry::timestamp);
  const auto same_time = [](const ImageEntry& a, const ImageEntry& b) { return a.timestamp == b.timestamp; };
  const auto repeated = std::ranges::adjacent_find(entries, same_time);
  if (repeated != entries.end()) {
    throw invalid_input(repeated->path.string(),
                        fmt::format("has the same time in its name, {} ns, as {}", repeated->timestamp.ns,
                                    std::next(repeated)->path.filename().string()));
  }
  return entries;
}

bool are_frame_numbers(const std::vector<fs::path>& images) {
  const auto by_time = [](const fs::path& a, const fs::path& b) { return require_time(a) < require_time(b); };
  const auto [first, last] = std::ranges::minmax_element(images, by_time);
  const auto num_periods = static_cast<std::int64_t>(images.size()) - 1;
  return require_time(*last).ns - require_time(*first).ns < num_periods * kLeastFramePeriod_ns;
}

}  // namespace

std::vector<ImageEntry> give_times(const std::vector<fs::path>& images, std::optional<double> rate_hz,
                                   const std::string& where) {
  const auto num_digits = std::ranges::count_if(images, is_named_by_digits);
  if (num_digits == std::ssize(images)) {
    return rate_hz && are_frame_numbers(images) ? entries_by_rate(images, *rate_hz) : entries_by_name(images);
  }
  const std::string odd = std::ranges::find_if_not(images, is_named_by_digits)->filename().string();
  if (num_digits > 0) {
    throw invalid_input(where,
                        fmt::format("{} of {} images are named by a time, but not '{}': name all by times in "
                                    "nanoseconds or none",
                                    num_digits, images.size(), odd));
  }
  if (!rate_hz) {
    throw invalid_input(
        where, fmt::format("image names such as '{}' are no times (all digits, nanoseconds): give the "
                           "frame rate with --rate HZ",
                           odd));
  }
  return entries_by_rate(images, *rate_hz);
}

namespace {

struct FrameFacts {
  std::optional<double> exposure_s;
  double gain = 1.0;
};

double positive(const CsvTable& table, std::size_t row, std::string_view column) {
  const double value = table.number(row, column);
  if (value > 0.0) return value;
  throw invalid_input(table.where(row), fmt::format("{}: must be > 0 (is {})", column, value));
}

FrameFacts read_facts(const CsvTable& table, std::size_t row) {
  const auto has = [&](std::string_view column) {
    return table.has_column(column) && !table.is_empty(row, column);
  };
  FrameFacts facts;
  if (has("exposure_s")) facts.exposure_s = positive(table, row, "exposure_s");
  if (has("gain")) facts.gain = positive(table, row, "gain");
  return facts;
}

}  // namespace

void add_frame_facts(const fs::path& frames_csv, std::vector<ImageEntry>& images) {
  const CsvTable table = CsvTable::read_file(frames_csv, {"timestamp_ns"});
  std::map<std::int64_t, FrameFacts> facts_by_time;
  for (std::size_t row = 0; row < table.num_rows(); ++row) {
    const std::int64_t time_ns = table.integer(row, "timestamp_ns");
    if (!facts_by_time.empty() && time_ns <= facts_by_time.rbegin()->first) {
      throw invalid_input(table.where(row),
                          fmt::format("timestamp_ns: must be later than the row before's {} (is {})",
                                      facts_by_time.rbegin()->first, time_ns));
    }
    facts_by_time[time_ns] = read_facts(table, row);
  }
  for (ImageEntry& image : images) {
    const auto found = facts_by_time.find(image.timestamp.ns);
    if (found == facts_by_time.end()) continue;
    image.exposure_s = found->second.exposure_s;
    image.gain = found->second.gain;
  }
}

}  // namespace apriltrack
