#pragma once

#include <Eigen/Core>
#include <vector>

#include "pose_information.h"

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

  /// By which noise of `noise_variance` is to be multiplied, so that the tags' poses scatter as they do: 1 or
  /// more. 1 where most tags are seen in few of the blocks, each of which they follow.
  double tags_factor(double noise_variance) const;

  /// The same for parameters that were estimated with the poses. columns: of the views; information: what is
  /// left when the poses are eliminated from them.
  double parameters_factor(const std::vector<ParameterView>& columns, const ParameterInformation& information,
                           double noise_variance) const;

 private:
  bool has_blocks() const { return scores_.cols() > 0; }

  const std::vector<LinearView>& views_;
  const PoseInformation& poses_;
  std::vector<Eigen::Index> block_of_view_;
  /// Without what each tag keeps in all of its views, and each frame's pose fitted to what is left.
  std::vector<LinearView::Residual> residuals_;
  Eigen::MatrixXd scores_;    ///< Of the tags, rows as PoseInformation::offset_of() says; a column per block.
  std::size_t num_tags_ = 0;  ///< But the held one.
  std::vector<int> lasting_tags_;  ///< Seen in most of the blocks.
};

}  // namespace apriltrack
