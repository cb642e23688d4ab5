#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "loss_words.h"

namespace apriltrack::app {
namespace {

/// "" of all tags, else " of tags tag36h11/1, ...".
std::string of_tags(const std::vector<std::string>& tags) {
  if (tags.empty()) return "";
  constexpr std::size_t kMost = 8;
  const std::vector<std::string> names(
      tags.begin(), tags.begin() + static_cast<std::ptrdiff_t>(std::min(kMost, tags.size())));
  return fmt::format(" of tag{} {}{}", tags.size() == 1 ? "" : "s", fmt::join(names, ", "),
                     tags.size() > kMost ? ", ..." : "");
}

std::string origin_words(const ConversionLoss& loss, ConversionStep::Stage stage) {
  constexpr std::string_view kGiveField = "--field-length and --field-width of `map convert` give it";
  const bool to_corner = loss.value == "field";
  if (loss.how == LossHow::kConverted)
    return fmt::format("the origin was moved to the field's {}: {} and {} m were added to x and y",
                       to_corner ? "corner" : "centre", loss.numbers.at(0), loss.numbers.at(1));
  if (stage == ConversionStep::Stage::kRead)
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

std::string size_words(const ConversionLoss& loss, std::string_view title) {
  return loss.how == LossHow::kGiven
             ? fmt::format("the sizes{} are those that were given: the file states none", of_tags(loss.which))
             : fmt::format("the sizes{} are left out: a {} has no place for them", of_tags(loss.which),
                           title);
}

std::string family_words(const ConversionLoss& loss, std::string_view title) {
  if (loss.how == LossHow::kGiven)
    return fmt::format("the family{} is {}, as was given: the file names none", of_tags(loss.which),
                       loss.value);
  if (loss.how == LossHow::kAssumed)
    return fmt::format("the family{} is taken to be {}: the file names none; --family gives another",
                       of_tags(loss.which), loss.value);
  return fmt::format("the families{}{} are left out: a {} has no place for them", of_tags(loss.which),
                     loss.value.empty() ? "" : " (" + loss.value + ")", title);
}

std::string covariance_words(const ConversionLoss& loss, std::string_view title) {
  if (loss.how == LossHow::kAssumed)
    return fmt::format("a noise{} was made up, for a {} wants one: {}", of_tags(loss.which), title,
                       loss.value);
  if (loss.how == LossHow::kConverted)
    return fmt::format("covariances{} are written as {}", of_tags(loss.which), loss.value);
  if (!loss.value.empty())
    return fmt::format("covariances{} are left out: {}", of_tags(loss.which), loss.value);
  return fmt::format("covariances{} are left out: a {} holds none", of_tags(loss.which), title);
}

}  // namespace

std::string sentence_of_map_loss(const ConversionLoss& loss, const ConversionStep& step) {
  switch (loss.kind) {
    case LossKind::kSizes:
      return size_words(loss, step.title);
    case LossKind::kFamilies:
      return family_words(loss, step.title);
    case LossKind::kCovariance:
      return covariance_words(loss, step.title);
    case LossKind::kTags:
      return fmt::format("left out: {}", loss.value);
    case LossKind::kFrameName:
      return loss.how == LossHow::kConverted ? fmt::format("the frame is called {} there", loss.value)
                                             : fmt::format("the frame's name, '{}', is left out", loss.value);
    case LossKind::kOrigin:
      return origin_words(loss, step.stage);
    case LossKind::kFieldSize:
      return loss.how == LossHow::kLeftOut
                 ? "length and width of the field are left out"
                 : "length and width of the field are written as 0, for nobody stated them: poses from the "
                   "red alliance's side will be wrong; --field-length and --field-width give them";
    case LossKind::kMatrixOrder:
      return "its matrices are written by columns, where the format has rows, and were read so";
    case LossKind::kProvenance:
      return "the provenance is left out";
    case LossKind::kStatistics:
      return "the tags' statistics are left out";
    case LossKind::kExtensions:
      return fmt::format("keys of your own are left out: {}", loss.value);
    case LossKind::kForeignKeys:
      return fmt::format("keys that a map has no place for are passed over: {}", loss.value);
    default:
      break;
  }
  return "";
}

}  // namespace apriltrack::app
