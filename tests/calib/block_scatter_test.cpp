// What errors that blocks of frames share do to tags and to a parameter of all views, against many draws of
// them, each fitted by brute force.
#include "uncertainty/block_scatter.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <numeric>
#include <string>

#include "apriltrack/base/random.h"

namespace apriltrack {
namespace {

constexpr int kNumTags = 5, kFrames = 80, kTagsOfFrame = 3;
constexpr int kSameBlocks = 10, kOtherBlocks = 13;  // frames: those of the estimate, and no divisor of them
constexpr int kTrials = 150;

template <typename Matrix>
Matrix normal_matrix(Eigen::Index rows, Eigen::Index columns, RandomStream& random) {
  Matrix result(rows, columns);
  for (Eigen::Index i = 0; i < result.size(); ++i) result.data()[i] = random.normal();
  return result;
}

/// Views of no camera in particular, and one parameter that all of them follow. Tags and frames may move
/// together, each as its own coordinates say, and nothing is seen of it.
struct Recording {
  std::vector<LinearView> views;
  std::vector<ParameterView> columns;
};

Recording make_recording() {
  RandomStream random(53);
  std::vector<Matrix6d> rig_by_tag;
  for (int tag = 0; tag < kNumTags; ++tag) rig_by_tag.push_back(normal_matrix<Matrix6d>(6, 6, random));
  Recording made;
  for (int frame = 0; frame < kFrames; ++frame) {
    for (int i = 0; i < kTagsOfFrame; ++i) {
      LinearView view;
      view.tag = (frame + i) % kNumTags;
      view.frame = frame;
      view.residual = LinearView::Residual::Zero(8);
      view.by_rig = normal_matrix<LinearView::ByPose>(8, 6, random);
      view.by_tag = -view.by_rig * rig_by_tag[static_cast<std::size_t>(view.tag)];
      view.by_error = LinearView::ByError::Identity(8, 8);
      made.columns.push_back({made.views.size(), normal_matrix<Eigen::MatrixXd>(8, 1, random)});
      made.views.push_back(view);
    }
  }
  return made;
}

/// Errors of views: unit noise, and a pull of `spread` that is another one in each block
/// of frames: of each tag's pose, or of the parameter.
enum class Pulled { kTags, kParameter };

struct Errors {
  Pulled pulled = Pulled::kTags;
  double spread = 0.0;
  int frames_of_block = kOtherBlocks;
};

Eigen::VectorXd draw(const Errors& drawn, const Recording& recording, RandomStream& random) {
  Eigen::VectorXd errors(8 * static_cast<Eigen::Index>(recording.views.size()));
  Eigen::MatrixXd of_tags;
  double of_parameter = 0.0;
  int block = -1;
  for (std::size_t v = 0; v < recording.views.size(); ++v) {
    const LinearView& view = recording.views[v];
    if (view.frame / drawn.frames_of_block != block) {
      of_parameter = drawn.spread * random.normal();
      of_tags = drawn.spread * normal_matrix<Eigen::MatrixXd>(6, kNumTags, random);
      block = view.frame / drawn.frames_of_block;
    }
    Eigen::VectorXd error = normal_matrix<Eigen::VectorXd>(8, 1, random);
    if (drawn.pulled == Pulled::kTags) error += view.by_tag * of_tags.col(view.tag);
    if (drawn.pulled == Pulled::kParameter) error += recording.columns[v].by_parameter * of_parameter;
    errors.segment<8>(8 * static_cast<Eigen::Index>(v)) = error;
  }
  return errors;
}

/// Of all unknowns at once: tags but the first, frames, and the parameter if it is one.
class BruteForceFit {
 public:
  BruteForceFit(const Recording& recording, bool with_parameter) {
    const Eigen::Index of_poses = 6 * (kNumTags - 1 + kFrames);
    jacobian_.setZero(8 * static_cast<Eigen::Index>(recording.views.size()),
                      of_poses + (with_parameter ? 1 : 0));
    for (std::size_t v = 0; v < recording.views.size(); ++v) {
      const LinearView& view = recording.views[v];
      const Eigen::Index row = 8 * static_cast<Eigen::Index>(v);
      if (view.tag > 0) jacobian_.block<8, 6>(row, 6 * (view.tag - 1)) = view.by_tag;
      jacobian_.block<8, 6>(row, 6 * (kNumTags - 1 + view.frame)) = view.by_rig;
      if (with_parameter) jacobian_.block<8, 1>(row, of_poses) = recording.columns[v].by_parameter;
    }
    solver_.compute(jacobian_);
  }

  Eigen::VectorXd solve(const Eigen::VectorXd& errors) const { return -solver_.solve(errors); }
  Eigen::VectorXd residuals(const Eigen::VectorXd& errors, const Eigen::VectorXd& solution) const {
    return errors + jacobian_ * solution;
  }

