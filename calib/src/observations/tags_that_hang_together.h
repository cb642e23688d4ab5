#pragma once

#include <optional>
#include <vector>

namespace apriltrack {

/// A tag that is seen at a moment.
struct TagAtMoment {
  int tag = 0;
  int moment = 0;
};

/// What can be solved for with one tag held.
struct HangingTogether {
  std::vector<bool> is_in;  ///< Of what was given.
  int held_tag = 0;  ///< The wanted one, or the one that is seen most; -1 where nothing hangs together.
};

/// Tags that two moments or more show, in moments that show two tags or more, all of them joined by such
/// moments: the part with the wanted tag or, where that is in none, the one that is seen most.
HangingTogether tags_that_hang_together(const std::vector<TagAtMoment>& seen, int wanted_tag);

}  // namespace apriltrack
