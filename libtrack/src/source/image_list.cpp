#include "image_list.h"

#include <fmt/format.h>

#include <algorithm>

#include "apriltrack/base/error.h"

namespace apriltrack {

std::optional<SourceFrame> ImageListSource::next() {
  if (position_ >= entries_.size()) return std::nullopt;
  const ImageEntry& entry = entries_[position_++];
  SourceFrame frame;
  frame.timestamp = entry.timestamp;
  frame.exposure_s = entry.exposure_s;
  frame.gain = entry.gain;
  frame.exposure_where = entry.exposure_where;
  frame.name = entry.path.string();
  try {
    frame.pixels = read(entry.path);
  } catch (const Error& error) {
    frame.error = error.where() == frame.name ? error.cause() : error.what();  // the name is told already
  }
  return frame;
}

bool ImageListSource::pass_over() {
  if (position_ >= entries_.size()) return false;
  ++position_;
  return true;
}

GrayImage ImageListSource::read(const std::filesystem::path& path) {
  const ImageValues values = read_values(path);
  if (!values.is_deep()) return gray_of(values, {});
  if (!range_) {
    range_ = bits_ ? range_of_bits(*bits_) : find_range();
    if (!bits_) tell_of_range(*range_);
  }
  check_range(values, path);
  return gray_of(values, *range_);
}

ValueRange ImageListSource::find_range() const {
  constexpr std::size_t kMostPictures = 9;
  ValueCounts counts;
  const std::size_t num_pictures = std::min(kMostPictures, entries_.size());
  for (std::size_t i = 0; i < num_pictures; ++i) {
    const std::size_t last = entries_.size() - 1;
    const std::size_t index = num_pictures == 1 ? 0 : i * last / (num_pictures - 1);
    try {
      const ImageValues values = read_values(entries_[index].path);
      if (values.is_deep()) counts.add(values.pixels);
    } catch (const Error&) {
      continue;  // it will be told of when its turn comes
    }
  }
  return counts.is_empty() ? ValueRange{} : counts.range();
}

void ImageListSource::tell_of_range(const ValueRange& range) const {
  if (range == ValueRange{}) return;
  log_(LogLevel::kInfo,
       fmt::format("{}: the 16-bit pictures use {} and are scaled by that (--bits N overrides)", name_,
                   told(range)));
}

void ImageListSource::check_range(const ImageValues& values, const std::filesystem::path& path) {
  if (has_warned_ || *range_ == ValueRange{}) return;
  ValueCounts counts;
  counts.add(values.pixels);
  if (counts.lowest() >= range_->black && counts.highest() <= range_->white) return;
  has_warned_ = true;
  log_(LogLevel::kWarning,
       fmt::format("{} has values from {} to {}, but the pictures are scaled by {}: what lies beyond is "
                   "lost; give --bits N for the bits that count",
                   path.string(), counts.lowest(), counts.highest(), told(*range_)));
}

}  // namespace apriltrack
