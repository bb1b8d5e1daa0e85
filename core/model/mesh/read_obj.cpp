// Wavefront OBJ: v, f (v, v/vt, v//vn, v/vt/vn; negative indices count back from the vertices so far), l; a line that ends
// with \ goes on in the next one. Objects (o) and groups (g) name the faces and lines that follow. An object ends the groups that
// vertices, faces or lines came after; a g line that stands before it alone goes on. What draws is read past (vt unless it is requested),
// lines of words that OBJ does not have are counted.
#include <algorithm>
#include <optional>

#include "core/base/input/names.hpp"
#include "core/base/input/text_scanner.hpp"
#include "core/model/mesh/raw_mesh.hpp"

namespace bb {
namespace {

using Words = std::vector<std::string_view>;

constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
constexpr std::size_t most_groups = 1000;  // that one g line names; bounds what a line can cost

/// A name in UTF-8; other bytes are taken as Latin-1.
std::string name_in_utf8(std::string_view name) {
  if (is_utf8(name)) return std::string(name);
  std::string out;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80) {
      out += c;
    } else {
      out += static_cast<char>(0xC0 | (byte >> 6));
      out += static_cast<char>(0x80 | (byte & 0x3F));
    }
  }
  return out;
}

/// Texture, normals, materials and display: nothing of a surface.
bool is_read_past(std::string_view word) {
  static const std::set<std::string_view> known{"vt",     "vn",       "vp",       "s",          "mg",
                                                "usemtl", "mtllib",   "usemap",   "maplib",     "lod",
                                                "bevel",  "c_interp", "d_interp", "shadow_obj", "trace_obj",
                                                "ctech",  "stech",    "call",     "csh"};
  return known.contains(word);
}

/// Curves and surfaces that are no polygons.
bool is_free_form(std::string_view word) {
  static const std::set<std::string_view> known{"cstype", "curv", "curv2", "surf", "bzp",
                                                "bsp",    "cdc",  "cdp",   "res"};
  return known.contains(word);
}

class ObjReader {
 public:
  ObjReader(const std::string& bytes, const std::string& name, bool uvs)
      : uvs_(uvs),
        scanner_(
            std::string_view(bytes).substr(bytes.starts_with(byte_order_mark) ? byte_order_mark.size() : 0),
            name) {
    mesh_.name = name;
    mesh_.first_number = 1;
  }

  RawMesh run() {
    while (next()) {
      if (!words_.empty()) take();
    }
    return std::move(mesh_);
  }

 private:
  /// The words of a line and of those that it goes on in, without a comment.
  bool next() {
    words_.clear();
    object_name_.clear();
    bool goes_on = true, of_object = false;
    for (bool any = false; goes_on; any = true) {
      if (!scanner_.next_line()) return any;
      if (!any) {
        line_ = scanner_.line();
        of_object = scanner_.word(0) == "o";
      }
      goes_on = of_object ? append_name() : append_line();
    }
    return true;
  }

  /// The rest of an o line is one name as it stands, with its blanks and number signs.
  bool append_name() {
    std::string_view text = scanner_.text();
    if (words_.empty()) {
      words_.push_back(text.substr(0, 1));
      text = scanner_.words().size() < 2
                 ? std::string_view()
                 : text.substr(static_cast<std::size_t>(scanner_.word(1).data() - text.data()));
    }
    const bool goes_on = text.ends_with('\\');
    if (goes_on) text.remove_suffix(1);
    text = text.substr(0, text.find_last_not_of(" \t") + 1);
    if (!object_name_.empty() && !text.empty()) object_name_ += ' ';
    object_name_ += text;
    return goes_on;
  }

  /// True where the line ends with a backslash and is no comment.
  bool append_line() {
    for (const std::string_view word : scanner_.words()) {
      if (word.starts_with('#')) return false;
      words_.push_back(word);
    }
    if (words_.empty() || scanner_.words().empty() || !words_.back().ends_with('\\')) return false;
    words_.back().remove_suffix(1);
    if (words_.back().empty()) words_.pop_back();
    return true;
  }

  void take() {
    const std::string_view key = words_[0];
    if (key == "v") {
      if (words_.size() < 4) scanner_.fail(fmt::format("{} words", words_.size()), "v X Y Z");
      mesh_.add_vertex({number(1), number(2), number(3)}, line_);
      groups_are_used_ = true;
    } else if (key == "f" || key == "fo") {
      take_face();
    } else if (key == "vt" && uvs_) {
      if (words_.size() < 2) scanner_.fail("a texture coordinate without numbers", "vt U V");
      mesh_.uvs.emplace_back(number(1), words_.size() > 2 ? number(2) : 0.0);
    } else if (key == "l") {
      take_line();
    } else if (key == "o") {
      take_object();
    } else if (key == "g") {
      take_groups();
    } else if (key == "p") {
      count_one(mesh_.left_out, "points (p)", line_);
    } else if (key.find('\0') != std::string_view::npos) {
      scanner_.fail("binary data", "the text of an OBJ file");
    } else if (is_free_form(key)) {
      scanner_.fail(fmt::format("a curve or surface of free form ({})", key), "polygons (f) and lines (l)");
    } else if (!is_read_past(key)) {
      count_one(mesh_.unread, fmt::format("a line that begins with \"{}\"", key.substr(0, 20)), line_);
    }
  }

