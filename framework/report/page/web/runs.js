// SPDX-License-Identifier: MIT
// The page of several runs. It shows errors against taps and against robot time, and the surfaces after a number of
// taps that a slider sets.

/// Returns the letter that stands for a run in plots.
const letterOf = (index) => String.fromCharCode("A".charCodeAt(0) + index);
const wordsOf = (run, index) => `${letterOf(index)}: ${run.name} ${run.id}`;

/// Returns the title of an error with its unit.
const errorTitle = ([name, title]) => (unitOf(name).unit ? `${title} [${unitOf(name).unit}]` : title);

/// Returns the index of the last map of a run after at most this many taps, or of the first map if all maps are later.
const frameAt = (run, taps) => Math.max(0, run.shown.findLastIndex((moment) => moment <= taps));

/// The plots of one error against taps and against robot time. Each plot shows all runs.
class ErrorPlots {
  constructor(data) {
    this.data = data;
    this.errors = data.errors.filter(([name]) => data.runs.some((run) => run.moments.some((moment) => typeof moment[name] === "number")));
    const options = this.errors.map((error) => element("option", { value: error[0] }, errorTitle(error)));
    this.choice = element("select", { id: "error", "aria-label": "error" }, ...options);
    this.choice.addEventListener("change", () => inTurn(() => this.draw()));
  }

  elements() {
    if (this.errors.length === 0) return [element("p", { class: "sub" }, "No run has a known truth or an expected error: there is nothing to show.")];
    const plots = [figure("over_taps", "over taps"), figure("over_seconds", "over robot time")];
    return [element("div", { class: "choices" }, this.choice), element("div", { class: "row wide" }, ...plots)];
  }

  async draw() {
    if (this.errors.length === 0) return;
    const error = this.errors.find(([one]) => one === this.choice.value);
    const [name] = error;
    const { factor } = unitOf(name);
    const title = errorTitle(error);
    const over = (cost) => this.data.runs.map((run, index) => {
      const moments = run.moments.filter((moment) => typeof moment[name] === "number");
      const words = plain(wordsOf(run, index));
      return {
        ...points(letterOf(index), moments.map((moment) => moment[cost]), moments.map((moment) => factor * moment[name]), [], { size: 4 }),
        mode: "lines+markers",
        line: { color: lineColour(index), width: 1.8 },
        hovertemplate: `%{y:.4g}<extra>${words}</extra>`,
      };
    });
    const axes = (cost) => ({ xaxis: axis(cost, { rangemode: "tozero" }), yaxis: axis(plain(title), { rangemode: "tozero", automargin: true }), showlegend: true, hovermode: "x unified" });
    await plot("over_taps", over("taps"), axes("taps"));
    await plot("over_seconds", over("robot_seconds"), { ...axes("robot time [s]"), hovermode: "closest" });
  }
}

/// The surface of each run after the number of taps that the slider sets, and the differences from the surface of the
/// first run.
class Surfaces {
  constructor(data, bytes) {
    this.data = data;
    let at = 0;
    this.maps = data.runs.map((run) => {
      const length = 2 * run.x.length * run.y.length * run.maps.reduce((sum, one) => sum + one.frames, 0);
      const maps = unpackMaps(bytes.subarray(at, at + length), run.maps, run.x.length, run.y.length);
      at += length;
      return Object.fromEntries(Object.entries(maps).map(([name, frames]) => [name, frames.map((lines) => scaled(lines, kCentimetres))]));
    });
    this.range = extent(this.maps.flatMap((one) => extent(one.height.flat(2))));
    const [first] = data.runs;
    const same = (run) => String(run.x) === String(first.x) && String(run.y) === String(first.y);
    this.like = data.runs.map((run, index) => index > 0 && same(run));
    this.most = Math.max(...data.runs.map((run) => run.moments.length - 1));
    this.input = element("input", { type: "range", id: "slider", min: 0, max: this.most, step: 1, value: this.most, "aria-label": "taps" });
    this.output = element("output", { id: "at", for: "slider" });
    this.input.addEventListener("input", () => this.show());
  }

  controls() {
    return element("div", { class: "controls" }, this.output, this.input);
  }

  figures() {
    return this.data.runs.map((run, index) => figure(`surface_${index}`, foreign(`${wordsOf(run, index)}, height [cm]`)));
  }

  differences() {
    const those = this.data.runs.flatMap((_, index) => (this.like[index] ? [figure(`difference_${index}`, `${letterOf(index)} minus A, height [cm]`)] : []));
    const others = this.data.runs.flatMap((_, index) => (index > 0 && !this.like[index] ? [letterOf(index)] : []));
    const note = others.length > 0 ? [element("p", { class: "sub" }, `Without a difference, because their candidates differ from A's: ${others.join(", ")}.`)] : [];
    return [element("div", { class: "row" }, ...those), ...note];
  }

  show() {
    return drawLatest(this.input, (taps) => this.draw(taps));
  }

  async draw(taps) {
    this.output.textContent = `after tap ${taps} of ${this.most}`;
    const frames = this.data.runs.map((run, index) => this.maps[index].height[frameAt(run, taps)]);
    const drawn = this.data.runs.map((run, index) => {
      const [on, off, failed] = tapsUntil(run, Math.min(taps, run.taps.length));
      const traces = [
        heatMap(run, frames[index], this.range, kWhere, "cm"),
        markTrace(on, "on the object", { symbol: "circle", size: 8, color: "#ffffff", line: edge("#000000", 1.4) }),
        ...deskMarks(off),
        markTrace(failed, "failed", { symbol: "square", size: 8, line: edge("#000000", 1), color: "#e69f00" }),
      ];
      return plot(`surface_${index}`, traces, { ...planeAxes(run), showlegend: false });
    });
    const less = frames.map((lines, index) => (this.like[index] ? lines.map((line, row) => line.map((value, column) => value - frames[0][row][column])) : null));
    const most = Math.max(1e-3, ...less.flatMap((lines) => (lines ? extent(lines.flat()).map(Math.abs) : [])));
    const compared = less.flatMap((lines, index) =>
      lines ? [plot(`difference_${index}`, [heatMap(this.data.runs[index], lines, [-most, most], "RdBu", "cm")], { ...planeAxes(this.data.runs[index]), showlegend: false })] : [],
    );
    await Promise.all([...drawn, ...compared]);
    publishDrawn(taps);
  }
}

function drawRuns(data, bytes) {
  const errors = new ErrorPlots(data);
  const surfaces = new Surfaces(data, bytes);
  const differences = data.differences.rows.length > 0 ? dataTable(data.differences) : element("p", { class: "sub" }, "The configs are equal.");
  document.body.append(
    dataTable(data.standings),
    section("Error", ...errors.elements()),
    element("h2", {}, "Surfaces"),
    surfaces.controls(),
    element("div", { class: "row" }, ...surfaces.figures()),
    section("Differences", ...surfaces.differences()),
    section("Differences between the configs", differences),
    element("p", { class: "sub" }, "Directories: ", foreign(data.runs.map((run, index) => `${letterOf(index)} ${run.directory}`).join("; ")), "."),
    footer(data),
  );
  return () => {
    inTurn(() => errors.draw());
    return surfaces.show();
  };
}

openPage(drawRuns);
