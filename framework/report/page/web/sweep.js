// SPDX-License-Identifier: MIT
// The page of a sweep: the plot of cost against error, the table of jobs, and the controls.

/// Returns an axis for values. The axis is logarithmic if the largest value is more than 20 times the least. `low` and
/// `high` are the ends of the axis. The axis extends beyond the values to the ends of intervals (`ends`), but by at
/// most half the range of the values, because intervals from few seeds may be much wider.
function rangeOf(values, ends) {
  const [[least, most], [lowest, highest]] = [values, ends].map(extent);
  const room = Math.max(most - least, 1e-12) / 2;
  const low = Math.min(Math.max(lowest, least - room), least);
  const high = Math.max(Math.min(highest, most + room), most);
  if (least > 0 && most / least > 20) {
    const bottom = Math.max(low, least / 4);
    const margin = (high / bottom) ** 0.07;
    const [from, to] = [bottom / margin, high * margin];
    return { type: "log", low: from, high: to, range: [Math.log10(from), Math.log10(to)] };
  }
  const margin = high > low ? 0.07 * (high - low) : Math.max(0.1 * Math.abs(high), 1e-12);
  return { type: "linear", low: low - margin, high: high + margin, range: [low - margin, high + margin] };
}

/// Draws each setting as a point at its mean cost and error, with a line along the front. Also draws the runs of the
/// settings as points; failed runs are grey.
function drawFront(sweep, choice) {
  const settings = settingsOf(sweep, choice);
  const here = (jobs) => jobs.filter((job) => sweep.sceneOf(job) === choice.scene);
  const at = (job) => ({ job, cost: sweep.number(choice.cost, job), error: sweep.number(choice.error, job) });
  const done = here(sweep.done).map(at).filter(({ cost, error }) => cost !== null && error !== null);
  const failed = here(sweep.failed).map(at).filter(({ cost }) => cost !== null);
  listFront(choice, settings.filter((one) => one.front > 0));
  describeFront(sweep, choice, settings, failed);
  if (done.length + failed.length === 0) return plotNothing("front");
  if (failed.length === 0 && ![choice.cost, choice.error].some((name) => differs(sweep, name))) {
    return plotNothing("front", [choice.cost, choice.error].map((name) => constantWords(sweep, name)).join(" "));
  }
  const ends = (kind) => {
    const values = [...done, ...failed].map((run) => run[kind]).filter((value) => value !== null);
    const intervals = settings.flatMap(({ [kind]: { mean, half } }) => [mean - (half ?? 0), mean + (half ?? 0)]);
    return rangeOf(values.length > 0 ? values : [0, 1], intervals);
  };
  const axisOf = (kind, { type, range }) => roomyAxis(directedTitle(sweep, choice[kind]), { type, range, exponentformat: "power" });
  const [x, y] = [ends("cost"), ends("error")];
  const edge = sweep.moreIsBetter(choice.error) ? y.low : y.high;
  return plotOfHeight("front", 520, frontTraces(sweep, settings, done, failed, x, y, edge), {
    xaxis: axisOf("cost", x),
    yaxis: axisOf("error", y),
    legend: { orientation: "h", y: 1.02, yanchor: "bottom", x: 0 },
    hovermode: "closest",
    margin: { l: 60, r: 14, t: 40, b: 50 },
  });
}