  void take_face() {
    const std::size_t first = mesh_.corners.size();
    for (std::size_t k = 1; k < words_.size(); ++k) {
      mesh_.corners.push_back(vertex(words_[k]));
      if (uvs_) mesh_.corner_uvs.push_back(texture(words_[k]));
    }
    if (mesh_.corners.size() - first < 3) {
      scanner_.fail(fmt::format("a face of {} corners", words_.size() - 1), "at least 3 corners");
    }
    mesh_.close_polygon(first, line_);
    mesh_.polygon_objects.push_back(set_now());
  }

  void take_line() {
    if (words_.size() < 3) scanner_.fail("a line of one point", "l with at least two vertex indices");
    for (std::size_t k = 2; k < words_.size(); ++k) {
      mesh_.add_segment(vertex(words_[k - 1]), vertex(words_[k]), line_);
      mesh_.segment_objects.push_back(set_now());
    }
  }

  void take_object() {
    object_.clear();
    if (groups_are_used_) groups_.clear();
    if (!object_name_.empty()) object_.push_back(number_of(object_name_));
    set_.reset();
  }

  /// Every word of a g line is a name.
  void take_groups() {
    groups_.clear();
    groups_are_used_ = false;
    for (std::size_t k = 1; k < words_.size(); ++k) {
      if (k <= most_groups) {
        groups_.push_back(number_of(words_[k]));
      } else {
        count_one(mesh_.left_out,
                  fmt::format("a name of a group behind the first {} of its line", most_groups), line_);
      }
    }
    set_.reset();
  }

  /// The set of the names that hold now.
  std::size_t set_now() {
    groups_are_used_ = true;
    if (!set_) {
      std::set<std::size_t> all(object_.begin(), object_.end());
      all.insert(groups_.begin(), groups_.end());
      std::vector<std::size_t> names(all.begin(), all.end());
      const auto [found, is_new] = sets_.try_emplace(names, mesh_.object_sets.size());
      if (is_new) mesh_.object_sets.push_back(std::move(names));
      set_ = found->second;
    }
    return *set_;
  }

  std::size_t number_of(std::string_view given) {
    const std::string name = name_in_utf8(given);
    const auto [found, is_new] = numbers_.try_emplace(name, mesh_.object_names.size());
    if (is_new) mesh_.object_names.push_back(name);
    return found->second;
  }

  double number(std::size_t i) const { return scanner_.value<double>(words_[i], "a number in range"); }

  /// 0-based. A number above that of the vertices so far may be of one that comes.
  long long vertex(std::string_view word) const {
    return index_of(word.substr(0, word.find('/')), word, mesh_.vertices.size(), "vertices",
                    "a vertex index (1 is the first, -1 the last so far)");
  }
  /// Of the second number of a corner; -1: it has none.
  long long texture(std::string_view word) const {
    const std::size_t slash = word.find('/');
    if (slash == std::string_view::npos) return -1;
    const std::string_view rest = word.substr(slash + 1), text = rest.substr(0, rest.find('/'));
    return text.empty() ? -1
                        : index_of(text, word, mesh_.uvs.size(), "texture coordinates",
                                   "the index of a texture coordinate (1 is the first, -1 the last so far)");
  }
  long long index_of(std::string_view text, std::string_view word, std::size_t n_so_far, const char* what,
                     const char* allowed) const {
    const auto index = scanner_.value<long long>(text, allowed);
    const auto n = static_cast<long long>(n_so_far);
    if (index == 0 || index < -n) {
      scanner_.fail(fmt::format("\"{}\" after {} {}", word, n, what), allowed);
    }
    return index > 0 ? index - 1 : n + index;
  }

  const bool uvs_;  // are read
  TextScanner scanner_;
  RawMesh mesh_;
  Words words_;
  std::string object_name_;  // of an o line
  long long line_ = 0;
  std::vector<std::size_t> object_, groups_;              // numbers of the names that hold now
  bool groups_are_used_ = false;                          // vertices, faces or lines came after the g line
  std::optional<std::size_t> set_;                        // of these names, once a face or line has it
  std::map<std::string, std::size_t> numbers_;            // of a name
  std::map<std::vector<std::size_t>, std::size_t> sets_;  // number of a set of names
};

}  // namespace

RawMesh parse_obj(const std::string& bytes, const std::string& name, bool uvs) {
  return ObjReader(bytes, name, uvs).run();
}

}  // namespace bb
