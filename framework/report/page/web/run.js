// SPDX-License-Identifier: MIT
// The page of a run: a slider over its taps, the surface and the maps as they were believed then, curves over all taps.

const kCentimetres = 100;

/// The maps of the page by name, each a list of frames, each a list of rows.
function unpackMaps(bytes, described, columns, rows) {
  const out = {};
  let at = 0;
  const cells = columns * rows;
  for (const { name, least, most, frames } of described) {
    out[name] = [];
    for (let frame = 0; frame < frames; ++frame, at += 2 * cells) {
      const lines = [];
      let level = 0;
      for (let row = 0, cell = 0; row < rows; ++row) {
        const line = new Array(columns);
        for (let column = 0; column < columns; ++column, ++cell) {
          level = (level + bytes[at + cell] + 256 * bytes[at + cells + cell]) & 0xffff;
          line[column] = least + (level / 65535) * (most - least);
        }
        lines.push(line);
      }
      out[name].push(lines);
    }
  }
  return out;
}

const scaled = (lines, factor) => lines.map((line) => line.map((value) => value * factor));
const product = (a, b) => a.map((line, row) => line.map((value, column) => value * b[row][column]));

function extent(frames) {
  let least = Infinity;
  let most = -Infinity;
  for (const lines of frames) {
    for (const line of lines) {
      for (const value of line) {
        if (value < least) least = value;
        if (value > most) most = value;
      }
    }
  }
  return [least, most];
}

/// The taps up to `taps`, by what they touched.
function tapsUntil(rows, taps) {
  const made = rows.slice(0, taps);
  return {
    on: made.filter((tap) => tap.on_surface === true),
    off: made.filter((tap) => tap.on_surface === false),
    failed: made.filter((tap) => tap.on_surface === null),
  };
}

const place = (tap) => `(${shown(tap.x * kCentimetres, 3)}, ${shown(tap.y * kCentimetres, 3)}) cm`;

function hover(tap) {
  const found = tap.on_surface === null ? tap.outcome : `${shown(tap.height * kCentimetres, 3)} cm`;
  return `tap ${tap.tap}: ${plain(found)}`;
}

/// Taps as marks in the plane: dots on the object, crosses off it, triangles where nothing was felt; a star is next.
function marks(data, moment) {
  const { on, off, failed } = tapsUntil(data.taps, moment.taps);
  const trace = (taps, name, marker) => ({
    type: "scatter",
    mode: "markers",
    name,
    x: taps.map((tap) => tap.x * kCentimetres),
    y: taps.map((tap) => tap.y * kCentimetres),
    text: taps.map(hover),
    hovertemplate: "%{text}<extra></extra>",
    marker,
  });
  const line = (colour, width) => ({ color: colour, width });
  const next = moment.next ? [moment.next] : [];
  const star = trace(next, "next", { symbol: "star", size: 15, color: "#e8112d", line: line("#ffffff", 1.2) });
  star.text = next.map(() => `next, tap ${moment.taps + 1}`);
  return [
    trace(on, "on the object", { symbol: "circle", size: 9, color: "#ffffff", line: line("#000000", 1.6) }),
    trace(off, "off the object", { symbol: "x-thin", size: 9, line: line("#ffffff", 4) }),
    { ...trace(off, "off the object", { symbol: "x-thin", size: 8, line: line("#000000", 1.8) }), showlegend: false },
    trace(failed, "no contact", { symbol: "triangle-up-open", size: 9, line: line("#e8112d", 2), color: "#e8112d" }),
    star,
  ];
}

/// The panels over the plane: what each shows, in which colours and range.
function mapPanels(data, maps) {
  const exploration = maps.u.map((lines, frame) => product(lines, maps.w[frame]));
  const most = Math.max(extent(exploration)[1], 1e-12);
  const panels = [
    { id: "u", title: "Uncertainty u", bar: "u", frames: maps.u, range: [0, 1], colours: "Viridis" },
    { id: "w", title: "Weight w", bar: "w", frames: maps.w, range: [0, 1], colours: "Cividis" },
    { id: "e", title: "Exploration e = u w", bar: "e", frames: exploration, range: [0, most], colours: "Viridis" },
  ];
  if (maps.score) {
    const title = `Score of the acquisition, ${data.run.acquisition}`;
    panels.push({ id: "score", title, bar: "score", frames: maps.score, range: extent(maps.score), colours: "Viridis" });
  }
  return panels;
}

