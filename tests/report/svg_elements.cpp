#include "svg_elements.h"

#include <cctype>
#include <cstdlib>
#include <limits>

namespace apriltrack::test {
namespace {

/// ` a="b" c="d"`.
std::map<std::string, std::string> attributes_in(const std::string& text) {
  std::map<std::string, std::string> attributes;
  for (std::size_t at = text.find('='); at != std::string::npos; at = text.find('=', at)) {
    const std::size_t name = text.rfind(' ', at) + 1, end = text.find('"', at + 2);
    attributes[text.substr(name, at - name)] = text.substr(at + 2, end - at - 2);
    at = end;
  }
  return attributes;
}

}  // namespace

double SvgElement::number(const std::string& attribute) const {
  const auto found = attributes.find(attribute);
  return found == attributes.end() ? std::numeric_limits<double>::quiet_NaN() : std::stod(found->second);
}

std::vector<Eigen::Vector2d> SvgElement::points(const std::string& attribute) const {
  std::vector<Eigen::Vector2d> all;
  const auto found = attributes.find(attribute);
  if (found == attributes.end()) return all;
  for (const char* at = found->second.c_str(); *at != '\0';) {
    if (*at == 'h') {  // and the 0 behind it: a line of no length
      at += 2;
    } else if (*at == '-' || std::isdigit(static_cast<unsigned char>(*at)) != 0) {
      char* end = nullptr;
      const double x = std::strtod(at, &end);
      const double y = std::strtod(end + 1, &end);
      all.emplace_back(x, y);
      at = end;
    } else {
      ++at;
    }
  }
  return all;
}

std::vector<SvgElement> svg_elements(const SvgPicture& picture) {
  const std::string text = picture.element("");
  std::vector<SvgElement> elements;
  std::string of_group;
  for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at + 1)) {
    const bool is_end = text[at + 1] == '/';
    const std::size_t name = at + (is_end ? 2 : 1), name_end = text.find_first_of(" />", name);
    SvgElement element{text.substr(name, name_end - name), {}, of_group};
    element.attributes = attributes_in(text.substr(name_end, text.find('>', name_end) - name_end));
    if (element.attributes.contains("style")) element.style = element.attributes["style"];
    if (element.name == "g") of_group = is_end ? "" : element.style;
    if (!is_end && element.name != "g" && element.name != "svg") elements.push_back(std::move(element));
  }
  return elements;
}

}  // namespace apriltrack::test
