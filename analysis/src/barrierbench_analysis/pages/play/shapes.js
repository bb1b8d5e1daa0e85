// Surfaces that are no body's triangles: analytic obstacles, and tubes round the edges of rods. All return
// {vertices: [x y z ...], indices: [a b c ...]}, lengths in m.

const ROUND = 96;  // segments of a circle: facets lie within 0.06% of the radius inside it

const add = (a, b, s = 1) => [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => { const l = Math.hypot(...a) || 1; return [a[0] / l, a[1] / l, a[2] / l]; };

/** Two unit vectors across a direction. */
function across(axis) {
  const least = [0, 1, 2].sort((i, j) => Math.abs(axis[i]) - Math.abs(axis[j]))[0];
  const u = unit(cross(axis, [0, 1, 2].map((k) => (k === least ? 1 : 0))));
  return [u, cross(axis, u)];
}

/** Rows of points joined by quadrilaterals; point(i, j) for i in 0..rows, j in 0..columns. */
function sheet(rows, columns, point) {
  const vertices = [], indices = [], at = (i, j) => i * (columns + 1) + j;
  for (let i = 0; i <= rows; i++) for (let j = 0; j <= columns; j++) vertices.push(...point(i, j));
  for (let i = 0; i < rows; i++) {
    for (let j = 0; j < columns; j++) {
      indices.push(at(i, j), at(i + 1, j), at(i, j + 1), at(i, j + 1), at(i + 1, j), at(i + 1, j + 1));
    }
  }
  return {vertices, indices};
}

function ball(centre, radius) {
  return sheet(ROUND / 2, ROUND, (i, j) => {
    const polar = 2 * Math.PI * i / ROUND, turn = 2 * Math.PI * j / ROUND;
    return add(centre, [Math.sin(polar) * Math.cos(turn), Math.sin(polar) * Math.sin(turn), Math.cos(polar)], radius);
  });
}

function circle(centre, u, v, radius, j) {
  const turn = 2 * Math.PI * j / ROUND;
  return add(add(centre, u, radius * Math.cos(turn)), v, radius * Math.sin(turn));
}

/** A plane as a square, a cylinder as a tube, both of half length `reach` round the point nearest `middle`. */
function solidObstacle(o, middle, reach) {
  if (o.kind === "sphere") return ball(o.point_m, o.radius_m);
  const axis = unit(o.axis), [u, v] = across(axis), away = dot(add(middle, o.point_m, -1), axis);
  if (o.kind === "plane") {
    const foot = add(middle, axis, -away);
    return sheet(1, 1, (i, j) => add(add(foot, u, (2 * i - 1) * reach), v, (2 * j - 1) * reach));
  }
  const near = add(o.point_m, axis, away);
  return sheet(1, ROUND, (i, j) => circle(add(near, axis, (2 * i - 1) * reach), u, v, o.radius_m, j));
}

/** What an obstacle forbids in the plane z = 0 of a planar scene, drawn a little behind it. */
function flatObstacle(o, middle, reach) {
  const behind = -0.02 * reach, x = [1, 0, 0], y = [0, 1, 0];
  if (o.kind === "plane") {
    const axis = unit([o.axis[0], o.axis[1], 0]), along = [-axis[1], axis[0], 0];
    const foot = add(middle, axis, -dot(add(middle, o.point_m, -1), axis));
    foot[2] = behind;
    return sheet(1, 1, (i, j) => add(add(foot, axis, -2 * i * reach), along, (2 * j - 1) * 2 * reach));
  }
  const centre = [o.point_m[0], o.point_m[1], behind], far = o.inside ? o.radius_m + 4 * reach : 0;
  return sheet(1, ROUND, (i, j) => circle(centre, x, y, i ? o.radius_m : far, j));
}

const obstacleShape = (o, planar, middle, reach) => (planar ? flatObstacle : solidObstacle)(o, middle, reach);

const SIDES = 8;  // of a tube

/** Tubes round edges: 2 * SIDES vertices an edge, first those of its first end. */
function tubeVertices(x, edges, radius) {
  const out = new Float32Array(edges.length * SIDES * 3);
  for (let e = 0, at = 0; e < edges.length; e += 2) {
    const [a, b] = [edges[e], edges[e + 1]].map((k) => [x[3 * k], x[3 * k + 1], x[3 * k + 2]]);
    const [u, v] = across(unit(add(b, a, -1)));
    for (const end of [a, b]) {
      for (let s = 0; s < SIDES; s++, at += 3) {
        const turn = 2 * Math.PI * s / SIDES;
        out.set(add(add(end, u, radius * Math.cos(turn)), v, radius * Math.sin(turn)), at);
      }
    }
  }
  return out;
}

function tubeIndices(count) {
  const out = [];
  for (let e = 0; e < count; e++) {
    const first = 2 * SIDES * e;
    for (let s = 0; s < SIDES; s++) {
      const i = first + s, j = first + (s + 1) % SIDES;
      out.push(i, j, i + SIDES, j, j + SIDES, i + SIDES);
    }
  }
  return new Uint32Array(out);
}

const ARROW_RINGS = [[0, 0.25], [0.72, 0.25], [0.72, 0.7], [1, 0]];  // share of the length, share of the thickness

/** Arrows from points along vectors (m): SIDES vertices a ring, ring after ring. Points and vectors: [x y z ...]. */
function arrowVertices(points, vectors, thickness) {
  const out = new Float32Array(points.length * ARROW_RINGS.length * SIDES);
  for (let k = 0, at = 0; k < points.length; k += 3) {
    const tail = points.slice(k, k + 3), way = vectors.slice(k, k + 3), length = Math.hypot(...way);
    const [u, v] = across(unit(way));
    for (const [along, wide] of ARROW_RINGS) {
      const centre = add(tail, way, along), radius = wide * Math.min(thickness, 0.3 * length);
      for (let s = 0; s < SIDES; s++, at += 3) {
        const turn = 2 * Math.PI * s / SIDES;
        out.set(add(add(centre, u, radius * Math.cos(turn)), v, radius * Math.sin(turn)), at);
      }
    }
  }
  return out;
}

function arrowIndices(count) {
  const out = [], rings = ARROW_RINGS.length;
  for (let k = 0; k < count; k++) {
    for (let ring = 0; ring + 1 < rings; ring++) {
      const first = SIDES * (rings * k + ring);
      for (let s = 0; s < SIDES; s++) {
        const i = first + s, j = first + (s + 1) % SIDES;
        out.push(i, j, i + SIDES, j, j + SIDES, i + SIDES);
      }
    }
  }
  return new Uint32Array(out);
}
