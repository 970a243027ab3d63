// SPDX-License-Identifier: MIT
// The page of a run. It has a slider that chooses a tap. It shows the surface and the maps after this tap, and curves
// over all taps.

/// Layouts of axes, by the value `axis` of a panel (curves.hpp).
const kAxes = {
  free: {},
  from_zero: { rangemode: "tozero" },
  share: { range: [-0.02, 1.02] },
  logarithmic: { type: "log", dtick: 1 },
};

/// Draws a panel of curves against the taps.
function drawCurves(id, panel, taps) {
  const traces = panel.curves.map(({ name, values }, i) => ({
    ...points(plain(name), taps, values, [], { size: 4, symbol: ["circle", "square", "diamond", "triangle-up", "x"][i % 5] }),
    mode: "lines+markers",
    line: { color: lineColour(i), width: 1.8 },
    hovertemplate: `%{y:.4g}<extra>${plain(name)}</extra>`,
  }));
  return plot(id, traces, {
    xaxis: axis("taps", { rangemode: "tozero" }),
    yaxis: axis(panel.unit ? `[${panel.unit}]` : "", { automargin: true, exponentformat: "power", ...kAxes[panel.axis] }),
    showlegend: panel.curves.length > 1,
    legend: { orientation: "h", y: 1.02, yanchor: "bottom", font: { size: 11 } },
    hovermode: "x unified",
  });
}

function facts(data) {
  const last = data.moments[data.moments.length - 1];
  const errors = data.errors.map(([name, title]) => [quantity(name, last[name]), "", title]);
  const items = [
    [last.taps, ` of ${data.budget}`, "taps"],
    [last.object_taps, "", "on the object"],
    [last.desk_taps, "", "on the desk"],
    [last.no_contact_taps || kNothing, "", "met nothing"],
    [last.failed_taps || kNothing, "", "failed"],
    [shown(data.summary?.first_hit_tap), "", "first hit at tap"],
    ...errors,
    [shown(data.summary?.coverage_95, 3), "", "95 % coverage"],
    [quantity("robot_seconds", last.robot_seconds), "", "robot time"],
  ];
  return factList(items.filter(([value]) => value !== kNothing).map(([value, unit, name]) => [`${value}${unit}`, name]));
}

/// Returns the elements that may change with every tap: state, numbers and warnings of the run.
function runState(data) {
  const state = data.state === "done" ? `stopped by: ${data.stop_reason}` : data.stop_reason ? `${data.state}: ${data.stop_reason}` : data.state;
  const footprint = data.any_side ? [] : [", footprint ", foreign(data.footprint)];
  const strategy = element("p", { class: "sub" }, "id ", data.id, `, seed ${data.seed}, acquisition `, foreign(data.acquisition), ...footprint, ", ", foreign(state), ".");
  return [strategy, facts(data), ...warningList(data.warnings.map((text) => [foreign(text)]))];
}

/// Draws all curves. If the titles of panels have changed, the figures are created again.
function drawAllCurves(data) {
  const row = document.getElementById("curves");
  const titles = JSON.stringify(data.curves.map(({ title }) => title));
  if (row.dataset.titles !== titles) row.replaceChildren(...data.curves.map(({ title }, i) => figure(`curve_${i}`, title)));
  row.dataset.titles = titles;
  document.getElementById("curve_constants").replaceChildren(...constants(data.constants));
  return Promise.all(data.curves.map((one, i) => drawCurves(`curve_${i}`, one, data.moments.map((moment) => moment.taps))));
}

/// Returns a text with the position or line of a tap.
const whereTo = (tap) => (fromAnySide(tap) ? wayOf(tap) : `at ${place(tap)}`);

const kChosenBy = { initial: "the initial design", acquisition: "the acquisition", fallback: "the fallback", caller: "the caller" };

