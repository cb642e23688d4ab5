#pragma once

namespace apriltrack::app {

/// What an option's value, or a word without an option, is; tells a shell what to offer.
enum class ValueKind { kNone, kText, kFile, kFolder, kInput, kChoice };

}  // namespace apriltrack::app
