#include "apriltrack/base/log.h"

namespace apriltrack {

LogSink silent_log() {
  return [](LogLevel, std::string_view) {};
}

}  // namespace apriltrack