function frontTraces(sweep, settings, done, failed, x, y, edge) {
  const runs = (list, name, marker, words) => points(name, list.map((run) => run.cost), list.map((run) => run.error ?? edge), list.map(words), marker);
  const about = ({ job }) => `job ${job.index}: ${plain(brief(sweep.words(job, sweep.all), 120))}`;
  const why = (run) => `${about(run)}<br>failed: ${plain(brief(run.job.reason, 120))}`;
  const means = (list, name, marker, more = {}) => {
    const bars = (kind, { type, low }) => ({
      type: "data",
      symmetric: false,
      array: list.map((one) => one[kind].half ?? 0),
      // On a logarithmic axis, bars end just below the lower end of the axis.
      arrayminus: list.map((one) => Math.min(one[kind].half ?? 0, type === "log" ? one[kind].mean - low / 2 : Infinity)),
      thickness: 1,
      width: 2,
      color: themed("bars"),
    });
    const text = list.map((one) => `${plain(brief(one.words, 120))}<br>${sweep.ended(one.jobs)}`);
    const hovertemplate = "%{text}<br>%{x:.4g}, %{y:.4g}<extra></extra>";
    const shape = { error_x: bars("cost", x), error_y: bars("error", y), hovertemplate, ...more };
    return points(name, list.map((one) => one.cost.mean), list.map((one) => one.error.mean), text, marker, shape);
  };
  const step = Math.max(1, Math.ceil(done.length / 5000));
  const complete = settings.filter((one) => one.complete);
  const front = complete.filter((one) => one.front > 0);
  const white = { color: themed("card"), width: 1 };
  return [
    runs(done.filter((_, i) => i % step === 0), "runs", { size: 5, color: themed("runs"), opacity: done.length > 600 ? 0.2 : 0.5 }, about),
    runs(failed, "failed runs", { size: 9, symbol: "x", color: kGrey, line: { color: themed("card"), width: 0.5 } }, why),
    means(settings.filter((one) => !one.complete), "settings not compared", { size: 9, symbol: "circle-open", color: kGrey, line: { width: 2 } }),
    means(complete.filter((one) => one.front === 0), "settings", { size: 9, color: lineColour(0), line: white }),
    means(front, "front", { size: 12, symbol: "diamond", color: lineColour(1), line: white }, {
      mode: "lines+markers+text",
      line: { color: lineColour(1), width: 1.5, shape: "hv" },
      texttemplate: front.map((one) => String(one.front)),
      textposition: "top right",
    }),
  ];
}

/// Returns remarks about the units of the means, and about a small number of seeds.
function meansWords(sweep, settings) {
  const kFew = 10;
  const rest = "numbered: no other setting is at least as good in both.";
  const counts = settings.map((one) => one.error.clusters);
  const equal = settings.some(({ cost, error }) => [cost, error].some((one) => one.clusters > 1 && one.half === null))
    ? " A setting with equal values has no bar, because the values show no spread."
    : "";
  const copies = settings.some(({ error }) => !sweep.seeds && error.clusters < error.count) ? " Copies of a run count once." : "";
  if (!sweep.seeds || counts.length === 0) return `The seed is not swept: means over the jobs of each setting; ${rest}${copies}${equal}`;
  const [fewest, most] = extent(counts);
  const over = fewest === most ? counted(most, "seed") : `${fewest} to ${counted(most, "seed")}`;
  const few = fewest < kFew ? ` With fewer than ${kFew} seeds such an interval can miss the true mean in more than 5 of 100 cases.` : "";
  return `Means over ${over} with 95 % intervals (Student's t); ${rest}${few}${equal}`;
}

function describeFront(sweep, choice, settings, placed) {
  const edged = placed.filter(({ error }) => error === null).length;
  const open = settings.filter((one) => !one.complete).length;
  const here = (jobs) => jobs.filter((job) => sweep.sceneOf(job) === choice.scene);
  const empty = sweep.groups(sweep.settings).filter(({ jobs }) => here(jobs).length > 0).length - settings.length;
  const gone = here(sweep.failed).length - placed.length;
  const end = sweep.moreIsBetter(choice.error) ? "lower" : "upper";
  setCaption(
    "front",
    meansWords(sweep, settings),
    open > 0 ? ` Not compared, because jobs failed, have not ended or lack a value: ${counted(open, "setting")}.` : "",
    empty > 0 ? ` Without any value: ${counted(empty, "setting")}.` : "",
    edged > 0 ? ` ${edged} failed runs have no error and are drawn at the ${end} edge.` : "",
    gone > 0 ? ` ${gone} failed runs have no cost either and are not drawn.` : "",
  );
}

