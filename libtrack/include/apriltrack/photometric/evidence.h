#pragma once

#include <vector>

#include "apriltrack/motion/motion_state.h"
#include "apriltrack/photometric/photometric_world.h"

namespace apriltrack {

/// How well one tag's picture explains the pixels that it should cover.
struct TagEvidence {
  int tag_index = 0;  ///< Into PhotometricWorld::tags.
  int num_pixels = 0;
  double area_px = 0.0;  ///< Of the image that these pixels stand for.
  double correlation =
      0.0;  ///< sqrt of the share of the pixels' variance that the tag explains; 0 for a negative tag.
  double contrast = 0.0;  ///< Light between black and white.
  double path_px = 0.0;   ///< Of the tag's fastest corner during the exposure.
  /// Of the pixels' variance, what changes from pixel to pixel at random where the tag is explained.
  double noise_share = 0.0;

  /// How many independent pixels they are worth: neighbours err together, and a tag is never all there is.
  double independent_samples() const;

  /// As the function of this name below: of this tag.
  double log_likelihood() const;

  /// Right states reach 0.943 and more where a tag is read, 0.957 where none is, in photoreal recordings;
  /// half a tag behind a hand costs some of that.
  static constexpr double kExplained = 0.85;
  bool is_explained() const { return clean_correlation() >= kExplained; }

  /// The correlation in an image without noise, nearly: of what the tag does not explain, only what
  /// neighbouring pixels share counts. In the dark a right state correlates no better than a wrong one in
  /// the light, but what it leaves over is noise alone. 0 where there is nothing but noise, or no
  /// correlation.
  double clean_correlation() const;
};

/// Those that are explained; all of them where none is.
std::vector<TagEvidence> explained_tags(const std::vector<TagEvidence>& tags);

/// Which of the tags in sight.
enum class TagChoice {
  kShown,   ///< Not those known to be hidden.
  kHidden,  ///< Those alone.
  kAll
};

/// Where and how finely evidence is looked for.
struct EvidenceOptions {
  int level = 0;
  /// About; where many tags show, each has its share of 10,000, 64 at least.
  int max_pixels_per_tag = 700;
  double extra_sigma_px = 0.0;  ///< Further blur of the tags' pictures, pixels of level 0.
  bool is_robust = true;        ///< Errors beyond the usual count less (hands, glare).
  TagChoice tags = TagChoice::kShown;
};

/// The evidence for a state as it stands: of every tag that shows enough of itself.
std::vector<TagEvidence> weigh_evidence(PhotometricWorld& world, const PhotometricFrame& frame,
                                        const MotionState& state, const EvidenceOptions& options = {});

/// How much better their own pictures explain the tags' pixels than what all tags of their families have in
/// common, in nats, together: of another tag's pixels, not at all. tags: the evidence for the state as it
/// stands, of tags that are not hidden.
double identity_log_odds(PhotometricWorld& world, const PhotometricFrame& frame, const MotionState& state,
                         const std::vector<TagEvidence>& tags);

/// Log-likelihood of the evidence against "no tag here": sum over tags of profile_log_likelihood, kappa 0.03
/// (docs/algorithms/blur_tracker.md, equation 9). A tag that should be seen and explains nothing (c = 0)
/// costs (n / 2) log(1 + kappa), up to 5 nats: that it is not seen speaks against the state.
double log_likelihood(const std::vector<TagEvidence>& tags);
/// The clean correlation that half of the independent samples or more reach: one hidden tag among others does
/// not change it. 0 without tags.
double typical_correlation(const std::vector<TagEvidence>& tags);
/// That two thirds of them reach.
double widespread_correlation(const std::vector<TagEvidence>& tags);

}  // namespace apriltrack
