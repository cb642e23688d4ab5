#pragma once

#include <string>
#include <utility>
#include <variant>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"

namespace apriltrack {

/// Why views give no map: a normal end of a trial, and no exception.
struct NoMap {
  std::string cause;  ///< For people.

  /// Where it is the end of the calibration, too.
  Error to_error() const { return no_result("calibrate", cause); }
};

/// What was asked for, or why there is none.
template <typename T>
class [[nodiscard]] Outcome {
 public:
  Outcome(T value) : value_(std::move(value)) {}  // NOLINT: both are meant to convert
  Outcome(NoMap why) : value_(std::move(why)) {}  // NOLINT

  explicit operator bool() const { return std::holds_alternative<T>(value_); }
  T& operator*() { return value(); }
  T* operator->() { return &value(); }
  /// Throws Error(kNoResult) where there is none.
  T value_or_throw() && {
    if (!*this) throw why().to_error();
    return std::move(value());
  }
  const NoMap& why() const {
    APRILTRACK_CHECK(!*this, "of an outcome that is there");
    return std::get<NoMap>(value_);
  }

 private:
  T& value() {
    APRILTRACK_CHECK(bool(*this), "no outcome: " + why().cause);
    return std::get<T>(value_);
  }

  std::variant<T, NoMap> value_;
};

}  // namespace apriltrack
