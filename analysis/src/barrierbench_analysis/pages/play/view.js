// One film in one plot of K3D: its surfaces, rods and obstacles in the state of a frame.

const MESH = 1, ROD = 2, ARROWS = 3, OBSTACLE = 10;  // ids of objects in a plot
const FIELD_OF_VIEW = {planar: 8, solid: 30};  // degrees
const ARROW_COLOUR = 0xd03a2b;
const GREY_END = 0.02;  // share of a colour map below its scale: what was not computed

const shaped = (data, columns) => ({data, shape: [data.length / columns, columns]});
const rgb = (hex) => [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16) / 255);

/** The arrays of a film, in the order in which they were written. */
function unpacked(film, buffer) {
  const {n_vertices: n, n_drawn, n_triangles: m, n_edges, steps} = film;
  let at = 0;
  const take = (Type, count) => { const a = new Type(buffer, at, count); at += 4 * count; return a; };
  const rows = (count) => { const all = take(Float32Array, count * steps.length);
    return steps.map((_, f) => all.subarray(f * count, (f + 1) * count)); };
  return {
    drawn: take(Uint32Array, 3 * m), triangles: take(Uint32Array, 3 * m), source: take(Uint32Array, n_drawn),
    edges: take(Uint32Array, 2 * n_edges), body: take(Uint32Array, n),
    positions: rows(3 * n), gap: rows(n), force: rows(n), stretch: rows(m),
    forces: film.forces ? rows(3 * n) : null,
  };
}

/** Colours of a field, or one a body, as K3D takes them: [share, r, g, b, ...], after what is not computed. */
function colourMap(words, colour) {
  const grey = rgb(words.not_computed), out = [0, ...grey, 0.4 * GREY_END, ...grey];
  const place = (share) => GREY_END + (1 - GREY_END) * share;
  if (colour === "body") {
    const all = words.body_colours;
    out.push(0.6 * GREY_END, ...rgb(all[0]));
    all.forEach((c, k) => out.push(place(k / all.length), ...rgb(c), place((k + 0.98) / all.length), ...rgb(c)));
    out.push(1, ...rgb(all[all.length - 1]));
  } else {
    const all = words.scales[colour].colours;
    out.push(0.6 * GREY_END, ...rgb(all[0]));  // the low end of the scale, where most values are, lies within one colour
    all.forEach((c, k) => out.push(place(k / (all.length - 1)), ...rgb(c)));
  }
  return new Float32Array(out);
}

class View {
  constructor(library, node, film, arrays, words, ground) {
    Object.assign(this, {film, words, ...arrays});
    const planar = words.planar;
    this.plot = new library.K3D(library.ThreeJsProvider, node, {
      menuVisibility: false, gridVisible: false, axesHelper: 0, cameraAutoFit: false, clearColor: ground,
      colorbarObjectId: 0,  // no object has it: the page draws the colour bar
      cameraMode: planar ? "trackball" : "orbit", cameraNoRotate: planar, cameraFov: FIELD_OF_VIEW[planar ? "planar" : "solid"],
    });
    this.frame = 0;
    this.colour = "";
    this.rodIndices = tubeIndices(film.n_edges);
    this.moving = [];  // obstacles: object, and the obstacle
    this.showsForces = true;
    this.pushed = this.forces ? this.everPushed() : [];
  }

  /** Vertices on which a force acts in some frame. */
  everPushed() {
    const out = [];
    for (let v = 0; v < this.film.n_vertices; v++) {
      if (this.forces.some((of) => of[3 * v] || of[3 * v + 1] || of[3 * v + 2])) out.push(v);
    }
    return out;
  }

  /** Arrows of the forces of a frame; of a vertex without one, and where they are not shown, without a length. */
  arrows() {
    const x = this.positions[this.frame], f = this.forces[this.frame], points = [], vectors = [];
    const {longest_arrow_N: most, longest_arrow_m: longest, rod_radius} = this.words;
    for (const v of this.pushed) {
      const force = [f[3 * v], f[3 * v + 1], f[3 * v + 2]], size = Math.hypot(...force);
      const metres = this.showsForces && size ? longest * Math.min(1, size / most) / size : 0;
      points.push(x[3 * v], x[3 * v + 1], x[3 * v + 2]);
      vectors.push(...force.map((part) => metres * part));
    }
    return {vertices: shaped(arrowVertices(points, vectors, 4 * rod_radius), 3)};
  }

  /** The object of all arrows, once. */
  async arrowObject() {
    if (!this.pushed.length) return;
    const indices = shaped(arrowIndices(this.pushed.length), 3);
    this.arrowMesh = this.surface(ARROWS, this.arrows().vertices, indices, {color: ARROW_COLOUR});
    await this.plot.load({objects: [this.arrowMesh]});
  }

