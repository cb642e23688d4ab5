#include "map_loss_words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace apriltrack::app {
namespace {

/// "" of all tags, else " of tags tag36h11/1, ...".
std::string of_tags(const std::vector<TagKey>& tags) {
  if (tags.empty()) return "";
  constexpr std::size_t kMost = 8;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < std::min(kMost, tags.size()); ++i) names.push_back(to_string(tags[i]));
  return fmt::format(" of tag{} {}{}", tags.size() == 1 ? "" : "s", fmt::join(names, ", "),
                     tags.size() > kMost ? ", ..." : "");
}

std::string origin_words(const MapLoss& loss, LossStage stage) {
  constexpr std::string_view kGiveField = "--field-length and --field-width of `map convert` give it";
  const bool to_corner = loss.value == "field";
  if (loss.how == MapLossHow::kConverted)
    return fmt::format("the origin was moved to the field's {}: {} and {} m were added to x and y",
                       to_corner ? "corner" : "centre", loss.shift_m.x(), loss.shift_m.y());
  if (stage == LossStage::kRead)
    return fmt::format("the size of the field is not known, so that the origin stays in its centre; {}",
                       kGiveField);
  return to_corner
             ? fmt::format(
                   "positions are from the field's centre, where the file's reader expects its corner: the "
                   "size of the field is not known; {}",
                   kGiveField)
             : fmt::format(
                   "the map's origin stands for the field's centre, for the size of the field is not known; "
                   "{}",
                   kGiveField);
}

std::string size_words(const MapLoss& loss, std::string_view title) {
  return loss.how == MapLossHow::kGiven
             ? fmt::format("the sizes{} are those that were given: the file states none", of_tags(loss.tags))
             : fmt::format("the sizes{} are left out: a {} has no place for them", of_tags(loss.tags), title);
}

std::string family_words(const MapLoss& loss, std::string_view title) {
  if (loss.how == MapLossHow::kGiven)
    return fmt::format("the family{} is {}, as was given: the file names none", of_tags(loss.tags),
                       loss.value);
  if (loss.how == MapLossHow::kAssumed)
    return fmt::format("the family{} is taken to be {}: the file names none; --family gives another",
                       of_tags(loss.tags), loss.value);
  return fmt::format("the families{}{} are left out: a {} has no place for them", of_tags(loss.tags),
                     loss.value.empty() ? "" : " (" + loss.value + ")", title);
}

std::string covariance_words(const MapLoss& loss, std::string_view title) {
  if (loss.how == MapLossHow::kAssumed)
    return fmt::format("a noise{} was made up, for a {} wants one: {}", of_tags(loss.tags), title,
                       loss.value);
  if (loss.how == MapLossHow::kConverted)
    return fmt::format("covariances{} are written as {}", of_tags(loss.tags), loss.value);
  return fmt::format("covariances{} are left out: a {} holds none", of_tags(loss.tags), title);
}

}  // namespace

std::string sentence_of(const MapLoss& loss, LossStage stage, std::string_view title) {
  switch (loss.kind) {
    case MapLossKind::kSizes:
      return size_words(loss, title);
    case MapLossKind::kFamilies:
      return family_words(loss, title);
    case MapLossKind::kCovariance:
      return covariance_words(loss, title);
    case MapLossKind::kTags:
      return fmt::format("left out: {}", loss.value);
    case MapLossKind::kFrameName:
      return loss.how == MapLossHow::kConverted
                 ? fmt::format("the frame is called {} there", loss.value)
                 : fmt::format("the frame's name, '{}', is left out", loss.value);
    case MapLossKind::kOrigin:
      return origin_words(loss, stage);
    case MapLossKind::kFieldSize:
      return loss.how == MapLossHow::kLeftOut
                 ? "length and width of the field are left out"
                 : "length and width of the field are written as 0, for nobody stated them: poses from the "
                   "red "
                   "alliance's side will be wrong; --field-length and --field-width give them";
    case MapLossKind::kMatrixOrder:
      return "its matrices are written by columns, where the format has rows, and were read so";
    case MapLossKind::kProvenance:
      return "the provenance is left out";
    case MapLossKind::kStatistics:
      return "the tags' statistics are left out";
    case MapLossKind::kExtensions:
      return fmt::format("keys of your own are left out: {}", loss.value);
    case MapLossKind::kForeignKeys:
      return fmt::format("keys that a map has no place for are passed over: {}", loss.value);
  }
  return "";
}

nlohmann::json losses_json(const std::vector<MapLoss>& losses, LossStage stage, std::string_view title) {
  nlohmann::json out = nlohmann::json::array();
  for (const MapLoss& loss : losses) {
    nlohmann::json tags = nlohmann::json::array();
    for (const TagKey& key : loss.tags) tags.push_back(to_string(key));
    out.push_back({{"kind", to_string(loss.kind)},
                   {"how", to_string(loss.how)},
                   {"stage", stage == LossStage::kRead ? "read" : "write"},
                   {"tags", tags},
                   {"message", sentence_of(loss, stage, title)}});
  }
  return out;
}

void tell_losses(const std::vector<MapLoss>& losses, LossStage stage, std::string_view title,
                 const std::string& file, const Console& console) {
  for (const MapLoss& loss : losses) {
    const std::string text = file + ": " + sentence_of(loss, stage, title);
    const bool is_doubtful = loss.how == MapLossHow::kAssumed || loss.how == MapLossHow::kUnknown;
    if (is_doubtful)
      console.warning(text);
    else
      console.info(text);
  }
}

}  // namespace apriltrack::app
