// SPDX-License-Identifier: MIT
// The panels over the jobs of a sweep that show one number of each: cells, groups, lines across all keys.

const axis = (title, more = {}) => ({ title: { text: title }, zeroline: false, automargin: true, ...more });

/// An axis along the values of a key, or of groups: one place each, named as far as there is room.
function placesAxis(title, names, more = {}, most = 36, room = 25) {
  const texts = briefs(names, most);
  const step = Math.ceil(names.length / room);
  const places = names.map((_, i) => i).filter((i) => i % step === 0);
  return axis(title, {
    tickmode: "array",
    tickvals: places,
    ticktext: places.map((i) => plain(texts[i])),
    range: [-0.5, names.length - 0.5],
    showgrid: false,
    ...more,
  });
}

const namesOf = (key) => key.order.map((value) => key.values[value] || kNoValue);
const titleOf = (name) => plain(brief(withUnit(name), 60));

function judged(sweep, column) {
  const way = sweep.columns.get(column).better;
  return way ? `${titleOf(column)}, ${way}` : titleOf(column);
}

/// Draws into a figure of that height.
function drawIn(id, traces, more, height) {
  const place = document.getElementById(id);
  place.style.height = `${height}px`;
  return Plotly.react(place, traces, layout({ height, ...more }), kPlotConfig);
}

function say(id, ...text) {
  document.getElementById(id).closest("figure").querySelector("figcaption").replaceChildren(...text);
}

/// Means in cells of two keys, and beside them the spread; with one key, means as points with their spread as bars.
class CellsPanel {
  constructor(sweep) {
    this.sweep = sweep;
  }

  draw(choice) {
    const across = this.sweep.key(choice.across);
    const up = this.sweep.key(choice.up);
    const single = !up || up === across;
    document.getElementById("cells_spread").closest("figure").hidden = single;
    return single ? this.drawPoints(across, choice.metric) : this.drawCells(across, up, choice.metric);
  }

  /// What all other keys are taken together for.
  others(...keys) {
    const rest = this.sweep.keys.filter((key) => key.varies && !keys.includes(key)).map((key) => brief(key.name));
    return rest.length > 0 ? `over ${rest.join(", ")} of the jobs that are done` : "of the job that is done";
  }

  cell(jobs, metric) {
    const done = jobs.filter((job) => job.state === "done");
    return estimate(this.sweep.numbers(metric, done), this.sweep.data.factors);
  }

  hover(jobs, keys, metric, found) {
    const spread = found.deviation === null ? "" : ` ± ${shown(found.deviation)}`;
    const lines = keys.map((key) => plain(brief(`${key.name}: ${this.sweep.text(key, jobs[0])}`, 80)));
    const value = found.count > 0 ? `mean ${shown(found.mean)}${spread} of ${found.count} values` : "no value";
    return [...lines, `${titleOf(metric)}: ${value}`, this.sweep.ended(jobs)].join("<br>");
  }

