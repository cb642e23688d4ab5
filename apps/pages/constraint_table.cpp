#include "constraint_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apriltrack/base/degrees.h"
#include "apriltrack/report/lengths.h"

namespace apriltrack::app {
namespace {

nlohmann::json or_null(const std::optional<double>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json(nullptr);
}

nlohmann::json told_reading(const ConstraintReading& reading) {
  return {{"name", reading.name},
          {"unit", reading.unit},
          {"measured", reading.measured},
          {"predicted", or_null(reading.predicted)},
          {"sigma", or_null(reading.sigma)}};
}

std::string in_words(double value, const std::string& unit) {
  if (unit == "m") return length_in_words(value);
  if (unit == "rad") return fmt::format("{:.5g} degrees", kDegPerRad * value);
  return fmt::format("{:.5g} {}", value, unit);
}

/// Of the number that differs most.
std::string difference_in_words(const ConstraintAudit& audit) {
  const std::string unused = audit.is_used ? "" : "not used: " + audit.reason;
  if (!audit.is_used && !audit.z) return unused;
  const std::string so = audit.is_used ? "" : unused + ": ";
  const auto worst = std::ranges::max_element(audit.readings, {}, &ConstraintReading::sigmas_off);
  if (!audit.z) return "nothing else tells";
  if (worst == audit.readings.end() || !worst->sigma)
    return fmt::format("{}all its numbers together, {:.1f} sigmas", so, *audit.z);
  const double difference = worst->measured - *worst->predicted;
  const std::string words =
      worst->unit == "rad"
          ? fmt::format("{:+.3f} deg (sigma {:.3f})", kDegPerRad * difference, kDegPerRad * *worst->sigma)
          : fmt::format("{:+.2f} mm (sigma {:.2f})", 1e3 * difference, 1e3 * *worst->sigma);
  return fmt::format("{}{} {}, {:.1f} sigmas", so, worst->name, words, *audit.z);
}

}  // namespace

nlohmann::json told_constraints(const std::vector<ConstraintAudit>& audits) {
  nlohmann::json list = nlohmann::json::array();
  for (const ConstraintAudit& audit : audits) {
    nlohmann::json one = {
        {"name", audit.title}, {"type", audit.type}, {"used", audit.is_used}, {"z", or_null(audit.z)}};
    one["tags"] = nlohmann::json::array();
    for (const TagKey& tag : audit.tags) one["tags"].push_back(to_string(tag));
    one["readings"] = nlohmann::json::array();
    for (const ConstraintReading& reading : audit.readings) one["readings"].push_back(told_reading(reading));
    if (!audit.is_used) one["reason"] = audit.reason;
    list.push_back(std::move(one));
  }
  return list;
}

std::string constraint_table(const std::vector<ConstraintAudit>& audits) {
  std::size_t width = 0;
  for (const ConstraintAudit& audit : audits) width = std::max(width, audit.title.size());
  std::string text;
  for (const ConstraintAudit& audit : audits)
    text += fmt::format("\n{}{:<{}}  {}",
                        text.empty() ? "constraints, measured less what all else says:\n  " : "  ",
                        audit.title, width, difference_in_words(audit));
  return text;
}

HtmlTable constraints_table(const std::vector<ConstraintAudit>& audits) {
  HtmlTable table{{"constraint", "what", "measured", "without it", "sigma", "sigmas off"},
                  {},
                  "What was measured, and what the images and the other constraints say without it. Sigma is "
                  "that of the difference."};
  for (const ConstraintAudit& audit : audits) {
    if (!audit.is_used) {
      table.rows.push_back({audit.title, "not used: " + audit.reason, "-", "-", "-", "-"});
      continue;
    }
    for (const ConstraintReading& reading : audit.readings) {
      const auto number = [&](const std::optional<double>& value) {
        return value ? in_words(*value, reading.unit) : std::string("-");
      };
      table.rows.push_back({audit.title, reading.name, number(reading.measured), number(reading.predicted),
                            number(reading.sigma),
                            reading.sigma ? fmt::format("{:.1f}", reading.sigmas_off())
                            : audit.z     ? fmt::format("together {:.1f}", *audit.z)
                                          : "nothing else tells"});
    }
  }
  return table;
}

}  // namespace apriltrack::app
