#include "apriltrack/report/overlay_video.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <system_error>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"
#include "apriltrack/base/held.h"
#include "apriltrack/image/opencv_bridge.h"
#include "apriltrack/io/scratch_file.h"
#include "apriltrack/io/staged_files.h"
#include "canvas.h"
#include "video_encoder.h"

namespace apriltrack {
namespace fs = std::filesystem;
namespace {

constexpr int kSmallestBar_px = 24;
constexpr double kBarShare = 0.055;  // of the picture's height
const cv::Scalar kBarColour(36, 30, 26);
const cv::Scalar kBarInk(250, 248, 246);
constexpr double kFarthestSides = 3.0;  // of the picture's longer side, beyond its border

int even(int length) {
  return length + length % 2;
}

int bar_height(int picture_height) {
  const int wanted = std::max(kSmallestBar_px, static_cast<int>(std::lround(kBarShare * picture_height)));
  return even(picture_height + wanted) - picture_height;
}

void check_name(const fs::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  if (extension != ".mp4")
    throw invalid_input(
        path.string(),
        fmt::format(
            "a video with overlays is written as MP4: give it a name that ends in .mp4 (it ends in '{}')",
            path.extension().string()));
  std::error_code ignored;
  if (fs::is_directory(path, ignored))
    throw io_error(path.string(), "cannot be written: it is a folder; give another name");
}

bool can_be_drawn(const ColouredOutline& outline, cv::Size picture) {
  const double margin = kFarthestSides * std::max(picture.width, picture.height);
  return std::ranges::all_of(outline.corners_px, [&](const Eigen::Vector2d& corner) {
    return corner.allFinite() && corner.x() >= -margin && corner.x() <= picture.width + margin &&
           corner.y() >= -margin && corner.y() <= picture.height + margin;
  });
}

/// OpenCV too has the centres of pixels at whole numbers.
void draw_outline(cv::Mat& picture, const ColouredOutline& outline) {
  constexpr int kFractionBits = 4;
  constexpr double kUnits = 1 << kFractionBits;
  if (!can_be_drawn(outline, picture.size())) return;
  std::vector<cv::Point> corners;
  for (const Eigen::Vector2d& corner : outline.corners_px)
    corners.emplace_back(cvRound(kUnits * corner.x()), cvRound(kUnits * corner.y()));
  const int width = std::max(2, cvRound(picture.cols / 280.0));
  cv::polylines(picture, corners, true, bgr_of(outline.colour), width, cv::LINE_AA, kFractionBits);
}

void draw_caption(cv::Mat bar, const OverlayFrame& frame) {
  bar.setTo(kBarColour);
  const int height = bar.rows;
  const int block = height / 2;
  const cv::Rect block_area(block / 2, (height - block) / 2, block, block);
  cv::rectangle(bar, block_area, bgr_of(frame.caption_colour), cv::FILLED);
  const double letters = 0.4 * height;
  const double left = block_area.br().x + 0.5 * block;
  const double room = bar.cols - left - 0.5 * block;
  draw_text(bar, shortened(frame.caption, letters, room), {left, 0.5 * (height + letters)}, letters, kBarInk);
}

}  // namespace

class OverlayVideo::Impl {
 public:
  Impl(const fs::path& path, int width, int height, double frames_per_s)
      : path_(path),
        picture_size_(width, height),
        canvas_(height + bar_height(height), even(width), CV_8UC3, kBarColour),
        encoded_(std::in_place, written_file(path)),
        encoder_(
            std::make_unique<VideoEncoder>(encoded_->path(), path.string(),
                                           VideoEncoder::Format{canvas_.cols, canvas_.rows, frames_per_s})) {}

  cv::Size size() const { return canvas_.size(); }

  void add(const OverlayFrame& frame) {
    APRILTRACK_CHECK(encoder_, "a closed video takes no frames");
    APRILTRACK_CHECK(
        frame.image.width() == picture_size_.width && frame.image.height() == picture_size_.height,
        "a video's pictures are all of the size that it was made for");
    const int bar = canvas_.rows - picture_size_.height;
    cv::Mat picture = canvas_(cv::Rect(0, bar, picture_size_.width, picture_size_.height));
    cv::cvtColor(mat_of(frame.image), picture, cv::COLOR_GRAY2BGR);
    for (const ColouredOutline& outline : frame.outlines) draw_outline(picture, outline);
    draw_caption(canvas_.rowRange(0, bar), frame);
    encoder_->add(canvas_);
  }

  void close(StagedFiles& files) {
    APRILTRACK_CHECK(encoder_, "a video is closed once");
    const std::unique_ptr<VideoEncoder> encoder = std::move(encoder_);
    if (encoder->num_frames() == 0)
      throw no_result(path_.string(), "was not written: no frame came that it could show");
    encoder->finish();
    move_index_to_front(encoded_->path(), files.stage(path_), path_.string(), encoder->num_frames());
    encoded_.reset();
  }

 private:
  fs::path path_;
  cv::Size picture_size_;
  cv::Mat canvas_;
  std::optional<ScratchFile> encoded_;  ///< What the index is moved out of.
  std::unique_ptr<VideoEncoder> encoder_;
};

OverlayVideo::OverlayVideo(const fs::path& path, int width, int height, double frames_per_s) {
  APRILTRACK_CHECK(width > 0 && height > 0, "a video has at least one pixel");
  APRILTRACK_CHECK(std::isfinite(frames_per_s) && frames_per_s > 0.0, "a video has frames at some rate");
  check_name(path);
  impl_ = std::make_unique<Impl>(path, width, height, frames_per_s);
}

OverlayVideo::~OverlayVideo() = default;
OverlayVideo::OverlayVideo(OverlayVideo&&) noexcept = default;
OverlayVideo& OverlayVideo::operator=(OverlayVideo&&) noexcept = default;

int OverlayVideo::width() const {
  return held(impl_).size().width;
}

int OverlayVideo::height() const {
  return held(impl_).size().height;
}

void OverlayVideo::add(const OverlayFrame& frame) {
  held(impl_).add(frame);
}

void OverlayVideo::close() {
  StagedFiles files;
  held(impl_).close(files);
  files.commit();
}

void OverlayVideo::close(StagedFiles& files) {
  held(impl_).close(files);
}

}  // namespace apriltrack