  drawCells(across, up, metric) {
    const grid = (value) => up.order.map(() => across.order.map(() => value));
    const means = grid(null);
    const spreads = grid(null);
    const hovers = grid("no such job");
    for (const { places, jobs } of this.sweep.groups([up, across])) {
      const [row, column] = places;
      const found = this.cell(jobs, metric);
      means[row][column] = found.mean;
      spreads[row][column] = found.deviation;
      hovers[row][column] = this.hover(jobs, [across, up], metric, found);
    }
    const cells = across.order.length * up.order.length;
    const cellsOf = (z, title, colours) => ({
      type: "heatmap",
      z,
      text: z.map((line) => line.map((value) => (value === null ? "" : shown(value)))),
      customdata: hovers,
      texttemplate: cells <= 80 && across.order.length <= 8 ? "%{text}" : "",
      hovertemplate: "%{customdata}<extra></extra>",
      colorscale: colours,
      colorbar: { title: { text: title, side: "right" }, thickness: 12 },
      xgap: 1,
      ygap: 1,
    });
    // Cells of continuous keys are too many and nearly all empty: there each stands as a square.
    const filled = means.flatMap((line, row) => line.map((_, column) => [row, column])).filter(([row, column]) => means[row][column] !== null);
    const sparse = cells > 400 && filled.length < cells / 8;
    const squaresOf = (z, title, colours) => {
      const places = filled.filter(([row, column]) => z[row][column] !== null);
      return {
        type: "scatter",
        mode: "markers",
        x: places.map(([, column]) => column),
        y: places.map(([row]) => row),
        marker: { symbol: "square", size: 8, color: places.map(([row, column]) => z[row][column]), colorscale: colours, showscale: true, colorbar: { title: { text: title, side: "right" }, thickness: 12 } },
        customdata: places.map(([row, column]) => hovers[row][column]),
        hovertemplate: "%{customdata}<extra></extra>",
      };
    };
    const trace = sparse ? squaresOf : cellsOf;
    const more = {
      xaxis: placesAxis(plain(brief(across.name)), namesOf(across)),
      yaxis: placesAxis(plain(brief(up.name)), namesOf(up)),
      plot_bgcolor: "#dcdcdc",
      margin: { l: 60, r: 12, t: 12, b: 50 },
    };
    const height = Math.min(sparse ? 520 : 900, Math.max(340, 130 + 24 * up.order.length));
    say("cells_mean", "Mean ", foreign(this.others(across, up)), ". Grey: no value.");
    say("cells_spread", "Spread: standard deviation of the same jobs. Grey: fewer than two values.");
    return Promise.all([
      drawIn("cells_mean", [trace(means, judged(this.sweep, metric), "Viridis")], more, height),
      drawIn("cells_spread", [trace(spreads, `standard deviation of ${titleOf(metric)}`, "Cividis")], more, height),
    ]);
  }

  drawPoints(key, metric) {
    const groups = this.sweep.groups([key]);
    const found = groups.map(({ jobs }) => this.cell(jobs, metric));
    const trace = {
      type: "scatter",
      mode: "markers",
      x: groups.map(({ places }) => places[0]),
      y: found.map((one) => one.mean),
      error_y: { type: "data", array: found.map((one) => one.deviation ?? 0), color: "#7fb2d6", thickness: 2 },
      marker: { size: 9, color: kColours[0] },
      customdata: groups.map(({ jobs }, i) => this.hover(jobs, [key], metric, found[i])),
      hovertemplate: "%{customdata}<extra></extra>",
    };
    say("cells_mean", "Mean ", foreign(this.others(key)), "; bars: standard deviation.");
    const more = { xaxis: placesAxis(plain(brief(key.name)), namesOf(key)), yaxis: axis(judged(this.sweep, metric)) };
    return drawIn("cells_mean", [trace], more, 380);
  }
}

/// The values of the jobs of each group as a box, with the jobs themselves as points.
class GroupsPanel {
  constructor(sweep) {
    this.sweep = sweep;
  }

  keys(choice) {
    if (choice.group === kEachSetting) return this.sweep.settings;
    const names = [choice.group, choice.then].filter((name, i, all) => name && all.indexOf(name) === i);
    return names.map((name) => this.sweep.key(name)).filter(Boolean);
  }

