// SPDX-License-Identifier: MIT
// The page of a sweep: cost against error, the table of jobs, and how all panels follow the controls.

/// The least and the most of very many numbers.
const leastOf = (values) => values.reduce((a, b) => Math.min(a, b), Infinity);
const mostOf = (values) => values.reduce((a, b) => Math.max(a, b), -Infinity);

/// Ends of an axis for values, logarithmic where they span much; `low` and `high` are its ends in the values' unit.
function rangeOf(means, ends) {
  const least = leastOf(means);
  const most = mostOf(means);
  const low = Math.min(leastOf(ends), least);
  const high = Math.max(mostOf(ends), most);
  if (least > 0 && most / least > 20) {
    const bottom = Math.max(low, least / 4);
    const margin = (high / bottom) ** 0.07;
    const [from, to] = [bottom / margin, high * margin];
    return { type: "log", low: from, high: to, range: [Math.log10(from), Math.log10(to)] };
  }
  const margin = high > low ? 0.07 * (high - low) : Math.max(0.1 * Math.abs(high), 1e-12);
  return { type: "linear", low: low - margin, high: high + margin, range: [low - margin, high + margin] };
}

/// Settings by mean cost and mean error, those on the front joined; runs behind them, failed ones grey.
class FrontPanel {
  constructor(sweep) {
    this.sweep = sweep;
  }

  /// Done and failed runs as {job, cost, error}; a failed one without an error has null there.
  runs(choice) {
    const at = (job) => ({ job, cost: this.sweep.number(choice.cost, job), error: this.sweep.number(choice.error, job) });
    const runs = (jobs) => jobs.map(at).filter(({ cost }) => cost !== null);
    return { done: runs(this.sweep.done).filter(({ error }) => error !== null), failed: runs(this.sweep.failed) };
  }

  draw(choice) {
    const settings = settingsOf(this.sweep, choice.cost, choice.error);
    const runs = this.runs(choice);
    this.list(choice, settings);
    this.caption(choice, settings, runs);
    const all = [...runs.done, ...runs.failed];
    if (all.length === 0) return drawIn("front", [], { xaxis: { visible: false }, yaxis: { visible: false } }, 120);
    const ends = (kind) => settings.flatMap((one) => [one[kind].mean - (one[kind].half ?? 0), one[kind].mean + (one[kind].half ?? 0)]);
    // A few settings seen in a few seeds have intervals far wider than anything measured: the axis ends before them.
    const values = (kind) => all.map((run) => run[kind]).filter((value) => value !== null);
    const kept = (kind) => {
      const [least, most] = [leastOf(values(kind)), mostOf(values(kind))];
      const room = Math.max(most - least, 1e-12) / 2;
      return ends(kind).map((end) => Math.min(Math.max(end, least - room), most + room));
    };
    const x = rangeOf(values("cost"), kept("cost"));
    const y = values("error").length > 0 ? rangeOf(values("error"), kept("error")) : rangeOf([0, 1], []);
    const edge = this.sweep.moreIsBetter(choice.error) ? y.low : y.high;
    const more = {
      xaxis: axis(judged(this.sweep, choice.cost), { type: x.type, range: x.range, exponentformat: "power" }),
      yaxis: axis(judged(this.sweep, choice.error), { type: y.type, range: y.range, exponentformat: "power" }),
      legend: { orientation: "h", y: 1.02, yanchor: "bottom", x: 0 },
      hovermode: "closest",
      margin: { l: 60, r: 14, t: 40, b: 50 },
    };
    return drawIn("front", this.traces(settings, runs, x, y, edge), more, 520);
  }

  traces(settings, runs, x, y, edge) {
    const points = (list, name, marker, hover) => ({
      type: "scatter",
      mode: "markers",
      name,
      x: list.map((run) => run.cost),
      y: list.map((run) => run.error ?? edge),
      text: list.map(hover),
      hovertemplate: "%{text}<extra></extra>",
      marker,
    });
    const about = ({ job }) => `job ${job.index}: ${plain(brief(this.sweep.words(job, this.sweep.all), 120))}`;
    const why = (run) => `${about(run)}<br>failed: ${plain(brief(run.job.reason, 120))}`;
    const step = Math.max(1, Math.ceil(runs.done.length / 5000));
    const complete = settings.filter((one) => one.complete);
    const front = complete.filter((one) => one.front > 0);
    return [
      points(runs.done.filter((_, i) => i % step === 0), "runs", { size: 5, color: "#56b4e9", opacity: runs.done.length > 600 ? 0.2 : 0.5 }, about),
      points(runs.failed, "failed runs", { size: 9, symbol: "x", color: kGrey, line: { color: "#ffffff", width: 0.5 } }, why),
      this.means(settings.filter((one) => !one.complete), "settings not compared", { size: 9, symbol: "circle-open", color: kGrey, line: { width: 2 } }, x, y),
      this.means(complete.filter((one) => one.front === 0), "settings", { size: 9, color: kColours[0], line: { color: "#ffffff", width: 1 } }, x, y),
      {
        ...this.means(front, "front", { size: 12, symbol: "diamond", color: kColours[1], line: { color: "#ffffff", width: 1 } }, x, y),
        mode: "lines+markers+text",
        line: { color: kColours[1], width: 1.5, shape: "hv" },
        texttemplate: front.map((one) => String(one.front)),
        textposition: "top right",
      },
    ];
  }

