// SPDX-License-Identifier: MIT
// What the panels of a sweep's page are made of: columns, groups, means, the front. Nothing here draws.

/// What stands for a value that a job has not, because its plugins know no such option.
const kNoValue = "–";

/// Text on one line and without marks of direction, cut where it is long.
function brief(text, most = 36) {
  const line = String(text)
    .replace(/[\n\r\t]+/g, " ")
    .replace(/\d*\.\d{5,}/g, (digits) => shown(Number(digits)))
    .replace(/[\u200e\u200f\u202a-\u202e\u2066-\u2069]/g, "");
  const letters = Array.from(line);
  return letters.length > most ? `${letters.slice(0, most - 1).join("")}…` : line;
}

/// Names that stand side by side, each brief: cut at their ends, or in the middle where that leaves equal ones, and
/// numbered where even those are equal.
function briefs(names, most = 36) {
  const alike = (texts) => new Set(texts).size < new Set(names).size;
  const ends = names.map((name) => brief(name, most));
  if (!alike(ends)) return ends;
  const middles = names.map((name) => {
    const letters = Array.from(brief(name, Infinity));
    const half = Math.floor((most - 1) / 2);
    return letters.length > most ? `${letters.slice(0, half).join("")}…${letters.slice(-half).join("")}` : letters.join("");
  });
  return alike(middles) ? middles.map((text, i) => `${i + 1}: ${text}`) : middles;
}

/// The sweep as the panels ask for it.
class SweepData {
  constructor(data) {
    this.data = data;
    this.jobs = data.jobs.map(([id, state, reason, reported], index) => ({ index, id, state, reason, reported: reported === 1 }));
    this.done = this.jobs.filter((job) => job.state === "done");
    this.failed = this.jobs.filter((job) => job.state === "failed");
    this.keys = data.keys.map((key) => {
      const order = orderOf(key);
      const place = [];
      order.forEach((value, at) => (place[value] = at));
      return { ...key, order, place, varies: order.length > 1 };
    });
    this.columns = new Map(data.columns.map((column) => [column.name, column]));
    const kept = this.keys.filter((key) => key.name !== "seed");
    this.settings = kept;
    this.varying = kept.filter((key) => key.varies);
    this.all = this.keys.filter((key) => key.varies);  // what tells jobs apart
  }

  key(name) {
    return this.keys.find((key) => key.name === name);
  }

  count(state) {
    return this.jobs.filter((job) => job.state === state).length;
  }

  moreIsBetter(column) {
    return this.columns.get(column)?.better === "more is better";
  }

  /// The number of a job in the unit in which it is shown, or null.
  number(column, job) {
    const value = this.columns.get(column).numbers[job.index];
    return value === null ? null : value * unitOf(column).factor;
  }

  numbers(column, jobs) {
    return jobs.map((job) => this.number(column, job)).filter((value) => value !== null);
  }

  /// The value of a key as written.
  text(key, job) {
    return key.values[key.of_job[job.index]] || kNoValue;
  }

  /// "acquisition=weighted, taps=17": what a job's keys are, those without a value left out.
  words(job, keys = this.varying) {
    const said = keys.filter((key) => key.values[key.of_job[job.index]] !== "");
    return said.map((key) => `${key.name}=${this.text(key, job)}`).join(", ") || "the only setting";
  }

  /// Jobs with equal values of `keys`, in the order of the sweep: a list of {jobs, places}, the place of each value in
  /// the order of its key.
  groups(keys) {
    const found = new Map();
    for (const job of this.jobs) {
      const places = keys.map((key) => key.place[key.of_job[job.index]]);
      const name = places.join();
      if (!found.has(name)) found.set(name, { places, jobs: [] });
      found.get(name).jobs.push(job);
    }
    const sorted = [...found.values()];
    const compare = (a, b) => a.places.map((place, i) => place - b.places[i]).find((step) => step !== 0) ?? 0;
    return sorted.sort(compare);
  }

  /// Some jobs by what became of them: "19 of 20 done, 1 failed".
  ended(jobs) {
    const done = jobs.filter((job) => job.state === "done").length;
    const failed = jobs.filter((job) => job.state === "failed").length;
    const open = jobs.length - done - failed;
    return `${done} of ${jobs.length} done${failed ? `, ${failed} failed` : ""}${open ? `, ${open} not ended` : ""}`;
  }
}

/// The numbers of a key's values in the order in which they are shown: as numbers where they are, else as in the sweep;
/// what stands for no value comes first.
function orderOf(key) {
  const order = key.values.map((_, i) => i);
  const rank = (i) => (key.values[i] === "" ? -Infinity : key.numbers ? key.numbers[i] : i);
  return order.sort((a, b) => (rank(a) < rank(b) ? -1 : rank(a) > rank(b) ? 1 : a - b));
}

