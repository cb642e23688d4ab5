#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <vector>

namespace apriltrack {

/// Which tags are where the map has them, by what frames said of pairs of tags: that both fit one pose, or
/// not. A tag that does not fit another may be right, and the other wrong; what both were to third ones
/// tells. Those that more speaks against than for are suspect: moved since the map was made, or mistaken for
/// others.
///
/// A frame costs what it says: its pairs, some tens of nanoseconds each, where fitting one tag takes a
/// thousand times as much; where suspects, or tags that were seen with them, are among these, what was ever
/// said of suspects besides. What else the map holds costs nothing. Remembered are the pairs that were ever
/// seen together: of a tag no more than others of the map, however long the recording.
class TagTrust {
 public:
  /// All of them fit one pose, which would not be so were one of them moved.
  void agree(const std::vector<int>& tags);
  /// The tags that the pose rests on, and those that do not fit it. weight: 1 for a frame that shows both;
  /// in halves, so that sums are exact.
  void disagree(const std::vector<int>& tags, const std::vector<int>& others, double weight = 1.0);

  /// How much more speaks against a tag than for it, but for what suspects say; 0 where nothing was said.
  double doubt(int tag) const;
  /// Whether another, unsuspected, was ever seen to fit.
  bool is_confirmed(int tag) const;
  bool is_suspect(int tag) const { return suspects_.contains(tag); }
  const std::set<int>& suspects() const { return suspects_; }

  /// Pairs looked at so far, each time: what it all costs.
  std::uint64_t work() const { return work_; }

 private:
  /// What was said of a tag.
  struct Said {
    std::map<int, double> of_pairs;  ///< By the other tag; negative: the two fit.
    double doubt = 0.0;              ///< The sum over those that are no suspects;
    int num_suspects = 0;            ///< how many are.
  };

  void add(int a, int b, double weight);
  void add_doubt(int tag, double more);
  /// Whether what is said of it may make suspects, or clear them.
  bool concerns_suspects(int tag) const;
  void find_suspects();
  /// The most doubtful of those that are doubtful enough; all that are as doubtful.
  std::vector<int> most_doubtful(const std::set<int>& suspects_before);
  void suspect(int tag);
  void clear(int tag);

  std::map<int, Said> said_;  ///< Of all tags that anything was said of.
  std::set<int> doubtful_;    ///< Those of them whose doubt makes suspects.
  std::set<int> suspects_;
  /// What was said since they were found, or that others were suspect before, may change who they are.
  bool is_open_ = false;
  std::uint64_t work_ = 0;
};

}  // namespace apriltrack
