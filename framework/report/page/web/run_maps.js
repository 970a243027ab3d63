// SPDX-License-Identifier: MIT
// Surface and maps of a run at one moment, with its taps.

/// Unpacks the maps that pack_maps() in run_page.cpp has packed. Returns an object from names to maps. A map is a list
/// of frames, and a frame is a list of rows.
function unpackMaps(bytes, described, columns, rows) {
  const out = {};
  const cells = columns * rows;
  let at = 0;
  for (const { name, least, most, frames, colours } of described) {
    if (colours) out[`${name}_colours`] = colours;
    out[name] = Array.from({ length: frames }, (_, frame) => {
      const begin = at + 2 * cells * frame;
      let level = 0;
      const valueOf = (cell) => {
        level = (level + bytes[begin + cell] + 256 * bytes[begin + cells + cell]) & 0xffff;
        return least + (level / 65535) * (most - least);
      };
      return Array.from({ length: rows }, (_, row) => Array.from({ length: columns }, (_, column) => valueOf(row * columns + column)));
    });
    at += 2 * cells * frames;
  }
  return out;
}

const scaled = (lines, factor) => lines.map((line) => line.map((value) => value * factor));
const product = (a, b) => a.map((line, row) => line.map((value, column) => value * b[row][column]));

/// Returns whether the contact of a tap has the label "on an object" at a moment. Returns null for a tap without a
/// contact.
const labelAt = (moment, tap) => (tap.on_object === null ? null : tap.on_object !== moment.relabelled.includes(tap.tap));

/// Returns the first `taps` taps of a run in three lists: on the object, on the desk, failed. The labels are the labels
/// after these taps.
const tapsUntil = (run, taps) => [true, false, null].map((touched) => run.taps.slice(0, taps).filter((tap) => labelAt(run.moments[taps], tap) === touched));

const centimetres = (...metres) => `(${metres.map((value) => shown(value * kCentimetres, 3)).join(", ")}) cm`;
const place = (tap) => centimetres(tap.x, tap.y);

function hover(tap) {
  const found = tap.on_object === null ? tap.outcome : `${shown(tap.height * kCentimetres, 3)} cm`;
  return `tap ${tap.tap}: ${plain(found)}`;
}

/// Returns a list with the next tap, or an empty list. `word` is the hover text.
const nextOf = (moment) => (moment.next ? [{ ...moment.next, word: `next, tap ${moment.taps + 1}` }] : []);

/// Returns a trace with marks of taps in the plane. If a tap has `word`, it is the hover text.
function markTrace(taps, name, marker, more = {}) {
  const along = (side) => taps.map((tap) => tap[side] * kCentimetres);
  return points(name, along("x"), along("y"), taps.map((tap) => tap.word ?? hover(tap)), marker, more);
}

const kNextColour = "#e6007e";
const edge = (color, width) => ({ color, width });

/// Returns the taps that are suspected outliers at this moment. The hover text has probability and reason.
const suspectedOf = (data, moment) =>
  (moment.suspected_outliers ?? []).map((one) => ({ ...data.taps[one.tap - 1], word: `tap ${one.tap} may be an outlier: ${one.words}` }));

/// Returns crosses that are visible on dark and on light backgrounds.
const deskMarks = (taps) => [
  markTrace(taps, "on the desk", { symbol: "x-thin", size: 9, line: edge("#ffffff", 4) }),
  markTrace(taps, "on the desk", { symbol: "x-thin", size: 8, line: edge("#000000", 1.8) }, { showlegend: false }),
];

