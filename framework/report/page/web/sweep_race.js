// SPDX-License-Identifier: MIT
// The panel of a race of `palpate tune`: each setting's mean over its seeds so far, and the mean against each key.

/// Returns the means of the first 1, 2, ... values.
function runningMeans(values) {
  let sum = 0;
  return values.map((value, i) => (sum += value) / (i + 1));
}

/// Returns the settings with their numbers in the unit of the page.
function racedSettings(sweep, { metric, settings }) {
  const place = new Map(sweep.jobs.map((job) => [job.index, job]));
  return settings.map((one) => {
    const values = one.jobs.map((index) => place.get(index)).filter(Boolean).map((job) => sweep.number(metric, job));
    const means = runningMeans(values.filter((value) => value !== null));
    return { ...one, means, mean: means[means.length - 1] ?? null };
  }).filter((one) => one.means.length > 0);
}

function drawRace(sweep) {
  const { metric, end } = sweep.race;
  const settings = racedSettings(sweep, sweep.race);
  const why = (one) => `${plain(brief(one.words, 120))}<br>${one.remark}`;
  const [least, most] = extent(settings.flatMap((one) => one.means));
  const type = least > 0 && most / least > 4 ? "log" : "linear";
  const colour = (one) => (one.best ? lineColour(1) : one.lost ? kGrey : lineColour(0));
  const lines = settings.map((one) => {
    const x = one.means.map((_, i) => i + 1);
    const size = one.means.map((_, i) => (i + 1 < x.length ? 0 : 8));
    const marker = { size, symbol: one.lost ? "x" : "circle", color: colour(one), opacity: 1 };
    return points("", x, one.means, x.map(() => why(one)), marker, {
      mode: "lines+markers",
      line: { color: colour(one), width: one.best ? 3 : 1 },
      opacity: one.lost ? 0.5 : 1,
      showlegend: false,
    });
  });
  const drawn = [plotOfHeight("race", 460, lines, {
    xaxis: roomyAxis("number of seeds", { type: "log" }),
    yaxis: roomyAxis(`mean of ${directedTitle(sweep, metric)}`, { type }),
    hovermode: "closest",
  })];
  setCaption("race", `One line per setting: its mean over the seeds so far. A cross marks where it lost; the thick line is the best one. ${end}`);
  sweep.race.keys.forEach((key, i) => {
    const shownOnes = settings.filter((one) => one.at[i] !== null);
    const marker = { size: shownOnes.map((one) => Math.min(18, 4 + 2 * Math.sqrt(one.means.length))), color: shownOnes.map(colour), opacity: 0.7 };
    drawn.push(plotOfHeight(`race_${i}`, 320, [points("", shownOnes.map((one) => one.at[i]), shownOnes.map((one) => one.mean), shownOnes.map(why), marker)], {
      xaxis: key.texts ? placesAxis(plain(brief(key.name)), key.texts) : roomyAxis(plain(brief(key.unit ? `${key.name} [${key.unit}]` : key.name)), { type: key.logarithmic ? "log" : "linear" }),
      yaxis: roomyAxis(titleOf(metric), { type }),
      hovermode: "closest",
    }));
  });
  return Promise.all(drawn);
}

function placeRace({ race }) {
  return section("Race", figure("race", ""), element("div", { class: "row wide" }, ...race.keys.map((key, i) => figure(`race_${i}`, foreign(`Mean against ${key.name}; larger points have more seeds.`)))));
}
