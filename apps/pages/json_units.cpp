#include "json_units.h"

#include <string>
#include <string_view>

#include "apriltrack/base/degrees.h"
#include "apriltrack/eval/statistics.h"

namespace apriltrack::app {
namespace {

using nlohmann::json;

constexpr int kOlderDecimals = 4;

struct OlderUnit {
  std::string_view suffix;
  std::string_view older_suffix;
  double factor;
};

constexpr OlderUnit kOlderUnits[] = {{"_m", "_mm", 1e3}, {"_rad", "_deg", kDegPerRad}};

/// A number, or an object of numbers such as {"rms": ..., "max": ...}; what is null stays so.
json scaled(const json& value, double factor) {
  if (value.is_number()) return round_to_decimals(factor * value.get<double>(), kOlderDecimals);
  if (!value.is_object()) return value;
  json out = json::object();
  for (const auto& [key, part] : value.items()) out[key] = scaled(part, factor);
  return out;
}

json older_entries(const json& object) {
  json older = json::object();
  for (const auto& [key, value] : object.items()) {
    for (const OlderUnit& unit : kOlderUnits) {
      if (!key.ends_with(unit.suffix)) continue;
      const std::string name = key.substr(0, key.size() - unit.suffix.size());
      older[name + std::string(unit.older_suffix)] = scaled(value, unit.factor);
    }
  }
  return older;
}

}  // namespace

json with_older_units(json answer) {
  if (!answer.is_structured()) return answer;
  for (json& part : answer) part = with_older_units(std::move(part));
  if (answer.is_object()) answer.update(older_entries(answer));
  return answer;
}

}  // namespace apriltrack::app
