#pragma once

#include <functional>
#include <string_view>

namespace apriltrack {

enum class LogLevel { kInfo, kWarning };

/// Receives what the library has to say. The library itself never prints.
using LogSink = std::function<void(LogLevel, std::string_view)>;

/// A sink that throws everything away; the default wherever a sink is an option.
LogSink silent_log();

}  // namespace apriltrack
