#pragma once

#include <set>
#include <vector>

#include "apriltrack/tracker/blur_tracker.h"
#include "apriltrack/tracker/track_result.h"
#include "blur_frame.h"
#include "chance_readings.h"
#include "explanation.h"
#include "hidden_tags.h"
#include "tag_strain.h"
#include "tag_trust.h"

namespace apriltrack {

/// Which tags are believed: those that fit one pose, in this frame and in those before
/// (docs/algorithms/blur_tracker.md, section 7). Owns the marks of the world's tags: what is hidden, suspect
/// or left out takes no part in fits. Of one recording; world, options: must outlive it. map: the world's.
class TagConsensus {
 public:
  TagConsensus(const TagMap& map, PhotometricWorld& world, const BlurTrackerOptions& options)
      : world_(world), options_(options), readings_(map) {}
  ~TagConsensus() { unmark(); }
  TagConsensus(const TagConsensus&) = delete;
  TagConsensus& operator=(const TagConsensus&) = delete;

  /// Nothing is left out any more, but for suspects.
  void begin_frame();
  bool knows_hidden_tags() const { return hidden_.has_hopeful(); }
  /// Of the tags read, those that take part; the world's tags are marked. with_hidden: what is known to be
  /// hidden takes part as well.
  void choose(BlurFrame& frame, bool with_hidden);

  /// Of every frame: all that was read in it.
  void were_read(const BlurFrame& frame) { readings_.were_read(frame.read); }

  /// Whether the tags of the convincing explanation contradict each other, and one is to be left out from now
  /// on: explain the frame anew.
  bool leaves_one_out(const BlurFrame& frame, const Explanation& best);
  /// Why the explanation, of those that leaves_one_out() has seen last, may not be claimed; empty where it
  /// may. Remembers who contradicts whom.
  std::string objection(const BlurFrame& frame, const Explanation& best,
                        const std::vector<MotionHypothesis>& expected);

  /// Good enough to go on from, not to be claimed: a blurred tag that is half hidden, that moved as nothing
  /// let expect, or that leaves the place of another, which should be seen and is not, open by 10 px.
  bool is_doubtful(const Explanation& best) const;

  /// Of a frame that is claimed.
  void learn(const BlurFrame& frame, const Explanation& best, bool has_rival);
  void report(const BlurFrame& frame, const Explanation& best, TrackResult& result) const;
  /// Of one that is not.
  void learn_contradictions(const Explanation& best);

 private:
  struct Doubted {
    int tag_index;
    double doubt;
  };

  bool is_left_out(int tag_index) const {
    return trust_.is_suspect(tag_index) || left_out_.contains(tag_index);
  }
  bool is_in_fit(const TagStrain& strain) const { return !world_.tag_at(strain.tag_index).is_hidden; }
  void unmark();
  static bool is_told_of(const BlurFrame& frame, const Explanation& best, int tag_index);
  std::vector<Doubted> doubted_tags() const;
  std::vector<int> strained_tags() const;
  bool jumps_alone(const Explanation& best, const std::vector<MotionHypothesis>& expected);
  bool is_vague(const Explanation& best) const;
  bool is_read_by_chance(const Explanation& best) const;
  bool leaves_open_what_is_missed(const Explanation& best, double max_sigma_px) const;
  bool may_be_mistaken(const BlurFrame& frame, const Explanation& best) const;
  void learn_hidden_tags(const BlurFrame& frame, const Explanation& best, bool has_rival);
  TagReport report_of(const BlurFrame& frame, const TagEvidence& evidence, const TagVotes& votes) const;
  TagState state_of(const TagEvidence& evidence, const TagVotes& votes) const;
  TagVotes votes_of_all_read(const BlurFrame& frame, const Explanation& best) const;

  PhotometricWorld& world_;
  const BlurTrackerOptions& options_;
  HiddenTags hidden_;
  TagTrust trust_;
  ChanceReadings readings_;
  std::vector<int> witnesses_;  ///< Tags that the motion so far rests on.

  // Of this frame:
  std::set<int> left_out_;          ///< beside suspects;
  std::set<int> doubted_;           ///< suspect or left out, as marked in the world;
  int num_examined_ = 0;            ///< explanations;
  bool is_torn_ = false;            ///< its tags do not fit one pose, and nothing tells which is wrong;
  std::vector<TagEquations> tags_;  ///< of the explanation examined last, those out of its fit too,
  std::vector<TagStrain> strains_;  ///< likewise.
};

}  // namespace apriltrack
