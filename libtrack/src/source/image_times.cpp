#include "image_times.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "apriltrack/base/error.h"
#include "apriltrack/image/exposure.h"
#include "apriltrack/io/csv.h"
#include "image_names.h"

namespace apriltrack {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t kLeastFramePeriod_ns = 1000;

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
  if (!time) throw invalid_input(path.string(), "its name is no time: it is beyond 64 bits of nanoseconds");
  return *time;
}

/// In the order of time.
std::vector<ImageEntry> entries_by_name(const std::vector<fs::path>& images) {
  std::vector<ImageEntry> entries;
  for (const fs::path& path : images) entries.push_back({.path = path, .timestamp = require_time(path)});
  std::ranges::stable_sort(entries, {}, &ImageEntry::timestamp);
  return entries;
}

bool are_no_frame_period_apart(const ImageEntry& a, const ImageEntry& b) {
  return nanoseconds_apart(a.timestamp, b.timestamp) < kLeastFramePeriod_ns;
}

[[noreturn]] void refuse_times(const ImageEntry& before, const ImageEntry& after) {
  const std::string name = before.path.filename().string();
  const std::uint64_t period_ns = nanoseconds_apart(before.timestamp, after.timestamp);
  if (period_ns == 0) {
    throw invalid_input(after.path.string(),
                        fmt::format("has the same time in its name, {} ns, as {}", after.timestamp.ns, name));
  }
  throw invalid_input(
      after.path.string(),
      fmt::format("is {} ns after {}, as names of digits are times in nanoseconds; if they are "
                  "frame numbers, give the frame rate with --rate HZ",
                  period_ns, name));
}

/// Of the differences of neighbours; the smaller of the two in the middle. Requires two entries or more.
std::uint64_t median_step(const std::vector<ImageEntry>& entries) {
  std::vector<std::uint64_t> steps;
  for (std::size_t i = 1; i < entries.size(); ++i)
    steps.push_back(nanoseconds_apart(entries[i - 1].timestamp, entries[i].timestamp));
  const auto middle = steps.begin() + (std::ssize(steps) - 1) / 2;
  std::ranges::nth_element(steps, middle);
  return *middle;
}

/// Numbers that were taken for times so far. Counted from frame 0, not from the first that is there: cameras
/// that were numbered together stay together, whichever frames each of them lost.
std::vector<ImageEntry> entries_by_number(std::vector<ImageEntry> entries, double rate_hz) {
  for (ImageEntry& entry : entries) {
    const long double time_ns = std::round(static_cast<long double>(entry.timestamp.ns) * 1e9L / rate_hz);
    if (!(std::abs(time_ns) < 9.2e18L)) {
      throw invalid_input(entry.path.string(),
                          fmt::format("is frame {} in its name, which at {:g} Hz is a time beyond 64 bits",
                                      entry.timestamp.ns, rate_hz));
    }
    entry.timestamp.ns = static_cast<std::int64_t>(time_ns);
  }
  return entries;
}

std::string in_unit(double time_ns) {
  if (time_ns < 1e3) return fmt::format("{:g} ns", time_ns);
  if (time_ns < 1e6) return fmt::format("{:.4g} us", 1e-3 * time_ns);
  return time_ns < 1e9 ? fmt::format("{:.4g} ms", 1e-6 * time_ns) : fmt::format("{:.4g} s", 1e-9 * time_ns);
}

/// Units of time that programs name pictures by, in ns: nanoseconds, microseconds, milliseconds, seconds.
constexpr std::array<std::int64_t, 4> kUnits_ns = {1, 1'000, 1'000'000, 1'000'000'000};

std::vector<ImageEntry> entries_by_unit(std::vector<ImageEntry> entries, std::int64_t unit_ns) {
  for (ImageEntry& entry : entries) {
    if (entry.timestamp.ns > std::numeric_limits<std::int64_t>::max() / unit_ns)
      throw invalid_input(entry.path.string(),
                          fmt::format("its name in units of {} is a time beyond 64 bits of nanoseconds",
                                      in_unit(static_cast<double>(unit_ns))));
    entry.timestamp.ns *= unit_ns;
  }
  return entries;
}

/// But for frames that were dropped or taken away.
bool agree(double step_ns, double period_ns) {
  constexpr double kMaxRatio = 3.0;
  const double ratio = step_ns / period_ns;
  return ratio <= kMaxRatio && ratio >= 1.0 / kMaxRatio;
}

