// SPDX-License-Identifier: MIT
// What the page of a run from any side draws of one moment: the closed surface, and the taps as arrows.

/// The nodes of a cube are counted along x, then y, then z; an edge is one of three axes from one of them. Of each face the
/// nodes counter-clockwise, seen from outside the cube: as in space/mesh.cpp, which says why such a mesh is closed.
const kCubeFaces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
const edgeBetween = (one, other) => 8 * ((one ^ other) >> 1) + (one & other);

/// The rings of edges of a cube, by its nodes inside as bits; each with whether it needs a vertex in its middle.
function ringsOf(inside) {
  const known = ringsOf.known ??= new Map();
  if (known.has(inside)) return known.get(inside);
  const next = new Map();
  const crowded = new Set();
  const within = (node) => (inside >> node) & 1;
  for (const face of kCubeFaces) {
    const node = (k) => face[k % 4];
    const leaves = [0, 1, 2, 3].filter((k) => within(node(k)) && !within(node(k + 1)));
    for (const k of leaves) {
      let back = k + 1;
      while (!within(node(back + 1))) back += 1;
      const [leave, enter] = [edgeBetween(node(k), node(k + 1)), edgeBetween(node(back), node(back + 1))];
      next.set(enter, leave);
      if (leaves.length === 2) crowded.add(leave).add(enter);
    }
  }
  const rings = [];
  while (next.size > 0) {
    const ring = [];
    for (let edge = Math.min(...next.keys()); next.has(edge);) {
      ring.push(edge);
      const follows = next.get(edge);
      next.delete(edge);
      edge = follows;
    }
    rings.push({ ring, middle: ring.length > 3 && ring.some((edge) => crowded.has(edge)) });
  }
  known.set(inside, rings);
  return rings;
}

/// A mesh as plotly has it, centimetres, with the deviations of its vertices in millimetres.
function unpackSurface(bytes, begin, { origin, side, nodes, vertices, least, most }, desk) {
  const out = { x: [], y: [], z: [], i: [], j: [], k: [], deviation: [], nodes, vertices };
  const [nx, ny] = nodes;
  const strides = [1, nx, nx * ny];
  const count = nx * ny * nodes[2];
  const inside = (node) => (node < count ? (bytes[begin + (node >> 3)] >> (node & 7)) & 1 : 0);
  const shares = begin + Math.ceil(count / 8);
  const first = new Int32Array(count);
  let level = 0;
  for (let node = 0; node < count; node += 1) {
    first[node] = out.x.length;
    const here = inside(node);
    for (let axis = 0; axis < 3; axis += 1) {
      if (inside(node + strides[axis]) === here) continue;
      const vertex = out.x.length;
      const at = [node % nx, Math.floor(node / nx) % ny, Math.floor(node / strides[2])];
      at[axis] += bytes[shares + vertex] / 255;
      const [x, y, z] = at.map((steps, i) => kCentimetres * (origin[i] + side * steps));
      level = (level + bytes[shares + vertices + vertex]) & 255;
      out.x.push(x);
      out.y.push(y);
      out.z.push(z + kCentimetres * desk);
      out.deviation.push(1000 * (least + (level / 255) * (most - least)));
    }
  }
  const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((i) => (i & 1) + strides[1] * ((i >> 1) & 1) + strides[2] * (i >> 2));
  const vertexOf = (cube, edge) => {
    const node = cube + corners[edge % 8];
    let vertex = first[node];
    for (let axis = 0; axis < edge >> 3; axis += 1) vertex += inside(node) === inside(node + strides[axis]) ? 0 : 1;
    return vertex;
  };
  const triangle = (a, b, c) => {
    out.i.push(a);
    out.j.push(b);
    out.k.push(c);
  };
  for (let cube = 0; cube + corners[7] < count; cube += 1) {
    let mask = 0;
    for (let i = 0; i < 8; i += 1) mask |= inside(cube + corners[i]) << i;
    if (mask === 0 || mask === 255) continue;
    for (const { ring, middle } of ringsOf(mask)) {
      const around = ring.map((edge) => vertexOf(cube, edge));
      if (middle) {
        const hub = out.x.length;
        for (const of of [out.x, out.y, out.z, out.deviation]) of.push(around.reduce((sum, vertex) => sum + of[vertex], 0) / around.length);
        around.forEach((vertex, i) => triangle(hub, vertex, around[(i + 1) % around.length]));
      } else {
        for (let i = 1; i + 1 < around.length; i += 1) triangle(around[0], around[i], around[i + 1]);
      }
    }
  }
  return out;
}