function listFront(choice, front) {
  const value = ({ mean, half }) => `${shown(mean)}${half === null ? "" : ` ± ${shown(half, 2)}`}`;
  const rows = front.map((one) => [String(one.front), foreign(one.words), value(one.cost), value(one.error)]);
  const header = ["", "on the front", foreign(withUnit(choice.cost)), foreign(withUnit(choice.error))];
  document.getElementById("front_list").replaceChildren(front.length > 0 ? table(header, rows, 2) : "");
}

/// The table of jobs, which can be sorted and filtered.
class JobTable {
  constructor(sweep) {
    this.sweep = sweep;
    this.by = null;
    this.down = false;
    this.most = 200;
    this.filter = element("input", { type: "search", id: "filter", placeholder: "filter", "aria-label": "filter the jobs" });
    this.table = element("table", { id: "jobs" });
    this.note = element("p", { class: "sub", id: "jobs_note" });
    this.more = element("button", { type: "button", id: "more" }, "more");
    this.filter.addEventListener("input", () => this.show());
    this.more.addEventListener("click", () => {
      this.most += 500;
      this.show();
    });
  }

  place() {
    return section("Jobs", element("p", {}, this.filter), element("div", { class: "scroll" }, this.table), this.note, this.more, ...this.howToReport());
  }

  /// Sets the columns. A column has a title, a value for sorting and a cell. Columns of numbers come last.
  choose(choice) {
    const wanted = [choice.metric, choice.cost, choice.error, ...mainColumns(this.sweep)];
    const names = [...new Set(wanted)].filter((name) => this.sweep.columns.has(name) && !this.sweep.key(name));
    const texts = [
      { name: "job", get: (job) => job.index, show: (job) => this.link(job) },
      { name: "state", get: (job) => this.state(job), show: (job) => foreign(this.state(job)) },
      ...this.sweep.keys.map((key) => ({ name: key.name, get: (job) => key.of_job[job.place], show: (job) => foreign(this.sweep.text(key, job)) })),
    ];
    const numbers = names.map((name) => {
      const get = (job) => this.sweep.number(name, job);
      return { name: withUnit(name), get, show: (job) => shown(get(job)) };
    });
    this.columns = [...texts, ...numbers];
    this.texts = texts.length;
    this.show();
  }

  state(job) {
    return job.reason && job.state === "failed" ? `failed: ${job.reason}` : job.state;
  }

  /// Returns the number of a job, as a link if the job has a page.
  link(job) {
    const live = this.sweep.live !== undefined;  // On a live page, the server makes the pages of jobs.
    if (job.state === "missing" || !(live || job.reported)) return String(job.index);
    return element("a", { href: `jobs/${encodeURIComponent(job.id)}/${live ? "" : "report.html"}` }, String(job.index));
  }

  /// Returns a note that explains how to make the page of a job; an empty list if all jobs have a page.
  howToReport() {
    const bare = this.sweep.jobs.find((job) => !job.reported && job.state !== "missing");
    if (!bare || this.sweep.live !== undefined) return [];
    const command = commandOn("report", `${this.sweep.folder}/jobs/${bare.id}`);
    return [element("p", { class: "sub", id: "how_to_report" }, `A job's number links to its own page, if it exists. Job ${bare.index} has no page yet: `, command, " makes it. Make this page again to link to it.")];
  }

  /// Returns the jobs that match the filter, in the chosen order.
  chosen() {
    const word = this.filter.value.trim().toLowerCase();
    const about = (job) => `${job.index} ${job.id} ${this.state(job)} ${this.sweep.words(job, this.sweep.all)}`.toLowerCase();
    const jobs = this.sweep.jobs.filter((job) => word === "" || about(job).includes(word));
    if (this.by === null || this.by >= this.columns.length) return jobs;
    const { get } = this.columns[this.by];
    const sign = this.down ? -1 : 1;
    // Jobs without a value are last in both orders.
    const compare = (a, b) => (a === null || b === null ? (a === null) - (b === null) : sign * (a < b ? -1 : a > b ? 1 : 0));
    return jobs.sort((a, b) => compare(get(a), get(b)));
  }

