#include "tag_fault_words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "apriltrack/base/degrees.h"

namespace apriltrack {
namespace {

std::string words_of_two(const TwoPlaces& two, const std::string& when, const std::string& name) {
  return fmt::format(
      "{} is seen at two places, {}, {} apart: its id hangs twice (a duplicate), or it was carried from one "
      "to the other. It is left out: cover one, or give it another id",
      name, when, shift_and_turn(two.change()));
}

/// As the subject of what may be said of any.
std::string one_of(const std::vector<std::vector<TagKey>>& joints) {
  constexpr std::size_t kMostNamed = 10;
  std::vector<std::string> names;
  for (const std::vector<TagKey>& tags : joints)
    names.push_back(tags.size() == 1 ? to_string(tags.front())
                                     : fmt::format("the board ({})", list_tags(tags)));
  if (names.size() == 1) return names.front() + ", which";
  if (names.size() > kMostNamed) {
    names.resize(kMostNamed);
    names.push_back(fmt::format("{} more", joints.size() - kMostNamed));
  }
  return fmt::format("one of {}, each of which", fmt::join(names, ", "));
}

/// Nothing that is in doubt is said outright.
std::string perhaps(const std::string& words) {
  const std::string word = "Perhaps ";
  return words.starts_with(word) ? words : word + words;
}

}  // namespace

std::string shift_and_turn(const Pose& change) {
  return fmt::format("{:.3g} m and {:.1f} degrees", change.translation().norm(),
                     rotation_angle_rad(change.rotation(), Eigen::Quaterniond::Identity()) * kDegPerRad);
}

std::string words_of_size(const TagFit& scaled, const std::string& name) {
  const double scale = std::exp(scaled.shape.log_scale);
  return fmt::format(
      "{} looks {:.1f} % {} than its stated size of {:.4g} m (sigma {:.1f} %): a wrong size was given, or it "
      "was printed at another scale; measure it (about {:.4g} m), and correct --tag-size or --tag-sizes. It "
      "is left out",
      name, 100.0 * std::abs(scale - 1.0), scale > 1.0 ? "larger" : "smaller", scaled.shape.size_m,
      100.0 * scaled.scale_sigma, scale * scaled.shape.size_m);
}

std::string words_of_bend(const TagFit& bent, const std::string& name) {
  const TagShape& shape = bent.shape;
  std::string what;
  if (bent.is_twist_clear)
    what = fmt::format("its corners lie {:.1f} mm (sigma {:.1f}) before and behind one plane",
                       1e3 * std::abs(shape.twist) * shape.size_m, 1e3 * bent.twist_sigma * shape.size_m);
  if (bent.is_aspect_clear)
    what += fmt::format("{}it is {:.1f} % (sigma {:.1f}) {} than high", what.empty() ? "" : ", and ",
                        100.0 * std::abs(shape.aspect), 100.0 * bent.aspect_sigma,
                        shape.aspect > 0.0 ? "wider" : "narrower");
  if (bent.is_clear_together)
    what +=
        "; by itself that may be chance, but scale, aspect and twist together are off as they are in one "
        "sound tag of 7,000";
  return fmt::format(
      "{} is bent, not flat, or was printed unevenly: {}. Fix it to a flat, stiff board; its pose is that of "
      "the plane through its corners",
      name, what);
}

std::string words_of_move(const TwoPlaces& two, const std::vector<ProbeView>& probes, Timestamp begin,
                          const std::string& name) {
  if (two.change().translation().norm() > kOneObject_m) return words_of_two(two, "one after the other", name);
  const auto second = std::ranges::find(two.is_at_second, true) - two.is_at_second.begin();
  const ProbeView& before = probes[static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, second - 1))];
  const ProbeView& after = probes[static_cast<std::size_t>(second)];
  return fmt::format(
      "{} was moved by {} while filming, between {:.2f} and {:.2f} s after the first frame. It is left out: "
      "film again, with all tags fixed",
      name, shift_and_turn(two.change()), seconds_between(begin, before.timestamp),
      seconds_between(begin, after.timestamp));
}

std::string words_of_copies(const TwoPlaces& two, const std::string& name) {
  return words_of_two(two, "by turns", name);
}

std::string words_of_loose(const std::string& name) {
  return fmt::format(
      "{} hangs loosely: it moves from view to view, and no fixed place explains them. It is left out: fix "
      "it to the wall",
      name);
}

std::string words_of_rival(const std::string& words) {
  const std::string another = ". Or another tag is at fault: the views do not tell which";
  return words.ends_with(another) ? words : perhaps(words) + another;
}

std::string words_of_rivals_in_map(const std::string& words, const std::vector<std::vector<TagKey>>& others) {
  const std::string way_out = ": then the map is folded there. Film them at both places together with others";
  if (words.ends_with(way_out)) return words;
  return fmt::format("{}. Or {} alone joins its two places, hangs twice, or was moved{}", perhaps(words),
                     one_of(others), way_out);
}

std::string words_of_rivals_instead(const std::string& words,
                                    const std::vector<std::vector<TagKey>>& others) {
  return fmt::format(
      "{}. Or {} alone joins its two places, hangs twice, or was moved, instead: the views do "
      "not tell which; hold neither",
      perhaps(words), one_of(others));
}

std::string words_of_joint(const std::string& name, const std::vector<TagKey>& board,
                           const std::string& of_two_places) {
  return fmt::format(
      "{}{} alone joins the two places at which {} is seen: it may be what hangs twice (a duplicate), or was "
      "carried to another place, instead. It is left out: film both together with other tags",
      name, board.size() == 1 ? "" : fmt::format(" (of the board {})", list_tags(board)), of_two_places);
}

}  // namespace apriltrack
