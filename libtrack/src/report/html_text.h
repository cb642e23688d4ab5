#pragma once

#include <string>
#include <string_view>

namespace apriltrack {

/// Plain text as HTML and XML alike write it, between tags or within quotes. What is no character of XML 1.0
/// (broken UTF-8, most control characters) becomes U+FFFD.
std::string escaped(std::string_view text);

/// Whether a table's cell is a number, be it with a unit ("0.5 px", "99 %"), or stands for one ("-", "",
/// "- (of 3)").
bool is_number_or_blank(std::string_view cell);

}  // namespace apriltrack
