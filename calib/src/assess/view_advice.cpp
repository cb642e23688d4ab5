#include "assess/view_advice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "apriltrack/base/degrees.h"
#include "assess/candidate_views.h"
#include "assess/picture_equations.h"
#include "assess/weak_directions.h"
#include "numerics/words.h"
#include "observations/observations.h"

namespace apriltrack {
namespace {

constexpr int kPictures = 5;
constexpr std::size_t kMostAdvice = 3;
constexpr int kMostTried = 4;
constexpr std::size_t kMostSeen = 8;     // tags of a picture that are reckoned with
constexpr std::size_t kMostSparse = 14;  // tags beside the weakest one whose surroundings are looked at, too
constexpr double kWellKnown = 0.05;      // of weakness: 1 mrad, 0.8 mm of a tag of 16 cm
constexpr double kWorthIt = 0.8;         // of sigma

/// A candidate with what it would say.
struct Prospect {
  CandidateView view;
  PictureEquations picture;
};

/// Squared length of the error, position in tenths of the size, rotation in 0.02 rad.
double looseness(const Matrix6d& covariance, double size_m) {
  const double position_m = kWeakPosition * size_m;
  return covariance.topLeftCorner<3, 3>().trace() / (position_m * position_m) +
         covariance.bottomRightCorner<3, 3>().trace() / (kWeakRotation_rad * kWeakRotation_rad);
}

int camera_of(const MapEvidence& evidence) {
  std::map<int, int> views;
  for (const MappedView& view : evidence.views) ++views[view.camera];
  int best = 0;
  for (const auto& [camera, count] : views) {
    if (count > views[best]) best = camera;
  }
  return best;
}

std::string angle_in_words(const ViewAdvice& advice) {
  const auto degrees = [](double rad) { return std::abs(rad) * kDegPerRad; };
  std::string words;
  if (advice.aside_rad != 0.0)
    words += fmt::format(", {:.0f} degrees from the {}", degrees(advice.aside_rad),
                         advice.aside_rad > 0.0 ? "right" : "left");
  if (advice.above_rad != 0.0)
    words += fmt::format(", {:.0f} degrees from {}", degrees(advice.above_rad),
                         advice.above_rad > 0.0 ? "above" : "below");
  return words.empty() ? ", head-on" : words;
}

/// "from 6.3 to 5.9": with as many digits as tell the two apart, up to three.
std::string from_to(double before, double after) {
  const std::string few_before = in_two_digits(before), few_after = in_two_digits(after);
  return few_before == few_after ? fmt::format("from {:.3g} to {:.3g}", before, after)
                                 : fmt::format("from {} to {}", few_before, few_after);
}

class Adviser {
 public:
  Adviser(const TagMap& map, const JointCovariance& joint, const MapEvidence& evidence, const CameraRig& rig)
      : map_(map),
        joint_(joint),
        evidence_(evidence),
        camera_(camera_of(evidence)),
        rig_(rig),
        scene_(map, joint, evidence.noise, camera_of_scene()) {
    scene_.most_tags = kMostSeen;
    for (const MapTag& tag : map.tags) places_.push_back(joint.row_of(tag.key).value_or(-6) / 6);
  }

  std::vector<ViewAdvice> run() {
    std::vector<ViewAdvice> advice;
    std::set<std::size_t> tried;
    for (int i = 0; i < kMostTried && advice.size() < kMostAdvice; ++i) {
      const auto target = weakest(tried);
      if (!target) break;
      tried.insert(*target);
      if (auto one = help(*target)) advice.push_back(std::move(*one));
    }
    return advice;
  }

 private:
  const MapTag& tag_at(std::size_t place) const { return *map_.find(joint_.tags[place]); }
  int number_of(const TagKey& key) const {
    return static_cast<int>(std::ranges::find(map_.tags, key, &MapTag::key) - map_.tags.begin());
  }
  /// -1 for a tag that the joint covariance does not have.
  Eigen::Index place_of(int tag) const { return places_[static_cast<std::size_t>(tag)]; }
  const Camera& camera_of_scene() const { return rig_.cameras[static_cast<std::size_t>(camera_)]; }
  Matrix6d covariance_at(std::size_t place) const {
    const auto row = 6 * static_cast<Eigen::Index>(place);
    return joint_.block(row, row);
  }

  /// Of the tags that are not known well, and were not tried.
  std::optional<std::size_t> weakest(const std::set<std::size_t>& tried) const {
    std::optional<std::size_t> worst;
    double most = kWellKnown;
    for (std::size_t place = 0; place < joint_.tags.size(); ++place) {
      if (tried.contains(place)) continue;
      const double weakness = weakness_of(covariance_at(place), tag_at(place).size_m);
      if (weakness > most) {
        most = weakness;
        worst = place;
      }
    }
    return worst;
  }

