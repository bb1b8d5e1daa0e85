// Wavefront OBJ: v, f (v, v/vt, v//vn, v/vt/vn; negative indices count back) and l. The rest is read past.
#include "core/input/text_scanner.hpp"
#include "core/mesh/raw_mesh.hpp"

namespace bb {
namespace {

/// 0-based index of a face or line word; 1-based positive and backward negative in the file.
long long vertex_index(const TextScanner& scanner, std::string_view word, std::size_t n_vertices) {
  const std::string_view text = word.substr(0, word.find('/'));
  long long index = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), index);
  if (error != std::errc() || end != text.data() + text.size() || index == 0) {
    scanner.fail(fmt::format("\"{}\"", word), "a vertex index (1 is the first, -1 the last so far)");
  }
  return index > 0 ? index - 1 : static_cast<long long>(n_vertices) + index;
}

}  // namespace

RawMesh parse_obj(const std::string& bytes, const std::string& name) {
  RawMesh mesh;
  mesh.name = name;
  TextScanner scanner(bytes, name);
  while (scanner.next_line()) {
    const auto& words = scanner.words();
    if (scanner.word(0) == "v") {
      mesh.add_vertex({scanner.number(1), scanner.number(2), scanner.number(3)}, scanner.line());
    } else if (scanner.word(0) == "f") {
      const std::size_t first = mesh.corners.size();
      for (std::size_t k = 1; k < words.size() && words[k][0] != '#'; ++k) {
        mesh.corners.push_back(vertex_index(scanner, words[k], mesh.vertices.size()));
      }
      mesh.close_polygon(first, scanner.line());
    } else if (scanner.word(0) == "l") {
      if (words.size() < 3) scanner.fail("a line of one point", "l with at least two vertex indices");
      for (std::size_t k = 2; k < words.size() && words[k][0] != '#'; ++k) {
        mesh.add_segment(vertex_index(scanner, words[k - 1], mesh.vertices.size()),
                         vertex_index(scanner, words[k], mesh.vertices.size()), scanner.line());
      }
    } else if (!words.empty() && words[0].find('\0') != std::string_view::npos) {
      scanner.fail("binary data", "the text of an OBJ file");
    }
  }
  return mesh;
}

}  // namespace bb
