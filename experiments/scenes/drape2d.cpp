// The drape of "The Polynomial That Fixed 30 Years of Cloth Simulation" as one planar scene: a sheet of width
// W in the x-y plane above a disk (an analytic sphere, since all vertices stay in its middle plane). Source:
// the article's mesh function and figure; both of its variants, and two that let layers and drapes form.
#include "core/model/mesh/generators.hpp"
#include "experiments/scenes/procedural_scene.hpp"

namespace bb {
namespace {

struct Layout {
  int n_x = 0, n_y = 0, sheets = 1;
};

Layout layout_of(const std::string& variant, int n) {
  if (variant == "strip") return {3 * n, 3, 1};
  if (variant == "stack") return {2 * n, 2, 3};
  return {n, n, 1};
}

Scene build_drape2d(const ParameterMap& p, const SceneContext& context) {
  const std::string& variant = text(p, "variant");
  const Layout layout = layout_of(variant, integer(p, "n"));
  const double width = number(p, "width_m"), radius = number(p, "disk_radius_m");
  const double height = width / (layout.n_x - 1) * (layout.n_y - 1);  // square cells
  const double gap = number(p, "start_gap_d_hat") * context.d_hat;

  SceneBuilder builder("drape2d", true, Vec3d(0, -number(p, "gravity_m_per_s2"), 0), "scene drape2d");
  builder.set_planar_pairs(text(p, "pairs") == "point_edge" ? PlanarPairs::point_edge
                                                            : PlanarPairs::vertex_vertex);
  for (int s = 0; s < layout.sheets; ++s) {
    BodySpec sheet;
    sheet.name = layout.sheets == 1 ? "sheet" : "sheet" + std::to_string(s);
    sheet.mesh = grid_mesh(layout.n_x, layout.n_y, width, height);
    const double bottom = radius + gap + s * (height + gap);
    sheet.mesh.vertices.row(1).array() += bottom + 0.5 * height;
    sheet.material = cloth_material(p, context);
    sheet.velocity = Vec3d(0, -number(p, "start_speed_m_per_s"), 0);
    sheet.d_hat = context.d_hat;
    if (variant == "pinned") sheet.pins.emplace_back().top_row = true;
    builder.add_body(sheet);
  }
  Obstacle disk;
  disk.name = "disk";
  disk.kind = ObstacleKind::sphere;
  disk.radius = radius;
  builder.add_obstacle(disk);
  return builder.finish();
}

}  // namespace

ProceduralScene make_scene_drape2d() {
  ProceduralScene scene;
  scene.planar = true;
  scene.defaults = {0.01, 40, 0.01, 0.02};
  scene.build = build_drape2d;
  scene.parameters = {
      {"variant", word({"pinned", "free", "strip", "stack"}), "pinned",
       "n x n with its top row held, n x n free, 3n x 3 draped over the disk, three 2n x 2 sheets"},
      {"protocol", word({"equal_force", "article_literal"}), "equal_force",
       "what is compared: matched forces in the common pipeline, or the article's own formulas and "
       "solver"},
      {"pairs", word({"point_edge", "vertex_vertex"}), "point_edge",
       "pairs of the planar self contact; vertex_vertex is the article's: edges may cross, which the "
       "audit counts"},
      {"width_m", positive("m"), 1, "width of the sheet; cells are squares"},
      {"n", count(2, 2000), 10, "resolution, see variant"},
      {"youngs_N_per_m", positive("N/m"), 100, "Young's modulus times thickness"},
      {"poisson", number_in(0, 0.49, "1"), 0.3, "Poisson's ratio, plane stress"},
      {"density_kg_per_m2", positive("kg/m^2"), 0.3, "mass per area"},
      {"disk_radius_m", positive("m"), 0.3, "radius of the disk, centred at the origin"},
      {"start_gap_d_hat", positive("d_hat"), 1.2,
       "gap at the start: between sheet and disk, and between sheets"},
      {"start_speed_m_per_s", any_number("m/s"), 1, "speed at the start, downwards"},
      gravity_parameter(),
  };
  return scene;
}

}  // namespace bb
