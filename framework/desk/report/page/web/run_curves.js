// SPDX-License-Identifier: MIT
// What the page of a run draws over the taps: errors, likelihoods, hyperparameters, times.

/// The parameters of a process that a curve shows, by name: of the kernel, and signal, noise, mean.
function hyperparameters(process) {
  if (!process) return {};
  const out = {};
  // Kernels may be made of kernels: kernels.0.length_scale.
  const take = (prefix, fields) => {
    for (const [name, value] of Object.entries(fields)) {
      if (value !== null && typeof value === "object") take(`${prefix}${name}.`, value);
      else out[prefix + name] = value;
    }
  };
  take("", process.kernel ?? {});
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
  const lengths = data.errors.filter(([, , unit]) => unit === "m");
  const shares = data.errors.filter(([, , unit]) => unit === "");
  const out = [
    {
      title: "Error of the reconstruction (root mean square)",
      unit: "cm",
      lines: lengths.map(([name, label]) => line(label, (m) => m[name] && m[name] * kCentimetres)),
    },
    ...shares.map(([name, label]) => ({ title: label, axis: label, range: [-0.02, 1.02], lines: [line(label, (m) => m[name])] })),
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
  const told = Object.keys(moments[moments.length - 1].footprint ?? {}).filter((name) => name !== "remark");
  out.push({ title: `What footprint/${data.run.footprint} tells`, axis: "value", lines: told.map((name) => line(name.replaceAll("_", " "), (m) => m.footprint?.[name])) });
  out.push(timeCurves(data));
  return out
    .map((one) => ({ ...one, lines: one.lines.filter(({ values }) => values.some((value) => value !== null)) }))
    .filter((one) => one.lines.length > 0);
}

/// Milliseconds of each tap by phase. Not every tap has a line: one during which the program was killed has none.
function timeCurves(data) {
  const byTap = new Map(data.timings.map(([tap, ...seconds]) => [tap, seconds]));
  const lines = data.phases.map((name, i) => ({
    name,
    values: data.moments.map((moment) => (byTap.has(moment.taps) ? 1000 * byTap.get(moment.taps)[i] : null)),
  }));
  return { title: "Time of a tap, by phase", unit: "ms", logarithmic: true, lines };
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
