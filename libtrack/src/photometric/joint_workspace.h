#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "apriltrack/photometric/joint_likelihood.h"
#include "patch_columns.h"
#include "patch_placement.h"
#include "row_pairs.h"
#include "tag_prediction.h"
#include "view_cone.h"

namespace apriltrack {

/// What a hypothesis makes of a tag before its samples are looked at.
struct PatchInView {
  PlacedPatch placed;
  std::array<float, 9> camera_from_plane{};
  double num_independent = 0.0;
  std::size_t prediction = 0;  ///< Of patterns: which of the workspace's.
  bool is_in_view = false;
};

/// Which of a patch's samples are looked at.
enum class SampleSet { kSome, kQuarter, kAll };

struct PatchSamples {
  std::vector<std::size_t> cells;
  PatchColumns grid;  ///< Of patterns.
  std::vector<PatchColumns> references;
};

struct JointLikelihood::Workspace {
  PatchSamples& of(SampleSet set) { return samples[static_cast<std::size_t>(set)]; }

  ViewCone cone;  ///< What the frame shows.
  LensFactors lens;
  RowPairs rows;
  std::array<PatchSamples, 3> samples;
  std::vector<std::size_t> selection;      ///< Hypotheses to evaluate.
  std::vector<double> bounds;              ///< Of all hypotheses' log-likelihoods, from above.
  std::vector<PatchInView> views;          ///< Of a batch, hypothesis by hypothesis.
  std::vector<TagPrediction> predictions;  ///< Likewise, of patterns in view.
};

/// Hypotheses that are evaluated together.
struct JointLikelihood::Batch {
  const PhotometricFrame& frame;
  std::span<const MotionState> hypotheses;  ///< All of them,
  std::span<const std::size_t> selection;   ///< and which are of this batch.
  SampleSet set = SampleSet::kAll;
  PairedRows image;

  const MotionState& hypothesis(std::size_t position) const { return hypotheses[selection[position]]; }
};

}  // namespace apriltrack
