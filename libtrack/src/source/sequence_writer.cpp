#include "apriltrack/source/sequence_writer.h"

#include <fmt/format.h>

#include <string>
#include <system_error>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"
#include "apriltrack/io/atomic_file.h"
#include "apriltrack/io/numbers.h"
#include "apriltrack/source/image_file.h"
#include "image_names.h"

namespace apriltrack {
namespace fs = std::filesystem;
namespace {

/// Takes away what an earlier sequence left, so that old frames never mix with new ones; nothing that is not
/// part of a sequence is touched.
void remove_sequence(const fs::path& folder) {
  for (const fs::path& path : list_images(folder / "frames")) {
    if (is_named_by_digits(path) && time_in_name(path)) fs::remove(path);
  }
  for (const char* name : {"camera.yaml", "map.yaml", "frames.csv", "truth.tum"}) fs::remove(folder / name);
}

void make_sequence_folder(const fs::path& folder, bool overwrite) {
  fs::create_directories(folder);
  if (!fs::is_empty(folder) && !overwrite) {
    throw io_error(folder.string(), "is not empty: name a new folder, or ask for overwriting");
  }
  fs::create_directories(folder / "frames");
  remove_sequence(folder);
}

}  // namespace

std::string sequence_frame_name(Timestamp time) {
  APRILTRACK_CHECK(time.ns >= 0, "a sequence's file names are times of 0 ns or more");
  return fmt::format("{:019}.png", time.ns);
}

SequenceWriter::SequenceWriter(const fs::path& folder, bool overwrite) : folder_(folder) {
  try {
    is_new_ = !fs::exists(folder);
    make_sequence_folder(folder, overwrite);
  } catch (const fs::filesystem_error& error) {
    throw io_error(folder.string(),
                   fmt::format("cannot be made a sequence folder: {}", error.code().message()));
  }
}

void SequenceWriter::discard() const {
  std::error_code ignored;  // what is not empty, or not there, stays as it is
  try {
    remove_sequence(folder_);
  } catch (const fs::filesystem_error&) {
    return;  // the disk fails altogether: there is an error to be told of already
  }
  fs::remove(folder_ / "frames", ignored);
  if (is_new_) fs::remove(folder_, ignored);
}

void SequenceWriter::write_camera(const CameraRig& rig) const {
  write_cameras(folder_ / "camera.yaml", rig);
}

void SequenceWriter::write_map(const TagMap& map) const {
  write_tag_map(folder_ / "map.yaml", map);
}

void SequenceWriter::write_frame(const Frame& frame) const {
  write_image(folder_ / "frames" / sequence_frame_name(frame.timestamp), frame.image);
}

void SequenceWriter::write_frames_csv(const std::vector<Frame>& frames) const {
  std::string text = "timestamp_ns,exposure_s,gain\n";
  for (const Frame& frame : frames) {
    const std::string exposure = frame.exposure_s ? format_exact(*frame.exposure_s) : "";
    text += fmt::format("{},{},{}\n", frame.timestamp.ns, exposure, format_exact(frame.gain));
  }
  write_file_atomically(folder_ / "frames.csv", text);
}

}  // namespace apriltrack