/// Returns a text about the tap of a moment.
function story(data, moment, drawn) {
  const out = [];
  const tap = data.taps[moment.taps - 1];
  if (tap) {
    const reason = tap.reason ? `: ${tap.reason}` : "";
    const touched = `touched ${labelAt(moment, tap) ? "the object" : "the desk"} at ${shown(tap.height * kCentimetres, 4)} cm`;
    const what = tap.on_object === null ? `made no contact (${tap.outcome}${reason})` : touched;
    const motion = tap.motion === undefined ? "" : `, by motion ${tap.motion}`;
    out.push(`Tap ${tap.tap} ${whereTo(tap)}, chosen by ${kChosenBy[tap.source]}${tap.why ? ` (${tap.why})` : ""}${motion}, ${what}.`);
  } else {
    out.push("Before the first tap.");
  }
  out.push(`So far ${moment.object_taps} on the object, ${moment.desk_taps} on the desk.`);
  for (const number of moment.relabelled) {
    const on = labelAt(moment, data.taps[number - 1]);
    out.push(`Tap ${number} is now read as ${on ? "on the object" : "on the desk"}, unlike when it was made.`);
  }
  if (moment.next) {
    const score = moment.next.score === null ? "" : `, score ${shown(moment.next.score)}`;
    const ties = moment.next.ties > 1 ? `, one of ${moment.next.ties} that are tied` : "";
    out.push(`Next: ${whereTo(moment.next)}, by ${kChosenBy[moment.next.source]}${score}${ties}.`);
  } else {
    out.push(moment.is_next_known ? "No candidate is left." : "The next tap is chosen by a program, which reports do not start.");
  }
  for (const one of moment.suspected_outliers ?? []) out.push(`Tap ${one.tap} may be an outlier: ${one.words}.`);
  if (moment.remark) out.push(`Remark of the footprint ${data.footprint}: ${moment.remark}.`);
  if (moment.least_weight < -1e-6 || moment.most_weight > 1 + 1e-6) {
    out.push(`w leaves [0, 1] here: ${shown(moment.least_weight, 3)} to ${shown(moment.most_weight, 3)}; its colours end at 0 and 1.`);
  }
  if (data.any_side && !moment.surface_drawn) out.push("No tap has hit an object yet: it may be anywhere, and no surface is drawn.");
  if (drawn !== moment) out.push(data.any_side ? `The surface shown is that after tap ${drawn.taps}.` : `The maps shown are those after tap ${drawn.taps}.`);
  return element("p", { class: "story", id: "story" }, foreign(out.join(" ")));
}

/// The slider, and the elements that it changes.
class Slider {
  constructor(data, maps) {
    this.data = data;
    this.surface = data.any_side ? new SpaceView(data, maps) : new SurfaceView(data, maps);
    [this.panels, this.constant] = data.any_side ? [[], []] : mapPanels(data, maps);
    // With WebGL, the colours of the surface show the standard deviation.
    if (!this.surface.spatial && !data.any_side) this.panels.unshift(this.surface.deviationPanel());
    this.input = element("input", { type: "range", id: "slider", min: 0, max: data.moments.length - 1, step: 1, value: data.moments.length - 1, "aria-label": "tap" });
    this.output = element("output", { id: "at", for: "slider" });
    this.truth = element("input", { type: "checkbox", id: "truth" });
    this.player = new Player(this);
    this.stale = true;  // whether the curves must be drawn again
  }

  /// Adds the maps of further moments.
  grow(further) {
    this.surface.grow(further);
    for (const panel of this.panels) {
      panel.frames.push(...panel.of(further));
      panel.range = panel.rangeOf(panel.frames);
    }
  }

  /// Returns the number of values in all maps or surfaces. `news` is an update, whose list `maps` has one entry per
  /// map.
  numbers(news) {
    if (this.data.any_side) return 10 * this.surface.surfaces.reduce((sum, { x }) => sum + x.length, 0);
    return this.data.shown.length * news.maps.length * this.data.x.length * this.data.y.length;
  }

  controls() {
    const out = element("div", { class: "controls" }, this.output, this.player.button, this.input, liveNote(this.data));
    if (this.data.truth) out.append(element("label", {}, this.truth, this.surface.spatial || this.data.any_side ? " show truth as wireframe" : " show truth instead"));
    return out;
  }

