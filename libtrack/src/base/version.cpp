#include "apriltrack/base/version.h"

#define APRILTRACK_TEXT_OF(number) #number
#define APRILTRACK_TEXT(number) APRILTRACK_TEXT_OF(number)

namespace apriltrack {

const char* version() {
  return APRILTRACK_TEXT(APRILTRACK_VERSION_MAJOR) "." APRILTRACK_TEXT(
      APRILTRACK_VERSION_MINOR) "." APRILTRACK_TEXT(APRILTRACK_VERSION_PATCH);
}

}  // namespace apriltrack
