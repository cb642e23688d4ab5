#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apriltrack/image/image.h"
#include "apriltrack/report/colour.h"

namespace apriltrack {

class StagedFiles;

/// A tag's outline in the pixels of the frame: (0, 0) is the centre of the top-left pixel.
struct ColouredOutline {
  std::array<Eigen::Vector2d, 4> corners_px;
  Colour colour;
};

struct OverlayFrame {
  GrayView image;
  /// One with a corner that is not finite, or farther outside than three times the picture's longer side
  /// (seen at a grazing angle, or behind the camera), is not drawn.
  std::vector<ColouredOutline> outlines;
  std::string caption;    ///< ASCII; shortened to fit.
  Colour caption_colour;  ///< Of a block before the caption; the letters are white on a dark bar.
};

/// Writes frames with what was found in them as a video that browsers play: H.264 (yuv420p) in MP4, its index
/// first. The caption stands in a bar above the picture (players lay their controls over its foot); the
/// picture fills the rows from height() - its own height on.
///
/// All is written beside the file and put in its place when it is closed: a run that fails leaves no file, or
/// the old one as it was.
/// One call at a time; give each thread its own.
class OverlayVideo {
 public:
  /// width, height: of the pictures. Requires both > 0 and a finite frame rate > 0. Throws
  /// Error(kInvalidInput) for a name that does not end in .mp4 and Error(kIo) when the file cannot be written
  /// or FFmpeg has no H.264 encoder.
  OverlayVideo(const std::filesystem::path& path, int width, int height, double frames_per_s);
  ~OverlayVideo();
  OverlayVideo(OverlayVideo&&) noexcept;
  OverlayVideo& operator=(OverlayVideo&&) noexcept;

  /// Of the video: the pictures' width, and their height with the bar, both made even.
  int width() const;
  int height() const;

  /// Requires an image of width x height pixels, and that the video is not closed. Throws Error(kIo).
  void add(const OverlayFrame& frame);

  /// Completes the file. Throws Error(kIo), and Error(kNoResult) when it holds no frame.
  void close();
  /// The same, but `files` puts it in place, together with what else is in them.
  void close(StagedFiles& files);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace apriltrack
