// SPDX-License-Identifier: MIT
// Curves of groups of jobs against taps or robot time, with one plot per scene. analysis/group_curves.hpp computes the
// numbers.

/// Returns the scenes that have curves.
const scenesOfCurves = (sweep) => [...new Set(sweep.curves.sets[0].curves.map(({ scene }) => scene))];

/// Returns the section with controls and plots.
function placeCurves(sweep, chooser, choices) {
  const against = [...new Set(sweep.curves.sets.map((one) => one.against))];
  return section(
    kOverTaps,
    choices(
      chooser("curve_of", "show", sweep.curves.metrics, [drawCurves], withUnit),
      chooser("against", "against", against, [drawCurves], withUnit),
      chooser("curves_by", "groups by", sweep.curves.by, [drawCurves]),
    ),
    element("p", { class: "sub", id: "curves_note" }),
    element("div", { class: "row wide", id: "curves" }, ...scenesOfCurves(sweep).map((scene, i) => figure(`curves_${i}`, foreign(scene)))),
  );
}

const kOverTaps = "Over the taps";

/// Returns a command of palpate on a folder, quoted for a shell.
function commandOn(name, folder) {
  const word = /^[\w./+:@=-]+$/.test(folder) ? folder : `'${folder.replace(/'/g, "'\\''")}'`;
  return element("code", {}, foreign(`palpate ${name} ${word}`));
}

/// Returns a section that explains how to get curves; an empty list if the page cannot have curves.
function noCurves(sweep) {
  if (sweep.live !== undefined || sweep.sampled || sweep.done.length === 0) return [];
  return [section(kOverTaps, element("p", { class: "sub", id: "how_to_curves" }, commandOn("curves", sweep.folder), " computes the errors after each tap from the record. Make this page again to show them."))];
}

/// Returns band and line of a group. `place` is the index of the group among the groups of all scenes.
function curveTraces(curve, place, metric, against) {
  const [x, y] = [unitOf(against).factor, unitOf(metric).factor];
  const scaled = (values) => values.map((value) => (value === null ? null : value * y));
  const colour = lineColour(place);
  const at = curve.at.map((value) => value * x);
  const edge = (values) => ({ type: "scatter", mode: "lines", x: at, y: scaled(values), line: { width: 0 }, hoverinfo: "skip", showlegend: false, legendgroup: curve.name });
  const fill = colour.replace(/^#(..)(..)(..)$/, (_, ...parts) => `rgba(${parts.slice(0, 3).map((one) => parseInt(one, 16)).join()},0.18)`);
  const text = curve.at.map((_, i) => {
    const [low, high] = [curve.low[i], curve.high[i]].map((end) => (end === null ? null : shown(end * y, 3)));
    return `${plain(brief(curve.name, 80))}: ${shown(curve.mean[i] === null ? null : curve.mean[i] * y, 3)}${low === null ? "" : ` [${low}, ${high}]`}, ${counted(curve.jobs[i], "job")}`;
  });
  const line = { type: "scatter", mode: "lines", name: plain(brief(curve.name, 60)), x: at, y: scaled(curve.mean), text, hovertemplate: "%{text}<extra></extra>", legendgroup: curve.name };
  return [edge(curve.low), { ...edge(curve.high), fill: "tonexty", fillcolor: fill }, { ...line, line: { color: colour, width: 2, dash: place < kColours.lines.light.length ? "solid" : "dash" } }];
}

function drawCurves(sweep, { curve_of: metric, against, curves_by: by }) {
  const set = sweep.curves.sets.find((one) => one.metric === metric && one.against === against && one.by === by);
  const scenes = scenesOfCurves(sweep);
  const names = [...new Set(set.curves.map(({ name }) => name))];
  document.getElementById("curves_note").textContent = `Lines: means over ${set.over}; bands: their 95 % intervals (Student's t). A job that has ended counts with its final value. ${set.remarks.trim().split("\n").map((line) => line && `${line[0].toUpperCase()}${line.slice(1)}.`).join(" ")}`;
  return Promise.all(
    scenes.map((scene, i) => {
      const curves = set.curves.filter((one) => one.scene === scene);
      const traces = curves.flatMap((one) => curveTraces(one, names.indexOf(one.name), metric, against));
      const lines = curves.flatMap((one) => one.mean.filter((value) => value !== null).map((value) => value * unitOf(metric).factor));
      // The axis covers the lines, but only a part of wide bands, because bands after the first taps may be very wide.
      const [least, most] = extent(lines);
      const room = Math.max(most - least, 1e-12);
      const highest = extent(traces.flatMap(({ y }) => y.filter((value) => value !== null)))[1];
      const range = [least >= 0 ? 0 : least - 0.3 * room, Math.min(highest, most + 0.5 * room) + 0.04 * room];
      return plotOfHeight(`curves_${i}`, 380, traces, {
        xaxis: roomyAxis(titleOf(against), { rangemode: "tozero" }),
        yaxis: roomyAxis(directedTitle(sweep, metric), { range }),
        legend: { orientation: "h", y: 1.02, yanchor: "bottom", x: 0 },
        hovermode: "closest",
      });
    }),
  );
}