/// Returns the marks of taps in the plane: discs for taps on the object, crosses for the desk, squares for failed taps,
/// rings around suspected outliers, a star for the next tap.
function marks(data, moment) {
  const [on, off, failed] = tapsUntil(data, moment.taps);
  const suspected = suspectedOf(data, moment);
  const ring = markTrace(suspected, "suspected outliers", { symbol: "circle-open", size: 18, line: edge("#e8112d", 2.4) });
  return [
    ...(suspected.length > 0 ? [ring] : []),
    markTrace(on, "on the object", { symbol: "circle", size: 9, color: "#ffffff", line: edge("#000000", 1.6) }),
    ...deskMarks(off),
    markTrace(failed, "failed", { symbol: "square", size: 8, line: edge("#000000", 1), color: "#e69f00" }),
    markTrace(nextOf(moment), "next", { symbol: "star", size: 15, color: kNextColour, line: edge("#ffffff", 1.2) }),
  ];
}

/// Returns the panels of maps, and {title, value} for each map that has the same value in all cells and at all moments.
/// On a page that receives updates, no map counts as constant.
function mapPanels(data, maps) {
  const panel = (id, of, rangeOf = () => [0, 1], colours = kWhere) => {
    const frames = of(maps);
    return { id, title: data.titles[id], bar: id, of, frames, rangeOf, range: rangeOf(frames), colours };
  };
  const panels = [panel("u", ({ u }) => u, () => [0, 1], kUnknown)];
  if (maps.p) {
    panels.push(panel("p", ({ p }) => p));
  } else {
    const exploration = ({ u, w }) => u.map((lines, frame) => product(lines, w[frame]));
    const upTo = (frames) => {
      const largest = extent(frames.flat(2))[1];
      return [0, largest > 1e-6 ? largest : 1];  // If all values are only rounding errors, the range is 0 to 1.
    };
    panels.push(panel("w", ({ w }) => w), panel("e", exploration, upTo));
  }
  if (maps.score) panels.push(panel("score", ({ score }) => score, (frames) => extent(frames.flat(2))));
  const varied = ({ frames }) => {
    const [least, most] = extent(frames.flat(2));
    return data.live !== undefined || most - least > 1e-6;  // Differences up to 1e-6 are rounding errors.
  };
  const constant = panels.filter((one) => !varied(one)).map(({ title, frames }) => ({ title, value: frames[0][0][0] }));
  return [panels.filter(varied), constant];
}

/// Returns the colour bar of a surface. It is next to the surface, or below it on a narrow screen.
function deviationBar(label) {
  const below = { title: { text: label, side: "bottom" }, orientation: "h", y: 0, yanchor: "top", ypad: 0, thickness: 10, len: 0.9 };
  return colourBar(label, kNarrow.matches ? below : { len: 0.8 });
}

/// Returns colours for standard deviations of the height in centimetres. The second argument is the colour scale of the
/// frame, from the data of the page.
function deviationColours(lines, { low, high, logarithmic, label }) {
  const bar = deviationBar(label);
  if (!logarithmic) return { surfacecolor: lines, cmin: low, cmax: high, colorbar: bar };
  const powers = [-4, -3, -2, -1, 0, 1, 2, 3, 4, 5].map((power) => 10 ** power);
  const ticks = powers.flatMap((power) => [power, 2 * power, 5 * power]).filter((value) => value >= low && value <= high);
  return {
    surfacecolor: lines.map((line) => line.map((value) => Math.log10(Math.max(value, low)))),
    cmin: Math.log10(low),
    cmax: Math.log10(high),
    colorbar: { ...bar, tickvals: ticks.map(Math.log10), ticktext: ticks.map((value) => shown(value, 1)) },
  };
}

/// Returns axes over the whole area with the same scale in both directions.
function planeAxes(data) {
  const range = (side) => [0, side * kCentimetres];
  return {
    xaxis: axis("x [cm]", { range: range(data.width), constrain: "domain" }),
    yaxis: axis("y [cm]", { range: range(data.depth), constrain: "domain", scaleanchor: "x" }),
  };
}

