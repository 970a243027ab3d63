// SPDX-License-Identifier: MIT
// Panels that show one number per job: cells, groups, and lines across all keys. One function draws each panel. Its
// arguments are the sweep and the choices of the reader.

/// Returns an axis whose margin grows with its tick labels.
const roomyAxis = (title, more = {}) => axis(title, { automargin: true, ...more });

/// Returns an axis with one position per value of a key, or per group. If there are many positions, only some have a
/// tick label.
function placesAxis(title, names, more = {}, most = 36, room = 25) {
  const texts = briefs(names, most);
  const step = Math.ceil(names.length / room);
  const places = names.map((_, i) => i).filter((i) => i % step === 0);
  return roomyAxis(title, {
    tickmode: "array",
    tickvals: places,
    ticktext: places.map((i) => plain(texts[i])),
    range: [-0.5, names.length - 0.5],
    showgrid: false,
    ...more,
  });
}

const namesOf = (key) => key.values.map((value) => value || kNothing);
const keyAxis = (key) => placesAxis(plain(brief(key.name)), namesOf(key));
const titleOf = (name) => plain(brief(withUnit(name), 60));

function directedTitle(sweep, column) {
  const way = sweep.columns.get(column).better;
  return way ? `${titleOf(column)},${kNarrow.matches ? "<br>" : " "}${way}` : titleOf(column);
}

/// Draws a plot into a figure of this height.
function plotOfHeight(id, height, traces, more) {
  const place = document.getElementById(id);
  place.hidden = false;
  place.style.height = `${height}px`;
  return plot(place, traces, { height, ...more });
}

/// Hides the plot of a figure. `words`, if any, replaces the caption.
function plotNothing(id, words) {
  if (words) setCaption(id, foreign(words));
  const place = document.getElementById(id);
  Plotly.purge(place);
  place.hidden = true;
}

/// Returns a text about a column that has the same value in all jobs.
function constantWords(sweep, column) {
  const values = sweep.numbers(column, sweep.done);
  if (values.length === 0) return `No finished job has a value of ${column}.`;
  return `${withUnit(column)}: ${shown(values[0])} ${values.length === 1 ? "in the one job that has it" : `in each of ${values.length} jobs`}.`;
}

function setCaption(id, ...text) {
  document.getElementById(id).closest("figure").querySelector("figcaption").replaceChildren(...text);
}

/// Draws means and standard deviations of the jobs with equal values of one or two keys.
function drawCells(sweep, { across, up, metric }) {
  const keys = [across, up].filter((name, i, all) => name && all.indexOf(name) === i).map((name) => sweep.key(name));
  const hover = (jobs, { count, clusters, mean, deviation }) => {
    const spread = deviation === null ? "" : ` ± ${shown(deviation)}`;
    const units = count > 0 ? sweep.unitWords(clusters, count) : "";
    const lines = keys.map((key) => plain(brief(`${key.name}: ${sweep.text(key, jobs[0])}`, 80)));
    const value = count > 0 ? `mean ${shown(mean)}${spread} of ${count} values${units ? `, ${units}` : ""}` : "no value";
    return [...lines, `${titleOf(metric)}: ${value}`, sweep.ended(jobs)].join("<br>");
  };
  const cells = sweep.groups(keys).map(({ places, jobs }) => {
    const valued = jobs.filter((job) => job.state === "done" && sweep.raw(metric, job) !== null);
    const found = spread(sweep.numbers(metric, valued), valued.map((job) => sweep.unit(job)));
    return { ...found, column: places[0], row: places[1], hover: hover(jobs, found) };
  });
  // The means are over all other keys.
  const rest = sweep.all.filter((key) => !keys.includes(key)).map((key) => brief(key.name));
  const over = foreign(rest.length > 0 ? `over ${rest.join(", ")} of the finished jobs` : "of the finished job");
  document.getElementById("cells_spread").closest("figure").hidden = keys.length < 2 || !differs(sweep, metric) || !hasSpread(cells);
  if (!differs(sweep, metric)) return plotNothing("cells_mean", constantWords(sweep, metric));
  return keys.length < 2 ? drawPoints(sweep, keys[0], metric, cells, over) : drawMaps(sweep, keys, metric, cells, over);
}

/// Returns whether any cell has at least two values.
const hasSpread = (cells) => cells.some((one) => one.deviation !== null);

