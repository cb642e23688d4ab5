#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <span>
#include <vector>

#include "apriltrack/photometric/evidence.h"
#include "apriltrack/photometric/photometric_world.h"
#include "tag_photometry.h"
#include "tag_pixels.h"
#include "tag_prediction.h"
#include "view_path.h"

namespace apriltrack {

/// A tag that shows enough of itself on one level, with the pixels that it is judged by.
struct ActiveTag {
  int index = 0;  ///< Into PhotometricWorld::tags.
  TagPixels pixels;
  const TagPrediction* prediction = nullptr;  ///< At the state that it was found for; until the next is.
  PredictedPixels predicted;                  ///< Likewise.
  double scale = 0.0;                         ///< Of the residuals; 0 until it is measured.
};

/// What is looked at of the tags.
struct ActiveTagsOptions {
  int level = 0;
  int max_pixels = 700;  ///< Of each tag.
  /// Of all tags together, who share them where these are fewer: 14 have all that is asked for, as many as a
  /// room shows. What a frame of hundreds costs does not grow with them, until they are down to what still
  /// tells one tag from another.
  int max_pixels_in_all = 10'000;
  double extra_sigma_px = 0.0;  ///< Further blur of the tags' pictures, pixels of level 0.
  /// A pixel costs as much as its path has instants: where these are fewer than four, as many more pixels.
  bool more_where_sharp = false;
  TagChoice tags = TagChoice::kShown;
};

/// The tags that a state shows. Uses its memory again: found once, it allocates nothing for as many.
class ActiveTags {
 public:
  void find(PhotometricWorld& world, const PhotometricFrame& frame, ViewPath& path,
            const ActiveTagsOptions& options);

  std::span<ActiveTag> tags() { return std::span(slots_).first(count_); }
  std::span<const ActiveTag> tags() const { return std::span(slots_).first(count_); }

 private:
  /// A tag whose square passes through the image.
  struct TagInImage {
    int index;
    TagPrediction prediction;
    SweptArea swept;
  };

  void find_in_image(PhotometricWorld& world, const PhotometricFrame& frame, ViewPath& path,
                     const ActiveTagsOptions& options);
  ActiveTag& next_slot() {
    if (count_ == slots_.size()) slots_.emplace_back();
    return slots_[count_];
  }

  std::vector<TagInImage> in_image_;
  std::vector<ActiveTag> slots_;
  std::size_t count_ = 0;
};

/// The tags that the state shows, in the world's memory until others are looked for.
std::span<const ActiveTag> find_active_tags(PhotometricWorld& world, const PhotometricFrame& frame,
                                            const MotionState& state, const EvidenceOptions& options);

/// What its pixels say of the state that it was found for.
TagEvidence evidence_of(const ActiveTag& tag, const TagMisfit& misfit);

/// The residuals' scale that a first, plain fit of the colours shows, with a floor for what no model
/// explains.
double scale_of(const TagMisfit& misfit);

}  // namespace apriltrack
