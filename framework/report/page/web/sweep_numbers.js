// SPDX-License-Identifier: MIT
// Data for the panels on the page of a sweep: columns, groups, means, and the front.

/// Returns text on one line, with rounded numbers and at most `most` letters.
function brief(text, most = 36) {
  const letters = Array.from(oneLine(text).replace(/\d*\.\d{5,}/g, (digits) => shown(Number(digits))));
  return letters.length > most ? `${letters.slice(0, most - 1).join("")}…` : letters.join("");
}

/// Returns short names that differ from each other. Long names are cut at the end. If some names are then equal, long
/// names are cut in the middle instead, and if necessary all names get a number in front.
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

/// The data of a sweep in the form that the panels use.
class SweepData {
  constructor(data) {
    Object.assign(this, data);  // This adds the fields of sweep_data(), such as jobs, keys, first_looks and tally.
    this.sampled = this.tally.step > 1 ? this.tally : null;
    this.jobs.forEach((job, place) => Object.assign(job, { place }));
    [this.done, this.failed] = ["done", "failed"].map((state) => this.jobs.filter((job) => job.state === state));
    this.columns = new Map(data.columns.map((column) => [column.name, column]));
    this.all = this.keys.filter((key) => key.values.length > 1);  // keys that distinguish jobs
    this.seeds = this.all.find((key) => key.name === "seed");
    [this.settings, this.varying] = [this.keys, this.all].map((keys) => keys.filter((key) => key.name !== "seed"));
  }

  key(name) {
    return this.keys.find((key) => key.name === name);
  }

  /// Returns the numbers of jobs by state: [[19, "done"], [1, "failed"]].
  counts() {
    return kStates.map((state) => [this.tally.counts[state] ?? 0, state]).filter(([count]) => count > 0);
  }

  moreIsBetter(column) {
    return this.columns.get(column)?.better === "more is better";
  }

  /// Returns the value of a column for a job in SI units, or null.
  raw(column, job) {
    return this.columns.get(column).numbers[job.place];
  }

  /// Returns the value of a column for a job in the unit that the page shows, or null.
  number(column, job) {
    const value = this.raw(column, job);
    return value === null ? null : value * unitOf(column).factor;
  }

  numbers(column, jobs) {
    return jobs.map((job) => this.number(column, job)).filter((value) => value !== null);
  }

  /// Returns the number of a job's unit of statistics (StatisticalUnits in analysis/groups.hpp).
  unit(job) {
    return this.units_of_jobs[job.place];
  }

  /// Returns "20 seeds". If the seed is not swept, returns "12 units, copies count once" if there are copies of runs,
  /// else "".
  unitWords(clusters, jobs) {
    if (this.seeds) return counted(clusters, "seed");
    return clusters < jobs ? `${counted(clusters, "unit")}, copies count once` : "";
  }

  /// Returns a job's value of a key, as written in the config; a dash if the job's plugins do not have the option.
  text(key, job) {
    return key.values[key.of_job[job.place]] || kNothing;
  }

  /// Returns the values of a job's keys: "acquisition=weighted, taps=17".
  words(job, keys = this.varying) {
    const said = keys.filter((key) => key.values[key.of_job[job.place]] !== "");
    return said.map((key) => `${key.name}=${this.text(key, job)}`).join(", ") || "the only setting";
  }

  /// Returns a text with the job's values of the scene keys; "" if the sweep has one scene.
  sceneOf(job) {
    return this.scene_keys.map((name) => this.text(this.key(name), job)).join(", ");
  }

  /// Returns the scenes in the order of the sweep.
  scenes() {
    return [...new Set(this.jobs.map((job) => this.sceneOf(job)))];
  }

  /// Returns the groups of jobs with equal values of `keys`, sorted by these values, as a list of {jobs, places}.
  /// `places` has the index of the group's value for each key.
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

  /// Returns the numbers of some jobs by state: "19 of 20 done, 1 failed".
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

/// Returns mean, standard deviation, number of values, and number of different units of statistics. The standard
/// deviation is null for fewer than two values.
function spread(values, units) {
  const count = values.length;
  const mean = count > 0 ? meanOf(values) : null;
  const squares = values.reduce((sum, one) => sum + (one - mean) ** 2, 0);
  return { count, clusters: new Set(units).size, mean, deviation: count > 1 ? Math.sqrt(squares / (count - 1)) : null };
}

/// Returns the mean of a column over the jobs of a setting, and half the width of its 95 % interval (null for none).
/// The program has computed both. If every setting has one job, the mean is the value of the job.
function estimate(sweep, name, setting) {
  const { numbers, estimates } = sweep.columns.get(name);
  const { factor } = unitOf(name);
  const inUnit = (value) => (value === null ? null : value * factor);
  if (estimates) {
    const [mean, half, count, clusters] = estimates[setting];
    return { count, clusters, mean: inUnit(mean), half: inUnit(half) };
  }
  const job = sweep.jobs[sweep.setting_jobs[setting][0]];
  const mean = job.state === "done" ? numbers[job.place] : null;
  const count = mean === null ? 0 : 1;
  return { count, clusters: count, mean: inUnit(mean), half: null };
}

/// Returns the settings of a scene (a name from sweep.scenes()) that have both cost and error: {words, jobs, cost,
/// error, complete, front}. The settings on the front come first. `front` numbers these settings from 1, and is 0 for
/// all others.
function settingsOf(sweep, { cost, error, scene }) {
  const keys = sweep.varying.filter((key) => !sweep.scene_keys.includes(key.name));
  const all = sweep.setting_jobs.map((places, i) => {
    const jobs = places.map((place) => sweep.jobs[place]);
    const [paid, lost] = [cost, error].map((name) => estimate(sweep, name, i));
    const complete = Math.min(paid.count, lost.count) === jobs.length;
    return { words: sweep.words(jobs[0], keys), jobs, cost: paid, error: lost, complete, front: 0 };
  });
  const ofScene = ({ jobs }) => sweep.sceneOf(jobs[0]) === scene;
  const front = sweep.fronts[cost][error].map((i) => all[i]).filter(ofScene);
  front.forEach((one, i) => Object.assign(one, { front: i + 1 }));
  return [...front, ...all.filter((one) => ofScene(one) && one.front === 0 && one.cost.count > 0 && one.error.count > 0)];
}

/// Returns the main columns of results that the page has, the most important column first.
function mainColumns(sweep) {
  return sweep.first_looks.filter((name) => sweep.columns.has(name));
}

/// Returns whether done jobs differ in a column.
function differs(sweep, name) {
  const values = sweep.numbers(name, sweep.done);
  return values.some((value) => value !== values[0]);
}

/// Returns the pair of keys for which the largest share of the combinations of values has jobs. In case of a tie,
/// returns the first such pair. If there are fewer than two keys, "" replaces missing keys.
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

/// Returns the initial choices of the controls.
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
