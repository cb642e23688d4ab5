#pragma once

#include <map>
#include <set>
#include <utility>
#include <vector>

namespace apriltrack {

/// Which tags are where the map has them, by what frames said of pairs of tags: that both fit one pose, or
/// not. A tag that does not fit another may be right, and the other wrong; what both were to third ones
/// tells. Those that more speaks against than for are suspect: moved since the map was made, or mistaken for
/// others.
class TagTrust {
 public:
  /// All of them fit one pose, which would not be so were one of them moved.
  void agree(const std::vector<int>& tags);
  /// The tags that the pose rests on, and those that do not fit it. weight: 1 for a frame that shows both.
  void disagree(const std::vector<int>& tags, const std::vector<int>& others, double weight = 1.0);

  /// How much more speaks against a tag than for it, but for what suspects say; 0 where nothing was said.
  double doubt(int tag) const;
  /// Whether another, unsuspected, was ever seen to fit.
  bool is_confirmed(int tag) const;
  bool is_suspect(int tag) const { return suspects_.contains(tag); }
  const std::set<int>& suspects() const { return suspects_; }

 private:
  void add(int a, int b, double weight);
  double doubt_but_of(int tag, const std::set<int>& left_out) const;
  void find_suspects();

  std::map<int, std::map<int, double>> against_;  ///< Of each pair, both ways; negative: it fits.
  std::set<int> suspects_;
};

}  // namespace apriltrack