/// Returns the positions of a map's cells along an axis. A single cell also needs its width, which plotly cannot infer.
function cells(name, centres, side) {
  if (centres.length > 1) return { [name]: centres.map((value) => value * kCentimetres) };
  return { [`${name}0`]: (side / 2) * kCentimetres, [`d${name}`]: side * kCentimetres };
}

function heatMap(data, lines, range, colours, title) {
  return {
    type: "heatmap",
    ...cells("x", data.x, data.width),
    ...cells("y", data.y, data.depth),
    z: lines,
    zmin: range[0],
    zmax: range[1],
    colorscale: colours,
    colorbar: colourBar(title, { xpad: 4, exponentformat: "power" }),
    hovertemplate: "x %{x:.1f} cm, y %{y:.1f} cm: %{z:.4g}<extra></extra>",
  };
}

/// The surface in three dimensions. If the browser has no WebGL, it is shown as a map.
class SurfaceView {
  constructor(data, maps) {
    this.data = data;
    this.flat = data.x.length < 2 || data.y.length < 2;  // whether the grid is a single line of cells
    this.spatial = hasWebGL() && !this.flat;
    this.heights = [];
    this.deviations = [];
    this.colours = [];
    this.grow(maps);
    this.withTruth = false;
    this.x = data.x.map((value) => value * kCentimetres);
    this.y = data.y.map((value) => value * kCentimetres);
  }

  /// Adds the maps of further moments, and replaces the true heights by their current state.
  grow(maps) {
    this.heights.push(...maps.height.map((lines) => scaled(lines, kCentimetres)));
    this.deviations.push(...maps.deviation.map((lines) => scaled(lines, kCentimetres)));
    this.colours.push(...maps.deviation_colours);
    this.truth = maps.truth ? scaled(maps.truth[0], kCentimetres) : null;
    this.range = extent([...this.heights, this.truth ?? []].flat(2));
    // Marks are shown this much above the surface, which would otherwise hide their lower halves.
    this.lift = 0.06 * (this.range[1] - this.range[0]);
  }

  caption() {
    if (this.flat) return "Reconstructed height.";
    return this.spatial
      ? "Reconstructed surface, coloured by the standard deviation of its height; on pins, discs: taps on the object, crosses: taps on the desk, star: the next tap. Drag to turn" + (kFingers.matches ? "." : ", Ctrl and wheel to zoom.")
      : "Reconstructed height. (This browser has no WebGL: the page shows a map instead of a picture in three dimensions.)";
  }

  traces(frame, moment) {
    if (!this.spatial) {
      const heights = this.withTruth && this.truth ? this.truth : this.heights[frame];
      return [heatMap(this.data, heights, this.range, kWhere, "height [cm]"), ...marks(this.data, moment)];
    }
    const surface = {
      type: "surface",
      x: this.x,
      y: this.y,
      z: this.heights[frame],
      // The colour scale is chosen per frame, because a fit of the hyperparameters may change the standard deviations
      // by a factor of a hundred.
      ...deviationColours(this.deviations[frame], this.colours[frame]),
      colorscale: kUnknown,
      customdata: this.deviations[frame],
      hovertemplate: "x %{x:.1f} cm, y %{y:.1f} cm<br>height %{z:.4r} cm<br>standard deviation %{customdata:.3r} cm<extra></extra>",
    };
    const [on, off] = tapsUntil(this.data, moment.taps);
    // The mark of the next tap is at the top of the plot, so that the surface never hides it. The arm also comes from
    // above.
    const above = this.range[1] / kCentimetres;
    const next = nextOf(moment).map((one) => ({ ...one, height: this.heightAt(frame, one) / kCentimetres, above }));
    const raised = (taps, name, marker) => markTrace(taps, name, marker, { type: "scatter3d", z: taps.map((tap) => this.pin(tap)[1]) });
    const out = [
      surface,
      this.pins([...on, ...off, ...next]),
      raised(on, "on the object", { symbol: "circle", size: kNarrow.matches ? 4 : 6, color: "#ffffff", line: edge("#000000", 2) }),
      raised(off, "on the desk", { symbol: "cross", size: 5, color: themed("ink") }),
      // In three dimensions, plotly has no star symbols. Text such as ★ is possible and always faces the viewer.
      {
        ...raised(next, "next", {}),
        mode: "text",
        text: next.map(() => "★"),
        textposition: "middle center",
        textfont: { size: 26, color: kNextColour, family: "DejaVu Sans, sans-serif" },
        customdata: next.map((one) => one.word),
        hovertemplate: "%{customdata}<extra></extra>",
      },
    ];
    if (this.withTruth && this.truth) out.push(this.wireframe());
    return out;
  }

