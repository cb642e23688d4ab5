#include "apriltrack/report/html_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "apriltrack/base/check.h"
#include "apriltrack/base/error.h"
#include "apriltrack/io/atomic_file.h"
#include "apriltrack/io/input_file.h"
#include "html_text.h"

namespace apriltrack {
namespace {

constexpr std::string_view kStyle = R"(
:root { color-scheme: light dark; --paper: #fff; --ink: #1e2228; --pale: #6b7480; --rule: #dde1e6;
  --tint: #f5f7f9; --accent: #0072b2; --path: #56b4e9; --good: #009e73; --warning: #d55e00; --alarm: #fdf1e8; }
@media (prefers-color-scheme: dark) {
  :root { --paper: #15181c; --ink: #e4e7eb; --pale: #9aa3ad; --rule: #333a42; --tint: #1d2126;
    --accent: #56b4e9; --path: #2b7fb0; --good: #1fbf93; --warning: #f08a3c; --alarm: #2c211a; }
}
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink);
  font: 1rem/1.6 system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", sans-serif;
  -webkit-text-size-adjust: 100%; }
main { max-width: 66rem; margin: 0 auto; padding: 2.5rem 1.25rem 4rem; }
h1 { font-size: 1.9rem; line-height: 1.25; margin: 0 0 1.5rem; padding-bottom: 1rem;
  border-bottom: 3px solid var(--accent); text-wrap: balance; }
h2 { font-size: 1.3rem; line-height: 1.3; margin: 2.75rem 0 .75rem; }
p { max-width: 44rem; margin: 0 0 1rem; overflow-wrap: anywhere; }
figure { margin: 1.5rem 0; }
figure .wide { margin: 0; }
figure img, figure video { display: block; width: 100%; height: auto; border: 1px solid var(--rule);
  border-radius: 8px; background: #fff; }
figure video { background: #000; }
figure svg { display: block; width: 100%; height: auto; }
figure .pair { display: grid; gap: 1.25rem; grid-template-columns: repeat(auto-fit, minmax(20rem, 1fr)); }
.alarm { max-width: 48rem; margin: 0 0 .6rem; padding: .6rem .9rem; background: var(--alarm);
  border-left: 4px solid var(--warning); border-radius: 0 6px 6px 0; overflow-wrap: anywhere; }
ul { max-width: 46rem; margin: 0 0 1rem; padding-left: 1.2rem; }
li { margin: 0 0 .5rem; overflow-wrap: anywhere; }
figcaption, caption { color: var(--pale); font-size: .9rem; overflow-wrap: anywhere; }
figcaption { margin-top: .6rem; max-width: 44rem; }
.wide { overflow-x: auto; margin: 1.5rem 0; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
caption { caption-side: bottom; text-align: left; padding-top: .6rem; }
th, td { padding: .45rem .75rem; text-align: left; vertical-align: top; border-bottom: 1px solid var(--rule); }
thead th { color: var(--pale); font-size: .85rem; font-weight: 600; vertical-align: bottom;
  border-bottom: 2px solid var(--rule); }
tbody th { font-weight: 600; }
.dense th, .dense td { padding: .35rem .5rem; font-size: .88rem; }
.dense caption { max-width: 60rem; }
th:first-child, td:first-child { padding-left: .25rem; }
.number { text-align: right; white-space: nowrap; }
thead .number { white-space: normal; }
pre { margin: 1.5rem 0; padding: .9rem 1.1rem; overflow-x: auto; background: var(--tint);
  border: 1px solid var(--rule); border-radius: 8px;
  font: .88rem/1.55 ui-monospace, "SF Mono", Menlo, Consolas, monospace; }
@media (max-width: 40rem) {
  main { padding: 1.5rem 1rem 3rem; }
  h1 { font-size: 1.5rem; }
  .wide img { min-width: 42rem; }
  th, td { padding: .4rem .6rem; font-size: .9rem; }
}
@media print {
  :root { --paper: #fff; --ink: #000; --pale: #444; --rule: #bbb; --tint: #fff; --accent: #000; --path: #777; --good: #000;
    --warning: #000; --alarm: #fff; }
  main { max-width: none; padding: 0; }
  figure, tr, pre { break-inside: avoid; }
  h2 { break-after: avoid; }
  .alarm { border: 1px solid var(--rule); border-left-width: 4px; }
  .wide { overflow: visible; }
  .wide img { min-width: 0; }
  pre { white-space: pre-wrap; }
  figure video { display: none; }
}
)";

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
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n"
      "<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n<main>\n<h1>{0}</h1>\n{2}</main>\n</body>\n"
      "</html>\n",
      escaped(title_), kStyle, body_);
}

void write_html_page(const std::filesystem::path& path, const HtmlPage& page) {
  write_file_atomically(path, page.html());
}

}  // namespace apriltrack