/// The surfaces of the page, in the order of their moments.
function unpackSurfaces(bytes, described, desk) {
  let begin = 0;
  return described.map((one) => {
    const out = unpackSurface(bytes, begin, one, desk);
    begin += Math.ceil((one.nodes[0] * one.nodes[1] * one.nodes[2]) / 8) + 2 * one.vertices;
    return out;
  });
}

const fromAnySide = (tap) => tap["direction.x"] !== undefined;
const kAxes3 = ["x", "y", "z"];
const directionOf = (tap) => kAxes3.map((side) => tap[`direction.${side}`]);
/// The place so far along the way of a tap, metres.
const along = (tap, way) => kAxes3.map((side, i) => tap[side] + way * directionOf(tap)[i]);

/// How the tool came, in words.
function slant(tap) {
  const degrees = Math.round((Math.asin(-tap["direction.z"]) * 180) / Math.PI);
  if (degrees > 85) return "straight down";
  if (Math.abs(degrees) < 3) return "level";
  return `coming ${degrees > 0 ? "down" : "up"} at ${Math.abs(degrees)}°`;
}

const wayOf = (tap) => `from ${centimetres(...along(tap, 0))}, ${slant(tap)}`;

/// The surface with taps as arrows, in three dimensions, or as points seen from above where the browser has no WebGL.
class SpaceView {
  constructor(data, surfaces) {
    this.data = data;
    this.spatial = hasWebGL();
    this.surfaces = [];
    this.withTruth = false;
    this.grow(surfaces);
  }

  /// The truth as closed lines, with gaps between them, centimetres.
  truth() {
    const out = { x: [], y: [], z: [] };
    for (const ring of this.data.true_contours) {
      kAxes3.forEach((side, axis) => {
        let tenths = axis === 2 ? 1e4 * this.data.desk : 0;
        const line = ring.filter((_, i) => i % 3 === axis).map((step) => (tenths += step) / 100);
        for (const value of [...line, line[0], null]) out[side].push(value);
      });
    }
    return out;
  }

  grow(surfaces) {
    this.surfaces.push(...surfaces);
    const taps = this.data.taps.filter((tap) => tap.on_object).map((tap) => along(tap, tap.along).map((value) => value * kCentimetres));
    const last = this.surfaces[this.surfaces.length - 1];
    const kRoom = 2.5;  // for the arrows
    this.range = kAxes3.map((side, i) => {
      const area = [0, kCentimetres * [this.data.width, this.data.depth][i]];
      const [low, high] = extent([...last[side], ...taps.map((at) => at[i])]);
      if (low > high) return i < 2 ? area : [kCentimetres * this.data.desk, kCentimetres * this.data.desk + 15];
      return [i < 2 ? low - kRoom : kCentimetres * this.data.desk, high + kRoom];
    });
  }

  /// Lists with an element for each moment that is shown.
  lists() {
    return [this.surfaces];
  }

  caption() {
    const what = "Reconstructed closed surface, coloured by its standard deviation. Arrows: taps, with tips where the tool stopped, on the object, on the desk (grey) or without a contact (orange). Magenta: the next tap.";
    if (this.spatial) return `${what} Drag to turn${kFingers.matches ? "." : ", Ctrl and wheel to zoom."}`;
    return `${what} (This browser has no WebGL: the page shows points of the surface, seen from above.)`;
  }

  /// The end of the way of a tap, its last few centimetres, or, of one that met nothing, what of it crosses the picture.
  arrow(tap) {
    const shaft = tap.word ? 0.06 : 0.03;  // the next one is to be seen
    if (tap.on_object !== null) return [along(tap, Math.max(0, tap.along - shaft)), along(tap, tap.along)];
    let [begin, end] = [0, tap.along ?? tap.length];
    const [from, direction] = [along(tap, 0), directionOf(tap)];
    this.range.forEach((range, i) => {
      const ends = range.map((value) => (value / kCentimetres - from[i]) / direction[i]).sort((a, b) => a - b);
      if (direction[i] !== 0) [begin, end] = [Math.max(begin, ends[0]), Math.min(end, ends[1])];
    });
    return begin < end ? [along(tap, begin), along(tap, end)] : null;
  }