  draw(choice) {
    const kMostGroups = 40;
    const kMostPoints = 4000;
    const keys = this.keys(choice);
    const all = this.sweep.groups(keys);
    const groups = all.slice(0, kMostGroups);
    const named = keys.length === 1 ? keys : keys.filter((key) => key.varies);
    const names = groups.map(({ jobs }) =>
      keys.length === 1 ? this.sweep.text(keys[0], jobs[0]) : this.sweep.words(jobs[0], named),
    );
    const first = keys.length > 1 ? named[0] : undefined;
    const points = groups.reduce((sum, { jobs }) => sum + jobs.length, 0) <= kMostPoints ? "all" : "outliers";
    const traces = groups.map(({ jobs }, i) => {
      const valued = jobs.filter((job) => job.state === "done" && this.sweep.number(choice.metric, job) !== null);
      const colour = kColours[first ? first.place[first.of_job[jobs[0].index]] % kColours.length : 0];
      return {
        type: "box",
        orientation: "h",
        name: String(i),
        x: valued.map((job) => this.sweep.number(choice.metric, job)),
        y: valued.map(() => i),
        boxpoints: points,
        jitter: 0.7,
        pointpos: 0,
        width: 0.7,
        quartilemethod: "linear",
        marker: { size: 3, color: colour, opacity: 0.45 },
        line: { color: colour, width: 1.5 },
        fillcolor: "rgba(0,0,0,0.04)",
        text: valued.map((job) => `job ${job.index}`),
        hoveron: "boxes+points",
      };
    });
    const rest = all.length - groups.length;
    const without = groups.reduce((sum, { jobs }, i) => sum + jobs.length - traces[i].x.length, 0);
    say(
      "groups",
      "Boxes: quartiles and median; points: jobs.",
      rest > 0 ? ` ${rest} more groups are not shown: choose fewer keys.` : "",
      without > 0 ? ` ${without} of their jobs have no value: failed, not ended, or without it.` : "",
    );
    const more = {
      xaxis: axis(judged(this.sweep, choice.metric)),
      yaxis: placesAxis("", names, { range: [groups.length - 0.5, -0.5] }, 60, kMostGroups),
      showlegend: false,
    };
    return drawIn("groups", traces, more, Math.max(260, 90 + 30 * groups.length));
  }
}

/// Lines across the keys and the main numbers, one a job.
class ParallelPanel {
  constructor(sweep, spatial) {
    this.sweep = sweep;
    this.spatial = spatial;
  }

  /// The axes: {name, title, values, least, most, ticks: [{at, text}]}, and the jobs that have a value on each.
  lines(metric) {
    const numbers = mainColumns(this.sweep).filter((name) => name !== metric && differs(this.sweep, name) && !this.sweep.key(name));
    const columns = [...numbers.slice(0, 5), metric];
    const has = (job) => columns.every((name) => this.sweep.number(name, job) !== null);
    const most = this.spatial ? 20000 : 5000;
    const valued = this.sweep.done.filter(has);
    const step = Math.max(1, Math.ceil(valued.length / most));
    const jobs = valued.filter((_, i) => i % step === 0);
    const axes = this.sweep.varying.slice(0, 7).map((key) => {
      const names = namesOf(key);
      const thin = Math.ceil(names.length / 25);
      const ticks = briefs(names, 12).map((text, at) => ({ at, text })).filter(({ at }) => at % thin === 0);
      return { title: key.name, values: jobs.map((job) => key.place[key.of_job[job.index]]), least: 0, most: names.length - 1, ticks };
    });
    for (const name of columns) {
      const values = jobs.map((job) => this.sweep.number(name, job));
      const [least, largest] = values.reduce(([a, b], value) => [Math.min(a, value), Math.max(b, value)], [Infinity, -Infinity]);
      const marked = largest > least ? [least, (least + largest) / 2, largest] : [least];
      const ticks = marked.map((at) => ({ at, text: shown(at, 3) }));
      axes.push({ title: withUnit(name), values, least, most: largest, ticks });
    }
    return { axes, jobs, left: this.sweep.done.length - valued.length, step };
  }

  draw(choice) {
    const { axes, jobs, left, step } = this.lines(choice.metric);
    const colours = axes[axes.length - 1];
    say(
      "parallel",
      "A line a job that is done, coloured by ",
      foreign(withUnit(choice.metric)),
      this.spatial ? ". Drag along an axis to pick lines, drag a name to move an axis." : ".",
      left > 0 ? ` ${left} jobs lack one of the values and are left out.` : "",
      step > 1 ? ` Drawn is one of ${step} jobs.` : "",
    );
    document.getElementById("parallel").style.minWidth = `${90 * axes.length}px`; // on a narrow page it scrolls
    if (jobs.length === 0) return drawIn("parallel", [], { xaxis: { visible: false }, yaxis: { visible: false } }, 120);
    return this.spatial ? this.drawSpatial(axes, colours) : this.drawFlat(axes, colours, jobs);
  }

