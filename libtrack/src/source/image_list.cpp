#include "image_list.h"

#include "apriltrack/base/error.h"
#include "apriltrack/source/image_file.h"

namespace apriltrack {
namespace {

/// What is wrong, without the name that the message begins with: the frame has it already.
std::string cause_of(const Error& error, const std::string& name) {
  const std::string message = error.what();
  const std::string where = name + ": ";
  return message.starts_with(where) ? message.substr(where.size()) : message;
}

}  // namespace

std::optional<SourceFrame> ImageListSource::next() {
  if (position_ >= entries_.size()) return std::nullopt;
  const ImageEntry& entry = entries_[position_++];
  SourceFrame frame;
  frame.timestamp = entry.timestamp;
  frame.exposure_s = entry.exposure_s;
  frame.gain = entry.gain;
  frame.name = entry.path.string();
  try {
    frame.pixels = read_image(entry.path);
  } catch (const Error& error) {
    frame.error = cause_of(error, frame.name);
  }
  return frame;
}

bool ImageListSource::pass_over() {
  if (position_ >= entries_.size()) return false;
  ++position_;
  return true;
}

}  // namespace apriltrack