const axis = (title, more = {}) => ({ title: { text: title }, zeroline: false, ...more });

/// From edge to edge of the cells, centimetres equally long in both directions.
function planeAxes(data) {
  const range = (centres) => {
    const half = centres.length > 1 ? (centres[1] - centres[0]) / 2 : 0.005;
    return [(centres[0] - half) * kCentimetres, (centres[centres.length - 1] + half) * kCentimetres];
  };
  return {
    xaxis: axis("x [cm]", { range: range(data.x), constrain: "domain" }),
    yaxis: axis("y [cm]", { range: range(data.y), constrain: "domain", scaleanchor: "x" }),
  };
}

function heatMap(data, lines, range, colours, title) {
  return {
    type: "heatmap",
    x: data.x.map((value) => value * kCentimetres),
    y: data.y.map((value) => value * kCentimetres),
    z: lines,
    zmin: range[0],
    zmax: range[1],
    colorscale: colours,
    colorbar: { title: { text: title, side: "right" }, thickness: 12, xpad: 4 },
    hovertemplate: "x %{x:.1f} cm, y %{y:.1f} cm: %{z:.4g}<extra></extra>",
  };
}

/// The surface in three dimensions, or as a map where the browser has no WebGL.
class SurfaceView {
  constructor(data, maps) {
    this.data = data;
    this.spatial = hasWebGL();
    this.heights = maps.height.map((lines) => scaled(lines, kCentimetres));
    this.deviations = maps.deviation.map((lines) => scaled(lines, kCentimetres));
    this.truth = maps.truth ? scaled(maps.truth[0], kCentimetres) : null;
    this.range = extent(this.truth ? [...this.heights, this.truth] : this.heights);
    // Where nothing is known of an object's level, its deviation is of no size that means anything.
    const prior = Math.max(...data.moments.map((moment) => moment.largest_deviation)) * kCentimetres;
    this.mostDeviation = Math.min(extent(this.deviations)[1], prior);
    this.withTruth = false;
    this.x = data.x.map((value) => value * kCentimetres);
    this.y = data.y.map((value) => value * kCentimetres);
  }

  caption() {
    return this.spatial
      ? "Reconstructed surface, coloured by the standard deviation of its height; discs: taps on the object, crosses: taps off it. Drag to turn."
      : "Reconstructed height. (This browser has no WebGL: the surface is a map instead of a picture in three dimensions.)";
  }

  traces(frame, moment) {
    if (!this.spatial) {
      const heights = this.withTruth && this.truth ? this.truth : this.heights[frame];
      return [heatMap(this.data, heights, this.range, "Viridis", "height [cm]"), ...marks(this.data, moment)];
    }
    const surface = {
      type: "surface",
      x: this.x,
      y: this.y,
      z: this.heights[frame],
      surfacecolor: this.deviations[frame],
      cmin: 0,
      cmax: this.mostDeviation,
      colorscale: "Viridis",
      colorbar: { title: { text: "standard deviation [cm]", side: "right" }, thickness: 12, len: 0.8 },
      hovertemplate: "x %{x:.1f} cm, y %{y:.1f} cm<br>height %{z:.2f} cm<br>standard deviation %{surfacecolor:.2f} cm<extra></extra>",
    };
    const { on, off } = tapsUntil(this.data.taps, moment.taps);
    const lift = 0.015 * (this.range[1] - this.range[0]);  // or half of every mark would be inside of the surface
    const points = (taps, name, marker) => ({
      type: "scatter3d",
      mode: "markers",
      name,
      x: taps.map((tap) => tap.x * kCentimetres),
      y: taps.map((tap) => tap.y * kCentimetres),
      z: taps.map((tap) => tap.height * kCentimetres + lift),
      text: taps.map(hover),
      hovertemplate: "%{text}<extra></extra>",
      marker,
    });
    const out = [
      surface,
      points(on, "on the object", { symbol: "circle", size: 6, color: "#ffffff", line: { color: "#000000", width: 2 } }),
      points(off, "off the object", { symbol: "cross", size: 5, color: "#000000" }),
    ];
    if (this.withTruth && this.truth) out.push(this.wireframe());
    return out;
  }