  /** Obstacles, once; those that move are reloaded with every frame. */
  obstacles() {
    const {middle, radius, planar, obstacle_colour} = this.words;
    return Promise.all(this.film.obstacles.map((o, k) => {
      const {indices} = obstacleShape(o, planar, middle, 1.6 * radius);
      const object = this.surface(OBSTACLE + k, this.obstacleVertices(o),
        shaped(new Uint32Array(indices), 3), {color: parseInt(obstacle_colour.slice(1), 16), side: o.inside && !planar ? "back" : "double"});
      if (o.vertex !== undefined) this.moving.push([object, o]);
      return this.plot.load({objects: [object]});
    }));
  }

  obstacleVertices(o) {
    const {middle, radius, planar} = this.words, x = this.positions[this.frame];
    const there = o.vertex === undefined ? o : {...o, point_m: Array.from(x.subarray(3 * o.vertex, 3 * o.vertex + 3))};
    return shaped(new Float32Array(obstacleShape(there, planar, middle, 1.6 * radius).vertices), 3);
  }

  surface(id, vertices, indices, more) {
    const none = {data: new Float32Array(0), shape: [0]};
    return {
      id, type: "Mesh", visible: true, vertices, indices, side: "double", flat_shading: false, normals: none, roughness: 0.75,
      attribute: none, triangles_attribute: none, color_map: none, color_range: [], opacity: 1, color: 0xffffff,
      model_matrix: shaped(new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]), 4), ...more,
    };
  }

  /** Whether the field of triangles is shown: then every triangle has corners of its own. */
  get perTriangle() { return this.colour !== "body" && this.words.scales[this.colour].element === "triangle"; }

  share(value) {
    const {factor, top} = this.words.scales[this.colour];
    return Number.isNaN(value) ? 0 : GREY_END + (1 - GREY_END) * Math.min(Math.max(factor * value / top, 0), 1);
  }

  bodyShare(vertex) {
    const many = this.words.body_colours.length;
    return GREY_END + (1 - GREY_END) * (this.body[vertex] % many + 0.5) / many;
  }

  /** Place on the colour map of a vertex, which for a field of triangles has none. */
  vertexShare(vertex) {
    if (this.colour === "body") return this.bodyShare(vertex);
    return this.perTriangle ? 0 : this.share(this[this.colour][this.frame][vertex]);
  }

  state() {
    const x = this.positions[this.frame], source = this.perTriangle ? this.triangles : this.source;
    const vertices = new Float32Array(3 * source.length), attribute = new Float32Array(source.length);
    source.forEach((from, k) => {
      vertices.set(x.subarray(3 * from, 3 * from + 3), 3 * k);
      attribute[k] = this.perTriangle ? this.share(this.stretch[this.frame][Math.floor(k / 3)]) : this.vertexShare(from);
    });
    return {vertices: shaped(vertices, 3), attribute: {data: attribute, shape: [attribute.length]}};
  }

  rods() {
    const attribute = new Float32Array(this.edges.length * SIDES);
    this.edges.forEach((from, k) => attribute.fill(this.vertexShare(from), k * SIDES, (k + 1) * SIDES));
    const vertices = tubeVertices(this.positions[this.frame], this.edges, this.words.rod_radius);
    return {vertices: shaped(vertices, 3), attribute: {data: attribute, shape: [attribute.length]}};
  }

  /** New objects: for the first frame, and when colours mean something else. */
  async coloured(colour) {
    this.colour = colour;
    const map = colourMap(this.words, colour);
    const colours = {color_map: {data: map, shape: [map.length]}, color_range: [0, 1]};
    const indices = this.perTriangle ? Uint32Array.from(this.triangles.keys()) : this.drawn;
    this.objects = [];
    for (const [id, state, corners] of [[MESH, this.state(), indices], [ROD, this.rods(), this.rodIndices]]) {
      if (!corners.length) continue;
      if (this.plot.getWorld().ObjectsListJson[id]) await this.plot.removeObject(id);
      const object = this.surface(id, state.vertices, shaped(corners, 3), {attribute: state.attribute, ...colours});
      await this.plot.load({objects: [object]});
      this.objects.push(object);
    }
  }

  async shown(frame) {
    this.frame = frame;
    for (const object of this.objects) {
      const state = object.id === MESH ? this.state() : this.rods();
      Object.assign(object, state);
      await this.plot.reload(object, state);
    }
    if (this.arrowMesh) {
      const state = this.arrows();
      Object.assign(this.arrowMesh, state);
      await this.plot.reload(this.arrowMesh, state);
    }
    for (const [object, o] of this.moving) {
      const state = {vertices: this.obstacleVertices(o)};
      Object.assign(object, state);
      await this.plot.reload(object, state);
    }
  }

  /** The last frame up to a time, s. */
  frameAt(time) {
    let frame = 0;
    while (frame + 1 < this.film.times.length && this.film.times[frame + 1] <= time + 1e-9) frame += 1;
    return frame;
  }
}