  means(settings, name, marker, x, y) {
    const bars = (kind, ends) => ({
      type: "data",
      symmetric: false,
      array: settings.map((one) => one[kind].half ?? 0),
      // A logarithmic axis has no 0 for a bar to reach.
      arrayminus: settings.map((one) => Math.min(one[kind].half ?? 0, ends.type === "log" ? one[kind].mean - ends.low / 2 : Infinity)),
      thickness: 1,
      width: 2,
      color: "rgba(80,80,80,0.35)",
    });
    return {
      type: "scatter",
      mode: "markers",
      name,
      x: settings.map((one) => one.cost.mean),
      y: settings.map((one) => one.error.mean),
      error_x: bars("cost", x),
      error_y: bars("error", y),
      text: settings.map((one) => `${plain(brief(one.words, 120))}<br>${this.sweep.ended(one.jobs)}`),
      hovertemplate: "%{text}<br>%{x:.4g}, %{y:.4g}<extra></extra>",
      marker,
    };
  }

  caption(choice, settings, runs) {
    const failed = this.sweep.failed.length;
    const placed = runs.failed.length;
    const edged = runs.failed.filter(({ error }) => error === null).length;
    const open = settings.filter((one) => !one.complete).length;
    const empty = this.sweep.groups(this.sweep.settings).length - settings.length;
    const end = this.sweep.moreIsBetter(choice.error) ? "lower" : "upper";
    const text = ["Means over the seeds with 95 % intervals; numbered: no other setting is at least as good in both."];
    if (open > 0) text.push(`Not compared, for jobs that failed, have not ended or lack a value: ${many(open, "setting")}.`);
    if (empty > 0) text.push(`Without any value: ${many(empty, "setting")}.`);
    if (edged > 0) text.push(`${edged} failed runs came to no error and stand at the ${end} edge.`);
    if (failed > placed) text.push(`${failed - placed} failed runs came to no cost either and are not drawn.`);
    say("front", text.join(" "));
  }

  list(choice, settings) {
    const value = (of) => `${shown(of.mean)}${of.half === null ? "" : ` ± ${shown(of.half, 2)}`}`;
    const front = settings.filter((one) => one.front > 0);
    const rows = front.map((one) => [String(one.front), foreign(one.words), value(one.cost), value(one.error)]);
    const header = ["", "on the front", foreign(withUnit(choice.cost)), foreign(withUnit(choice.error))];
    document.getElementById("front_list").replaceChildren(front.length > 0 ? table(header, rows, 2) : "");
  }
}

/// All jobs in a table that is sorted by a click and filtered by a word.
class JobTable {
  constructor(sweep) {
    this.sweep = sweep;
    this.by = null;
    this.down = false;
    this.most = 200;
    this.filter = element("input", { type: "search", id: "filter", placeholder: "filter", "aria-label": "filter the jobs" });
    this.body = element("tbody");
    this.head = element("thead");
    this.note = element("p", { class: "sub", id: "jobs_note" });
    this.more = element("button", { type: "button", id: "more" }, "more");
    this.filter.addEventListener("input", () => this.show());
    this.more.addEventListener("click", () => {
      this.most += 500;
      this.show();
    });
  }

  place() {
    const all = element("div", { class: "scroll" }, element("table", { id: "jobs" }, this.head, this.body));
    return section("Jobs", element("p", {}, this.filter), all, this.note, this.more);
  }

