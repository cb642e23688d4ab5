#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "apriltrack/report/scene_view.h"
#include "apriltrack/report/svg_picture.h"

namespace apriltrack {

/// The first cell of a row names the row. Columns of numbers, units behind them or not, are set flush right.
struct HtmlTable {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
  std::string caption;
};

/// A page that is one file: pictures and videos are inside it (RFC 2397), and it needs no network, which its
/// own policy forbids it to ask for. Only scenes need a script, which is in the page where there is one.
/// Readable on a phone, in print, and in light and dark surroundings. It is well-formed XML too. All text is
/// plain: it is escaped, and what XML cannot hold becomes U+FFFD.
class HtmlPage {
 public:
  explicit HtmlPage(std::string title);

  void heading(const std::string& words);
  void paragraph(const std::string& words);
  /// Requires rows as long as the header.
  void table(const HtmlTable& table);
  /// bytes: a PNG file's. Throws Error(kInvalidInput) when they are not.
  void png(std::string_view bytes, const std::string& caption);
  /// A drawing, in the colours of the page.
  void svg(const SvgPicture& picture, const std::string& caption);
  /// Several beside each other where there is room, below each other where there is not.
  void svg(const std::vector<SvgPicture>& pictures, const std::string& caption);
  /// Something that is turned about by mouse and touch, in WebGL; 0.4 MB for the first one. Where that is not
  /// to be had, the page says so: what it shows is to be on the page in a drawing, too.
  void scene(const SceneView& scene, const std::string& caption);
  /// Things to be heeded, each set off from the text.
  void warnings(const std::vector<std::string>& all);
  /// Sentences, one below the other.
  void list(const std::vector<std::string>& items);
  /// Both read the file now. Throw Error(kIo), and Error(kInvalidInput) when it is no PNG, or no MP4.
  void picture(const std::filesystem::path& png, const std::string& caption);
  void video(const std::filesystem::path& mp4, const std::string& caption);
  /// Commands or program text, kept line by line.
  void code(const std::string& text);

  std::string html() const;

 private:
  void add_png(std::string_view bytes, const std::string& caption, const std::string& name);

  std::string title_;
  std::string body_;
  bool has_scene_ = false;
};

/// Throws Error(kIo).
void write_html_page(const std::filesystem::path& path, const HtmlPage& page);

}  // namespace apriltrack