  wireframe() {
    const lines = (values) => ({ show: true, color: "#000000", width: 1, start: values[0], end: values[values.length - 1], size: 2 * (values[1] - values[0]) });
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
    if (!this.spatial) return layout({ ...planeAxes(this.data), showlegend: false });
    const range = [Math.min(this.range[0], 0), this.range[1] * 1.05 + 0.1];
    return layout({
      margin: { l: 0, r: 0, t: 0, b: 0 },
      showlegend: false,
      uirevision: "keep the view",
      scene: {
        aspectmode: "data",
        camera: { eye: { x: 1.2, y: -1.6, z: 1.05 }, center: { x: 0, y: 0, z: -0.15 } },
        xaxis: axis("x [cm]"),
        yaxis: axis("y [cm]"),
        zaxis: axis("height [cm]", { range }),
      },
    });
  }

  draw(frame, moment) {
    return Plotly.react("surface", this.traces(frame, moment), this.layout(), kPlotConfig);
  }
}

/// The parameters of a process that a curve shows, by name: of the kernel, and signal, noise, mean.
function hyperparameters(process) {
  if (!process) return {};
  const out = { ...process.kernel };
  for (const name of ["signal", "noise", "mean"]) out[name] = process[name];
  return out;
}

/// What is drawn over the taps: a list of {title, unit or axis, lines: [{name, values}], logarithmic}. Values stand at all
/// moments; what a run has not is left out.
function curves(data) {
  const moments = data.moments;
  const over = (get) => moments.map((moment) => get(moment) ?? null);
  const line = (name, get) => ({ name, values: over(get) });
  const process = (kind) => (moment) => moment[kind];
  const out = [
    {
      title: "Error of the reconstruction (root mean square)",
      unit: "cm",
      lines: [
        line("scene", (m) => m.rmse_m && m.rmse_m * kCentimetres),
        line("on the object", (m) => m.rmse_on_surface_m && m.rmse_on_surface_m * kCentimetres),
        line("height mean on the object", (m) => m.rmse_height_m && m.rmse_height_m * kCentimetres),
      ],
    },
    { title: "Outline: intersection over union", axis: "IoU", range: [-0.02, 1.02], lines: [line("IoU", (m) => m.footprint_iou)] },
    { title: "Largest standard deviation of a height", unit: "cm", fromZero: true, lines: [line("largest", (m) => m.largest_deviation * kCentimetres)] },
    {
      title: "Share of taps on the object",
      axis: "share",
      range: [-0.02, 1.02],
      lines: [line("share", (m) => (m.taps > 0 ? m.on_surface_taps / m.taps : null))],
    },
    {
      title: "Log marginal likelihood",
      unit: "nat",
      lines: [
        line("heights", (m) => m.height_process?.log_marginal_likelihood),
        line("labels", (m) => m.weight_process?.log_marginal_likelihood),
        line("surface", (m) => m.surface_process?.log_marginal_likelihood),
      ],
    },
    { title: "Robot time so far", unit: "s", fromZero: true, lines: [line("robot", (m) => m.robot_seconds)] },
  ];
  for (const [kind, label] of [["height_process", "heights"], ["weight_process", "labels"], ["surface_process", "surface"]]) {
    const names = Object.keys(hyperparameters(moments[moments.length - 1][kind])).filter((name) => name !== "mean");
    const lines = names.map((name) => line(name, (m) => hyperparameters(process(kind)(m))[name]));
    out.push({ title: `Hyperparameters, ${label} (SI units)`, axis: "value", logarithmic: true, lines });
  }
  out.push(timeCurves(data));
  return out
    .map((one) => ({ ...one, lines: one.lines.filter(({ values }) => values.some((value) => value !== null)) }))
    .filter((one) => one.lines.length > 0);
}

/// Milliseconds of each tap by phase, of timings.csv.
function timeCurves(data) {
  const [header, ...rows] = data.timings.trim().split("\n").map((row) => row.split(","));
  const phases = (header ?? []).slice(1).filter((name) => name !== "robot");
  const at = (name) => (header ?? []).indexOf(name);
  const lines = phases.map((name) => ({
    name,
    values: data.moments.map((moment) => {
      const row = rows[moment.taps - 1];
      return row ? 1000 * Number(row[at(name)]) : null;
    }),
  }));
  return { title: "Computing time of a tap, by phase", unit: "ms", lines };
}

