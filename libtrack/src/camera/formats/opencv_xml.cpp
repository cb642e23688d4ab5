// cv::FileStorage as XML (opencv/opencv: modules/core/src/persistence_xml.cpp): elements of elements or of
// text,
// <_> for the items of a list, matrices with rows, cols, dt and data. It becomes YAML of the same lines,
// which the reader of the YAML form understands.

#include <fmt/format.h>

#include <algorithm>

#include "apriltrack/base/error.h"
#include "apriltrack/io/numbers.h"
#include "formats.h"
#include "lines.h"

namespace apriltrack {
namespace {

constexpr int kMaxXmlDepth = 32;  // of a camera file: 3

class XmlToYaml {
 public:
  explicit XmlToYaml(const CameraText& file) : file_(file) {}

  std::string convert() {
    skip_blanks();
    if (at("<?xml")) skip_past("?>");
    skip_blanks();
    if (open_tag() != "opencv_storage")
      fail("the first element must be <opencv_storage>, as cv::FileStorage writes it");
    contents("opencv_storage", 0);
    return yaml_;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    const auto line =
        1 + std::count(file_.text.begin(), file_.text.begin() + static_cast<std::ptrdiff_t>(place_), '\n');
    throw invalid_input(fmt::format("{}:{}", file_.name, line), fmt::format("is XML, but {}", what));
  }
  bool at(std::string_view text) const { return file_.text.compare(place_, text.size(), text) == 0; }
  /// To just behind `end`; lines are kept.
  std::string skip_past(std::string_view end) {
    const std::size_t found = file_.text.find(end, place_);
    if (found == std::string::npos) fail(fmt::format("'{}' is missing", end));
    const std::string passed = file_.text.substr(place_, found - place_);
    yaml_.append(static_cast<std::size_t>(std::count(passed.begin(), passed.end(), '\n')), '\n');
    place_ = found + end.size();
    return passed;
  }
  void skip_blanks() {
    for (; place_ < file_.text.size(); ++place_) {
      const char c = file_.text[place_];
      if (c == '\n') yaml_ += '\n';
      if (std::string_view(" \t\r\n").find(c) != std::string_view::npos) continue;
      if (!at("<!--")) return;
      skip_past("-->");
      --place_;  // the loop steps on
    }
  }
  /// Name of the element that begins here; attributes say what its children say as well.
  std::string open_tag() {
    if (!at("<") || at("</")) fail("an element must begin here");
    ++place_;
    const std::string tag = skip_past(">");
    return tag.substr(0, tag.find_first_of(" \t\r\n"));
  }
  void contents(const std::string& name, int depth) {
    if (depth > kMaxXmlDepth) fail("elements lie too deep in each other");
    skip_blanks();
    const bool has_elements = at("<") && !at("</");
    if (has_elements)
      elements(depth);
    else
      text(name);
    if (skip_past(">") != fmt::format("</{}", name)) fail(fmt::format("</{}> must stand here", name));
  }
  void elements(int depth) {
    const bool is_list = at("<_>");
    yaml_ += is_list ? "[" : "{";
    for (int i = 0; at("<") && !at("</"); ++i) {
      if (i > 0) yaml_ += ", ";
      const std::string name = open_tag();
      if (!is_list) yaml_ += fmt::format("\"{}\": ", name);
      contents(name, depth + 1);
      skip_blanks();
    }
    yaml_ += is_list ? "]" : "}";
  }
  void text(const std::string& name) {
    const std::size_t end = std::min(file_.text.find('<', place_), file_.text.size());
    const std::vector<std::string> words =
        words_of(std::string_view(file_.text).substr(place_, end - place_));
    if (name == "data") {
      yaml_ += fmt::format("[{}]", fmt::join(words, ", "));
    } else {
      const std::string whole = fmt::format("{}", fmt::join(words, " "));
      yaml_ += parse_double(whole) ? whole : quoted_text(whole);
    }
    yaml_.append(
        static_cast<std::size_t>(std::count(file_.text.begin() + static_cast<std::ptrdiff_t>(place_),
                                            file_.text.begin() + static_cast<std::ptrdiff_t>(end), '\n')),
        '\n');
    place_ = end;
  }
  static std::string quoted_text(const std::string& text) {
    std::string quoted = "'";
    for (const char c : text) quoted += c == '\'' ? "''" : std::string(1, c);
    return quoted + "'";
  }

  const CameraText& file_;
  std::size_t place_ = 0;
  std::string yaml_;
};

}  // namespace

bool is_opencv_xml(const CameraText& file) {
  const std::size_t first = file.text.find_first_not_of(" \t\r\n");
  return first != std::string::npos && file.text[first] == '<';
}

YamlNode opencv_xml_tree(const CameraText& file) {
  return YamlNode::read_text(XmlToYaml(file).convert(), file.name);
}

}  // namespace apriltrack