/// With a rate, the steps between the names tell what they are: times in one of the units, if they agree with
/// it but for frames that were dropped or taken away, or frame numbers.
std::vector<ImageEntry> entries_by_digits_and_rate(std::vector<ImageEntry> entries, double rate_hz,
                                                   const std::string& where) {
  constexpr std::uint64_t kMaxStepOfNumbers = 1000;    // every thousandth frame of a film
  constexpr std::int64_t kMostNumber = 1'000'000'000;  // of a year at 30 Hz
  if (entries.size() < 2) return entries;
  const auto same = std::ranges::adjacent_find(entries, {}, &ImageEntry::timestamp);
  if (same != entries.end()) refuse_times(*same, *std::next(same));
  const double period_ns = 1e9 / rate_hz;
  const std::uint64_t step = median_step(entries);
  const auto agrees = [&](std::int64_t unit_ns) {
    return agree(static_cast<double>(step) * static_cast<double>(unit_ns), period_ns);
  };
  if (agrees(1)) return entries;
  if (step < kMaxStepOfNumbers && entries.front().timestamp.ns < kMostNumber)
    return entries_by_number(std::move(entries), rate_hz);
  const auto unit = std::ranges::find_if(kUnits_ns, agrees);
  if (unit != kUnits_ns.end()) return entries_by_unit(std::move(entries), *unit);
  throw invalid_input(
      where,
      fmt::format(
          "read as nanoseconds, the names of its images are {} apart, but --rate {:g} says {}, with which "
          "micro- and milliseconds and seconds do not agree either; leave out --rate if they are "
          "nanoseconds; frame numbers must be less than {} apart",
          in_unit(static_cast<double>(step)), rate_hz, in_unit(period_ns), kMaxStepOfNumbers));
}

/// Names in microseconds would pass for nanoseconds.
void refuse_rate_of_names(const std::vector<ImageEntry>& entries, const std::string& where) {
  constexpr std::uint64_t kLeastStep_ns = 100'000;  // no film of tags has 10,000 frames a second
  if (entries.size() < 2) return;
  const std::uint64_t step_ns = median_step(entries);
  if (step_ns >= kLeastStep_ns) return;
  throw invalid_input(
      where, fmt::format("read as nanoseconds, the names of its images are {} apart, {:.3g} frames a second: "
                         "give the frame rate with --rate HZ, which tells their unit",
                         in_unit(static_cast<double>(step_ns)), 1e9 / static_cast<double>(step_ns)));
}

std::vector<ImageEntry> entries_by_digits(const std::vector<fs::path>& images, std::optional<double> rate_hz,
                                          const std::string& where) {
  std::vector<ImageEntry> entries = entries_by_name(images);
  if (rate_hz) return entries_by_digits_and_rate(std::move(entries), *rate_hz, where);
  const auto close = std::ranges::adjacent_find(entries, are_no_frame_period_apart);
  if (close != entries.end()) refuse_times(*close, *std::next(close));
  refuse_rate_of_names(entries, where);
  return entries;
}

/// Of names in seconds with a point.
std::vector<ImageEntry> entries_by_seconds(const std::vector<fs::path>& images, std::optional<double> rate_hz,
                                           const std::string& where) {
  std::vector<ImageEntry> entries = entries_by_name(images);
  const auto close = std::ranges::adjacent_find(entries, are_no_frame_period_apart);
  if (close != entries.end())
    throw invalid_input(std::next(close)->path.string(),
                        fmt::format("is {} ns after {}, as names of digits with a point are times in seconds",
                                    nanoseconds_apart(close->timestamp, std::next(close)->timestamp),
                                    close->path.filename().string()));
  if (!rate_hz || entries.size() < 2) return entries;
  const double period_ns = 1e9 / *rate_hz, step_ns = static_cast<double>(median_step(entries));
  if (!agree(step_ns, period_ns))
    throw invalid_input(where,
                        fmt::format("read as seconds, the names of its images are {} apart, but --rate {:g} "
                                    "says {}: leave out --rate, or, if they are no times, rename them",
                                    in_unit(step_ns), *rate_hz, in_unit(period_ns)));
  return entries;
}

}  // namespace

