#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apriltrack/camera/camera.h"
#include "apriltrack/image/frame.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

/// "0000000000050000000.png": nanoseconds as 19 digits, so that names sorted as text are sorted by time.
/// Requires a time of 0 or more.
std::string sequence_frame_name(Timestamp time);

/// Writes a sequence folder: frames/TIMESTAMP_NS.png, camera.yaml, map.yaml, frames.csv
/// (docs/file_formats.md). write_frame may be called from several threads at once.
class SequenceWriter {
 public:
  /// Throws Error(kIo) when the folder cannot be made, or is not empty and `overwrite` is false.
  SequenceWriter(const std::filesystem::path& folder, bool overwrite);

  void write_camera(const CameraRig& rig) const;
  void write_map(const TagMap& map) const;
  void write_frame(const Frame& frame) const;
  /// One row per frame; only needed when exposure or gain differ from frame to frame.
  void write_frames_csv(const std::vector<Frame>& frames) const;

  /// Takes away what was written, and the folders that were made for it: a sequence that could not be
  /// completed is none. What does not belong to a sequence stays.
  void discard() const;

  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
  bool is_new_ = false;  ///< The folder was made for it.
};

}  // namespace apriltrack
