#pragma once

#include <Eigen/Core>
#include <vector>

#include "uncertainty/pose_information.h"

namespace apriltrack {

/// What blocks of neighbouring frames say, each for itself: how far each would pull the solution. Errors that
/// whole blocks of frames share (a lens that no formula describes, a focus that drifts, blur) pull further
/// than noise that is each view's own: the scores of blocks are their independent units (Liang and Zeger's
/// estimate; docs/algorithms/calibration.md, equation 9a).
class BlockScatter {
 public:
  /// views: linearised where the adjustment ended, in the order of time; `poses` is made from them. Keeps
  /// references to both.
  BlockScatter(const std::vector<LinearView>& views, const PoseInformation& poses);

  /// By which noise of `noise_variance` is to be multiplied, so that the tags' poses scatter as they do,
  /// about the tag that most views show, whichever is held: 1 or more. Nearer to 1 the more tags are seen in
  /// few of the blocks, each of which they follow.
  double tags_factor(double noise_variance) const;

  /// The same for parameters that were estimated with the poses. columns: of the views; information: what is
  /// left when the poses are eliminated from them.
  double parameters_factor(const std::vector<ParameterView>& columns, const ParameterInformation& information,
                           double noise_variance) const;

 private:
  struct SeenTags {
    std::vector<int> all, lasting;  ///< The latter in most of the blocks, and not the one most seen.
    int most_seen = 0;
  };

  bool has_blocks() const { return !block_of_view_.empty(); }
  /// Of the tags, rows as poses.offset_of() says; a column per block.
  Eigen::MatrixXd scores(const PoseInformation& poses) const;
  SeenTags seen_tags() const;
  double tags_factor_about(const PoseInformation& poses, const SeenTags& seen, double noise_variance) const;

  const std::vector<LinearView>& views_;
  const PoseInformation& poses_;
  std::vector<Eigen::Index> block_of_view_;  ///< Empty where there are too few frames.
  /// Without what each tag keeps in all of its views, and each frame's pose fitted to what is left.
  std::vector<LinearView::Residual> residuals_;
};

}  // namespace apriltrack
