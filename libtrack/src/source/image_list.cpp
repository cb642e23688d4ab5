#include "image_list.h"

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
  return scaling_.to_gray(read_values(path), path.string(), [&] { return count_sample(); });
}

ValueCounts ImageListSource::count_sample() const {
  ValueCounts counts;
  const std::size_t num_pictures = std::min(PictureScaling::kMostInSample, entries_.size());
  for (std::size_t i = 0; i < num_pictures; ++i) {
    try {
      const std::size_t place = PictureScaling::place_in_sample(i, num_pictures, entries_.size());
      const ImageValues values = read_values(entries_[place].path);
      if (values.is_deep()) counts.add(values.pixels);
    } catch (const Error&) {
      continue;  // it will be told of when its turn comes
    }
  }
  return counts;
}

bool ImageListSource::tells_all_exposures() const {
  return std::ranges::all_of(entries_, [](const ImageEntry& entry) { return entry.exposure_s.has_value(); });
}

}  // namespace apriltrack