  /// Taps as arrows of one colour.
  arrows(taps, name, color, size = 0.7) {
    const drawn = taps.map((tap) => ({ ends: this.arrow(tap), tap })).filter(({ ends }) => ends);
    const words = ({ tap }) => tap.word ?? `${hover(tap)}<br>${slant(tap)}`;
    const side = (i) => drawn.flatMap(({ ends }) => [ends[0][i] * kCentimetres, ends[1][i] * kCentimetres, null]);
    const text = drawn.flatMap((one) => [words(one), words(one), ""]);
    const lines = { type: this.spatial ? "scatter3d" : "scatter", mode: "lines", name, x: side(0), y: side(1), line: { color, width: this.spatial ? 5 : 2 }, text, hovertemplate: "%{text}<extra></extra>" };
    if (!this.spatial) {
      const tips = drawn.map(({ ends }) => ends[1].map((value) => value * kCentimetres));
      return [lines, points(name, tips.map((at) => at[0]), tips.map((at) => at[1]), drawn.map(words), { color, size: 7, symbol: "circle" })];
    }
    const tip = (i) => drawn.map(({ ends }) => ends[1][i] * kCentimetres);
    const way = (i) => drawn.map(({ tap }) => directionOf(tap)[i]);
    const cones = {
      type: "cone", name, x: tip(0), y: tip(1), z: tip(2), u: way(0), v: way(1), w: way(2), anchor: "tip",
      sizemode: "raw", sizeref: size, showscale: false, colorscale: [[0, color], [1, color]], text: drawn.map(words), hovertemplate: "%{text}<extra></extra>",
    };
    return drawn.length > 0 ? [{ ...lines, z: side(2) }, cones] : [];
  }

  traces(frame, moment) {
    const surface = this.surfaces[frame];
    const [on, off, others] = tapsUntil(this.data, moment.taps);
    const missed = others.filter((tap) => tap.outcome === "no_contact");  // of the others nothing is known of their way
    const most = Math.max(extent(surface.deviation)[1], 0);
    const title = "standard deviation [mm]";
    const below = { title: { text: title, side: "bottom" }, orientation: "h", y: 0, yanchor: "top", ypad: 0, thickness: 10, len: 0.9 };
    const colours = { colorscale: kUnknown, cmin: 0, cmax: most, colorbar: colourBar(title, this.spatial && kNarrow.matches ? below : { len: 0.8 }) };
    const next = nextOf(moment).map((one) => ({ ...one, on_object: one.along < one.length ? false : null }));
    const out = [
      ...this.arrows(on, "on the object", themed("ink")),
      ...this.arrows(off, "on the desk", themed("faint")),
      ...this.arrows(missed, "met nothing", "#e69f00"),
      ...this.arrows(next, "next", kNextColour, 1),
    ];
    if (!this.spatial) {
      const every = Math.ceil(surface.x.length / 4000);
      const some = (list) => list.filter((_, i) => i % every === 0);
      const words = some(surface.z).map((z) => `height ${shown(z, 3)} cm`);
      out.unshift(points("surface", some(surface.x), some(surface.y), words, { size: 4, color: some(surface.deviation), ...colours }));
      const { x, y } = this.withTruth ? this.truth() : {};
      if (this.withTruth) out.push({ type: "scatter", mode: "lines", name: "truth", x, y, line: { color: themed("ink"), width: 0.5 }, hoverinfo: "skip" });
      return out;
    }
    const { colorbar, colorscale, cmin, cmax } = colours;
    out.unshift({
      type: "mesh3d", name: "surface", ...surface, intensity: surface.deviation, colorscale, cmin, cmax, colorbar, flatshading: false,
      lighting: { ambient: 0.55, diffuse: 0.75, specular: 0.12, roughness: 0.7, vertexnormalsepsilon: 0, facenormalsepsilon: 0 },
      lightposition: { x: -1000, y: -2000, z: 3000 },
      text: surface.deviation.map((value) => shown(value, 2)),
      hovertemplate: "(%{x:.1f}, %{y:.1f}, %{z:.1f}) cm<br>standard deviation %{text} mm<extra></extra>",
    });
    if (this.withTruth) out.push({ type: "scatter3d", mode: "lines", name: "truth", ...this.truth(), line: { color: themed("accent"), width: 1.5 }, hoverinfo: "skip" });
    return out;
  }

  layout() {
    if (!this.spatial) return { ...planeAxes(this.data), showlegend: false };
    const lengths = this.range.map(([low, high]) => high - low);
    const side = Math.max(...lengths) / (kNarrow.matches ? 1.05 : 1.2);
    const ratio = (i) => lengths[i] / side;
    return turntable({
      aspectratio: { x: ratio(0), y: ratio(1), z: ratio(2) },
      camera: { eye: { x: 1.05, y: -1.45, z: 0.85 }, center: { x: 0, y: 0, z: -0.12 } },
      xaxis: axis("x [cm]", { range: this.range[0] }),
      yaxis: axis("y [cm]", { range: this.range[1] }),
      zaxis: axis("height [cm]", { range: this.range[2] }),
    });
  }

  draw(frame, moment) {
    return plot("surface", this.traces(frame, moment), this.layout());
  }
}
