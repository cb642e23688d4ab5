#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "apriltrack/base/log.h"
#include "apriltrack/image/frame.h"

namespace apriltrack {

/// A frame that owns its pixels, or word of one that could not be decoded.
struct SourceFrame {
  GrayImage pixels;  ///< Empty when the frame is unreadable.
  Timestamp timestamp;
  std::optional<double> exposure_s;
  double gain = 1.0;
  std::string name;            ///< File, or video, or topic, and number: what a message calls this frame.
  std::string exposure_where;  ///< File, line and column that tell the exposure; empty where none does.
  std::string error;           ///< Why it could not be decoded, without its name; empty for a good frame.

  bool is_readable() const { return error.empty(); }
  /// A view for the library's functions; this object must outlive it.
  Frame frame(int camera_index = 0) const;
};

/// Which moment of a frame's exposure its recorded time is: the start of its first row's, the middle of its
/// middle row's, the end of its last row's.
enum class StampIs { kStart, kMiddle, kEnd };

struct SourceOptions {
  /// For images whose names are no times; in [1e-3, 1e6]. Names of digits must agree with it, or be frame
  /// numbers.
  std::optional<double> rate_hz = std::nullopt;
  std::size_t skip = 0;  ///< Frames left out at the start.
  std::size_t step = 1;  ///< Every step-th frame.
  std::optional<std::size_t> max_frames = std::nullopt;
  /// Of 16-bit image files, how many bits count, in [8, 16]: white is 2^bits - 1. Unset: as the pictures use
  /// them, decided once for the whole source (docs/file_formats.md) and told to the log.
  std::optional<int> bits = std::nullopt;
  /// Which camera's folder of a EuRoC/ASL recording with several; empty: cam0. All other inputs, a single
  /// camera folder among them, have one camera whatever its name.
  std::string camera_name = {};
  /// Which topic of a bag; empty: the only one with pictures. Of other inputs it is an error.
  std::string topic = {};
  /// Frames' times are moved to the middle of the exposure of the middle row: by half the frame's own
  /// exposure where it is told, else by half of exposure_s, which is required then; and by what a rolling
  /// shutter needs from the row that is exposed first to the middle, or from there to the last.
  StampIs stamp_is = StampIs::kMiddle;
  std::optional<double> exposure_s = std::nullopt;  ///< Of the camera's file. For stamp_is alone.
  double readout_s = 0.0;  ///< From the row that a rolling shutter exposes first to the last: >= 0.
  /// Hears of a recording that is not as its own files say: frames that its frames.csv does not know, a video
  /// that ends before its header's count, a bag that is damaged.
  LogSink log = silent_log();
};

/// Which numbers of a 16-bit picture stand for black and for white.
struct ValueRange {
  int black = 0;
  int white = 65535;
  bool operator==(const ValueRange&) const = default;
  /// N where it is 0 to 2^N - 1; nullopt of temperatures and the like.
  std::optional<int> bits() const;
};

/// Frames in the order of time. A frame that cannot be decoded is handed out as unreadable, never passed
/// over. One call at a time; give each thread its own.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  /// nullopt at the end.
  virtual std::optional<SourceFrame> next() = 0;
  /// How many frames there are, where that is known beforehand (not for live cameras; an estimate for
  /// videos).
  virtual std::optional<std::size_t> num_frames() const = 0;
  /// By which 16-bit image files are scaled, as found or as SourceOptions::bits says; nullopt until one has
  /// been read, and for all else.
  virtual std::optional<ValueRange> value_range() const { return std::nullopt; }
  /// What this source is, for messages.
  virtual std::string name() const = 0;
};

/// A sequence folder, a folder of images, a glob, a EuRoC/ASL `mav0` folder (or one camera folder of it), a
/// video file, a bag (ROS 1 bag, MCAP, rosbag2: apriltrack/bag/bag_reader.h), `camera:N` or a V4L2 path; `-`,
/// standard input, or a FIFO: a video in a container that need not be gone back in, or JPEG or PNG pictures
/// one after the other. A pipe can be opened once. Times of a bag's frames are those of their headers. A live
/// camera's times are the driver's own (of arrival where it tells none), not corrected to the middle of the
/// exposure. Throws Error(kIo) when there is nothing to read, Error(kInvalidInput) when images need a rate
/// and none is given, a recording has no camera of the name asked for, its frames.csv knows none of its
/// frames, a bag has no topic with pictures or several and none is named, or an option is out of its range.
std::unique_ptr<FrameSource> open_source(const std::string& input, const SourceOptions& options = {});

/// Files that a sequence folder brings with it; nullopt where it does not, or INPUT is no such folder.
std::optional<std::filesystem::path> sequence_camera_file(const std::string& input);
std::optional<std::filesystem::path> sequence_map_file(const std::string& input);
/// The sensor.yaml of the camera of a EuRoC/ASL recording whose pictures open_source() reads. camera_name: as
/// in SourceOptions, with its errors; nullopt where INPUT is none, or has no such file.
std::optional<std::filesystem::path> euroc_camera_file(const std::string& input,
                                                       const std::string& camera_name = "");

}  // namespace apriltrack
