#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "doctor_findings.h"

namespace apriltrack::app {

/// For people: each recording, the tags, notes and the verdict; warnings have been heard by then.
std::string told_facts(const Facts& facts, std::span<const Finding> findings, const Verdict& verdict);

/// For programs (docs/file_formats.md).
nlohmann::json json_of(const Facts& facts, std::span<const Finding> findings, const Verdict& verdict);

}  // namespace apriltrack::app