function curveTraces(one, data) {
  return one.lines.map(({ name, values }, i) => ({
    type: "scatter",
    mode: "lines+markers",
    name: plain(name),
    x: data.moments.map((moment) => moment.taps),
    y: one.logarithmic ? values.map((value) => (value > 0 ? value : null)) : values,
    line: { color: kColours[i % kColours.length], width: 1.8 },
    marker: { size: 4, symbol: ["circle", "square", "diamond", "triangle-up", "x"][i % 5] },
    hovertemplate: `%{y:.4g}<extra>${plain(name)}</extra>`,
  }));
}

function curveLayout(one) {
  return layout({
    xaxis: axis("taps", { rangemode: "tozero" }),
    yaxis: axis(one.axis ?? `[${one.unit}]`, { automargin: true, type: one.logarithmic ? "log" : "linear", dtick: one.logarithmic ? 1 : undefined, range: one.range, rangemode: one.fromZero ? "tozero" : "normal", exponentformat: "power" }),
    showlegend: one.lines.length > 1,
    legend: { orientation: "h", y: 1.02, yanchor: "bottom", font: { size: 11 } },
    hovermode: "x unified",
  });
}

function facts(data) {
  const last = data.moments[data.moments.length - 1];
  const cm = (value) => (value === null || value === undefined ? null : `${shown(value * kCentimetres, 3)} cm`);
  const items = [
    ["taps", `${last.taps} of ${data.run.budget}`],
    ["on the object", last.on_surface_taps],
    ["off", last.off_surface_taps],
    ["no contact", last.failed_taps || null],
    ["first hit at tap", data.summary?.first_hit_tap],
    ["rmse, scene", cm(last.rmse_m)],
    ["rmse on the object", cm(last.rmse_on_surface_m)],
    ["outline IoU", last.footprint_iou === null ? null : shown(last.footprint_iou, 3)],
    ["95 % coverage", data.summary?.coverage_95 === undefined ? null : shown(data.summary.coverage_95, 3)],
    ["robot time", `${shown(last.robot_seconds, 3)} s`],
  ].filter(([, value]) => value !== null && value !== undefined && value !== "–");
  return element("ul", { class: "facts" }, ...items.map(([name, value]) => element("li", {}, element("b", {}, String(value)), element("span", {}, name))));
}

const kChosenBy = { initial: "the initial design", acquisition: "the acquisition", fallback: "the fallback" };

/// The moment in words.
function story(data, moment) {
  const out = [];
  const tap = data.taps[moment.taps - 1];
  if (tap) {
    const what =
      tap.on_surface === null
        ? `brought no contact (${tap.outcome}${tap.reason ? `: ${tap.reason}` : ""})`
        : `touched ${tap.on_surface ? "the object" : "the desk"} at ${shown(tap.height * kCentimetres, 4)} cm`;
    const why = tap.why ? ` (${tap.why})` : "";
    out.push(`Tap ${tap.tap} at ${place(tap)}, chosen by ${kChosenBy[tap.source]}${why}, ${what}. `);
  } else {
    out.push("Before the first tap. ");
  }
  out.push(`So far ${moment.on_surface_taps} on the object, ${moment.off_surface_taps} off. `);
  if (moment.next) {
    const score = moment.next.score === null ? "" : `, score ${shown(moment.next.score)}`;
    const ties = moment.next.ties > 1 ? `, one of ${moment.next.ties} that are tied` : "";
    out.push(`Next: ${place(moment.next)}, by ${kChosenBy[moment.next.source]}${score}${ties}. `);
  } else {
    out.push("No candidate is left. ");
  }
  if (moment.least_weight < -1e-6 || moment.most_weight > 1 + 1e-6) {
    out.push(`w leaves [0, 1] here: ${shown(moment.least_weight, 3)} to ${shown(moment.most_weight, 3)}; its colours end at 0 and 1.`);
  }
  return element("p", { class: "story", id: "story" }, foreign(out.join("")));
}

/// Everything that changes with the slider.
class Slider {
  constructor(data, maps) {
    this.data = data;
    this.surface = new SurfaceView(data, maps);
    this.panels = mapPanels(data, maps);
    this.curves = curves(data);
    this.input = element("input", { type: "range", id: "slider", min: 0, max: data.shown.length - 1, step: 1, value: data.shown.length - 1, "aria-label": "tap" });
    this.output = element("output", { id: "at", for: "slider" });
    this.truth = element("input", { type: "checkbox", id: "truth" });
    this.drawing = Promise.resolve();
  }

