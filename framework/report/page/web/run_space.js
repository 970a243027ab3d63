// SPDX-License-Identifier: MIT
// Closed surface and taps of a run from any side at one moment.

/// Returns the cumulative sums of `steps`, multiplied by `unit`.
function summed(steps, unit) {
  let sum = 0;
  return steps.map((step) => unit * (sum += step));
}

/// Returns a mesh for plotly in centimetres. The standard deviations of its vertices are in millimetres.
function unpackSurface({ x, y, z, i, j, k, deviation }) {
  const corners = { i: summed(i, 1), j: summed(j, 1), k: summed(k, 1) };
  return { x: summed(x, 0.01), y: summed(y, 0.01), z: summed(z, 0.01), ...corners, deviation: summed(deviation, 0.01) };
}

const fromAnySide = (tap) => tap["direction.x"] !== undefined;
const kAxes3 = ["x", "y", "z"];
const directionOf = (tap) => kAxes3.map((side) => tap[`direction.${side}`]);
/// Returns the position that is `way` metres along the path of a tap, in metres.
const along = (tap, way) => kAxes3.map((side, i) => tap[side] + way * directionOf(tap)[i]);

/// Returns a text about the direction of a tap.
function slant(tap) {
  const degrees = Math.round((Math.asin(-tap["direction.z"]) * 180) / Math.PI);
  if (degrees > 85) return "straight down";
  if (Math.abs(degrees) < 3) return "level";
  return `coming ${degrees > 0 ? "down" : "up"} at ${Math.abs(degrees)}°`;
}

const wayOf = (tap) => `from ${centimetres(...along(tap, 0))}, ${slant(tap)}`;

/// The surface with taps as arrows, in three dimensions. Nothing is shown if the browser has no WebGL.
class SpaceView {
  constructor(data, surfaces) {
    this.data = data;
    this.spatial = hasWebGL();
    this.surfaces = [];
    this.withTruth = false;
    this.grow(surfaces);
  }

  /// Returns the contours of the truth as closed lines with gaps between them, in centimetres.
  truth() {
    const out = { x: [], y: [], z: [] };
    for (const ring of this.data.true_contours) {
      for (const side of kAxes3) {
        const line = summed(ring[side], 0.01);
        out[side].push(...line, line[0], null);
      }
    }
    return out;
  }

  grow(surfaces) {
    this.surfaces.push(...surfaces);
    const taps = this.data.taps.filter((tap) => tap.on_object).map((tap) => along(tap, tap.along).map((value) => value * kCentimetres));
    const last = this.surfaces[this.surfaces.length - 1];
    const kRoom = 2.5;  // centimetres of free space for the arrows
    this.range = kAxes3.map((side, i) => {
      const area = [0, kCentimetres * [this.data.width, this.data.depth][i]];
      const [low, high] = extent([...last[side], ...taps.map((at) => at[i])]);
      if (low > high) return i < 2 ? area : [kCentimetres * this.data.desk, kCentimetres * this.data.desk + 15];
      return [i < 2 ? low - kRoom : kCentimetres * this.data.desk, high + kRoom];
    });
  }

  caption() {
    const what = "Reconstructed closed surface, coloured by its standard deviation. Arrows: taps, with tips where the tool stopped, on the object, on the desk (grey) or without a contact (orange). Magenta: the next tap.";
    return this.spatial ? `${what} Drag to turn${kFingers.matches ? "." : ", Ctrl and wheel to zoom."}` : "The surface is not drawn, because this browser has no WebGL.";
  }

  /// Returns the two ends of a tap's arrow: the last 3 cm of the path (6 cm for the next tap). For a tap without a
  /// contact, returns the ends of the part of the path within the picture, or null if there is no such part.
  arrow(tap) {
    const shaft = tap.word ? 0.06 : 0.03;  // The arrow of the next tap is longer.
    if (tap.on_object !== null) return [along(tap, Math.max(0, tap.along - shaft)), along(tap, tap.along)];
    let [begin, end] = [0, tap.along ?? tap.length];
    const [from, direction] = [along(tap, 0), directionOf(tap)];
    this.range.forEach((range, i) => {
      const ends = range.map((value) => (value / kCentimetres - from[i]) / direction[i]).sort((a, b) => a - b);
      if (direction[i] !== 0) [begin, end] = [Math.max(begin, ends[0]), Math.min(end, ends[1])];
    });
    return begin < end ? [along(tap, begin), along(tap, end)] : null;
  }

  /// Returns traces that show taps as arrows of one colour.
  arrows(taps, name, color, size = 0.7) {
    const drawn = taps.map((tap) => ({ ends: this.arrow(tap), tap })).filter(({ ends }) => ends);
    const words = ({ tap }) => tap.word ?? `${hover(tap)}<br>${slant(tap)}`;
    const side = (i) => drawn.flatMap(({ ends }) => [ends[0][i] * kCentimetres, ends[1][i] * kCentimetres, null]);
    const text = drawn.flatMap((one) => [words(one), words(one), ""]);
    const lines = { type: "scatter3d", mode: "lines", name, x: side(0), y: side(1), z: side(2), line: { color, width: 5 }, text, hovertemplate: "%{text}<extra></extra>" };
    const tip = (i) => drawn.map(({ ends }) => ends[1][i] * kCentimetres);
    const way = (i) => drawn.map(({ tap }) => directionOf(tap)[i]);
    const cones = {
      type: "cone", name, x: tip(0), y: tip(1), z: tip(2), u: way(0), v: way(1), w: way(2), anchor: "tip",
      sizemode: "raw", sizeref: size, showscale: false, colorscale: [[0, color], [1, color]], text: drawn.map(words), hovertemplate: "%{text}<extra></extra>",
    };
    return drawn.length > 0 ? [lines, cones] : [];
  }

  traces(frame, moment) {
    const surface = this.surfaces[frame];
    const [on, off, others] = tapsUntil(this.data, moment.taps);
    const missed = others.filter((tap) => tap.outcome === "no_contact");  // For other failed taps, the path is unknown.
    const most = Math.max(extent(surface.deviation)[1], 0);
    const next = nextOf(moment).map((one) => ({ ...one, on_object: one.along < one.length ? false : null }));
    const out = [
      ...this.arrows(on, "on the object", themed("ink")),
      ...this.arrows(off, "on the desk", themed("faint")),
      ...this.arrows(missed, "met nothing", "#e69f00"),
      ...this.arrows(next, "next", kNextColour, 1),
    ];
    out.unshift({
      type: "mesh3d", name: "surface", ...surface, intensity: surface.deviation, flatshading: false,
      colorscale: kUnknown, cmin: 0, cmax: most, colorbar: deviationBar("standard deviation [mm]"),
      lighting: { ambient: 0.55, diffuse: 0.75, specular: 0.12, roughness: 0.7, vertexnormalsepsilon: 0, facenormalsepsilon: 0 },
      lightposition: { x: -1000, y: -2000, z: 3000 },
      text: surface.deviation.map((value) => shown(value, 2)),
      hovertemplate: "(%{x:.1f}, %{y:.1f}, %{z:.1f}) cm<br>standard deviation %{text} mm<extra></extra>",
    });
    if (this.withTruth) out.push({ type: "scatter3d", mode: "lines", name: "truth", ...this.truth(), line: { color: themed("accent"), width: 1.5 }, hoverinfo: "skip" });
    return out;
  }

  layout() {
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
    return this.spatial ? plot("surface", this.traces(frame, moment), this.layout()) : undefined;
  }
}