std::vector<ImageEntry> give_times(const std::vector<fs::path>& images, std::optional<double> rate_hz,
                                   const std::string& where) {
  const auto num_digits = std::ranges::count_if(images, is_named_by_digits);
  const auto num_seconds = std::ranges::count_if(images, is_named_by_seconds);
  if (num_digits == std::ssize(images)) return entries_by_digits(images, rate_hz, where);
  if (num_seconds == std::ssize(images)) return entries_by_seconds(images, rate_hz, where);
  // What there is most of is what is meant.
  const auto is_meant = num_digits >= num_seconds ? is_named_by_digits : is_named_by_seconds;
  const std::string odd = std::ranges::find_if_not(images, is_meant)->filename().string();
  if (num_digits + num_seconds > 0) {
    throw invalid_input(where,
                        fmt::format("{} of {} images are named by a time, but not '{}': name all by times in "
                                    "nanoseconds, all by times in seconds with a point, or none",
                                    std::max(num_digits, num_seconds), images.size(), odd));
  }
  if (!rate_hz) {
    throw invalid_input(
        where,
        fmt::format(
            "image names such as '{}' are no times (digits, nanoseconds; with a point, seconds): give the "
            "frame rate with --rate HZ",
            odd));
  }
  return entries_by_rate(images, *rate_hz);
}

namespace {

constexpr std::string_view kTimeColumn = "timestamp_ns";
constexpr std::string_view kExposureColumn = "exposure_s";
constexpr std::string_view kGainColumn = "gain";

struct FrameFacts {
  std::size_t row = 0;
  std::optional<double> exposure_s = std::nullopt;
  double gain = 1.0;
};

std::string where_in(const CsvTable& table, std::size_t row, std::string_view column) {
  return fmt::format("{}: {}", table.where(row), column);
}

double read_exposure(const CsvTable& table, std::size_t row) {
  const double exposure_s = table.number(row, kExposureColumn);
  if (const auto fault = fault_of_exposure(exposure_s))
    throw invalid_input(where_in(table, row, kExposureColumn), *fault);
  return exposure_s;
}

double read_gain(const CsvTable& table, std::size_t row) {
  const double gain = table.number(row, kGainColumn);
  if (gain > 0.0) return gain;
  throw invalid_input(where_in(table, row, kGainColumn), fmt::format("must be > 0 (is {})", gain));
}

FrameFacts read_facts(const CsvTable& table, std::size_t row) {
  const auto has = [&](std::string_view column) {
    return table.has_column(column) && !table.is_empty(row, column);
  };
  FrameFacts facts{.row = row};
  if (has(kExposureColumn)) facts.exposure_s = read_exposure(table, row);
  if (has(kGainColumn)) facts.gain = read_gain(table, row);
  return facts;
}

using FactsByTime = std::map<std::int64_t, FrameFacts>;

FactsByTime read_facts(const CsvTable& table) {
  FactsByTime facts_by_time;
  for (std::size_t row = 0; row < table.num_rows(); ++row) {
    const std::int64_t time_ns = table.integer(row, kTimeColumn);
    if (!facts_by_time.empty() && time_ns <= facts_by_time.rbegin()->first) {
      throw invalid_input(where_in(table, row, kTimeColumn),
                          fmt::format("must be later than the row before's {} (is {})",
                                      facts_by_time.rbegin()->first, time_ns));
    }
    facts_by_time[time_ns] = read_facts(table, row);
  }
  return facts_by_time;
}

/// Both spans of time, for the user whose file and frames do not meet. Requires some of each.
std::string describe_spans(const FactsByTime& facts, const std::vector<ImageEntry>& images) {
  return fmt::format("its timestamp_ns run from {} to {}, the frames from {} to {}", facts.begin()->first,
                     facts.rbegin()->first, images.front().timestamp.ns, images.back().timestamp.ns);
}

}  // namespace

void add_frame_facts(const fs::path& frames_csv, std::vector<ImageEntry>& images, const LogSink& log) {
  const CsvTable table = CsvTable::read_file(frames_csv, {std::string(kTimeColumn)});
  const FactsByTime facts_by_time = read_facts(table);
  if (facts_by_time.empty()) return;
  std::size_t num_unknown = 0;
  for (ImageEntry& image : images) {
    const auto found = facts_by_time.find(image.timestamp.ns);
    if (found == facts_by_time.end()) {
      ++num_unknown;
      continue;
    }
    const FrameFacts& facts = found->second;
    image.exposure_s = facts.exposure_s;
    image.gain = facts.gain;
    if (facts.exposure_s) image.exposure_where = where_in(table, facts.row, kExposureColumn);
  }
  if (num_unknown == images.size()) {
    throw invalid_input(frames_csv.string(),
                        fmt::format("none of its rows has the time of a frame: {}; give it the frames' own "
                                    "times, to the nanosecond, or take it away",
                                    describe_spans(facts_by_time, images)));
  }
  if (num_unknown > 0) {
    log(LogLevel::kWarning,
        fmt::format("{}: {} of {} frames have no row in it, and so no exposure of their own: {}",
                    frames_csv.string(), num_unknown, images.size(), describe_spans(facts_by_time, images)));
  }
}

}  // namespace apriltrack