  /// A column: its header, what is shown of a job, and by what it is sorted.
  choose(choice) {
    const wanted = [choice.metric, choice.cost, choice.error, ...mainColumns(this.sweep)];
    const names = wanted.filter((name, i) => this.sweep.columns.has(name) && wanted.indexOf(name) === i && !this.sweep.key(name));
    this.columns = [
      { name: "job", get: (job) => job.index, show: (job) => this.link(job) },
      { name: "state", get: (job) => this.state(job) },
      ...this.sweep.keys.map((key) => ({
        name: key.name,
        get: (job) => key.place[key.of_job[job.index]],
        show: (job) => foreign(this.sweep.text(key, job)),
      })),
      ...names.map((name) => ({ name: withUnit(name), number: true, get: (job) => this.sweep.number(name, job) })),
    ];
    this.show();
  }

  state(job) {
    return job.reason && job.state === "failed" ? `failed: ${job.reason}` : job.state;
  }

  link(job) {
    if (job.state === "missing") return String(job.index);
    const place = `jobs/${encodeURIComponent(job.id)}/`;
    const out = element("span", {}, element("a", { href: place }, String(job.index)));
    if (job.reported) out.append(" ", element("a", { href: `${place}report.html` }, "report"));
    return out;
  }

  /// The jobs that the filter leaves, in the chosen order.
  chosen() {
    const word = this.filter.value.trim().toLowerCase();
    const about = (job) => `${job.index} ${job.id} ${this.state(job)} ${this.sweep.words(job, this.sweep.all)}`.toLowerCase();
    const jobs = this.sweep.jobs.filter((job) => word === "" || about(job).includes(word));
    if (this.by === null || this.by >= this.columns.length) return jobs;
    const { get } = this.columns[this.by];
    const sign = this.down ? -1 : 1;
    // What has no value stands last, whichever way.
    const compare = (a, b) => (a === null || b === null ? (a === null) - (b === null) : sign * (a < b ? -1 : a > b ? 1 : 0));
    return jobs.sort((a, b) => compare(get(a), get(b)));
  }

  header(column, i) {
    const mark = this.by === i ? (this.down ? " ▼" : " ▲") : "";
    const button = element("button", { type: "button", class: "sort" }, foreign(column.name), mark);
    button.addEventListener("click", () => {
      this.down = this.by === i && !this.down;
      this.by = i;
      this.show();
      this.head.querySelectorAll("button")[i].focus();  // the one that took its place
    });
    const order = this.by === i ? { "aria-sort": this.down ? "descending" : "ascending" } : {};
    return element("th", { ...(column.number ? { class: "number" } : {}), ...order }, button);
  }

  show() {
    const jobs = this.chosen();
    const drawn = jobs.slice(0, this.most);
    const cell = (column, job) => {
      const content = column.show ? column.show(job) : column.number ? shown(column.get(job)) : foreign(column.get(job));
      return element("td", column.number ? { class: "number" } : {}, content);
    };
    this.head.replaceChildren(element("tr", {}, ...this.columns.map((column, i) => this.header(column, i))));
    this.body.replaceChildren(
      ...drawn.map((job) => element("tr", { class: job.state }, ...this.columns.map((column) => cell(column, job)))),
    );
    const left = jobs.length < this.sweep.jobs.length ? ` of ${this.sweep.jobs.length}` : "";
    this.note.textContent = `${drawn.length < jobs.length ? `the first ${drawn.length} of ` : ""}${jobs.length}${left} jobs`;
    this.more.hidden = drawn.length === jobs.length;
  }
}

/// What went wrong, in words: failures by their reason, and what has not ended.
function troubles(sweep) {
  const kMostReasons = 12;
  const reasons = new Map();
  for (const job of sweep.failed) {
    if (!reasons.has(job.reason)) reasons.set(job.reason, []);
    reasons.get(job.reason).push(job);
  }
  const out = [...reasons].slice(0, kMostReasons).map(([reason, jobs]) =>
    element(
      "li",
      {},
      jobs.length === 1 ? `Job ${jobs[0].index} failed (` : `${jobs.length} jobs failed, the first is job ${jobs[0].index} (`,
      foreign(sweep.words(jobs[0], sweep.all)),
      "): ",
      foreign(reason),
    ),
  );
  if (reasons.size > kMostReasons) out.push(element("li", {}, `${reasons.size - kMostReasons} more reasons stand in the table of jobs.`));
  const open = sweep.jobs.length - sweep.done.length - sweep.failed.length;
  if (open > 0) {
    const some = ["running", "unfinished", "missing"].filter((state) => sweep.count(state) > 0).map((state) => `${sweep.count(state)} ${state}`);
    out.push(element("li", {}, `${open} of ${sweep.jobs.length} jobs ${open === 1 ? "has" : "have"} not ended (${some.join(", ")}): this page shows the sweep as it stood; 'palpate resume' carries on what nobody runs.`));
  }
  return out.length > 0 ? [element("ul", { class: "warnings", id: "warnings" }, ...out)] : [];
}

