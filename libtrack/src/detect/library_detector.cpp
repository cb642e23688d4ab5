#include "library_detector.h"

#include <apriltag/apriltag.h>

#include <algorithm>
#include <cmath>

#include "../tags/native_family.h"
#include "apriltrack/base/check.h"
#include "apriltrack/tags/tag_family.h"

namespace apriltrack {
namespace {

/// The library's threshold works on tiles of 4 x 4 pixels and reads each tile's neighbours: smaller images
/// hold no tag, and make it read outside.
constexpr int kMinImageSide_px = 12;

struct DetectionsDeleter {
  void operator()(zarray_t* detections) const { apriltag_detections_destroy(detections); }
};

}  // namespace

struct LibraryDetector::State {
  struct DetectorDeleter {
    void operator()(apriltag_detector_t* detector) const { apriltag_detector_destroy(detector); }
  };

  using NativeDetector = std::unique_ptr<apriltag_detector_t, DetectorDeleter>;

  static NativeDetector make_detector(bool refine_edges) {
    NativeDetector detector(apriltag_detector_create());
    // With two threads the library's answer differs from run to run when an id occurs more than once.
    detector->nthreads = 1;
    detector->quad_decimate = 1.0F;  // as every call says anew
    detector->refine_edges = refine_edges;
    return detector;
  }

  apriltag_detector_t* detector(std::optional<std::size_t> family_index) const {
    return (family_index ? of_one[*family_index] : of_all).get();
  }

  // Detectors refer to the families until they are destroyed: they come last, so that they go first.
  std::vector<NativeFamily> families;
  NativeDetector of_all;
  std::vector<NativeDetector> of_one;  ///< By family; they use the same decoding tables.
};

LibraryDetector::LibraryDetector(const std::vector<Family>& families, bool refine_edges)
    : state_(std::make_unique<State>()) {
  state_->of_all = State::make_detector(refine_edges);
  for (const auto& [name, corrected_bits] : families) {
    state_->families.push_back(make_native_family(name));
    state_->of_one.push_back(State::make_detector(refine_edges));
    const int bits = std::min(corrected_bits, TagFamily::get(name).max_corrected_bits());
    for (apriltag_detector_t* detector : {state_->of_all.get(), state_->of_one.back().get()})
      apriltag_detector_add_family_bits(detector, state_->families.back().get(), bits);
  }
}

LibraryDetector::~LibraryDetector() = default;
LibraryDetector::LibraryDetector(LibraryDetector&&) noexcept = default;
LibraryDetector& LibraryDetector::operator=(LibraryDetector&&) noexcept = default;

std::vector<LibraryDetection> LibraryDetector::detect(const GrayView& image, double decimate,
                                                      int least_contrast,
                                                      std::optional<std::size_t> family_index) {
  state_->detector(family_index)->quad_decimate = static_cast<float>(decimate);
  state_->detector(family_index)->qtp.min_white_black_diff = least_contrast;
  const Eigen::Vector2d offset = Eigen::Vector2d::Constant(library_pixel_offset());
  std::vector<LibraryDetection> detections = detect_in_library_pixels(image, family_index);
  for (LibraryDetection& detection : detections)
    for (Eigen::Vector2d& corner : detection.corners_px) corner -= offset;
  return detections;
}

std::vector<LibraryDetection> LibraryDetector::detect_in_library_pixels(
    const GrayView& image, std::optional<std::size_t> family_index) {
  if (image.width() < kMinImageSide_px || image.height() < kMinImageSide_px) return {};
  // The library takes a mutable buffer but only reads it.
  image_u8_t native_image = {image.width(), image.height(), static_cast<int32_t>(image.stride()),
                             const_cast<std::uint8_t*>(image.data())};
  const std::unique_ptr<zarray_t, DetectionsDeleter> found(
      apriltag_detector_detect(state_->detector(family_index), &native_image));
  std::vector<LibraryDetection> detections;
  for (int i = 0; i < zarray_size(found.get()); ++i) {
    apriltag_detection_t* native = nullptr;
    zarray_get(found.get(), i, &native);
    const auto family = std::find_if(state_->families.begin(), state_->families.end(),
                                     [&](const NativeFamily& f) { return f.get() == native->family; });
    LibraryDetection detection;
    detection.family_index = static_cast<std::size_t>(family - state_->families.begin());
    detection.id = native->id;
    detection.hamming = native->hamming;
    detection.decision_margin = native->decision_margin;
    for (std::size_t k = 0; k < kNumCorners; ++k)
      detection.corners_px[k] = Eigen::Vector2d(native->p[k][0], native->p[k][1]);
    detections.push_back(detection);
  }
  return detections;
}

namespace {

/// A blurred picture of one tag, in linear light, for the measurement below only. Every pixel is the mean of
/// `kSamples` x `kSamples` points of the pattern.
GrayImage render_upright_tag(const TagPattern& pattern, const Eigen::Vector2d& centre_px, double half_size_px,
                             double angle_rad, int side_px) {
  constexpr int kSamples = 6;
  const double c = std::cos(angle_rad) / half_size_px;
  const double s = std::sin(angle_rad) / half_size_px;
  GrayImage image(side_px, side_px);
  for (int y = 0; y < side_px; ++y) {
    for (int x = 0; x < side_px; ++x) {
      double sum = 0.0;
      for (int j = 0; j < kSamples; ++j) {
        for (int i = 0; i < kSamples; ++i) {
          const double dx = x - 0.5 + (i + 0.5) / kSamples - centre_px.x();
          const double dy = y - 0.5 + (j + 0.5) / kSamples - centre_px.y();
          sum += pattern.brightness(c * dx + s * dy, -s * dx + c * dy);
        }
      }
      image(x, y) = static_cast<std::uint8_t>(std::lround(20.0 + 200.0 * sum / (kSamples * kSamples)));
    }
  }
  return image;
}

}  // namespace

double measure_library_pixel_offset() {
  // Turned, so that no edge runs along the pixels, and at centres that balance what rounding is left.
  constexpr int kPictureSide_px = 80;
  constexpr double kHalfSize_px = 24.3;
  const TagPattern pattern = TagFamily::get("tag36h11").pattern(0);
  LibraryDetector detector({{"tag36h11", 0}}, true);
  double sum = 0.0;
  int count = 0;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector2d centre_px(39.5 + 0.25 * i, 39.5 + 0.25 * ((i * 3) % 4));
    const GrayImage image =
        render_upright_tag(pattern, centre_px, kHalfSize_px, 0.2 + 0.15 * i, kPictureSide_px);
    for (const LibraryDetection& detection : detector.detect_in_library_pixels(image.view())) {
      for (const Eigen::Vector2d& corner : detection.corners_px) sum += (corner - centre_px).mean();
      count += kNumCorners;
    }
  }
  APRILTRACK_CHECK(count > 0, "the installed AprilTag library does not find a plain rendered tag");
  const double offset = sum / count;
  const double rounded = std::round(2.0 * offset) / 2.0;
  APRILTRACK_CHECK(
      std::abs(offset - rounded) < 0.1,
      "the installed AprilTag library's pixel origin is neither a pixel's centre nor its corner");
  return rounded;
}

double library_pixel_offset() {
  static const double offset =
      measure_library_pixel_offset();  // initialised once, whatever the number of threads
  return offset;
}

}  // namespace apriltrack
