#include "observations/resting_frames.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "apriltrack/calib/camera_places.h"
#include "numerics/upper_median.h"

namespace apriltrack {
namespace {

constexpr double kPlaceReach = 2.0;  ///< Of a tag's scatter at a place.
constexpr double kMoving = 0.1;      ///< Of a tag's views at a place, where it is no outlier any more.

/// A tag in a camera.
using Sight = std::pair<int, int>;

struct RestingMoment {
  std::size_t begin = 0;  ///< Into the views.
  std::size_t end = 0;
};

Sight sight_of(const TagView& view) {
  return {view.camera, view.tag};
}

/// Rms over the corners.
double distance_px(const CornersPx& a, const CornersPx& b) {
  double squares = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) squares += (a[i] - b[i]).squaredNorm();
  return std::sqrt(squares / static_cast<double>(a.size()));
}

std::vector<RestingMoment> split_by_moment(std::span<const TagView> views) {
  std::vector<RestingMoment> moments;
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (v == 0 || views[v].frame != views[v - 1].frame) moments.push_back({v, v});
    moments.back().end = v + 1;
  }
  return moments;
}

/// By place, the moments; without those that are kept as they are.
std::vector<std::vector<std::size_t>> moments_by_place(std::span<const TagView> views,
                                                       const std::vector<RestingMoment>& moments,
                                                       const std::vector<bool>& is_kept,
                                                       double same_place_px) {
  std::vector<std::size_t> asked;
  std::vector<std::vector<TagSight>> sights;
  for (std::size_t m = 0; m < moments.size(); ++m) {
    if (is_kept[m]) continue;
    asked.push_back(m);
    sights.emplace_back();
    for (const TagView& view : views.subspan(moments[m].begin, moments[m].end - moments[m].begin))
      sights.back().push_back({view.camera, view.tag, view.corners_px});
  }
  const std::vector<std::size_t> places = find_camera_places(sights, same_place_px);
  std::vector<std::vector<std::size_t>> result;
  for (std::size_t i = 0; i < asked.size(); ++i) {
    if (places[i] == result.size()) result.emplace_back();
    result[places[i]].push_back(asked[i]);
  }
  return result;
}

CornersPx median_of(const std::vector<const TagView*>& views) {
  CornersPx median;
  std::vector<double> values(views.size());
  for (std::size_t i = 0; i < median.size(); ++i) {
    for (const int axis : {0, 1}) {
      std::ranges::transform(views, values.begin(), [&](const TagView* v) { return v->corners_px[i][axis]; });
      median[i][axis] = upper_median(values);
    }
  }
  return median;
}

/// The median of each coordinate; but of a tag that moved askew this may be at none of its places: then the
/// view nearest to it.
CornersPx central_of(const std::vector<const TagView*>& views, double same_place_px) {
  const CornersPx median = median_of(views);
  const auto from_median = [&](const TagView* one) { return distance_px(one->corners_px, median); };
  const TagView* nearest = *std::ranges::min_element(views, {}, from_median);
  return from_median(nearest) <= same_place_px ? median : nearest->corners_px;
}

/// Of a tag's views, by how much each differs from the next: what moves once, or slowly, scatters little.
double scatter_px(const std::vector<const TagView*>& views) {
  if (views.size() < 2) return 0.0;
  std::vector<double> steps_px;
  for (std::size_t i = 1; i < views.size(); ++i)
    steps_px.push_back(distance_px(views[i - 1]->corners_px, views[i]->corners_px));
  return upper_median(std::move(steps_px)) / std::numbers::sqrt2;
}

/// Merges the moments of one place; `is_dropped`, of each view, gains those that are in a mean, or no use.
class PlaceMerge {
 public:
  PlaceMerge(Observations& observations, const std::vector<RestingMoment>& moments, double same_place_px,
             const EdgeNoise& noise, std::vector<bool>& is_dropped)
      : observations_(observations),
        moments_(moments),
        same_place_px_(same_place_px),
        noise_(noise),
        is_dropped_(is_dropped) {}

  /// Where a tag moves, the moments that see it elsewhere are a place of their own.
  void merge(std::vector<std::size_t> left, RestingFrames& counts) {
    while (left.size() > 1) {
      const std::vector<std::size_t> still = drop_outliers(left);
      if (still.empty()) return;
      merge_still(still, counts);
      std::erase_if(left, [&](std::size_t m) { return std::ranges::binary_search(still, m); });
    }
  }

 private:
  /// Of each set of tags that is seen together one mean stays, but of those that show no two together which
  /// others do not: links between tags are never lost.
  void merge_still(const std::vector<std::size_t>& still, RestingFrames& counts) {
    std::map<std::vector<Sight>, std::vector<std::size_t>> by_sights;
    for (const std::size_t m : still) by_sights[sights_of(m)].push_back(m);
    using Group = std::pair<std::vector<Sight>, std::vector<std::size_t>>;
    std::vector<Group> groups(by_sights.begin(), by_sights.end());
    std::ranges::stable_sort(groups, std::ranges::greater(),
                             [](const Group& group) { return group.first.size() * group.second.size(); });
    std::set<std::pair<Sight, Sight>> covered;
    for (const auto& [sights, moments] : groups) {
      const bool is_new = cover_pairs(sights, covered);
      counts.merged += static_cast<int>(moments.size()) - (is_new ? 1 : 0);
      if (!is_new) {
        for (const std::size_t m : moments) drop(m);
      } else if (moments.size() > 1) {
        put_mean(moments);
        ++counts.places;
      }
    }
  }

