#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "apriltrack/image/image.h"

namespace apriltrack::test {

/// A video whose every time is known because the test chose it.
struct VideoPlan {
  std::vector<GrayImage> pictures = {};  ///< In the order of showing.
  std::vector<std::int64_t> times_ticks =
      {};                      ///< Of each picture, in ticks of 1/90000 s (Matroska rounds to milliseconds).
  int turn_clockwise_deg = 0;  ///< How players are told to turn the pictures.
  int damaged_picture = -1;    ///< This one's data is replaced by rubbish.
};
inline constexpr std::int64_t kTicksPerSecond = 90000;

/// One JPEG per frame, full range, container by the file's ending.
void write_mjpeg_video(const std::filesystem::path& path, const VideoPlan& plan);
/// MPEG-4 with two B-frames between its neighbours, stored in another order than shown; range 16 to 235.
void write_b_frame_video(const std::filesystem::path& path, const VideoPlan& plan);

/// H.264 in the order of showing, as live encoders send it at 30 Hz; only where FFmpeg can encode it.
void write_live_h264_video(const std::filesystem::path& path, const VideoPlan& plan);
bool can_write_h264();

}  // namespace apriltrack::test