  controls() {
    const out = element("div", { class: "controls" }, this.output, this.input);
    if (this.data.run.truth) out.append(element("label", {}, this.truth, this.surface.spatial ? " truth as wireframe" : " truth instead"));
    return out;
  }

  listen() {
    this.input.addEventListener("input", () => this.show());
    this.truth.addEventListener("change", () => {
      this.surface.withTruth = this.truth.checked;
      this.show();
    });
    // Arrow keys move the slider wherever the focus is, but in what takes keys itself.
    document.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      const busy = event.target !== this.input && event.target.closest?.("input, select, textarea");
      if (!step || busy || event.altKey || event.ctrlKey || event.metaKey) return;
      event.preventDefault();
      this.input.value = Number(this.input.value) + step;
      this.show();
    });
  }

  /// Draws the moment of the slider. One drawing at a time: of several wishes in between only the last is fulfilled.
  show() {
    this.wanted = Number(this.input.value);
    const wanted = this.wanted;
    this.drawing = this.drawing.then(() => (wanted === this.wanted ? this.draw(wanted) : undefined));
    return this.drawing;
  }

  async draw(frame) {
    const moment = this.data.moments[this.data.shown[frame]];
    this.output.textContent = `after tap ${moment.taps} of ${this.data.taps.length}`;
    document.getElementById("story").replaceWith(story(this.data, moment));
    await this.surface.draw(frame, moment);
    for (const { id, bar, frames, range, colours } of this.panels) {
      const traces = [heatMap(this.data, frames[frame], range, colours, bar), ...marks(this.data, moment)];
      await Plotly.react(`map_${id}`, traces, layout({ ...planeAxes(this.data), margin: { l: 44, r: 4, t: 6, b: 40 }, showlegend: false }), kPlotConfig);
    }
    const here = { type: "line", x0: moment.taps, x1: moment.taps, yref: "paper", y0: 0, y1: 1, line: { color: "#999999", width: 1, dash: "dot" } };
    await Promise.all(this.curves.map((one, i) => Plotly.relayout(`curve_${i}`, { shapes: [here] })));
    document.body.dataset.drawn = String(moment.taps);  // for whoever waits for the picture
  }
}

function drawRun(data, bytes) {
  const maps = unpackMaps(bytes, data.maps, data.x.length, data.y.length);
  const slider = new Slider(data, maps);
  const run = data.run;
  document.title = `${run.name} ${run.id} – palpate`;
  const state = run.state === "done" ? `stopped by: ${run.stop_reason}` : run.state;
  const thinned = data.shown.length < data.moments.length ? ` Maps are kept for ${data.shown.length} of ${data.moments.length} moments, so that this page stays small.` : "";
  const strategy = element("p", { class: "sub" }, "id ", run.id, `, seed ${run.seed}, acquisition `, foreign(run.acquisition), ", ", foreign(state), ".");
  document.body.append(
    element("h1", {}, foreign(run.name)),
    strategy,
    facts(data),
    ...(data.warnings.length > 0 ? [element("ul", { class: "warnings", id: "warnings" }, ...data.warnings.map((text) => element("li", {}, foreign(text))))] : []),
    slider.controls(),
    element("p", { class: "story", id: "story" }),
    element("div", { class: "tall" }, figure("surface", slider.surface.caption())),
    element("h2", {}, "Maps"),
    element("div", { class: "row", id: "maps_row" }, ...slider.panels.map(({ id, title }) => figure(`map_${id}`, foreign(title)))),
    element("p", { class: "sub" }, `Dots: taps on the object, crosses: off it, triangles: no contact; the star would be tapped next. Arrow keys move the slider.${thinned}`),
    element("h2", {}, "By tap"),
    element("div", { class: "row small" }, ...slider.curves.map(({ title }, i) => figure(`curve_${i}`, title))),
    section("Config", table(["key", "value", "where it was said"], data.config.map((line) => line.map(foreign)))),
    section("Made by", table(["", ""], data.build.map((line) => line.map(foreign)))),
    element("footer", {}, `palpate ${data.version}; method: Sun and Min 2021, arXiv:2110.09593; drawn with plotly.js (MIT).`),
  );
  slider.curves.forEach((one, i) => Plotly.newPlot(`curve_${i}`, curveTraces(one, data), curveLayout(one), kPlotConfig));
  slider.listen();
  return slider.show();
}

openPage(drawRun);