  /// Whether one of them was not covered yet.
  static bool cover_pairs(const std::vector<Sight>& sights, std::set<std::pair<Sight, Sight>>& covered) {
    bool is_new = false;
    for (std::size_t i = 0; i < sights.size(); ++i) {
      for (std::size_t j = i; j < sights.size(); ++j)
        is_new = covered.emplace(sights[i], sights[j]).second || is_new;
    }
    return is_new;
  }

  TagView& view(std::size_t v) { return observations_.views[v]; }

  void drop(std::size_t moment) {
    for (std::size_t v = moments_[moment].begin; v < moments_[moment].end; ++v) is_dropped_[v] = true;
  }

  std::vector<Sight> sights_of(std::size_t moment) {
    std::vector<Sight> sights;
    for (std::size_t v = moments_[moment].begin; v < moments_[moment].end; ++v) {
      if (!is_dropped_[v]) sights.push_back(sight_of(view(v)));
    }
    return sights;
  }

  /// The moments in which nothing moved.
  std::vector<std::size_t> drop_outliers(const std::vector<std::size_t>& of_place) {
    std::map<Sight, std::vector<const TagView*>> by_sight;
    for (const std::size_t m : of_place) {
      for (std::size_t v = moments_[m].begin; v < moments_[m].end; ++v)
        by_sight[sight_of(view(v))].push_back(&view(v));
    }
    std::map<Sight, CornersPx> central_px;
    std::map<Sight, double> reach_px;
    std::set<Sight> moving;
    for (const auto& [sight, views] : by_sight) {
      const CornersPx& central = central_px[sight] = central_of(views, same_place_px_);
      const double reach = reach_px[sight] = std::max(same_place_px_, kPlaceReach * scatter_px(views));
      const auto far = std::ranges::count_if(
          views, [&](const TagView* one) { return distance_px(one->corners_px, central) > reach; });
      if (static_cast<double>(far) > kMoving * static_cast<double>(views.size())) moving.insert(sight);
    }
    std::vector<std::size_t> still;
    for (const std::size_t m : of_place) {
      std::vector<std::size_t> far;
      bool has_moved = false;
      for (std::size_t v = moments_[m].begin; v < moments_[m].end; ++v) {
        const Sight sight = sight_of(view(v));
        if (distance_px(view(v).corners_px, central_px[sight]) <= reach_px[sight]) continue;
        far.push_back(v);
        has_moved = has_moved || moving.contains(sight);
      }
      if (has_moved) continue;
      for (const std::size_t v : far) is_dropped_[v] = true;
      still.push_back(m);
    }
    return still;
  }

  /// All show the same.
  void put_mean(const std::vector<std::size_t>& moments) {
    std::map<Sight, CornersPx> mean_px;
    const double share = 1.0 / static_cast<double>(moments.size());
    for_views(moments, [&](std::size_t, const TagView& one) {
      const auto [mean, is_new] = mean_px.try_emplace(sight_of(one));
      for (std::size_t i = 0; i < one.corners_px.size(); ++i) {
        if (is_new) mean->second[i].setZero();
        mean->second[i] += share * one.corners_px[i];
      }
    });
    std::map<std::size_t, double> squares;
    for_views(moments, [&](std::size_t m, const TagView& one) {
      const double away = distance_px(one.corners_px, mean_px[sight_of(one)]);
      squares[m] += away * away;
    });
    const std::size_t nearest =
        std::ranges::min_element(squares, {}, [](const auto& s) { return s.second; })->first;
    for (const std::size_t m : moments) {
      if (m != nearest) drop(m);
    }
    for (std::size_t v = moments_[nearest].begin; v < moments_[nearest].end; ++v) {
      if (is_dropped_[v]) continue;
      TagView& one = view(v);
      one.corners_px = mean_px[sight_of(one)];
      one.set_noise(one.corners_px, noise_);
      one.num_frames = static_cast<int>(moments.size());
    }
  }

  template <class Action>
  void for_views(const std::vector<std::size_t>& moments, const Action& action) {
    for (const std::size_t m : moments) {
      for (std::size_t v = moments_[m].begin; v < moments_[m].end; ++v) {
        if (!is_dropped_[v]) action(m, view(v));
      }
    }
  }

  Observations& observations_;
  const std::vector<RestingMoment>& moments_;
  const double same_place_px_;
  const EdgeNoise& noise_;
  std::vector<bool>& is_dropped_;
};

}  // namespace

RestingFrames merge_resting_frames(Observations& observations, double same_place_px, const EdgeNoise& noise,
                                   const std::set<Timestamp>& kept) {
  RestingFrames counts;
  if (!(same_place_px > 0.0)) return counts;
  const std::vector<RestingMoment> moments = split_by_moment(observations.views);
  std::vector<bool> is_kept;
  for (const RestingMoment& moment : moments)
    is_kept.push_back(
        kept.contains(observations.frames[static_cast<std::size_t>(observations.views[moment.begin].frame)]));
  std::vector<bool> is_dropped(observations.views.size(), false);
  PlaceMerge merge(observations, moments, same_place_px, noise, is_dropped);
  int number = 0;
  for (auto& place : moments_by_place(observations.views, moments, is_kept, same_place_px)) {
    if (place.size() < 2) continue;
    for (const std::size_t m : place) {
      for (std::size_t v = moments[m].begin; v < moments[m].end; ++v) observations.views[v].place = number;
    }
    ++number;
    merge.merge(std::move(place), counts);
  }
  std::size_t v = 0;
  std::erase_if(observations.views, [&](const TagView&) { return is_dropped[v++]; });
  return counts;
}

}  // namespace apriltrack