  header({ name }, i) {
    const mark = this.by === i ? (this.down ? " ▼" : " ▲") : "";
    const button = element("button", { type: "button", class: "sort" }, foreign(name), mark);
    button.addEventListener("click", () => {
      this.down = this.by === i && !this.down;
      this.by = i;
      this.show();
      this.table.querySelectorAll("button")[i].focus();  // the same button in the new header
    });
    return button;
  }

  show() {
    const jobs = this.chosen();
    const drawn = jobs.slice(0, this.most);
    const head = tableRow("th", this.columns.map((column, i) => this.header(column, i)), this.texts);
    head.children[this.by]?.setAttribute("aria-sort", this.down ? "descending" : "ascending");
    const rows = drawn.map((job) => {
      const row = tableRow("td", this.columns.map((column) => column.show(job)), this.texts);
      row.className = job.state;
      return row;
    });
    this.table.replaceChildren(element("thead", {}, head), element("tbody", {}, ...rows));
    const left = jobs.length < this.sweep.jobs.length ? ` of ${this.sweep.jobs.length}` : "";
    const rest = this.sweep.sampled ? `, one of ${this.sweep.sampled.step} of ${this.sweep.sampled.jobs}: the others are in results.csv` : "";
    this.note.textContent = `${drawn.length < jobs.length ? `the first ${drawn.length} of ` : ""}${jobs.length}${left} jobs${rest}`;
    this.more.hidden = drawn.length === jobs.length;
  }
}

/// Returns warnings about failures, by reason, and about jobs that have not ended.
function troubles(sweep) {
  const { failures, reasons, jobs: all } = sweep.tally;
  const out = failures.map(({ reason, jobs, first, words }) => [
    jobs === 1 ? `Job ${first} failed (` : `${jobs} jobs failed, the first is job ${first} (`,
    foreign(words || "the only setting"),
    "): ",
    foreign(reason),
  ]);
  const more = reasons - out.length;
  if (more > 0) out.push([`${more} more reasons are in ${sweep.sampled ? "results.csv" : "the table of jobs"}.`]);
  const some = sweep.counts().filter(([, state]) => state !== "done" && state !== "failed");
  const open = some.reduce((sum, [count]) => sum + count, 0);
  if (open > 0) {
    const states = some.map((count) => count.join(" ")).join(", ");
    out.push([`${open} of ${all} jobs ${open === 1 ? "has" : "have"} not ended (${states})${sweep.live === undefined ? ": this page shows an earlier state" : ""}; 'palpate resume' runs the jobs that no process is running.`]);
  }
  return out;
}

/// Returns a note if the page has only a sample of the jobs; otherwise an empty list.
function sampleNote({ sampled, jobs }) {
  if (!sampled) return [];
  const words = `This page has ${jobs.length} of ${sampled.jobs} jobs, one of ${sampled.step}, taken evenly from all settings: plots, means and the table below show only these. Counts and failures cover all jobs, and so do results.csv, 'palpate compare' and 'palpate pareto'.`;
  return [element("p", { class: "sub", id: "sampled" }, words)];
}

/// Returns the numbers of jobs by state, with notes and warnings.
function sweepState(sweep) {
  const counts = sweep.counts();
  if (!counts.some(([, state]) => state === "done")) counts.unshift([0, "done"]);
  return [factList([[sweep.tally.jobs, "jobs"], ...counts]), ...sampleNote(sweep), ...warningList(troubles(sweep))];
}

/// Returns a table of the swept keys with their values. These values replace the values in the config.
function sweptValues({ keys }) {
  const kMost = 24;
  const words = ({ values }) => [...values.slice(0, kMost).map((value) => value || kNothing), ...(values.length > kMost ? ["…"] : [])].join(", ");
  return table(["swept key", "values"], keys.map((key) => [foreign(key.name), foreign(words(key))]));
}

function drawSweep(data) {
  if (data.waiting !== undefined) return drawWaiting(data);
  const sweep = new SweepData(data);
  const swept = sweep.all.flatMap((key, i) => [i > 0 ? ", " : " over ", foreign(key.name), ` (${key.values.length})`]);
  document.body.append(
    element("p", { class: "sub" }, "sweep ", foreign(data.id), ...swept, ". ", liveNote(data)),
    element("div", { id: "standing" }, ...sweepState(sweep)),
  );
  const redraw = sweep.columns.size > 0 ? drawPanels(sweep) : noPanels(sweep);
  document.body.append(section("Config", sweptValues(sweep), element("pre", { class: "foreign scroll", dir: "ltr" }, data.config)), footer(data));
  follow(data, (news) => growSweep(sweep, news));
  return redraw;
}

