#include "field.h"

#include <fmt/format.h>

#include <cmath>

#include "apriltrack/base/error.h"
#include "apriltrack/io/numbers.h"
#include "formats.h"
#include "map_words.h"

namespace apriltrack {
namespace {

bool is_field_length(double length_m) {
  return std::isfinite(length_m) && length_m > 0.0;
}

/// nullopt where a user's own x_field says something else.
std::optional<double> number_in(const YamlNode& node, std::string_view key) {
  const auto value = node.find(key);
  if (!value || !value->is_scalar()) return std::nullopt;
  const auto number = parse_double(value->as_string());
  return number && is_field_length(*number) ? number : std::nullopt;
}

}  // namespace

FieldFacts field_of(const TagMap& map) {
  FieldFacts facts;
  for (const auto& [name, text] : map.extensions) {
    if (name != kFieldExtension) continue;
    const YamlNode node = YamlNode::read_text(text, std::string(kFieldExtension));
    if (!node.is_map()) continue;
    const auto length_m = number_in(node, "length_m");
    const auto width_m = number_in(node, "width_m");
    if (length_m && width_m) facts.size = FieldSize{*length_m, *width_m};
    if (const auto type = node.find("type"); type && type->is_scalar()) facts.type = type->as_string();
  }
  return facts;
}

void set_field(TagMap& map, const FieldFacts& field) {
  std::string text;
  if (field.size)
    text = fmt::format("length_m: {}, width_m: {}", format_exact(field.size->length_m),
                       format_exact(field.size->width_m));
  if (!field.type.empty()) text += (text.empty() ? "type: " : ", type: ") + quoted_text(field.type);
  if (!text.empty()) map.extensions.emplace_back(kFieldExtension, "{" + text + "}");
}

std::optional<FieldSize> agreed_field(const std::optional<FieldSize>& own, const MapPlace& place,
                                      const std::optional<FieldSize>& given) {
  if (!own || (own->length_m == 0.0 && own->width_m == 0.0)) return given;
  if (!is_field_length(own->length_m) || !is_field_length(own->width_m))
    place.fail(fmt::format("length and width of a field must be > 0 metres (are {} and {})", own->length_m,
                           own->width_m));
  if (given &&
      (std::abs(given->length_m - own->length_m) > 1e-9 || std::abs(given->width_m - own->width_m) > 1e-9))
    place.fail(
        fmt::format("the field is {} m x {} m here, and {} m x {} m by --field-length and --field-width: "
                    "leave these out, or give the same",
                    own->length_m, own->width_m, given->length_m, given->width_m));
  return own;
}

Eigen::Vector3d centre_of(const FieldSize& field) {
  return {0.5 * field.length_m, 0.5 * field.width_m, 0.0};
}

TagMap with_origin(const TagMap& map, const char* frame, const std::optional<FieldSize>& field,
                   std::vector<ConversionLoss>& losses) {
  const bool is_centred = map.frame == kFieldCentreFrame;
  const bool wants_centre = frame == std::string_view(kFieldCentreFrame);
  if (is_centred == wants_centre) return map;
  ConversionLoss loss{.kind = LossKind::kOrigin, .how = LossHow::kUnknown, .value = frame};
  TagMap moved = map;
  if (field) {
    loss.how = LossHow::kConverted;
    const Eigen::Vector3d shift_m = wants_centre ? Eigen::Vector3d(-centre_of(*field)) : centre_of(*field);
    loss.numbers = {shift_m.x(), shift_m.y(), shift_m.z()};
    for (MapTag& tag : moved.tags)
      tag.T_map_tag = Pose(tag.T_map_tag.rotation(), tag.T_map_tag.translation() + shift_m);
    moved.frame = frame;
  }
  losses.push_back(loss);
  return moved;
}

std::optional<StatedField> stated_field(const TagMap& map) {
  const std::optional<FieldSize> size = field_of(map).size;
  if (!size) return std::nullopt;
  if (map.frame == kFieldFrame) return StatedField{*size, centre_of(*size).head<2>()};
  if (map.frame == kFieldCentreFrame) return StatedField{*size, Eigen::Vector2d::Zero()};
  return std::nullopt;
}

}  // namespace apriltrack
