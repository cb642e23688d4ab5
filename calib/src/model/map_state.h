#pragma once

#include <vector>

#include "apriltrack/base/parallel.h"
#include "model/view_candidates.h"
#include "model/view_residual.h"
#include "observations/parts.h"

namespace apriltrack {

/// How large the corners' errors are, in units of those expected.
struct NoiseScale {
  double sum = 1.0;         ///< Of the numbers u of equation (5): errors that both ends of an edge share.
  double difference = 1.0;  ///< Of the numbers v.
  /// What corners err by beyond their detector's claims, px; kBeyondClaim_px is in TagView::whitening.
  double beyond_px = kBeyondClaim_px;
  std::vector<double> of_frame = {};  ///< Beside all that, indexed like Observations::frames; empty: 1.
  std::vector<double> of_view = {};   ///< Beside all that, by TagView::index; 1 for those that are not in it.

  /// What was measured of all views alike.
  NoiseScale of_all() const { return {sum, difference, beyond_px}; }
};

/// The unknowns of a calibration, indexed like Observations::tags, ::frames and ::cameras; entries that a
/// part does not use stay at identity.
struct MapState {
  std::vector<Pose> T_map_tag;
  std::vector<Pose> T_map_rig;
  std::vector<RigCamera> cameras;  ///< As given, until they are refined.
  NoiseScale noise;
};

/// How large the errors of a view are, over what TagView::whitening expects, where corners err by so much
/// beyond what detectors claim. 1 where none claims.
double scale_by_claim(const TagView& view, double beyond_px);
/// What the state's noise makes of TagView::whitening, row by row.
Vector8d noise_weights(const TagView& view, const MapState& state);
/// Of a view's residuals: into independent numbers of unit variance, as the state has the noise.
Matrix8d whitening(const TagView& view, const MapState& state);

/// view_residual() where the state has cameras, tag and rig.
bool residual_of(const Observations& observations, const TagView& view, const MapState& state,
                 Vector8d* residual_px, Matrix8x6d* by_rig = nullptr, Matrix8x6d* by_tag = nullptr);

/// residual_px: if given, the same before it is whitened.
Vector8d whitened_residual(const Observations& observations, const TagView& view, const MapState& state,
                           bool& is_valid, Vector8d* residual_px = nullptr);

/// A first map, free of flips as far as the views allow: tags along the tree of best-supported links from
/// `held_tag` (which lies at the origin), frames by the candidate that explains all their tags best, then
/// tags and frames in turn by their candidates' reprojection errors.
MapState start_state(const Observations& observations, const Part& part, int held_tag,
                     const std::vector<ViewCandidates>& candidates, const ParallelFor& parallel);

/// Expresses everything in the frame of `tag`.
void move_origin_to(MapState& state, int tag);

}  // namespace apriltrack