  void look_from(int tag, bool is_dense, std::vector<Prospect>& prospects) const {
    for (const CandidateView& view : candidate_views(map_, evidence_, camera_of_scene(), tag, is_dense)) {
      PictureEquations picture =
          picture_equations(scene_, view.T_map_camera, {place_of(view.tag), place_of(view.partner)});
      const auto shows = [&](int one) {
        return std::ranges::find(picture.tags, place_of(one)) != picture.tags.end();
      };
      if (shows(view.tag) && shows(view.partner)) prospects.push_back({view, std::move(picture)});
    }
  }

  /// Around the tag itself, and around others: what it hangs on may be what is weak.
  std::vector<Prospect> prospects_for(int tag) {
    if (!has_looked_around_) {
      has_looked_around_ = true;
      std::vector<std::pair<double, int>> weakest_first;
      for (std::size_t place = 0; place < joint_.tags.size(); ++place)
        weakest_first.emplace_back(-looseness(covariance_at(place), tag_at(place).size_m),
                                   number_of(joint_.tags[place]));
      std::ranges::sort(weakest_first);
      weakest_first.resize(std::min(kMostSparse, weakest_first.size()));
      for (const auto& [weakness, other] : weakest_first) look_from(other, false, around_);
    }
    std::vector<Prospect> prospects = around_;
    look_from(tag, true, prospects);
    return prospects;
  }

  std::optional<ViewAdvice> help(std::size_t place) {
    const MapTag& tag = tag_at(place);
    const std::vector<Prospect> prospects = prospects_for(number_of(tag.key));
    const double before = looseness(covariance_at(place), tag.size_m);
    const Prospect* best = nullptr;
    double least = kWorthIt * kWorthIt * before;
    for (const Prospect& prospect : prospects) {
      const JointUpdate update(joint_, prospect.picture, kPictures);
      const double after = looseness(update.covariance_of(static_cast<Eigen::Index>(place)), tag.size_m);
      if (after < least) {
        least = after;
        best = &prospect;
      }
    }
    if (best == nullptr) return std::nullopt;
    return take(place, *best);
  }

  ViewAdvice take(std::size_t place, const Prospect& best) {
    const JointUpdate update(joint_, best.picture, kPictures);
    const Matrix6d before = covariance_at(place);
    const Matrix6d after = update.covariance_of(static_cast<Eigen::Index>(place));
    ViewAdvice advice;
    advice.tag = tag_at(place).key;
    for (const Eigen::Index other : best.picture.tags) {
      if (other != static_cast<Eigen::Index>(place))
        advice.together.push_back(joint_.tags[static_cast<std::size_t>(other)]);
    }
    advice.pictures = kPictures;
    advice.T_map_camera = best.view.T_map_camera;
    advice.camera = camera_;
    advice.sigma_before_m = std::sqrt(before.topLeftCorner<3, 3>().trace());
    advice.sigma_after_m = std::sqrt(after.topLeftCorner<3, 3>().trace());
    advice.sigma_before_rad = std::sqrt(before.bottomRightCorner<3, 3>().trace());
    advice.sigma_after_rad = std::sqrt(after.bottomRightCorner<3, 3>().trace());
    advice.words = tell(advice, best);
    joint_ = update.updated();
    return advice;
  }

  /// The picture may be taken before another tag than the one that it helps: on the way there.
  std::string tell(ViewAdvice& advice, const Prospect& best) const {
    const TagKey& before = map_.tags[static_cast<std::size_t>(best.view.tag)].key;
    const TagKey& partner = map_.tags[static_cast<std::size_t>(best.view.partner)].key;
    advice.distance_m = best.view.distance_m;
    advice.aside_rad = best.view.aside_rad;
    advice.above_rad = best.view.above_rad;
    advice.before = before;
    advice.partner = partner;
    return words_of(advice, best.picture.tags.size());
  }

  static std::string words_of(const ViewAdvice& advice, std::size_t num_tags) {
    const std::size_t more = num_tags - 2;
    return fmt::format(
        "{} pictures that show {} and {} together{}, from {:.2g} m before {}{}: sigma of {} falls {} mm, and "
        "{} degrees",
        advice.pictures, to_string(advice.before), to_string(advice.partner),
        more == 0 ? std::string() : fmt::format(" ({} more in view)", more), advice.distance_m,
        to_string(advice.before), angle_in_words(advice), to_string(advice.tag),
        from_to(1e3 * advice.sigma_before_m, 1e3 * advice.sigma_after_m),
        from_to(advice.sigma_before_rad * kDegPerRad, advice.sigma_after_rad * kDegPerRad));
  }

  const TagMap& map_;
  JointCovariance joint_;  ///< With the pictures that were advised so far.
  const MapEvidence& evidence_;
  int camera_;
  const CameraRig& rig_;
  PictureScene scene_;
  std::vector<Eigen::Index> places_;  ///< In the joint covariance, of each tag of the map.
  bool has_looked_around_ = false;
  std::vector<Prospect> around_;
};

}  // namespace

std::vector<ViewAdvice> advise_views(const TagMap& map, const JointCovariance& joint,
                                     const MapEvidence& evidence, const CameraRig& rig) {
  return Adviser(map, joint, evidence, rig).run();
}

}  // namespace apriltrack
