#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apriltrack/calib/map_constraints.h"
#include "apriltrack/report/html_page.h"

namespace apriltrack::app {

/// For --json: what each constraint says, and what all else says without it.
nlohmann::json told_constraints(const std::vector<ConstraintAudit>& audits);

/// A line for each constraint, begun by a new line; empty without constraints.
std::string constraint_table(const std::vector<ConstraintAudit>& audits);

/// For the report: each number that was measured, and what all else says of it.
HtmlTable constraints_table(const std::vector<ConstraintAudit>& audits);

}  // namespace apriltrack::app