/// A choice among names, some of them shown otherwise than they are called.
function chooser(id, label, names, chosen, texts = {}) {
  const options = names.map((name) => element("option", { value: name, ...(name === chosen ? { selected: "" } : {}) }, brief(texts[name] ?? name, 60)));
  return element("label", {}, `${label} `, element("select", { id }, ...options));
}

function drawSweep(data) {
  const sweep = new SweepData(data);
  const choice = firstChoices(sweep);
  document.title = `${data.name} ${data.id} – palpate`;
  const counts = ["done", "failed", "running", "unfinished", "missing"].map((state) => [sweep.count(state), state]);
  const facts = [[sweep.jobs.length, "jobs"], ...counts.filter(([count, state]) => count > 0 || state === "done")];
  const swept = sweep.all.flatMap((key, i) => [i > 0 ? ", " : "", foreign(key.name), ` (${key.values.length})`]);
  document.body.append(
    element("h1", {}, foreign(data.name)),
    element("p", { class: "sub" }, "sweep ", foreign(data.id), ...(swept.length > 0 ? [" over ", ...swept] : []), "."),
    element("ul", { class: "facts" }, ...facts.map(([count, what]) => element("li", {}, element("b", {}, String(count)), element("span", {}, what)))),
    ...troubles(sweep),
  );
  const drawing = sweep.columns.size > 0 ? drawPanels(sweep, choice) : noPanels(sweep);
  document.body.append(
    section("Config", element("pre", { class: "foreign scroll", dir: "ltr" }, data.config)),
    element("footer", {}, `palpate ${data.version}; method: Sun and Min 2021, arXiv:2110.09593; drawn with plotly.js (MIT).`),
  );
  return drawing;
}

/// A sweep of which no job has ended.
function noPanels(sweep) {
  const jobs = new JobTable(sweep);
  document.body.append(element("p", { id: "nothing" }, "No job has come to a result yet: there is nothing to draw."), jobs.place());
  jobs.choose({});
  document.body.dataset.drawn = "1";
}

function drawPanels(sweep, choice) {
  const columns = [...sweep.columns.keys()];
  const keys = sweep.keys.map((key) => key.name);
  const errors = columns.filter((name) => name !== "coverage_95"); // best at 0.95, neither small nor large
  const costs = errors.filter((name) => !sweep.moreIsBetter(name));
  const cells = new CellsPanel(sweep);
  const groups = new GroupsPanel(sweep);
  const parallel = new ParallelPanel(sweep, hasWebGL());
  const front = new FrontPanel(sweep);
  const jobs = new JobTable(sweep);
  const none = { "": "nothing" };
  document.body.append(
    element("div", { class: "controls" }, chooser("metric", "show", columns, choice.metric, Object.fromEntries(columns.map((name) => [name, withUnit(name)])))),
    section(
      "By two keys",
      element("p", { class: "choices" }, chooser("across", "across", keys, choice.across), chooser("up", "up", ["", ...keys], choice.up, none)),
      element("div", { class: "row wide" }, figure("cells_mean", ""), figure("cells_spread", "")),
    ),
    section(
      "By groups",
      element("p", { class: "choices" }, chooser("group", "groups by", [kEachSetting, ...keys], choice.group), chooser("then", "and by", ["", ...keys], choice.then, none)),
      figure("groups", ""),
    ),
    section("All keys at once", figure("parallel", "")),
    section(
      "Cost and error",
      element("p", { class: "choices" }, chooser("cost", "cost", costs, choice.cost), chooser("error", "error", errors, choice.error)),
      figure("front", ""),
      element("div", { id: "front_list" }),
    ),
    jobs.place(),
  );
  const all = {
    metric: [cells, groups, parallel],
    across: [cells],
    up: [cells],
    group: [groups],
    then: [groups],
    cost: [front],
    error: [front],
  };
  let drawn = 0;
  // One drawing at a time. For whoever waits for the picture the page counts them.
  let drawing = Promise.resolve();
  const draw = (panels) => {
    drawing = drawing.then(async () => {
      for (const panel of panels) await panel.draw(choice);
      document.body.dataset.drawn = String(++drawn);
    }).catch(complain);
    return drawing;
  };
  for (const [id, panels] of Object.entries(all)) {
    document.getElementById(id).addEventListener("change", (event) => {
      choice[id] = event.target.value;
      if (["metric", "cost", "error"].includes(id)) jobs.choose(choice);
      draw(panels);
    });
  }
  jobs.choose(choice);
  return draw([cells, groups, parallel, front]);
}

openPage(drawSweep);
