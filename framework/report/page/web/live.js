// SPDX-License-Identifier: MIT
// Updates of the pages that `palpate watch` serves. On a page in a file, data.live is undefined, and these functions do
// nothing.

/// Returns a promise that is fulfilled after this many milliseconds, or when the signal `until` is aborted.
const pause = (milliseconds, until = new AbortController().signal) =>
  new Promise((done) => {
    setTimeout(done, milliseconds);
    until.addEventListener("abort", done, { once: true });
  });

/// Returns an element that shows the state of the connection; "" on a page in a file.
function liveNote(data) {
  return data.live === undefined ? "" : element("span", { id: "live", class: "live" }, "live");
}

function showConnection(words) {
  const note = document.getElementById("live");
  if (note) note.textContent = words;
}

/// Requests updates from the server in a loop, and calls `take` with each update. `take` never runs at the same time as
/// a drawing of the page (see inTurn()). A page in the background sends requests rarely and keeps no connection open,
/// because browsers allow few connections per server.
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
      if (answer.status === 403 || answer.status === 404) return showConnection("no longer live");
      showConnection("live");
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
        showConnection("not connected");
        await pause(kAfterTrouble, turn.signal);
      }
    }
    document.removeEventListener("visibilitychange", turned);
  }
}

/// Draws the page of a run or sweep that has nothing to show yet.
function drawWaiting(data) {
  const words = element("p", { id: "waiting" }, foreign(data.waiting));
  document.body.append(element("div", { class: "controls" }, liveNote(data)), words);
  follow(data, (news) => words.replaceChildren(foreign(news.trouble ?? data.waiting)));
  return () => publishDrawn("waiting");
}

/// Shows the reason why the page cannot be updated. The next successful update removes it.
function showTrouble(trouble) {
  document.getElementById("standing").append(element("p", { class: "trouble" }, foreign(trouble)));
}

/// Largest number of values in a page's maps. A page with more values is reloaded. The new page has maps of fewer
/// moments, because the server keeps the maps of only some moments of a long run.
const kMostNumbers = 12e6;

/// Adds moments to the page of a run. If the slider was at the last tap, it moves to the new last tap.
async function growRun(slider, news) {
  if (news.trouble) return showTrouble(news.trouble);
  const { data, input } = slider;
  const newest = Number(input.value) === data.moments.length - 1;
  data.moments.push(...news.moments);
  data.taps.push(...news.taps);
  for (const name of ["state", "stop_reason", "summary", "curves", "constants", "warnings"]) data[name] = news[name];
  data.true_contours = news.true_contours ?? data.true_contours;  // The contours change if taps push objects.
  if (news.bytes) {
    const bytes = await inflate(news.bytes, "deflate").arrayBuffer();
    const further = unpackMoments(data, news, new Uint8Array(bytes));
    data.shown.push(...news.shown);
    slider.grow(further);
    if (slider.numbers(news) > kMostNumbers) return location.reload();
  }
  input.max = data.moments.length - 1;
  if (newest) input.value = input.max;
  document.getElementById("standing").replaceChildren(...runState(data));
  slider.stale = true;
  slider.show();  // The slider draws when this update has been applied.
}

/// Applies new results to the page of a sweep. The choices of the reader are kept. If the columns have changed, the
/// page is reloaded.
function growSweep(sweep, news) {
  const fresh = { ...news.sweep, live: news.at };
  if (fresh.trouble) return showTrouble(fresh.trouble);
  const names = (data) => JSON.stringify([...data.columns.values()].map(({ name }) => name));
  if (names(fresh) !== names(sweep)) return location.reload();
  Object.assign(sweep, new SweepData(fresh));
  document.getElementById("standing").replaceChildren(...sweepState(sweep));
  sweep.refresh();
}