/// With one key, draws means as points. Bars show the standard deviations.
function drawPoints(sweep, key, metric, cells, over) {
  const trace = points("", cells.map((one) => one.column), cells.map((one) => one.mean), cells.map((one) => one.hover), { size: 9, color: lineColour(0) }, {
    error_y: { type: "data", array: cells.map((one) => one.deviation ?? 0), color: themed("bars"), thickness: 2 },
  });
  setCaption("cells_mean", "Mean ", over, "; bars: standard deviation.");
  return plotOfHeight("cells_mean", 380, [trace], { xaxis: keyAxis(key), yaxis: roomyAxis(directedTitle(sweep, metric)) });
}

/// With two keys, draws means as cells of a map, and the standard deviations as a second map.
function drawMaps(sweep, [across, up], metric, cells, over) {
  const count = across.values.length * up.values.length;
  // Keys with values sampled from continuous ranges have many cells, most of which are empty. In this case, a square
  // marks each filled cell.
  const sparse = count > 400 && cells.filter((one) => one.mean !== null).length < count / 8;
  const trace = (get, title, colorscale) => {
    const colours = { colorscale, colorbar: colourBar(title) };
    if (sparse) {
      const valued = cells.filter((one) => get(one) !== null);
      const marker = { symbol: "square", size: 8, color: valued.map(get), showscale: true, ...colours };
      return points("", valued.map((one) => one.column), valued.map((one) => one.row), valued.map((one) => one.hover), marker);
    }
    const grid = (of, none) => {
      const out = up.values.map(() => across.values.map(() => none));
      for (const one of cells) out[one.row][one.column] = of(one);
      return out;
    };
    return {
      type: "heatmap",
      z: grid(get, null),
      text: grid((one) => (get(one) === null ? "" : shown(get(one))), ""),
      customdata: grid((one) => one.hover, "no such job"),
      texttemplate: count <= 80 && across.values.length <= 8 ? "%{text}" : "",
      hovertemplate: "%{customdata}<extra></extra>",
      ...colours,
      xgap: 1,
      ygap: 1,
    };
  };
  const more = { xaxis: keyAxis(across), yaxis: keyAxis(up), plot_bgcolor: themed("empty"), margin: { l: 60, r: 12, t: 12, b: 50 } };
  const height = Math.min(sparse ? 520 : 900, Math.max(340, 130 + 24 * up.values.length));
  setCaption("cells_mean", "Mean ", over, ". Grey: no value.");
  setCaption("cells_spread", "Spread: standard deviation of the same jobs. Grey: fewer than two values.");
  const means = plotOfHeight("cells_mean", height, [trace((one) => one.mean, directedTitle(sweep, metric), kWhere)], more);
  if (!hasSpread(cells)) return means;
  return Promise.all([
    means,
    plotOfHeight("cells_spread", height, [trace((one) => one.deviation, `standard deviation of ${titleOf(metric)}`, kUnknown)], more),
  ]);
}

/// Returns a horizontal box plot of the values of some jobs, at position `i`.
function boxTrace(sweep, metric, jobs, i, colour, withPoints) {
  const valued = jobs.filter((job) => job.state === "done" && sweep.raw(metric, job) !== null);
  return {
    type: "box",
    orientation: "h",
    name: String(i),
    x: sweep.numbers(metric, valued),
    y: valued.map(() => i),
    boxpoints: withPoints ? "all" : "outliers",
    jitter: 0.7,
    pointpos: 0,
    width: 0.7,
    quartilemethod: "linear",
    marker: { size: 3, color: colour, opacity: 0.45 },
    line: { color: colour, width: 1.5 },
    fillcolor: "rgba(128,128,128,0.08)",
    text: valued.map((job) => `job ${job.index}`),
    hoveron: "boxes+points",
  };
}