/// Mean, standard deviation (null of one value) and half the width of the mean's 95 % interval, as the program
/// computes them.
function estimate(values, factors) {
  const count = values.length;
  if (count === 0) return { count, mean: null, deviation: null, half: null };
  const least = values.reduce((a, b) => Math.min(a, b));
  const most = values.reduce((a, b) => Math.max(a, b));
  const mean = least === most ? least : values.reduce((sum, one) => sum + one / count, 0);
  if (count < 2) return { count, mean, deviation: null, half: null };
  const squares = values.reduce((sum, one) => sum + (one - mean) * (one - mean), 0);
  const factor = factors[Math.min(count - 2, factors.length - 1)];
  return { count, mean, deviation: Math.sqrt(squares / (count - 1)), half: factor * Math.sqrt(squares / (count - 1) / count) };
}

/// The settings, all keys but the seed, with their means of cost and error over the jobs that are done and have both:
/// {words, jobs, cost, error, complete, front}, in the order of cost. As `palpate pareto` has it, only settings all of
/// whose jobs have both are compared; `front` counts from 1.
function settingsOf(sweep, cost, error) {
  const factors = sweep.data.factors;
  // In SI units, so that rounding decides of twins as in the program.
  const raw = (column, job) => sweep.columns.get(column).numbers[job.index];
  const scaled = (column, of) => {
    const { factor } = unitOf(column);
    const times = (value) => (value === null ? null : value * factor);
    return { ...of, mean: times(of.mean), deviation: times(of.deviation), half: times(of.half) };
  };
  const sign = sweep.moreIsBetter(error) ? -1 : 1;
  const settings = sweep.groups(sweep.settings).map(({ jobs }) => {
    const valued = jobs.filter((job) => job.state === "done" && raw(cost, job) !== null && raw(error, job) !== null);
    const over = (column) => estimate(valued.map((job) => raw(column, job)), factors);
    const [paid, missed] = [over(cost), over(error)];
    return {
      words: sweep.words(jobs[0]),
      jobs,
      cost: scaled(cost, paid),
      error: scaled(error, missed),
      point: { cost: paid.mean, loss: missed.mean === null ? null : sign * missed.mean },
      complete: valued.length === jobs.length,
      front: 0,
    };
  });
  const valued = settings.filter((one) => one.cost.count > 0);
  valued.sort((a, b) => a.point.cost - b.point.cost || a.point.loss - b.point.loss);
  // One is beaten if one before it is at most as large in loss, but for its twins.
  let last = null;
  let number = 0;
  for (const one of valued.filter(({ complete }) => complete)) {
    const twin = last && one.point.cost === last.cost && one.point.loss === last.loss;
    if (last && !twin && !(one.point.loss < last.loss)) continue;
    one.front = ++number;
    last = one.point;
  }
  return valued;
}

/// Columns that are worth a first look, the best first, as far as they are there.
function mainColumns(sweep) {
  return sweep.data.first_looks.filter((name) => sweep.columns.has(name));
}

/// Whether done jobs differ in a column.
function differs(sweep, name) {
  const values = sweep.numbers(name, sweep.done);
  return values.some((value) => value !== values[0]);
}

/// The two keys whose cells are filled best, the first such pair; of one key, or none, what there is.
function bestPair(sweep) {
  const keys = sweep.varying;
  let best = [keys[0]?.name ?? sweep.keys[0]?.name ?? "", ""];
  let most = 0;
  keys.forEach((across, i) => {
    for (const up of keys.slice(i + 1)) {
      const filled = sweep.groups([across, up]).length / (across.order.length * up.order.length);
      if (filled > most) [most, best] = [filled, [across.name, up.name]];
    }
  });
  return best;
}

/// What the controls say at first.
function firstChoices(sweep) {
  const names = [...sweep.columns.keys()];
  const error = [sweep.data.first_looks[0], "on_surface_taps"].find((name) => sweep.columns.has(name)) ?? names[0];
  const [across, up] = bestPair(sweep);
  const fewest = sweep.varying.reduce((a, b) => (b.order.length < a.order.length ? b : a), sweep.varying[0]);
  const costs = ["robot_seconds", "compute_seconds", "taps"].filter((name) => sweep.columns.has(name));
  return {
    metric: error,
    across,
    up,
    group: sweep.varying.length > 1 && sweep.groups(sweep.settings).length <= 16 ? kEachSetting : fewest?.name ?? across,
    then: "",
    cost: costs.find((name) => differs(sweep, name)) ?? costs[0] ?? names[0],
    error,
  };
}

const kEachSetting = "each setting";
