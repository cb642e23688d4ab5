#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include "faults/tag_fault.h"

namespace apriltrack {

/// A tag that may be at fault, and what counts beside it.
struct Suspect {
  int tag = 0;
  Part part;                       ///< The tag and its neighbours, before outliers were removed.
  std::vector<std::size_t> views;  ///< Of the tag, in the order of time.
};

/// One explanation of the suspect's views, and the map by it.
struct FaultTrial {
  TagFinding::Kind kind = TagFinding::Kind::kMoved;
  AdjustedPart solved;
  double gain = 0.0;  ///< Of half the squares, all views counted, over the better fit without a fault.
  std::vector<bool> is_at_second = {};  ///< Of the suspect's views: which of two places they show.
  Pose T_map_first, T_map_second;
  double log_scale = 0.0, scale_sigma = 0.0;  ///< kSize: of the stated size.
};

/// Solves a suspect's part anew, from the start, with one explanation or another: not to first order, and
/// with views that the fit had given up. (docs/algorithms/calibration.md, equation 6d.)
class FaultTrials {
 public:
  /// All outlive this. solved: the map to be explained, which may lack the suspect; by its cameras.
  FaultTrials(const PartTask& task, const Suspect& suspect, const AdjustedPart& solved);

  /// What explains most, if it explains enough.
  std::optional<FaultTrial> best();

 private:
  void ask_probes();
  double size_m() const;
  std::optional<FaultTrial> try_fault(const Observations& observations, FaultTrial trial) const;
  Observations split_suspect(const std::vector<bool>& is_at_second) const;
  std::optional<FaultTrial> split(TagFinding::Kind kind, const std::vector<bool>& is_at_second);
  std::optional<FaultTrial> solve_split(const std::vector<bool>& is_at_second) const;
  /// From the moment on, into its views, the tag hangs elsewhere.
  std::optional<FaultTrial> move_at(std::size_t moment);
  std::optional<FaultTrial> best_move_from(std::size_t moment);
  /// The first that explains all of the views, else the best that explains enough.
  std::optional<FaultTrial> best_move();
  /// That explains enough.
  std::optional<FaultTrial> best_copy();
  std::optional<FaultTrial> best_copy_from(std::vector<bool> is_at_second);
  /// What moves once more, at either place, has none.
  bool moves_again(const FaultTrial& moved) const;
  std::optional<FaultTrial> resize(double log_scale) const;
  std::optional<FaultTrial> best_size() const;
  std::optional<FaultTrial> if_enough(std::optional<FaultTrial> trial) const;
  bool explains_all(const FaultTrial& trial) const;
  bool are_apart(const FaultTrial& trial) const;

  const PartTask& task_;
  const Suspect& suspect_;
  const AdjustedPart& solved_;
  Observations observations_;
  std::optional<AdjustedPart> whole_;   ///< Without a fault, and with the suspect.
  std::vector<bool> is_given_up_;       ///< Of the suspect's views, there.
  std::size_t moment_of_probes_ = 0;    ///< Into the suspect's views; 0: none.
  std::vector<bool> places_of_probes_;  ///< Of the suspect's views; empty: one place.
  /// Those solved so far, by which views show the second place: several ways lead to the same.
  std::map<std::vector<bool>, std::optional<FaultTrial>> splits_;
};

/// What a view costs at which it is rejected, nats: no view costs more.
double cost_of_rejected_view(const TagView& view);

}  // namespace apriltrack
