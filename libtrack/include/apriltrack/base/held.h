#pragma once

#include "apriltrack/base/check.h"

namespace apriltrack {

/// What a movable object holds by a unique_ptr. Throws MisuseError where it was moved away.
template <class Pointer>
auto& held(const Pointer& pointer) {
  APRILTRACK_CHECK(pointer != nullptr, "a moved-from object can only be destroyed, or be assigned to");
  return *pointer;
}

}  // namespace apriltrack
