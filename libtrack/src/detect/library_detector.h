#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apriltrack/image/image.h"
#include "apriltrack/tags/tag_corners.h"

namespace apriltrack {

/// The pixels' origin that the installed AprilTag library uses, in ours: subtract it from the library's
/// coordinates.
///
/// Version 3.3 puts (0, 0) at the outer corner of the first pixel (offset 0.5), newer ones differ; so it is
/// measured, once, on a small rendered tag, and rounded to half a pixel.
double library_pixel_offset();

/// What the AprilTag library says of one tag, in our pixels (centre of the top-left pixel = (0, 0)).
struct LibraryDetection {
  std::size_t family_index = 0;  ///< Into the names that the detector was made with.
  int id = 0;
  int hamming = 0;
  double decision_margin = 0.0;  ///< Grey levels of the image that it was found in.
  std::array<Eigen::Vector2d, kNumCorners> corners_px;
};

/// Owns a detector of the AprilTag library with its families, one thread, for any number of images.
class LibraryDetector {
 public:
  static constexpr int kLibrarysLeastContrast = 5;

  /// A family, and how many wrong bits of its codes are corrected: decoding tables take up to 400 MB for one
  /// bit of the largest families, a few MB for none.
  struct Family {
    std::string name;
    int corrected_bits = 0;
  };

  /// Throws Error(kInvalidInput) for a name that is no family. No more bits are corrected than
  /// TagFamily::max_corrected_bits() says.
  LibraryDetector(const std::vector<Family>& families, bool refine_edges);
  ~LibraryDetector();
  LibraryDetector(LibraryDetector&&) noexcept;
  LibraryDetector& operator=(LibraryDetector&&) noexcept;

  /// In the library's order. decimate: quads are searched for in an image this many times smaller.
  /// least_contrast: where neighbouring pixels differ by fewer grey levels no edge is looked for.
  /// family_index: of the only one looked for; a search for more takes longer.
  std::vector<LibraryDetection> detect(const GrayView& image, double decimate, int least_contrast,
                                       std::optional<std::size_t> family_index = {});

 private:
  friend double measure_library_pixel_offset();
  /// Corners as the library reports them.
  std::vector<LibraryDetection> detect_in_library_pixels(const GrayView& image,
                                                         std::optional<std::size_t> family_index = {});

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace apriltrack
