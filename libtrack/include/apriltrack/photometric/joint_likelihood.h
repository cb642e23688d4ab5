#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "apriltrack/base/parallel.h"
#include "apriltrack/camera/camera.h"
#include "apriltrack/motion/motion_state.h"
#include "apriltrack/photometric/patch.h"
#include "apriltrack/photometric/photometric_world.h"
#include "apriltrack/photometric/profile_likelihood.h"
#include "apriltrack/tags/tag_map.h"

namespace apriltrack {

/// How a tag's correlation c becomes a log-likelihood (docs/algorithms/paper_filter.md, section 3).
enum class PatchError {
  kLinear,    ///< -gamma (1/2 - c/2): the paper's (13) and (14).
  kMinusLog,  ///< -gamma (-log c), c not below min_correlation: what the paper's author ran.
  /// profile_log_likelihood less its value at c = 0, c not below 0: Gaussian noise of unknown size, gain and
  /// offset unknown; n independent samples.
  kGaussianProfile,
};

/// What a tag's patch is compared with.
enum class TagTemplate {
  kReference,  ///< A patch that the caller gives, such as the tag's last sharp view.
  kPattern,    ///< The picture that its id stands for, integrated over the exposure along the hypothesis'
               ///< motion.
};

struct JointLikelihoodOptions {
  PatchGrid grid;
  TagTemplate tag_template = TagTemplate::kPattern;
  PatchError error = PatchError::kGaussianProfile;
  double gamma = 10.0;  ///< Of kLinear and kMinusLog.
  /// Of kMinusLog: what is worse counts as this, seen or not; in (0, 1).
  double min_correlation = 1e-4;
  /// Of kGaussianProfile: share of a patch's variance that no template explains; in (0, 1).
  double kappa = kUnexplainedVariance;
  /// Mean over the tags instead of the sum: the author's program. Evidence then does not grow with the tags.
  bool average_over_tags = false;
  /// What lies beside a pixel brighter than this is not seen: a saturated pixel does not tell its light. In
  /// the frame's units; the blur tracker's limit for light in [0, 1] is 0.985.
  double max_light = std::numeric_limits<double>::infinity();
  /// If positive, 64 samples of each patch are looked at first, and only hypotheses whose correlation there
  /// lies within so many standard deviations of the best one's are evaluated further. The others keep the
  /// score of those samples: their log-likelihoods are as they should be but for its noise, a standard
  /// deviation of (1 - c^2) / 8 in c of one tag. 0: every hypothesis in full.
  double coarse_sigmas = 0.0;
  /// Of kGaussianProfile. A quarter of each patch's samples is looked at first, which bounds what all of them
  /// can say: hypotheses that are less likely than another by a factor of exp(this) or more, whatever the
  /// rest of their samples shows, keep the score of that quarter; its log-likelihood is as far below the
  /// other's, too. Infinity: every hypothesis in full. In (0, inf].
  double negligible_log_ratio = 40.0;

  /// Throws Error(kInvalidInput) that names the field, its value and its range.
  void check() const;
};

/// What one hypothesis says of one tag.
struct TagScore {
  double log_likelihood = 0.0;
  double correlation = 0.0;  ///< Over what is seen.
  double seen_share = 0.0;   ///< Of the patch, 0 to 1.
};

struct JointScores {
  std::vector<double> log_likelihoods;  ///< One for each hypothesis.
  /// Hypothesis by hypothesis, each with num_tags entries in the order of the map.
  std::vector<TagScore> tags;
  std::size_t num_tags = 0;

  const TagScore& tag(std::size_t hypothesis, std::size_t index) const {
    return tags[hypothesis * num_tags + index];
  }
};

enum class SampleSet;

/// Log-likelihood of pose and velocity hypotheses, joint over the tags of a map.
///
/// For every hypothesis alike the same tags take part: those that have a template. Of a patch that is partly
/// out of the image, c is that of the samples seen, times their share if positive; of one that is not seen at
/// all, 0. So what is not seen is worth what an unrelated picture is, never more, and leaving the image is
/// not rewarded.
///
/// Computed by kernels in single precision for the instruction set at hand; sample_patch and correlate, and
/// TagPrediction for patterns, define what they compute, to 1e-4 in c, but for patches of next to no
/// contrast (docs/algorithms/paper_filter.md, section 7).
///
/// One frame at a time; give each thread its own.
class JointLikelihood {
 public:
  /// Throws Error(kInvalidInput) for options out of range and, with kPattern, for unknown families or ids.
  JointLikelihood(const Camera& camera, const TagMap& map, TrackMode mode,
                  const JointLikelihoodOptions& options = {});
  ~JointLikelihood();
  JointLikelihood(JointLikelihood&&) noexcept;
  JointLikelihood& operator=(JointLikelihood&&) noexcept;

  std::size_t num_tags() const { return tags_.size(); }
  const JointLikelihoodOptions& options() const { return options_; }

  /// A reference patch for tag `index` of the map: options().grid.num_samples() values, NaN where unknown.
  void set_reference(std::size_t index, std::span<const double> samples);
  /// The tag takes no part until it gets a new one.
  void clear_reference(std::size_t index);
  /// Empty when the tag has none.
  std::span<const double> reference(std::size_t index) const { return references_[index]; }
  bool takes_part(std::size_t index) const;

  /// frame: level 0 of its light and, with kPattern, its exposure. hypotheses: T_world_camera (ego) or
  /// T_camera_body (joint) at mid-exposure; velocities matter with kPattern only. scores: overwritten, its
  /// memory reused. Same numbers with any `parallel`. No memory is asked for when a call before this one had
  /// as many hypotheses and as large an image, but for patterns never seen that blurred.
  void evaluate(const PhotometricFrame& frame, std::span<const MotionState> hypotheses,
                const ParallelFor& parallel, JointScores* scores);

 private:
  struct Tag {
    Eigen::Matrix3d map_from_plane;  ///< (u, v, 1), in half tag sizes, to the map.
    Eigen::Vector3d normal_map;      ///< Of any length; points into the tag.
    double radius_m = 0.0;           ///< Of its patch.
  };
  struct Workspace;
  struct Batch;
  void score(const PhotometricFrame& frame, std::span<const MotionState> hypotheses, SampleSet set,
             const ParallelFor& parallel, JointScores* scores);
  bool has_bounds() const;
  void select_possible(double log_likelihood);
  void select_promising(const JointScores& scores);
  void place(const Batch& batch, std::size_t position);
  void predict(const Batch& batch);
  void make_rows();
  void score_hypothesis(const Batch& batch, std::size_t position, JointScores* scores) const;
  TagScore score_tag(const Batch& batch, std::size_t position, std::size_t index, double* bound) const;
  double max_template_squares(std::size_t index) const;

  CameraModel model_;
  TrackMode mode_;
  JointLikelihoodOptions options_;
  std::vector<Tag> tags_;
  std::vector<std::vector<double>> references_;
  std::optional<PhotometricWorld> world_;  ///< The tags' pictures; kPattern only.
  std::unique_ptr<Workspace> work_;
};

}  // namespace apriltrack