  listen() {
    this.input.addEventListener("input", () => this.show());
    this.truth.addEventListener("change", () => {
      this.surface.withTruth = this.truth.checked;
      this.show();
    });
    // Arrow keys move the slider, unless the focus is on a control that uses these keys.
    document.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      const busy = event.target !== this.input && event.target.closest?.("input:not([type=checkbox]), select, textarea");
      if (!step || busy || event.altKey || event.ctrlKey || event.metaKey) return;
      event.preventDefault();
      this.player.stop();
      this.input.value = Number(this.input.value) + step;
      this.show();
    });
  }

  /// Draws the moment that the slider has chosen.
  show() {
    return drawLatest(this.input, (at) => this.draw(at));
  }

  /// Draws all plots, at the beginning and after each change of colours.
  redraw() {
    this.stale = true;
    return this.show();
  }

  async draw(at) {
    const moment = this.data.moments[at];
    // The latest maps up to this moment, or the first maps if all are later.
    const frame = Math.max(0, this.data.shown.findLastIndex((one) => one <= at));
    const of = this.data.moments[this.data.shown[frame]];
    this.output.textContent = `after tap ${moment.taps} of ${this.data.taps.length}`;
    document.getElementById("story").replaceWith(story(this.data, moment, of));
    await this.surface.draw(frame, moment);
    for (const { id, bar, frames, range, colours } of this.panels) {
      const traces = [heatMap(this.data, frames[frame], range, colours, bar), ...marks(this.data, moment)];
      await plot(`map_${id}`, traces, { ...planeAxes(this.data), margin: { l: 44, r: 4, t: 6, b: 40 }, showlegend: false });
    }
    if (this.stale) await drawAllCurves(this.data);
    this.stale = false;
    const here = { type: "line", x0: moment.taps, x1: moment.taps, yref: "paper", y0: 0, y1: 1, line: { color: "#999999", width: 1, dash: "dot" } };
    await Promise.all(this.data.curves.map((one, i) => Plotly.relayout(`curve_${i}`, { shapes: [here] })));
    publishDrawn(moment.taps);
  }
}

/// Returns a line about the quantities that are constant in the run.
const constants = (texts) => (texts.length > 0 ? [element("p", { class: "sub constants" }, "Constant over all taps: ", foreign(texts.join("; ")), ".")] : []);

/// Returns the section with the maps of a run that taps from above.
function mapSection(slider) {
  return [
    element("h2", {}, "Maps"),
    element("div", { class: "row", id: "maps_row" }, ...slider.panels.map(({ id, title }) => figure(`map_${id}`, foreign(title)))),
    ...constants(slider.constant.map(({ title, value }) => `${title}: ${shown(value)} everywhere`)),
  ];
}

/// Unpacks the maps or surfaces of the moments in `described`.
function unpackMoments(data, described, bytes) {
  if (data.any_side) return described.surfaces.map(unpackSurface);
  return unpackMaps(bytes, described.maps, data.x.length, data.y.length);
}

function drawRun(data, bytes) {
  if (data.waiting !== undefined) return drawWaiting(data);
  const slider = new Slider(data, unpackMoments(data, data, bytes));
  const what = data.any_side ? "surfaces" : "maps";
  const thinned = data.shown.length < data.moments.length ? ` To stay small, this page has ${what} of ${data.shown.length} of ${data.moments.length} moments.` : "";
  document.body.append(
    element("div", { id: "standing" }, ...runState(data)),
    slider.controls(),
    element("p", { class: "story", id: "story" }),
    element("div", { class: "tall" }, figure("surface", slider.surface.caption())),
    ...(data.any_side ? [] : mapSection(slider)),
    element("p", { class: "sub" }, `${data.any_side ? "" : "Discs: taps on the object, crosses: taps on the desk, squares: failed taps, star: the next tap. "}Arrow keys move the slider.${thinned}`),
    element("h2", {}, "Curves over taps"),
    element("div", { class: "row small", id: "curves" }),
    element("div", { id: "curve_constants" }),
    section("Config", dataTable(data.config)),
    section("Build", dataTable(data.build)),
    footer(data),
  );
  slider.listen();
  follow(data, (news) => growRun(slider, news));
  return () => slider.redraw();
}

openPage(drawRun);
