// SPDX-License-Identifier: MIT
// What the panels of a sweep's page are made of: columns, groups, means, the front. Nothing here draws.

/// Text on one line, cut where it is long.
function brief(text, most = 36) {
  const letters = Array.from(oneLine(text).replace(/\d*\.\d{5,}/g, (digits) => shown(Number(digits))));
  return letters.length > most ? `${letters.slice(0, most - 1).join("")}…` : letters.join("");
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

const kStates = ["done", "failed", "running", "unfinished", "missing"];

/// The sweep as the panels ask for it.
class SweepData {
  constructor(data) {
    Object.assign(this, data);  // jobs, keys, first_looks, factors; of very many jobs `sampled`, what became of all
    this.jobs.forEach((job, place) => Object.assign(job, { place }));
    [this.done, this.failed] = ["done", "failed"].map((state) => this.jobs.filter((job) => job.state === state));
    this.columns = new Map(data.columns.map((column) => [column.name, column]));
    this.all = this.keys.filter((key) => key.values.length > 1);  // what tells jobs apart
    this.seeds = this.all.find((key) => key.name === "seed");
    [this.settings, this.varying] = [this.keys, this.all].map((keys) => keys.filter((key) => key.name !== "seed"));
  }

  key(name) {
    return this.keys.find((key) => key.name === name);
  }

  /// The states that jobs are in and their number, [[19, "done"], [1, "failed"]].
  counts() {
    const count = (state) => (this.sampled ? this.sampled.counts[state] ?? 0 : this.jobs.filter((job) => job.state === state).length);
    const counts = kStates.map((state) => [count(state), state]);
    return counts.filter(([count]) => count > 0);
  }

  moreIsBetter(column) {
    return this.columns.get(column)?.better === "more is better";
  }

  /// The number of a job in SI units, or null.
  raw(column, job) {
    return this.columns.get(column).numbers[job.place];
  }

  /// That in the unit in which it is shown.
  number(column, job) {
    const value = this.raw(column, job);
    return value === null ? null : value * unitOf(column).factor;
  }

  numbers(column, jobs) {
    return jobs.map((job) => this.number(column, job)).filter((value) => value !== null);
  }

  /// The number of the unit that a job is, or belongs to, in statistics (JobUnits in analysis/groups.hpp).
  unit(job) {
    return this.units[job.place];
  }

  /// "20 seeds"; where the seed is not swept "12 units, copies count once" of 24 jobs with copies, "" without any.
  unitWords(clusters, jobs) {
    if (this.seeds) return many(clusters, "seed");
    return clusters < jobs ? `${many(clusters, "unit")}, copies count once` : "";
  }

  /// The value of a key as written; plugins without such an option have none.
  text(key, job) {
    return key.values[key.of_job[job.place]] || kNothing;
  }

  /// "acquisition=weighted, taps=17": what a job's keys are, those without a value left out.
  words(job, keys = this.varying) {
    const said = keys.filter((key) => key.values[key.of_job[job.place]] !== "");
    return said.map((key) => `${key.name}=${this.text(key, job)}`).join(", ") || "the only setting";
  }

  /// What a job taps: the values of the keys that say it, "" where the sweep has one scene.
  sceneOf(job) {
    return this.scene_keys.map((name) => this.text(this.key(name), job)).join(", ");
  }

  /// The scenes in the order of the sweep.
  scenes() {
    return [...new Set(this.jobs.map((job) => this.sceneOf(job)))];
  }

  /// Jobs with equal values of `keys`, in the order of these: a list of {jobs, places}, the place of each value among
  /// those of its key.
  groups(keys) {
    const found = new Map();
    for (const job of this.jobs) {
      const places = keys.map((key) => key.of_job[job.place]);
      const name = places.join();
      if (!found.has(name)) found.set(name, { places, jobs: [] });
      found.get(name).jobs.push(job);
    }
    const compare = (a, b) => a.places.map((place, i) => place - b.places[i]).find((step) => step !== 0) ?? 0;
    return [...found.values()].sort(compare);
  }

  /// Some jobs by what became of them: "19 of 20 done, 1 failed".
  ended(jobs) {
    const [done, failed] = ["done", "failed"].map((state) => jobs.filter((job) => job.state === state).length);
    const open = jobs.length - done - failed;
    return `${done} of ${jobs.length} done${failed ? `, ${failed} failed` : ""}${open ? `, ${open} not ended` : ""}`;
  }
}

const meanOf = (values) => {
  const [least, most] = extent(values);
  return least === most ? least : values.reduce((sum, one) => sum + one / values.length, 0);
};

/// As in analysis/statistics.hpp.
const kRounding = 1e-12;

/// Mean, standard deviation (null of one value) and half the width of the mean's 95 % interval, as the program
/// computes them, times `unit`. `units` has the unit of each value (SweepData.unit): those of one unit are one cluster, and
/// `clusters` counts them. `half` is null of one cluster and of clusters with equal means, as in estimate_mean().
function estimate(values, units, factors, unit = 1) {
  const count = values.length;
  if (count === 0) return { count, clusters: 0, mean: null, deviation: null, half: null };
  const found = new Map();
  values.forEach((value, i) => (found.has(units[i]) ? found.get(units[i]).push(value) : found.set(units[i], [value])));
  const lists = [...found.values()];
  const clusters = lists.length;
  const even = lists.every((one) => one.length === lists[0].length);
  const mean = even ? meanOf(lists.map(meanOf)) : meanOf(values);
  if (count < 2) return { count, clusters, mean: mean * unit, deviation: null, half: null };
  const square = (value) => value * value;
  const deviation = Math.sqrt(values.reduce((sum, one) => sum + square(one - mean), 0) / (count - 1)) * unit;
  const [least, most] = extent(lists.map(meanOf));
  const largest = Math.max(...extent(values).map(Math.abs));
  if (clusters < 2 || most - least <= kRounding * largest) return { count, clusters, mean: mean * unit, deviation, half: null };
  const pulls = lists.map((one) => (meanOf(one) - mean) * (one.length / (count / clusters)));
  const variance = pulls.reduce((sum, one) => sum + square(one), 0) / (clusters - 1);
  const factor = factors[Math.min(clusters - 2, factors.length - 1)];
  return { count, clusters, mean: mean * unit, deviation, half: factor * Math.sqrt(variance / clusters) * unit };
}

/// The settings, all keys but the seed, with their means of cost and error over the jobs that are done and have both:
/// {words, jobs, cost, error, complete, front}, in the order of cost. As `palpate pareto` has it, only settings all of
/// whose jobs have both are compared; `front` counts from 1. They are those of one scene, by its name in sweep.scenes().
function settingsOf(sweep, { cost, error, scene }) {
  const sign = sweep.moreIsBetter(error) ? -1 : 1;
  const ofScene = sweep.groups(sweep.settings).filter(({ jobs }) => sweep.sceneOf(jobs[0]) === scene);
  const settings = ofScene.map(({ jobs }) => {
    const valued = jobs.filter((job) => job.state === "done" && sweep.raw(cost, job) !== null && sweep.raw(error, job) !== null);
    const units = valued.map((job) => sweep.unit(job));
    const over = (column) => [valued.map((job) => sweep.raw(column, job)), units, sweep.factors];
    return {
      words: sweep.words(jobs[0], sweep.varying.filter((key) => !sweep.scene_keys.includes(key.name))),
      jobs,
      cost: estimate(...over(cost), unitOf(cost).factor),
      error: estimate(...over(error), unitOf(error).factor),
      // In SI units, so that rounding decides of twins as in the program.
      paid: estimate(...over(cost)).mean,
      lost: sign * estimate(...over(error)).mean,
      complete: valued.length === jobs.length,
      front: 0,
    };
  });
  const valued = settings.filter((one) => one.cost.count > 0);
  valued.sort((a, b) => a.paid - b.paid || a.lost - b.lost);
  // One is beaten if one before it is at most as large in loss, but for its twins.
  let last = { lost: Infinity };
  let number = 0;
  for (const one of valued.filter(({ complete }) => complete)) {
    const twin = one.paid === last.paid && one.lost === last.lost;
    if (!twin && one.lost >= last.lost) continue;
    one.front = ++number;
    last = one;
  }
  return valued;
}

/// Columns that are worth a first look, the best first, as far as they are there.
function mainColumns(sweep) {
  return sweep.first_looks.filter((name) => sweep.columns.has(name));
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
      const filled = sweep.groups([across, up]).length / (across.values.length * up.values.length);
      if (filled > most) [most, best] = [filled, [across.name, up.name]];
    }
  });
  return best;
}

/// What the controls say at first.
function firstChoices(sweep) {
  const names = [...sweep.columns.keys()];
  const error = [sweep.first_looks[0], "object_taps"].find((name) => sweep.columns.has(name)) ?? names[0];
  const [across, up] = bestPair(sweep);
  const fewest = sweep.varying.reduce((a, b) => (b.values.length < a.values.length ? b : a), sweep.varying[0]);
  const costs = ["robot_seconds", "compute_seconds", "taps"].filter((name) => sweep.columns.has(name));
  return {
    metric: error,
    across,
    up,
    group: sweep.varying.length > 1 && sweep.groups(sweep.settings).length <= 16 ? kEachSetting : fewest?.name ?? across,
    then: "",
    scene: sweep.scenes()[0],
    curve_of: sweep.curves?.metrics[0],
    against: "taps",
    curves_by: sweep.curves?.by[0],
    cost: costs.find((name) => differs(sweep, name)) ?? costs[0] ?? names[0],
    error,
  };
}

const kEachSetting = "each setting";
