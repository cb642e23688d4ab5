#include "messages/tag_messages.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "apriltrack/base/degrees.h"
#include "faults/tag_places.h"

namespace apriltrack {
namespace {

using Kind = TagFinding::Kind;
using Blame = TagFinding::Blame;
using Boards = std::vector<std::vector<TagKey>>;

std::string message_of_size(const ShapeError& shape, const std::string& name) {
  const double scale = std::exp(shape.log_scale);
  return fmt::format(
      "{} looks {:.1f} % {} than its stated size of {:.4g} m (sigma {:.1f} %): a wrong size was given, or it "
      "was printed at another scale; measure it (about {:.4g} m), and correct its stated size. It is left "
      "out",
      name, 100.0 * std::abs(scale - 1.0), scale > 1.0 ? "larger" : "smaller", shape.size_m,
      100.0 * shape.scale_sigma, scale * shape.size_m);
}

std::string message_of_bend(const ShapeError& shape, bool is_left_out, const std::string& name) {
  std::string what;
  if (shape.is_twist_clear)
    what = fmt::format("its corners lie {:.1f} mm (sigma {:.1f}) before and behind one plane",
                       1e3 * std::abs(shape.twist) * shape.size_m, 1e3 * shape.twist_sigma * shape.size_m);
  if (shape.is_aspect_clear)
    what += fmt::format("{}it is {:.1f} % (sigma {:.1f}) {} than high", what.empty() ? "" : ", and ",
                        100.0 * std::abs(shape.aspect), 100.0 * shape.aspect_sigma,
                        shape.aspect > 0.0 ? "wider" : "narrower");
  return fmt::format(
      "{} is bent, not flat, or was printed unevenly: {}. Fix it to a flat, stiff board; its pose is that of "
      "the plane through its corners{}",
      name, what, is_left_out ? ". It is left out" : "");
}

std::string message_of_two_places(const PlaceChange& places, const std::string& name) {
  return fmt::format(
      "{} is seen at two places, {}, {} apart: its id hangs twice (a duplicate), or it was carried from one "
      "to the other. It is left out: cover one, or give it another id",
      name, places.is_one_after_other ? "one after the other" : "by turns",
      shift_and_turn(places.T_first_second));
}

/// begin: of the recording.
std::string message_of_places(const PlaceChange& places, Timestamp begin, const std::string& name) {
  if (!places.is_one_after_other || places.T_first_second.translation().norm() > kOneObject_m)
    return message_of_two_places(places, name);
  return fmt::format(
      "{} was moved by {} while filming, between {:.2f} and {:.2f} s after the first frame. It is left out: "
      "film again, with all tags fixed",
      name, shift_and_turn(places.T_first_second), seconds_between(begin, places.last_at_first),
      seconds_between(begin, places.first_at_second));
}

std::string message_of_loose(const std::string& name) {
  return fmt::format(
      "{} hangs loosely: it moves from view to view, and no fixed place explains them. It is left out: fix "
      "it to the wall",
      name);
}

/// Of the only tag that joins the two places at which another was found, or one of the board that does.
std::string message_of_joint(const std::string& name, const std::vector<TagKey>& board,
                             const std::string& of_two_places) {
  return fmt::format(
      "{}{} alone joins the two places at which {} is seen: it may be what hangs twice (a duplicate), or was "
      "carried to another place, instead. It is left out: film both together with other tags",
      name, board.size() == 1 ? "" : fmt::format(" (of the board {})", list_tags(board)), of_two_places);
}

std::string any_of(const Boards& joints) {
  constexpr std::size_t kMostNamed = 10;
  std::vector<std::string> names;
  for (const std::vector<TagKey>& tags : joints)
    names.push_back(tags.size() == 1 ? to_string(tags.front())
                                     : fmt::format("the board ({})", list_tags(tags)));
  if (names.size() == 1) return names.front();
  if (names.size() > kMostNamed) {
    names.resize(kMostNamed);
    names.push_back(fmt::format("{} more", joints.size() - kMostNamed));
  }
  return fmt::format("one of {}", fmt::join(names, ", "));
}

/// As the subject of what may be said of any.
std::string one_of(const Boards& joints) {
  return any_of(joints) + (joints.size() == 1 ? ", which" : ", each of which");
}

/// Where another tag may be at fault instead, nothing is said outright.
std::string with_blame(const std::string& message, Blame blame, const Boards& others) {
  switch (blame) {
    case Blame::kThisTag:
    case Blame::kJoinsPlacesOfAnother:
      return message;
    case Blame::kThisOrAnother:
      return fmt::format("Perhaps {}. Or {} at fault: the views do not tell which", message,
                         others.empty() ? "another tag is" : any_of(others) + " is");
    case Blame::kThisOrOthersInMap:
      return fmt::format(
          "Perhaps {}. Or {} alone joins its two places, hangs twice, or was moved: then the map is folded "
          "there. Film them at both places together with others",
          message, one_of(others));
    case Blame::kThisOrOthersNoMap:
      break;
  }
  return fmt::format(
      "Perhaps {}. Or {} alone joins its two places, hangs twice, or was moved, instead: the views do not "
      "tell which; hold neither",
      message, one_of(others));
}

Boards keys_of_boards(const Observations& observations, const std::vector<std::vector<int>>& boards) {
  Boards keys;
  for (const std::vector<int>& board : boards) keys.push_back(keys_of(observations, board));
  return keys;
}

std::string message_of_fault(const Observations& observations, const TagFinding& finding) {
  const std::string name = to_string(key_of(observations, finding.tag));
  if (finding.blame == Blame::kJoinsPlacesOfAnother)
    return message_of_joint(name, keys_of(observations, finding.others.front()),
                            to_string(key_of(observations, finding.joined_tag)));
  switch (finding.kind) {
    case Kind::kSize:
      return message_of_size(*finding.shape, name);
    case Kind::kNotFlat:
      return message_of_bend(*finding.shape, finding.is_left_out, name);
    case Kind::kMoved:
    case Kind::kTwoPlaces:
      return message_of_places(*finding.places, observations.frames.front(), name);
    case Kind::kLoose:
      break;
  }
  return message_of_loose(name);
}

CalibrationFinding::Kind kind_of(Kind kind) {
  switch (kind) {
    case Kind::kSize:
      return CalibrationFinding::Kind::kWrongSize;
    case Kind::kMoved:
      return CalibrationFinding::Kind::kMoved;
    case Kind::kTwoPlaces:
      return CalibrationFinding::Kind::kDuplicateId;
    case Kind::kNotFlat:
      return CalibrationFinding::Kind::kBent;
    case Kind::kLoose:
      break;
  }
  return CalibrationFinding::Kind::kLoose;
}

void set_value(const TagFinding& finding, CalibrationFinding& result) {
  if (finding.places) {
    result.value = finding.places->T_first_second.translation().norm();
    result.unit = "m";
    if (finding.places->is_one_after_other) result.timestamp = finding.places->first_at_second;
    return;
  }
  if (!finding.shape) return;
  const ShapeError& shape = *finding.shape;
  result.unit = "1";
  if (finding.kind == Kind::kSize) {
    result.value = std::exp(shape.log_scale);
    result.sigma = *result.value * shape.scale_sigma;
    return;
  }
  const bool is_aspect =
      shape.is_aspect_clear && (!shape.is_twist_clear || std::abs(shape.aspect) > std::abs(shape.twist));
  result.value = is_aspect ? shape.aspect : shape.twist;
  result.sigma = is_aspect ? shape.aspect_sigma : shape.twist_sigma;
}

}  // namespace

std::string shift_and_turn(const Pose& change) {
  return fmt::format("{:.3g} m and {:.1f} degrees", change.translation().norm(),
                     rotation_angle_rad(change.rotation(), Eigen::Quaterniond::Identity()) * kDegPerRad);
}

std::string message_of(const Observations& observations, const TagFinding& finding) {
  return with_blame(message_of_fault(observations, finding), finding.blame,
                    keys_of_boards(observations, finding.others));
}

CalibrationFinding reported(const Observations& observations, const TagFinding& finding) {
  CalibrationFinding result;
  result.kind = kind_of(finding.kind);
  result.tags = {key_of(observations, finding.tag)};
  set_value(finding, result);
  if (finding.blame == Blame::kJoinsPlacesOfAnother)
    result.alternatives = {{key_of(observations, finding.joined_tag)}};
  else
    result.alternatives = keys_of_boards(observations, finding.others);
  result.log_odds = finding.log_odds;
  result.is_in_doubt = finding.is_in_doubt();
  result.is_left_out = finding.is_left_out;
  result.message = message_of(observations, finding);
  return result;
}

}  // namespace apriltrack
