// Meshes of Gmsh (MSH 2.x and 4.1), ascii and binary. Nodes have any numbers; what is no node or element is read past.
#include <fmt/format.h>

#include <unordered_map>

#include "core/math/error.hpp"
#include "core/model/mesh/mixed_source.hpp"
#include "core/model/mesh/raw_mesh.hpp"

namespace bb {
namespace {

enum class GmshKind { point, line, polygon, tetrahedron, other };

struct GmshType {
  long long number;
  const char* name;
  std::size_t nodes;
  GmshKind kind;
};

constexpr GmshType gmsh_types[] = {
    {1, "line", 2, GmshKind::line},
    {2, "triangle", 3, GmshKind::polygon},
    {3, "quad", 4, GmshKind::polygon},
    {4, "tetrahedron", 4, GmshKind::tetrahedron},
    {5, "hexahedron", 8, GmshKind::other},
    {6, "prism", 6, GmshKind::other},
    {7, "pyramid", 5, GmshKind::other},
    {8, "line of second order", 3, GmshKind::other},
    {9, "triangle of second order", 6, GmshKind::other},
    {10, "quad of second order", 9, GmshKind::other},
    {11, "tetrahedron of second order", 10, GmshKind::other},
    {12, "hexahedron of second order", 27, GmshKind::other},
    {13, "prism of second order", 18, GmshKind::other},
    {14, "pyramid of second order", 14, GmshKind::other},
    {15, "point", 1, GmshKind::point},
    {16, "quad of second order", 8, GmshKind::other},
    {17, "hexahedron of second order", 20, GmshKind::other},
    {18, "prism of second order", 15, GmshKind::other},
    {19, "pyramid of second order", 13, GmshKind::other},
    {21, "triangle of third order", 10, GmshKind::other},
    {26, "line of third order", 4, GmshKind::other},
    {29, "tetrahedron of third order", 20, GmshKind::other},
};

class GmshReader {
 public:
  GmshReader(const std::string& bytes, const std::string& name) : in_(bytes, name) {
    mesh_.name = name;
    mesh_.places_are_lines = false;
    mesh_.vertex_element = "node";
    mesh_.cell_element = "element";
  }

  RawMesh run() {
    read_format();
    while (in_.next_line()) {
      const std::string section(in_.word(0));
      if (!section.starts_with('$')) in_.fail("no section", "$Nodes, $Elements or another section of Gmsh");
      if (section == "$Nodes") {
        version_ < 4 ? read_nodes_2() : read_nodes_4();
      } else if (section == "$Elements") {
        version_ < 4 ? read_elements_2() : read_elements_4();
      } else {
        count_one(mesh_.left_out, "section " + section.substr(0, 40), 0);
      }
      const std::string end = "$End" + section.substr(1);
      if (!in_.skip_past(end)) in_.fail("the end of the file", end);
    }
    return std::move(mesh_);
  }

 private:
  void read_format() {
    if (!in_.next_line() || in_.word(0) != "$MeshFormat")
      in_.fail("no $MeshFormat", "a file of Gmsh, version 2 or 4.1");
    in_.next_line();
    const std::string_view version = in_.word(0);
    version_ = version.starts_with("2") ? 2 : 4;
    const bool known = version.starts_with("2.") || version == "2" || version == "4.1";
    if (!known)
      in_.fail(fmt::format("version \"{}\"", version),
               "2.0 to 2.2, or 4.1 (gmsh IN -save -format msh41 -o OUT)");
    if (in_.word(2) != "8") in_.fail(fmt::format("numbers of {} bytes", in_.word(2)), "8");
    if (in_.word(1) == "1") {
      in_.set_binary(false);
      if (in_.number<long long>(four) != 1)
        in_.fail("bytes in the order of another machine", "little-endian numbers");
    }
    if (!in_.skip_past("$EndMeshFormat")) in_.fail("the end of the file", "$EndMeshFormat");
  }

  void add_node(long long tag, const Vec3d& x) {
    const auto [at, is_new] = index_.try_emplace(tag, static_cast<long long>(mesh_.vertices.size()));
    if (!is_new)
      throw ConfigError(mesh_.where("node", tag), "a node of that number already", "each number once");
    mesh_.add_vertex(x, tag);
    mesh_.numbers.push_back(tag);
  }

  Vec3d point() {
    const double x = in_.number<double>(real), y = in_.number<double>(real);
    return {x, y, in_.number<double>(real)};
  }