/// Draws the page of a sweep without results to plot.
function noPanels(sweep) {
  const jobs = new JobTable(sweep);
  document.body.append(element("p", { id: "nothing" }, "No job has a result yet: there is nothing to draw."), jobs.place());
  jobs.choose({});
  sweep.refresh = () => jobs.show();
  return () => publishDrawn(1);
}

/// Adds the panels to the page. `chooser` makes their controls.
function placePanels(sweep, chooser) {
  const columns = [...sweep.columns.keys()];
  const [errors, costs] = ["is_error", "is_cost"].map((role) => columns.filter((name) => sweep.columns.get(name)[role]));
  const keys = sweep.keys.map((key) => key.name);
  const choices = (...choosers) => element("p", { class: "choices" }, ...choosers);
  const orNothing = (name) => name || "nothing";
  const scenes = sweep.scenes();
  const ofScenes = scenes.length > 1 ? [chooser("scene", sweep.scene_keys.join(", "), scenes, [drawFront])] : [];
  document.body.append(
    ...(sweep.race ? [placeRace(sweep)] : []),
    ...(sweep.curves ? [placeCurves(sweep, chooser, choices)] : []),
    ...(sweep.planned ? [element("p", { class: "sub", id: "planned" }, foreign(sweep.planned))] : []),
    element("div", { class: "controls" }, chooser("metric", "show", columns, [drawCells, drawGroups, drawParallel], withUnit)),
    section(
      "By two keys",
      choices(chooser("across", "across", keys, [drawCells]), chooser("up", "up", ["", ...keys], [drawCells], orNothing)),
      element("div", { class: "row wide" }, figure("cells_mean", ""), figure("cells_spread", "")),
    ),
    section(
      "By groups",
      choices(chooser("group", "groups by", [kEachSetting, ...keys], [drawGroups]), chooser("then", "and by", ["", ...keys], [drawGroups], orNothing)),
      figure("groups", ""),
    ),
    ...(sweep.importance ? [section("Which key matters", element("pre", { class: "foreign scroll", id: "importance" }, sweep.importance))] : []),
    section("All keys at once", figure("parallel", "")),
    ...(sweep.curves ? [] : noCurves(sweep)),
    section(
      "Cost and error",
      choices(...ofScenes, chooser("cost", "cost", costs, [drawFront]), chooser("error", "error", errors, [drawFront])),
      figure("front", ""),
      element("div", { id: "front_list" }),
    ),
  );
}

function drawPanels(sweep) {
  const choice = firstChoices(sweep);
  const jobs = new JobTable(sweep);
  let drawn = 0;
  const drawAll = (panels) =>
    inTurn(async () => {
      for (const panel of panels) await panel(sweep, choice);
      publishDrawn(++drawn);
    });
  /// Returns a control that sets a choice, and then redraws the panels that depend on this choice.
  const chooser = (id, label, names, panels, textOf = (name) => name) => {
    const options = names.map((name) => element("option", { value: name, ...(name === choice[id] ? { selected: "" } : {}) }, brief(textOf(name), 60)));
    const control = element("select", { id }, ...options);
    control.addEventListener("change", () => {
      choice[id] = control.value;
      jobs.choose(choice);
      drawAll(panels);
    });
    return element("label", {}, `${label} `, control);
  };
  placePanels(sweep, chooser);
  document.body.append(jobs.place());
  jobs.choose(choice);
  const all = [...(sweep.race ? [drawRace] : []), drawCells, drawGroups, drawParallel, ...(sweep.curves ? [drawCurves] : []), drawFront];
  sweep.refresh = () => {
    jobs.show();
    drawAll(all);
  };
  return () => drawAll(all);
}

openPage(drawSweep);
