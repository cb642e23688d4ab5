#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apriltrack/camera/camera_model.h"
#include "apriltrack/detect/detection.h"
#include "apriltrack/image/image.h"
#include "apriltrack/image/response.h"

namespace apriltrack {

struct DetectorOptions {
  std::vector<std::string> families = {"tag36h11"};
  /// Undone before corners are localised. Tags are searched for in linear light and in grey levels as sRGB or
  /// the camera has them, so that neither's tags are lost: two searches, whatever the response.
  ResponseCurve response = ResponseCurve::srgb();
  /// As likely as `response`, where nothing tells which of the two it is (rival_response()). Corners are
  /// those of `response`, and their covariances count how far they would lie elsewhere under this one: one
  /// more fit for each tag.
  std::optional<ResponseCurve> rival_response = std::nullopt;
  /// Of the camera that takes the images: its lens bends a tag's edges, by half a pixel and more where it is
  /// wide. None: a bend that ordinary lenses have is estimated with the corners.
  std::optional<CameraModel> camera_model = std::nullopt;
  /// Corners from the tag's whole pattern, with a covariance, or else from curves fitted to its edges,
  /// without one. A tag that neither fits (hidden, cut by the image) is not reported, for its corners would
  /// be pixels off. Off: the quad's corners as the library found them, with biases of up to a pixel; only to
  /// reproduce old results.
  bool refine_edges = true;
  /// Quads are searched for in an image this many times smaller; 1 finds the smallest tags, 2 is three times
  /// faster.
  double decimate = 1.0;
  /// Grey levels, for a code read without a wrong bit; every corrected bit asks for as much again. Detections
  /// below are dropped. 5 keeps tags in a twentieth of the usual light and drops what is read into noise.
  double min_decision_margin = 5.0;
  /// Corrected bits, 0 to 2; detections above are dropped. By default each family has its own limit, by how
  /// often chance reads its codes (chance_readings.h): 2, but 1 for tagCircle21h7 and for families of over
  /// 5,000 codes, and 0 for tag16h5. Up to that limit readings that chance makes too often must also look
  /// like the tag that they are read as; a higher one given here takes all as they are.
  std::optional<int> max_hamming = std::nullopt;
  /// One search, in the image as it is, in half the time: it loses tags in the dark or beside bright light.
  /// With refine_edges off that is what the AprilTag library finds. Not for detect_in(), which always
  /// searches once, in linear light.
  bool search_raw_image_only = false;

  /// Throws Error(kInvalidInput) that names the option, its value and its range.
  void check() const;
};

/// Where a tag is looked for.
struct TagRegion {
  ImageRegion area;
  std::string family;  ///< The only one looked for there; empty: all of the detector's.
};

/// Why a tag that was read is not reported.
enum class LeftOutReason {
  /// Neither its pattern nor its edges could be fitted: too small or blurred, hidden, or cut by the image.
  /// Its
  /// corners would be pixels off.
  kEdgesNotFitted,
  kMayBeChance,  ///< Of a family with few bits, and the picture does not look like the tag.
};

/// A tag that was read and is not reported.
struct LeftOutTag {
  Detection reading;  ///< Corners as the AprilTag library found them: right to a few pixels.
  LeftOutReason reason = LeftOutReason::kEdgesNotFitted;
};

/// All that was read in an image, in the order of Detector::detect().
struct FoundTags {
  std::vector<Detection> detections;
  std::vector<LeftOutTag> left_out;
};

/// Finds tags. One image at a time, rows downwards in memory; give each thread its own.
class Detector {
 public:
  /// Building the decoding tables takes up to seconds for families with many codes.
  explicit Detector(const DetectorOptions& options);
  ~Detector();
  Detector(Detector&&) noexcept;
  Detector& operator=(Detector&&) noexcept;

  /// Sorted by family, id, then centre (x, y); the same image gives the same answer, always. An id that is
  /// seen twice is reported twice.
  std::vector<Detection> detect(const GrayView& image);
  /// The same, and what was read and left out.
  FoundTags find(const GrayView& image);

  /// The same, of what lies whole within one of the regions, which must lie inside the image: for tags about
  /// whose place one knows. A region's family must be one of the options'. Searched in linear
  /// light alone, in an image `decimate` times smaller (as DetectorOptions'), corners as exact as ever: a
  /// fraction of the cost, but dark and blurred tags are missed that detect() finds.
  std::vector<Detection> detect_in(const GrayView& image, std::span<const TagRegion> regions,
                                   double decimate = 1.0);

  const DetectorOptions& options() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace apriltrack
