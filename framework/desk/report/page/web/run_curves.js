// SPDX-License-Identifier: MIT
// What the page of a run draws over the taps: errors, likelihoods, hyperparameters, times. The same panels as those of
// figures/curves.png, at all moments.

const kAxes = {
  free: {},
  from_zero: { rangemode: "tozero" },
  share: { range: [-0.02, 1.02] },
  logarithmic: { type: "log", dtick: 1 },
};

function drawCurves(id, panel, taps) {
  const traces = panel.curves.map(({ name, values }, i) => ({
    type: "scatter",
    mode: "lines+markers",
    name: plain(name),
    x: taps,
    y: values,
    line: { color: kColours[i % kColours.length], width: 1.8 },
    marker: { size: 4, symbol: ["circle", "square", "diamond", "triangle-up", "x"][i % 5] },
    hovertemplate: `%{y:.4g}<extra>${plain(name)}</extra>`,
  }));
  const more = {
    xaxis: axis("taps", { rangemode: "tozero" }),
    yaxis: axis(panel.unit ? `[${panel.unit}]` : "", { automargin: true, exponentformat: "power", ...kAxes[panel.axis] }),
    showlegend: panel.curves.length > 1,
    legend: { orientation: "h", y: 1.02, yanchor: "bottom", font: { size: 11 } },
    hovermode: "x unified",
  };
  return Plotly.newPlot(id, traces, layout(more), kPlotConfig);
}
