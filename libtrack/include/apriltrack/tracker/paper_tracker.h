#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "apriltrack/photometric/joint_likelihood.h"
#include "apriltrack/tracker/localizer.h"
#include "apriltrack/tracker/paper_filter.h"
#include "apriltrack/tracker/track_result.h"

namespace apriltrack {

/// Which of the paper's two descriptions is followed: its text, or its author's program.
enum class PaperVariant { kPrinted, kProgram };

/// "printed" or "program".
std::string_view to_string(PaperVariant variant);

struct PaperTrackerOptions {
  /// The values published with the variant (docs/algorithms/paper_filter.md, section 6).
  static PaperTrackerOptions published(PaperVariant variant);

  /// mode, and what detects and starts.
  LocalizerOptions localizer;
  PaperFilter::Options filter;
  /// tag_template is kReference always.
  JointLikelihoodOptions likelihood;
  /// A tag that correlates less than this with the answer waits for its next detection; -1: never.
  double discard_correlation = -1.0;
  /// The answer is evidence only if its tags correlate at least so much with their references: less, an image
  /// without a tag reaches too.
  double min_correlation = 0.6;
  int num_threads = 1;  ///< 0: one per core. Changes no result.

  /// Throws Error(kInvalidInput) that names the field, its value and its range.
  void check() const;
};

/// The seed paper's tracker (`--method paper`): a particle filter that compares, in every particle, the patch
/// of each tag with that of the tag's last detection. Kept as the baseline, with its accuracy.
///
/// Detections start it, renew the reference patches, and start it again when the best particle does not
/// look like its tags any more; else they do not enter the pose. Works on grey levels as they are, like the
/// paper.
///
/// Statuses: `detected` when a tag detected in this frame agrees with the pose, `tracked` when only earlier
/// references do, `predicted` when none does, up to 0.5 s, then `lost`.
///
/// One image at a time; give each thread its own. No frame throws once prepare() has been called.
class PaperTracker {
 public:
  /// Throws Error(kInvalidInput) when the map is empty or names an unknown family, or an option is out of
  /// range.
  PaperTracker(const Camera& camera, const TagMap& map, const PaperTrackerOptions& options);
  ~PaperTracker();
  PaperTracker(PaperTracker&&) noexcept;
  PaperTracker& operator=(PaperTracker&&) noexcept;

  /// Builds the detector's tables now (Localizer::prepare). Those who bring detections need none.
  void prepare();

  /// Frames come in the order of time; one from before the last starts anew, with what it shows. An image of
  /// another resolution than the camera's is lost; its reason says so.
  TrackResult track(const Frame& frame);
  /// The same with detections made elsewhere, by a detector of detector_options().
  TrackResult track(const Frame& frame, const std::vector<Detection>& detections);

  const DetectorOptions& detector_options() const;

  /// The cloud after the last frame, for those who want to look at it.
  const PaperFilter& filter() const;
  /// Of tag `index` of the map, rho x rho grey levels, NaN out of the image; empty before its first
  /// detection.
  std::span<const double> reference_patch(std::size_t index) const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace apriltrack