  /// Returns the ends of the vertical line from the surface up to the mark of a tap.
  pin(tap) {
    const [foot, above] = [tap.height, tap.above ?? tap.height].map((height) => height * kCentimetres);
    return [foot, above + this.lift];
  }

  pins(taps) {
    const along = (ends) => taps.flatMap((tap) => [...ends(tap), null]);
    const twice = (side) => along((tap) => [tap[side] * kCentimetres, tap[side] * kCentimetres]);
    return {
      type: "scatter3d",
      mode: "lines",
      name: "pins",
      x: twice("x"),
      y: twice("y"),
      z: along((tap) => this.pin(tap)),
      line: { color: themed("ink"), width: 2 },
      hoverinfo: "skip",
    };
  }

  /// Returns the reconstructed height at a position, in centimetres.
  heightAt(frame, { x, y }) {
    const nearest = (centres, at) => centres.reduce((best, centre, i) => (Math.abs(centre - at) < Math.abs(centres[best] - at) ? i : best), 0);
    return this.heights[frame][nearest(this.data.y, y)][nearest(this.data.x, x)];
  }

  /// Returns a panel with the standard deviations that the colours of the surface show.
  deviationPanel() {
    const rangeOf = (frames) => [0, extent(frames.flat(2))[1]];
    const frames = this.deviations;  // grow() extends this list.
    return { id: "deviation", title: this.data.titles.deviation, bar: "cm", of: () => [], frames, rangeOf, range: rangeOf(frames), colours: kUnknown };
  }

  wireframe() {
    const lines = (values) => ({ show: true, color: themed("ink"), width: 1, start: values[0], end: values[values.length - 1], size: 2 * (values[1] - values[0]) });
    return {
      type: "surface",
      name: "truth",
      x: this.x,
      y: this.y,
      z: this.truth,
      hidesurface: true,
      showscale: false,
      hoverinfo: "skip",
      contours: { x: lines(this.x), y: lines(this.y) },
    };
  }

  layout() {
    if (!this.spatial) return { ...planeAxes(this.data), showlegend: false };
    const low = Math.min(this.range[0], this.data.desk * kCentimetres);
    const range = [low, this.range[1] + this.lift + 0.05 * (this.range[1] - low) + 0.1];
    const [width, depth] = [this.data.width, this.data.depth].map((metres) => metres * kCentimetres);
    // With this scale, the surface fills the plot. On a narrow screen the scale is smaller, because the surface would
    // otherwise reach the colour bar below.
    const side = Math.max(width, depth) / (kNarrow.matches ? 1.05 : 1.3);
    return turntable({
      aspectratio: { x: width / side, y: depth / side, z: Math.max((range[1] - range[0]) / side, 0.15) },
      camera: { eye: { x: 1.2, y: -1.6, z: 1.05 }, center: { x: 0, y: 0, z: kNarrow.matches ? -0.1 : -0.22 } },
      xaxis: axis("x [cm]", { range: [0, width] }),
      yaxis: axis("y [cm]", { range: [0, depth] }),
      zaxis: axis("height [cm]", { range }),
    });
  }

  draw(frame, moment) {
    return plot("surface", this.traces(frame, moment), this.layout());
  }
}