  void read_nodes_2() {
    in_.next_line();
    const long long n = in_.size(0);
    in_.require_left(n, 28);
    for (long long k = 0; k < n; ++k) {
      const auto tag = in_.number<long long>(four);
      add_node(tag, point());
    }
  }

  void read_nodes_4() {
    const long long blocks = header();
    for (long long b = 0; b < blocks; ++b) {
      const auto dimension = in_.number<long long>(four);
      in_.number<long long>(four);  // the entity
      const bool parametric = in_.number<long long>(four) != 0;
      const auto tags = in_.numbers<long long>(in_.number<long long>(eight), eight);
      for (const long long tag : tags) {
        add_node(tag, point());
        for (long long k = 0; parametric && k < dimension; ++k) in_.number<double>(real);
      }
    }
  }

  void read_elements_2() {
    in_.next_line();
    const long long n = in_.size(0);
    if (!in_.is_binary()) {
      for (long long k = 0; k < n; ++k) {
        const auto tag = in_.number<long long>(four);
        const GmshType& type = type_of(in_.number<long long>(four), tag);
        skip(in_.number<long long>(four));
        add_element(type, tag);
      }
      return;
    }
    for (long long done = 0; done < n;) {
      const auto type = in_.number<long long>(four), some = in_.number<long long>(four),
                 tags = in_.number<long long>(four);
      if (some < 1 || some > n - done)
        in_.fail(fmt::format("a block of {} elements", some), fmt::format("1 to {}", n - done));
      for (long long k = 0; k < some; ++k) {
        const auto tag = in_.number<long long>(four);
        skip(tags);
        add_element(type_of(type, tag), tag);
      }
      done += some;
    }
  }

  void read_elements_4() {
    const long long blocks = header();
    for (long long b = 0; b < blocks; ++b) {
      skip(2);  // dimension and entity
      const auto type = in_.number<long long>(four), n = in_.number<long long>(eight);
      in_.require_left(n, 16);
      for (long long k = 0; k < n; ++k) {
        const auto tag = in_.number<long long>(eight);
        add_element(type_of(type, tag), tag);
      }
    }
  }

  /// Of version 4: how many blocks; the numbers of things and of tags follow from what comes.
  long long header() {
    const auto blocks = in_.number<long long>(eight);
    for (int k = 0; k < 3; ++k) in_.number<long long>(eight);
    in_.require_left(blocks, 20);
    return blocks;
  }

  void skip(long long n) {
    in_.require_left(n, 4);
    for (long long k = 0; k < n; ++k) in_.number<long long>(four);
  }

  const GmshType& type_of(long long number, long long element) const {
    for (const GmshType& type : gmsh_types) {
      if (type.number == number && type.kind != GmshKind::other) return type;
      if (type.number == number) refuse(fmt::format("a {} (type {})", type.name, number), element);
    }
    refuse(fmt::format("an element of type {}", number), element);
  }

  [[noreturn]] void refuse(const std::string& found, long long element) const {
    throw ConfigError(mesh_.where("element", element), found,
                      "elements of first order: point, line, triangle, quad, tetrahedron");
  }

  void add_element(const GmshType& type, long long tag) {
    const NumberType& size = version_ < 4 ? four : eight;
    const std::size_t first = mesh_.corners.size();
    for (std::size_t k = 0; k < type.nodes; ++k) {
      const auto node = in_.number<long long>(size);
      const auto found = index_.find(node);
      if (found == index_.end()) {
        throw ConfigError(mesh_.where("element", tag), fmt::format("node {}", node),
                          "a number of a node in $Nodes");
      }
      mesh_.corners.push_back(found->second);
    }
    if (type.kind == GmshKind::polygon) return mesh_.close_polygon(first, tag);
    if (type.kind == GmshKind::tetrahedron) return mesh_.close_tetrahedron(first, tag);
    if (type.kind == GmshKind::line) mesh_.add_segment(mesh_.corners[first], mesh_.corners[first + 1], tag);
    if (type.kind == GmshKind::point) count_one(mesh_.left_out, "element \"point\"", tag);
    mesh_.corners.resize(first);
  }

  static inline const NumberType& four = *number_type_of("int");
  static inline const NumberType& eight = *number_type_of("Int64");
  static inline const NumberType& real = *number_type_of("double");

  MixedSource in_;
  RawMesh mesh_;
  int version_ = 0;
  std::unordered_map<long long, long long> index_;  // of a node's number
};

}  // namespace

RawMesh parse_msh(const std::string& bytes, const std::string& name) { return GmshReader(bytes, name).run(); }

}  // namespace bb
