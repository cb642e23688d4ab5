#include "image_list.h"

#include "apriltrack/base/error.h"
#include "apriltrack/source/image_file.h"

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
    frame.pixels = read_image(entry.path);
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

}  // namespace apriltrack
