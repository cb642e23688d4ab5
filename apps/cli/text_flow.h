#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace apriltrack::app {

/// Words of `text` in lines of at most `width` characters (UTF-8) where words allow; every line but the first
/// begins with `indent` blanks. first_column: where the first line begins, whose blanks are already there.
std::string wrapped(const std::string& text, std::size_t width, std::size_t indent, std::size_t first_column);

/// A block of text: lines that flow become one, an empty line and one that begins with blanks stay as they
/// are.
std::vector<std::string> flowing_lines(const std::string& text);

/// Columns of the terminal that stdout is, 100 at most and where it is none.
std::size_t terminal_width();

}  // namespace apriltrack::app