 private:
  Eigen::MatrixXd jacobian_;
  Eigen::HouseholderQR<Eigen::MatrixXd> solver_;
};

void take(const Eigen::VectorXd& residuals, Recording& recording) {
  for (std::size_t v = 0; v < recording.views.size(); ++v)
    recording.views[v].residual = residuals.segment<8>(8 * static_cast<Eigen::Index>(v));
}

PoseInformation information_of(const Recording& recording, int held_tag) {
  std::vector<int> tags(kNumTags);
  std::iota(tags.begin(), tags.end(), 0);
  return PoseInformation::of(recording.views, tags, held_tag).value();
}

/// In units of the variance that unit noise gives.
struct Scatter {
  double variance = 0.0;  ///< Of the estimates.
  double factor = 0.0;    ///< As it is told, in the mean.
};

double of_parameter(const Recording& recording, const PoseInformation& poses, const Eigen::VectorXd& solution,
                    Scatter& sum) {
  const ParameterInformation left = poses.eliminate_poses(recording.columns);
  const double estimate = solution[solution.size() - 1];
  sum.variance += estimate * estimate * left.information(0, 0);
  return BlockScatter(recording.views, poses).parameters_factor(recording.columns, left, 1.0);
}

double of_tags(const Recording& recording, const PoseInformation& poses, const Eigen::VectorXd& solution,
               Scatter& sum) {
  const Eigen::Index size = poses.size();
  const Eigen::MatrixXd covariance = poses.solve(Eigen::MatrixXd::Identity(size, size));
  for (Eigen::Index i = 0; i < size; i += 6) {
    const Vector6d estimate = solution.segment<6>(i);
    sum.variance +=
        estimate.dot(covariance.block<6, 6>(i, i).ldlt().solve(estimate)) / static_cast<double>(size);
  }
  return BlockScatter(recording.views, poses).tags_factor(1.0);
}

Scatter scatter_of(const Errors& drawn) {
  Recording recording = make_recording();
  const bool with_parameter = drawn.pulled == Pulled::kParameter;
  const BruteForceFit fit(recording, with_parameter);
  Scatter sum;
  for (int trial = 0; trial < kTrials; ++trial) {
    RandomStream random(59, static_cast<std::uint64_t>(trial));
    const Eigen::VectorXd errors = draw(drawn, recording, random);
    const Eigen::VectorXd solution = fit.solve(errors);
    take(fit.residuals(errors, solution), recording);
    const PoseInformation poses = information_of(recording, 0);
    sum.factor += (with_parameter ? of_parameter : of_tags)(recording, poses, solution, sum);
  }
  return {sum.variance / kTrials, sum.factor / kTrials};
}

struct Claim {
  const char* name;
  Errors errors;
  double least, most;  ///< Of what is claimed over what is so.
};

class BlockScatterStatistics : public ::testing::TestWithParam<Claim> {};

TEST_P(BlockScatterStatistics, ClaimsWhatBlocksThatDifferLeave) {
  const Scatter scatter = scatter_of(GetParam().errors);
  EXPECT_GT(scatter.variance, 5.0);
  EXPECT_GT(scatter.factor, 5.0);
  EXPECT_GT(scatter.factor / scatter.variance, GetParam().least);
  EXPECT_LT(scatter.factor / scatter.variance, GetParam().most);
}

// Of one number in few blocks the factor 1 counts as well, and blocks that begin elsewhere hide a half.
INSTANTIATE_TEST_SUITE_P(
    Of, BlockScatterStatistics,
    ::testing::Values(Claim{"AParameter", {Pulled::kParameter, 0.3, kSameBlocks}, 0.5, 1.4},
                      Claim{"AParameterInOtherBlocks", {Pulled::kParameter, 0.3, kOtherBlocks}, 0.25, 1.4},
                      Claim{"Tags", {Pulled::kTags, 0.3, kSameBlocks}, 0.8, 1.4},
                      Claim{"TagsInOtherBlocks", {Pulled::kTags, 0.3, kOtherBlocks}, 0.6, 1.4}),
    [](const auto& one) { return std::string(one.param.name); });

class BlockScatterNoise : public ::testing::TestWithParam<Pulled> {};

TEST_P(BlockScatterNoise, StatisticsLeaveItAsItIsWhereItIsIndependent) {
  const Scatter scatter = scatter_of({.pulled = GetParam(), .spread = 0.0});
  EXPECT_GE(scatter.factor, 1.0);
  EXPECT_LT(scatter.factor, GetParam() == Pulled::kTags ? 1.35 : 1.25);
  EXPECT_NEAR(scatter.factor / scatter.variance, 1.0, 0.35);
}

INSTANTIATE_TEST_SUITE_P(Of, BlockScatterNoise, ::testing::Values(Pulled::kTags, Pulled::kParameter),
                         [](const auto& one) {
                           return std::string(one.param == Pulled::kTags ? "Tags" : "AParameter");
                         });

TEST(BlockScatter, SaysTheSameWhicheverTagIsHeld) {
  Recording recording = make_recording();
  RandomStream random(67);
  take(draw({Pulled::kTags, 0.3}, recording, random), recording);
  const PoseInformation poses = information_of(recording, 0);
  const double factor = BlockScatter(recording.views, poses).tags_factor(1.0);
  EXPECT_GT(factor, 2.0);
  for (int held = 1; held < kNumTags; ++held) {
    const PoseInformation others = information_of(recording, held);
    EXPECT_NEAR(BlockScatter(recording.views, others).tags_factor(1.0), factor, 1e-9 * factor) << held;
  }
}

}  // namespace
}  // namespace apriltrack
