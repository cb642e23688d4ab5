#include "apriltrack/report/html_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"
#include "apriltrack/io/atomic_file.h"
#include "apriltrack/io/base64.h"
#include "apriltrack/io/input_file.h"
#include "html_text.h"
#include "page_style.h"
#include "scene_viewer.h"

namespace apriltrack {
namespace {

std::string data_url(std::string_view type, std::string_view bytes) {
  return fmt::format("data:{};base64,{}", type, base64(bytes));
}

std::string figure_of(const std::string& medium, const std::string& caption) {
  const std::string below =
      caption.empty() ? "" : fmt::format("<figcaption>{}</figcaption>\n", escaped(caption));
  return fmt::format("<figure>\n<div class=\"wide\">{}</div>\n{}</figure>\n", medium, below);
}

bool is_column_of_numbers(const HtmlTable& table, std::size_t column) {
  return std::ranges::all_of(
             table.rows,
             [&](const std::vector<std::string>& row) { return is_number_or_blank(row[column]); }) &&
         !table.rows.empty();
}

std::string cell_of(const std::string& words, std::size_t column, bool is_header, bool is_number) {
  const bool is_name = column == 0 || is_header;
  const std::string scope = is_header ? " scope=\"col\"" : is_name ? " scope=\"row\"" : "";
  return fmt::format("<{0}{1}{2}>{3}</{0}>", is_name ? "th" : "td", scope,
                     is_number ? " class=\"number\"" : "", escaped(words));
}

/// Pictures and scripts are the page's own, and it asks for nothing else.
constexpr std::string_view kPolicy =
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:; media-src "
    "data:";

/// To an HTML parser the marks are comments of the script, to an XML parser they hold what is between them.
std::string viewer_element() {
  return "<script>/*<![CDATA[*/\n" + scene_viewer_script() + "\n/*]]>*/</script>\n";
}

}  // namespace

HtmlPage::HtmlPage(std::string title) : title_(std::move(title)) {}

void HtmlPage::heading(const std::string& words) {
  body_ += fmt::format("<h2>{}</h2>\n", escaped(words));
}

void HtmlPage::paragraph(const std::string& words) {
  body_ += fmt::format("<p>{}</p>\n", escaped(words));
}

void HtmlPage::code(const std::string& text) {
  body_ += fmt::format("<pre><code>{}</code></pre>\n", escaped(text));
}

void HtmlPage::table(const HtmlTable& table) {
  APRILTRACK_CHECK(!table.header.empty(), "a table has at least one column");
  for (const auto& row : table.rows)
    APRILTRACK_CHECK(row.size() == table.header.size(), "a table's rows are as long as its header");
  const auto row_of = [&](const std::vector<std::string>& cells, bool is_header) {
    std::string line = "<tr>";
    for (std::size_t i = 0; i < cells.size(); ++i)
      line += cell_of(cells[i], i, is_header, i > 0 && is_column_of_numbers(table, i));
    return line + "</tr>\n";
  };
  constexpr std::size_t kManyColumns =
      10;  // more than the page is wide, if they stood as far apart as others
  body_ += table.header.size() < kManyColumns ? "<div class=\"wide\"><table>\n"
                                              : "<div class=\"wide\"><table class=\"dense\">\n";
  if (!table.caption.empty()) body_ += fmt::format("<caption>{}</caption>\n", escaped(table.caption));
  body_ += "<thead>\n" + row_of(table.header, true) + "</thead>\n<tbody>\n";
  for (const auto& row : table.rows) body_ += row_of(row, false);
  body_ += "</tbody>\n</table></div>\n";
}

void HtmlPage::png(std::string_view bytes, const std::string& caption) {
  add_png(bytes, caption, "picture");
}

void HtmlPage::picture(const std::filesystem::path& png, const std::string& caption) {
  add_png(read_file(png, kMaxPictureBytes), caption, png.string());
}

void HtmlPage::add_png(std::string_view bytes, const std::string& caption, const std::string& name) {
  if (!bytes.starts_with("\x89PNG\r\n\x1A\n"))
    throw invalid_input(name, "is no PNG picture, which is what a page can hold");
  body_ += figure_of(
      fmt::format("<img alt=\"{}\" src=\"{}\"/>", escaped(caption), data_url("image/png", bytes)), caption);
}

void HtmlPage::video(const std::filesystem::path& mp4, const std::string& caption) {
  const std::string bytes = read_file(mp4, kMaxPictureBytes);
  constexpr std::size_t kTypeAt = 4;  // ISO/IEC 14496-12: a box begins with its length
  if (bytes.size() < 8 || bytes.compare(kTypeAt, 4, "ftyp") != 0)
    throw invalid_input(mp4.string(), "is no MP4 video, which is what a page can hold");
  body_ += figure_of(fmt::format("<video controls=\"controls\" loop=\"loop\" muted=\"muted\" "
                                 "playsinline=\"playsinline\" aria-label=\"{}\" src=\"{}\"></video>",
                                 escaped(caption), data_url("video/mp4", bytes)),
                     caption);
}

void HtmlPage::svg(const SvgPicture& picture, const std::string& caption) {
  body_ += figure_of(picture.element(caption), caption);
}

void HtmlPage::svg(const std::vector<SvgPicture>& pictures, const std::string& caption) {
  std::string all;
  for (const SvgPicture& picture : pictures) all += picture.element(caption) + "\n";
  body_ += fmt::format("<figure>\n<div class=\"pair\">{}</div>\n<figcaption>{}</figcaption>\n</figure>\n",
                       all, escaped(caption));
}

void HtmlPage::scene(const SceneView& scene, const std::string& caption) {
  has_scene_ = true;
  body_ += fmt::format(
      "<figure class=\"scene\">\n<div class=\"view\"><canvas tabindex=\"0\" aria-label=\"{0}\"></canvas>"
      "<p class=\"why\">The 3-D view needs a browser with WebGL and scripts. The drawings of the page show "
      "the "
      "same.</p><div class=\"tip\" hidden=\"hidden\"></div></div>\n<div class=\"controls\"></div>\n"
      "<script type=\"application/json\">{1}</script>\n<figcaption>{0}</figcaption>\n</figure>\n",
      escaped(caption), scene_json(scene));
}

void HtmlPage::warnings(const std::vector<std::string>& all) {
  for (const std::string& words : all) body_ += fmt::format("<p class=\"alarm\">{}</p>\n", escaped(words));
}

void HtmlPage::list(const std::vector<std::string>& items) {
  if (items.empty()) return;
  body_ += "<ul>\n";
  for (const std::string& item : items) body_ += fmt::format("<li>{}</li>\n", escaped(item));
  body_ += "</ul>\n";
}

std::string HtmlPage::html() const {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"{4}\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n"
      "<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n<main>\n<h1>{0}</h1>\n{2}</main>\n{3}</"
      "body>\n"
      "</html>\n",
      escaped(title_), page_style(), body_, has_scene_ ? viewer_element() : "", kPolicy);
}

void write_html_page(const std::filesystem::path& path, const HtmlPage& page) {
  write_file_atomically(path, page.html());
}

}  // namespace apriltrack