/// Draws one box plot per group, with the jobs as points.
function drawGroups(sweep, { group, then, metric }) {
  const kMostGroups = 40;
  const kMostPoints = 4000;
  if (!differs(sweep, metric)) return plotNothing("groups", constantWords(sweep, metric));
  const names = [group, then].filter((name, i, all) => name && all.indexOf(name) === i);
  const keys = group === kEachSetting ? sweep.settings : names.map((name) => sweep.key(name)).filter(Boolean);
  const all = sweep.groups(keys);
  const groups = all.slice(0, kMostGroups);
  const named = keys.filter((key) => key.values.length > 1);
  const nameOf = ({ jobs }) => (keys.length === 1 ? sweep.text(keys[0], jobs[0]) : sweep.words(jobs[0], named));
  const colourOf = ({ jobs }) => lineColour(keys.length > 1 && named.length > 0 ? named[0].of_job[jobs[0].place] : 0);
  const few = groups.reduce((sum, { jobs }) => sum + jobs.length, 0) <= kMostPoints;
  const traces = groups.map((one, i) => boxTrace(sweep, metric, one.jobs, i, colourOf(one), few));
  const rest = all.length - groups.length;
  const without = groups.reduce((sum, { jobs }, i) => sum + jobs.length - traces[i].x.length, 0);
  setCaption(
    "groups",
    "Boxes: quartiles and median; points: jobs.",
    rest > 0 ? ` ${rest} more groups are not shown: choose fewer keys.` : "",
    without > 0 ? ` ${without} of their jobs have no value: failed, not ended, or no value.` : "",
  );
  return plotOfHeight("groups", Math.max(260, 90 + 30 * groups.length), traces, {
    xaxis: roomyAxis(directedTitle(sweep, metric)),
    yaxis: placesAxis("", groups.map(nameOf), { range: [groups.length - 0.5, -0.5] }, kNarrow.matches ? 18 : 60, kMostGroups),
    showlegend: false,
  });
}

/// Returns the jobs that have a value on each axis, and the axes of keys and main numbers: {title, values, least, most,
/// ticks: [{at, text}]}.
function parallelAxes(sweep, metric) {
  const kMostJobs = 20000;
  const numbers = mainColumns(sweep).filter((name) => name !== metric && differs(sweep, name) && !sweep.key(name));
  const columns = [...numbers.slice(0, 5), metric];
  const valued = sweep.done.filter((job) => columns.every((name) => sweep.raw(name, job) !== null));
  const step = Math.max(1, Math.ceil(valued.length / kMostJobs));
  const jobs = valued.filter((_, i) => i % step === 0);
  const ofKeys = sweep.varying.slice(0, 7).map((key) => {
    const thin = Math.ceil(key.values.length / 25);
    const ticks = briefs(namesOf(key), 12).map((text, at) => ({ at, text })).filter(({ at }) => at % thin === 0);
    return { title: key.name, values: jobs.map((job) => key.of_job[job.place]), least: 0, most: key.values.length - 1, ticks };
  });
  const ofColumns = columns.map((name) => {
    const values = sweep.numbers(name, jobs);
    const [least, most] = extent(values);
    const marked = most > least ? [least, (least + most) / 2, most] : [least];
    return { title: withUnit(name), values, least, most, ticks: marked.map((at) => ({ at, text: shown(at, 3) })) };
  });
  return { axes: [...ofKeys, ...ofColumns], jobs, left: sweep.done.length - valued.length, step };
}

/// Draws one line per job across the keys and the main numbers.
function drawParallel(sweep, { metric }) {
  if (!hasWebGL()) return plotNothing("parallel", "This browser has no WebGL, which this plot needs.");
  const { axes, jobs, left, step } = parallelAxes(sweep, metric);
  setCaption(
    "parallel",
    "One line per finished job, coloured by ",
    foreign(withUnit(metric)),
    ". Drag along an axis to pick lines, drag a name to move an axis.",
    left > 0 ? ` ${left} jobs lack one of the values and are left out.` : "",
    step > 1 ? ` One of ${step} jobs is drawn.` : "",
  );
  document.getElementById("parallel").style.minWidth = `${90 * axes.length}px`; // On a narrow page, the plot scrolls.
  if (jobs.length === 0) return plotNothing("parallel");
  if (axes.every((one) => one.least === one.most)) return plotNothing("parallel", "All finished jobs have equal values.");
  const { least, most, title } = axes[axes.length - 1];
  const scale = { colorscale: kWhere, cmin: least, cmax: most, showscale: true, colorbar: colourBar(plain(brief(title))) };
  const trace = {
    type: "parcoords",
    line: { ...scale, color: axes[axes.length - 1].values },
    // plotly shows tick texts literally, but interprets tags in names.
    dimensions: axes.map(({ title, values, least, most, ticks }) => ({
      label: plain(brief(title, 24)),
      values,
      range: most > least ? [least, most] : [least - 1, least + 1],
      ...(least === 0 && ticks.every(({ at }) => Number.isInteger(at)) ? { tickvals: ticks.map(({ at }) => at), ticktext: ticks.map(({ text }) => text) } : {}),
    })),
    labelfont: { size: 11 },
    labelangle: -16,  // Because of the angle, neighbouring names do not overlap.
  };
  return plotOfHeight("parallel", 460, [trace], { margin: { l: 90, r: 60, t: 80, b: 24 } });
}
