// What errors that blocks of frames share do to a parameter of all views, against many draws of them.
#include "block_scatter.h"

#include <gtest/gtest.h>

#include "apriltrack/base/random.h"

namespace apriltrack {
namespace {

constexpr int kTags = 5, kFrames = 160, kTagsOfFrame = 3, kFramesOfBlock = 20;
constexpr int kTrials = 150;

template <typename Matrix>
Matrix normal_matrix(Eigen::Index rows, Eigen::Index columns, RandomStream& random) {
  Matrix result(rows, columns);
  for (Eigen::Index i = 0; i < result.size(); ++i) result.data()[i] = random.normal();
  return result;
}

/// Views of no camera in particular, and one parameter that all of them follow.
struct Recording {
  std::vector<LinearView> views;
  std::vector<ParameterView> columns;
};

Recording make_recording() {
  RandomStream random(53);
  Recording made;
  for (int frame = 0; frame < kFrames; ++frame) {
    for (int i = 0; i < kTagsOfFrame; ++i) {
      LinearView view;
      view.tag = (frame + i) % kTags;
      view.frame = frame;
      view.residual = LinearView::Residual::Zero(8);
      view.by_rig = normal_matrix<LinearView::ByPose>(8, 6, random);
      view.by_tag = normal_matrix<LinearView::ByPose>(8, 6, random);
      view.by_error = LinearView::ByError::Identity(8, 8);
      made.columns.push_back({made.views.size(), normal_matrix<Eigen::MatrixXd>(8, 1, random)});
      made.views.push_back(view);
    }
  }
  return made;
}

struct Scatter {
  double variance = 0.0;  ///< Of the estimates.
  double claimed = 0.0;   ///< In the mean.
  double factor = 0.0;    ///< In the mean.
};

/// Estimates of the parameter, which is another one in each block of frames by `spread`, under unit noise.
Scatter scatter_of(double spread) {
  Recording recording = make_recording();
  Scatter result;
  for (int trial = 0; trial < kTrials; ++trial) {
    RandomStream random(59, static_cast<std::uint64_t>(trial));
    double of_block = 0.0;
    int block = -1;
    for (std::size_t v = 0; v < recording.views.size(); ++v) {
      LinearView& view = recording.views[v];
      if (view.frame / kFramesOfBlock != block) of_block = spread * random.normal();
      block = view.frame / kFramesOfBlock;
      view.residual = normal_matrix<LinearView::Residual>(8, 1, random);
      view.residual -= of_block * recording.columns[v].by_parameter;
    }
    const auto poses = PoseInformation::of(recording.views, {0, 1, 2, 3, 4}, 0);
    const ParameterInformation left = poses->eliminate_poses(recording.columns);
    const double estimate = -left.gradient[0] / left.information(0, 0);
    const double factor =
        BlockScatter(recording.views, *poses).parameters_factor(recording.columns, left, 1.0);
    result.variance += estimate * estimate / kTrials;
    result.claimed += factor / left.information(0, 0) / kTrials;
    result.factor += factor / kTrials;
  }
  return result;
}

TEST(BlockScatterStatistics, ClaimsWhatBlocksThatDifferLeaveOfAParameter) {
  const Scatter scatter = scatter_of(0.2);
  EXPECT_GT(scatter.factor, 5.0);
  EXPECT_GT(scatter.claimed / scatter.variance, 0.5);  // of few blocks, the factor 1 counts as well
  EXPECT_LT(scatter.claimed / scatter.variance, 1.4);
}

TEST(BlockScatterStatistics, LeavesIndependentNoiseAsItIs) {
  const Scatter scatter = scatter_of(0.0);
  EXPECT_GE(scatter.factor, 1.0);
  EXPECT_LT(scatter.factor, 1.25);
  EXPECT_NEAR(scatter.claimed / scatter.variance, 1.0, 0.35);
}

}  // namespace
}  // namespace apriltrack
