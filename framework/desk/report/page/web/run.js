// SPDX-License-Identifier: MIT
// The page of a run: a slider over its taps, the surface and the maps as they were believed then, curves over all taps.

function facts(data) {
  const last = data.moments[data.moments.length - 1];
  const cm = (value) => (value === null || value === undefined ? null : `${shown(value * kCentimetres, 3)} cm`);
  const items = [
    ["taps", `${last.taps} of ${data.run.budget}`],
    ["on the object", last.on_surface_taps],
    ["off", last.off_surface_taps],
    ["no contact", last.failed_taps || null],
    ["first hit at tap", data.summary?.first_hit_tap],
    ...data.errors.map(([name, label, unit]) => (unit === "m" ? [`rmse ${label}`, cm(last[name])] : [label, last[name] === null ? null : shown(last[name], 3)])),
    ["95 % coverage", data.summary?.coverage_95 === undefined ? null : shown(data.summary.coverage_95, 3)],
    ["robot time", `${shown(last.robot_seconds, 3)} s`],
  ].filter(([, value]) => value !== null && value !== undefined && value !== "–");
  return element("ul", { class: "facts" }, ...items.map(([name, value]) => element("li", {}, element("b", {}, String(value)), element("span", {}, name))));
}

const kChosenBy = { initial: "the initial design", acquisition: "the acquisition", fallback: "the fallback" };

/// The moment in words.
function story(data, moment, drawn) {
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
  if (moment.remark) out.push(`The footprint, ${data.run.footprint}, says: ${moment.remark}. `);
  if (moment.least_weight < -1e-6 || moment.most_weight > 1 + 1e-6) {
    out.push(`w leaves [0, 1] here: ${shown(moment.least_weight, 3)} to ${shown(moment.most_weight, 3)}; its colours end at 0 and 1.`);
  }
  if (drawn !== moment) out.push(` The maps are those after tap ${drawn.taps}.`);
  return element("p", { class: "story", id: "story" }, foreign(out.join("")));
}

/// Everything that changes with the slider.
class Slider {
  constructor(data, maps) {
    this.data = data;
    this.surface = new SurfaceView(data, maps);
    this.panels = mapPanels(data, maps);
    // The surface shows it by its colours, where there is one.
    if (!this.surface.spatial) this.panels.unshift(this.surface.deviationPanel());
    this.input = element("input", { type: "range", id: "slider", min: 0, max: data.moments.length - 1, step: 1, value: data.moments.length - 1, "aria-label": "tap" });
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
      const busy = event.target !== this.input && event.target.closest?.("input:not([type=checkbox]), select, textarea");
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
    this.drawing = this.drawing.then(() => (wanted === this.wanted ? this.draw(wanted) : undefined)).catch(complain);
    return this.drawing;
  }

  async draw(at) {
    const moment = this.data.moments[at];
    // The latest maps that there are, and the first where there are none yet.
    const frame = Math.max(0, this.data.shown.findLastIndex((one) => one <= at));
    const of = this.data.moments[this.data.shown[frame]];
    this.output.textContent = `after tap ${moment.taps} of ${this.data.taps.length}`;
    document.getElementById("story").replaceWith(story(this.data, moment, of));
    await this.surface.draw(frame, moment);
    for (const { id, bar, frames, range, colours } of this.panels) {
      const traces = [heatMap(this.data, frames[frame], range, colours, bar), ...marks(this.data, moment)];
      await Plotly.react(`map_${id}`, traces, layout({ ...planeAxes(this.data), margin: { l: 44, r: 4, t: 6, b: 40 }, showlegend: false }), kPlotConfig);
    }
    const here = { type: "line", x0: moment.taps, x1: moment.taps, yref: "paper", y0: 0, y1: 1, line: { color: "#999999", width: 1, dash: "dot" } };
    await Promise.all(this.data.curves.map((one, i) => Plotly.relayout(`curve_${i}`, { shapes: [here] })));
    document.body.dataset.drawn = String(moment.taps);  // for whoever waits for the picture
  }
}

function drawRun(data, bytes) {
  const maps = unpackMaps(bytes, data.maps, data.x.length, data.y.length);
  const slider = new Slider(data, maps);
  const run = data.run;
  document.title = `${run.name} ${run.id} – palpate`;
  const state = run.state === "done" ? `stopped by: ${run.stop_reason}` : run.state;
  const thinned = data.shown.length < data.moments.length ? ` There are maps of ${data.shown.length} of ${data.moments.length} moments, so that this page stays small.` : "";
  const strategy = element("p", { class: "sub" }, "id ", run.id, `, seed ${run.seed}, acquisition `, foreign(run.acquisition), ", footprint ", foreign(run.footprint), ", ", foreign(state), ".");
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
    element("p", { class: "sub" }, `Dots: taps on the object, crosses: off it, squares: no contact; the star would be tapped next. Arrow keys move the slider.${thinned}`),
    element("h2", {}, "By tap"),
    element("div", { class: "row small" }, ...data.curves.map(({ title }, i) => figure(`curve_${i}`, title))),
    section("Config", table(["key", "value", "where it was said"], data.config.map((line) => line.map(foreign)))),
    section("Made by", table(["", ""], data.build.filter(([, value]) => value !== "").map((line) => line.map(foreign)))),
    element("footer", {}, `palpate ${data.version}; method: Sun and Min 2021, arXiv:2110.09593; drawn with plotly.js (MIT).`),
  );
  data.curves.forEach((one, i) => drawCurves(`curve_${i}`, one, data.moments.map((moment) => moment.taps)));
  slider.listen();
  return slider.show();
}

openPage(drawRun);