  drawSpatial(axes, colours) {
    const spread = (one) => (one.most > one.least ? [one.least, one.most] : [one.least - 1, one.least + 1]);
    const trace = {
      type: "parcoords",
      line: {
        color: colours.values,
        cmin: colours.least,
        cmax: colours.most,
        colorscale: "Viridis",
        showscale: true,
        colorbar: { title: { text: plain(brief(colours.title)), side: "right" }, thickness: 12 },
      },
      // Ticks are set as text as they are, only the names go through what knows tags.
      dimensions: axes.map((one) => {
        const ticks = one.ticks.every(({ at }) => Number.isInteger(at)) && one.least === 0 ? one.ticks : null;
        return {
          label: plain(brief(one.title, 24)),
          values: one.values,
          range: spread(one),
          ...(ticks ? { tickvals: ticks.map(({ at }) => at), ticktext: ticks.map(({ text }) => text) } : {}),
        };
      }),
      labelfont: { size: 11 },
      labelangle: -16,  // names side by side would run into each other
    };
    return drawIn("parallel", [trace], { margin: { l: 90, r: 60, t: 80, b: 24 } }, 460);
  }

  /// The same as lines in the plane, by their colours in few traces, so that very many stay quick.
  drawFlat(axes, colours, jobs) {
    const share = (one, value) => (one.most > one.least ? (value - one.least) / (one.most - one.least) : 0.5);
    const kSteps = 16;
    const lines = Array.from({ length: kSteps }, () => ({ x: [], y: [] }));
    jobs.forEach((_, i) => {
      const line = lines[Math.min(kSteps - 1, Math.floor(share(colours, colours.values[i]) * kSteps))];
      axes.forEach((one, at) => {
        line.x.push(at);
        line.y.push(share(one, one.values[i]));
      });
      line.x.push(null);
      line.y.push(null);
    });
    const thin = jobs.length > 200 ? 0.35 : 0.8;
    const traces = lines.map(({ x, y }, i) => ({ type: "scatter", mode: "lines", x, y, line: { width: 1, color: viridis((i + 0.5) / kSteps) }, opacity: thin, hoverinfo: "skip" }));
    const bar = { colorscale: "Viridis", cmin: colours.least, cmax: colours.most, color: [colours.least], showscale: true, opacity: 0, size: 1 };
    bar.colorbar = { title: { text: plain(brief(colours.title)), side: "right" }, thickness: 12 };
    traces.push({ type: "scatter", mode: "markers", x: [0], y: [0], marker: bar, hoverinfo: "skip" });
    const label = (x, y, text, more) => ({ x, y, text: plain(text), showarrow: false, font: { size: 11 }, ...more });
    const annotations = axes.flatMap((one, at) => [
      label(at, at % 2 === 0 ? 1.03 : 1.09, brief(one.title, 24), { yanchor: "bottom" }),
      ...one.ticks.map((tick) => label(at, share(one, tick.at), tick.text, { xanchor: "right", xshift: -3, bgcolor: "rgba(255,255,255,0.7)" })),
    ]);
    const shapes = axes.map((_, at) => ({ type: "line", x0: at, x1: at, y0: 0, y1: 1, line: { color: "#555555", width: 1 } }));
    const hidden = { visible: false, fixedrange: true };
    const more = {
      annotations,
      shapes,
      showlegend: false,
      hovermode: false,
      xaxis: { ...hidden, range: [-0.5, axes.length - 0.8] },
      yaxis: { ...hidden, range: [-0.04, 1.17] },
      margin: { l: 20, r: 12, t: 8, b: 8 },
    };
    return drawIn("parallel", traces, more, 440);
  }
}

/// A colour of Viridis, `share` from 0 to 1.
function viridis(share) {
  const stops = [[68, 1, 84], [72, 40, 120], [62, 74, 137], [49, 104, 142], [38, 130, 142], [31, 158, 137], [53, 183, 121], [109, 205, 89], [180, 222, 44], [253, 231, 37]];
  const at = Math.min(Math.max(share, 0), 1) * (stops.length - 1);
  const low = Math.min(Math.floor(at), stops.length - 2);
  const mixed = stops[low].map((one, i) => Math.round(one + (at - low) * (stops[low + 1][i] - one)));
  return `rgb(${mixed.join()})`;
}
