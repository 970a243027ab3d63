// SPDX-License-Identifier: MIT
// What makes a page that `palpate watch` serves follow what goes on. A page that lies in a file has no data.live, and
// nothing here does anything.

/// Waits until `until` fires, or so many milliseconds.
const pause = (milliseconds, until = new AbortController().signal) =>
  new Promise((done) => {
    setTimeout(done, milliseconds);
    until.addEventListener("abort", done, { once: true });
  });

/// Says how the page stands to its server, where there is one.
function liveNote(data) {
  return data.live === undefined ? "" : element("span", { id: "live", class: "live" }, "live");
}

function sayLive(words) {
  const note = document.getElementById("live");
  if (note) note.textContent = words;
}

/// Asks the server for what this page lacks, again and again, and has `take` put it into the page, between drawings. A
/// page in the background asks once in a while, so that it holds no connection of the few that a browser has.
async function follow(data, take) {
  const kSleep = 20000;
  const kAfterTrouble = 2000;
  let at = data.live;
  while (at !== undefined) {
    const turn = new AbortController();
    const turned = () => turn.abort();
    document.addEventListener("visibilitychange", turned, { once: true });
    try {
      const answer = await fetch(`news?at=${at}${document.hidden ? "&now" : ""}`, { signal: turn.signal, cache: "no-store" });
      if (answer.status === 403 || answer.status === 404) return sayLive("no longer live");
      sayLive("live");
      if (answer.status === 200) {
        const news = await answer.json();
        if (news.anew) return location.reload();
        await inTurn(() => take(news));
        at = news.at;
      } else if (document.hidden) {
        await pause(kSleep, turn.signal);
      }
    } catch (trouble) {
      if (!turn.signal.aborted) {
        sayLive("not connected");
        await pause(kAfterTrouble, turn.signal);
      }
    }
    document.removeEventListener("visibilitychange", turned);
  }
}

/// A page of a run or a sweep of which there is nothing to be shown yet.
function drawWaiting(data) {
  const words = element("p", { id: "waiting" }, foreign(data.waiting));
  document.body.append(element("div", { class: "controls" }, liveNote(data)), words);
  follow(data, (news) => words.replaceChildren(foreign(news.trouble ?? data.waiting)));
  return () => tellDrawn("waiting");
}

/// What cannot be followed any further is said on a page that has something to show, until that changes.
function tellTrouble(trouble) {
  document.getElementById("standing").append(element("p", { class: "trouble" }, foreign(trouble)));
}

/// A page keeps at most so many numbers in its maps. With more it is loaded again, with the maps of fewer moments, which
/// are all that the server keeps of a long run.
const kMostNumbers = 12e6;

/// Puts further moments into the page of a run. Its slider goes along if it stood at the last tap.
async function growRun(slider, news) {
  if (news.trouble) return tellTrouble(news.trouble);
  const { data, input } = slider;
  const newest = Number(input.value) === data.moments.length - 1;
  data.moments.push(...news.moments);
  data.taps.push(...news.taps);
  for (const name of ["state", "stop_reason", "summary", "curves", "constants", "warnings"]) data[name] = news[name];
  data.true_contours = news.true_contours ?? data.true_contours;  // of what is pushed
  if (news.bytes) {
    const bytes = Uint8Array.from(atob(news.bytes), (c) => c.charCodeAt(0));
    const plain = new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate")));
    const further = unpackMoments(data, news, new Uint8Array(await plain.arrayBuffer()));
    data.shown.push(...news.shown);
    slider.grow(further);
    if (slider.numbers(news) > kMostNumbers) return location.reload();
  }
  input.max = data.moments.length - 1;
  if (newest) input.value = input.max;
  document.getElementById("standing").replaceChildren(...standing(data));
  slider.stale = true;
  slider.show();  // in its turn, which comes after this
}

/// Puts what its jobs have come to into the page of a sweep, whose reader keeps what was chosen. With other columns it is
/// laid out anew.
function growSweep(sweep, news) {
  const fresh = { ...news.sweep, live: news.at };
  if (fresh.trouble) return tellTrouble(fresh.trouble);
  const names = (data) => JSON.stringify([...data.columns.values()].map(({ name }) => name));
  if (names(fresh) !== names(sweep)) return location.reload();
  Object.assign(sweep, new SweepData(fresh));
  document.getElementById("standing").replaceChildren(...standingOfSweep(sweep));
  sweep.refresh();
}
