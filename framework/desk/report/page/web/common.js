// SPDX-License-Identifier: MIT
// What all pages use. Text of a config reaches the page in two ways only: as text of an element, or through plain()
// into a plot, which would take some markup for its own.

/// Bytes of a packed element of this page, decompressed, as a response to read.
function unpack(id) {
  const { type, textContent } = document.getElementById(id);
  const bytes = Uint8Array.from(atob(textContent), (c) => c.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream(type.replace("application/", ""))));
}

/// Runs plotly, which then is the global Plotly.
async function loadPlotly() {
  document.head.append(element("script", {}, await unpack("plotly").text()));
}

/// Whether this browser can draw in three dimensions.
function hasWebGL() {
  const canvas = document.createElement("canvas");
  return Boolean(canvas.getContext("webgl2") || canvas.getContext("webgl"));
}

/// An element with attributes; children that are no elements become text.
function element(tag, attributes = {}, ...children) {
  const out = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) out.setAttribute(name, value);
  out.append(...children);
  return out;
}

/// Text that comes from a config, set apart, so that marks of direction in it turn nothing around it.
function foreign(text) {
  return element("bdi", { class: "foreign" }, String(text));
}

/// Text on one line and without marks of direction.
function oneLine(text) {
  return String(text)
    .replace(/[\n\r\t]+/g, " ")
    .replace(/[\u200e\u200f\u202a-\u202e\u2066-\u2069]/g, "");
}

/// Text for a title, a label or a hover of a plot, in which plotly would see tags and entities.
function plain(text) {
  return oneLine(text).replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");
}

/// A row of a table; the cells from the one behind the first `left` on are set to the right.
function tableRow(tag, cells, left = cells.length) {
  return element("tr", {}, ...cells.map((cell, i) => element(tag, i < left ? {} : { class: "number" }, cell)));
}

/// A table whose cells are texts or elements.
function table(header, rows, left) {
  const head = element("thead", {}, tableRow("th", header, left));
  const body = element("tbody", {}, ...rows.map((row) => tableRow("td", row, left)));
  return element("div", { class: "scroll" }, element("table", {}, head, body));
}

/// Numbers under their names, those first that are worth the first look.
function factList(facts) {
  const items = facts.map(([value, name]) => element("li", {}, element("b", {}, String(value)), element("span", {}, name)));
  return element("ul", { class: "facts" }, ...items);
}

/// What is to be known before the rest, if there is anything; each a list of texts and elements.
function warningList(warnings) {
  const items = warnings.map((words) => element("li", {}, ...words));
  return items.length > 0 ? [element("ul", { class: "warnings", id: "warnings" }, ...items)] : [];
}

/// A heading and what belongs to it.
function section(title, ...children) {
  return element("section", {}, element("h2", {}, title), ...children);
}

/// A place for a plot, under its caption. The wheel scrolls the page, over plots as elsewhere: a plot, which may zoom by
/// it, hears of it only while Ctrl is pressed.
function figure(id, caption) {
  const place = element("div", { id, class: "plot" });
  const scrolls = (event) => !event.ctrlKey && !event.metaKey;
  place.addEventListener("wheel", (event) => scrolls(event) && event.stopPropagation(), { capture: true, passive: true });
  return element("figure", {}, element("figcaption", {}, caption), place);
}

/// What stands where there is no value.
const kNothing = "–";

/// A number for people: `digits` significant ones.
function shown(value, digits = 4) {
  if (value === null || value === undefined) return kNothing;
  if (typeof value !== "number") return String(value);
  if (value !== 0 && (Math.abs(value) < 1e-4 || Math.abs(value) >= 1e6)) return value.toExponential(digits - 1);
  return String(Number(value.toPrecision(digits)));
}

/// "1 setting", "3 settings"
function many(count, what) {
  return `${count} ${what}${count === 1 ? "" : "s"}`;
}

/// The least and the most of very many numbers.
const extent = (values) => [values.reduce((a, b) => Math.min(a, b), Infinity), values.reduce((a, b) => Math.max(a, b), -Infinity)];

// Pages show positions, heights and their standard deviations in centimetres (config/scale.hpp).
const kCentimetres = 100;

// The colour scales of uncertainties, and of values that say where to tap.
const kUnknown = kColours.cividis;
const kWhere = kColours.viridis;

/// The units of data.units, by column.
let units = {};

/// The unit in which a column of a record is shown; a value in SI times `factor` is in that unit.
const unitOf = (name) => units[name] ?? { unit: "", factor: 1 };

/// A value of such a column with its unit: "2.61 mm".
function quantity(name, value, digits = 3) {
  const { unit, factor } = unitOf(name);
  const text = shown(typeof value === "number" ? value * factor : value, digits);
  return text === kNothing || unit === "" ? text : `${text} ${unit}`;
}

function withUnit(name) {
  const { unit } = unitOf(name);
  return unit ? `${name} [${unit}]` : name;
}

const kGrey = "#9a9a9a";

/// Whether the page is as narrow as on a phone: so it is in style.css.
const kNarrow = matchMedia("(max-width: 640px)");
/// Whether it is moved by fingers, which then do not draw frames on plots.
const kFingers = matchMedia("(pointer: coarse)");

/// What all plots have in common.
function layout(more = {}) {
  return {
    margin: { l: 54, r: 12, t: 8, b: 42 },
    font: { family: "system-ui, sans-serif", size: 12, color: themed("ink") },
    paper_bgcolor: "rgba(0,0,0,0)",
    plot_bgcolor: themed("card"),
    hoverlabel: { align: "left", bgcolor: themed("card"), bordercolor: themed("line"), font: { color: themed("ink") } },
    dragmode: kFingers.matches ? false : "zoom",
    ...more,
  };
}

/// An axis of a plot, or of its scene.
function axis(title, more = {}) {
  const [lines, grid] = ["soft", "grid"].map(themed);
  return { title: { text: title }, zeroline: false, gridcolor: grid, linecolor: lines, tickcolor: lines, ...more };
}

/// The layout of a plot that is turned. Its room is filled by the axes, not by what is drawn on them: else a flat surface
/// would fill it.
function turntable(scene) {
  return {
    margin: { l: 0, r: 0, t: 0, b: kNarrow.matches ? 56 : 0 },
    showlegend: false,
    uirevision: "keep the view",
    scene: { dragmode: "turntable", aspectmode: "manual", ...scene },
  };
}

/// The scale beside a plot whose colours are values.
const colourBar = (title, more = {}) => ({ title: { text: title, side: "right" }, thickness: 12, outlinecolor: themed("line"), ...more });

/// Points that say `text` to the pointer.
function points(name, x, y, text, marker, more = {}) {
  return { type: "scatter", mode: "markers", name, x, y, text, marker, hovertemplate: "%{text}<extra></extra>", ...more };
}

/// Draws into the figure `id`, where `more` is what its layout has beside what all have.
function plot(id, traces, more = {}) {
  return Plotly.react(id, traces, layout(more), { responsive: true, displaylogo: false, displayModeBar: false });
}

/// Says on the page what went wrong; what comes next may still be drawn.
function complain(trouble) {
  document.body.prepend(element("p", { class: "trouble" }, `A part of this page could not be drawn: ${trouble}`));
  console.error(trouble);
}

/// Begins a drawing when the one before it has ended.
function inTurn(draw) {
  inTurn.last = (inTurn.last ?? Promise.resolve()).then(draw).catch(complain);
  return inTurn.last;
}

/// Tells whoever waits for the picture what is drawn.
function tellDrawn(what) {
  document.body.dataset.drawn = String(what);
}

/// Unpacks the page's data and lets `draw` fill it, which returns what draws all plots again, in other colours; what goes
/// wrong is said on the page.
async function openPage(draw) {
  try {
    const [data, maps] = await Promise.all([unpack("data").json(), unpack("maps").arrayBuffer(), loadPlotly()]);
    units = data.units ?? {};
    document.title = `${data.name} ${data.id} – palpate`;
    const head = element("div", { class: "head" }, element("h1", {}, foreign(data.name)));
    document.body.append(head);
    const redraw = draw(data, new Uint8Array(maps));
    head.append(themeSwitch(redraw));
    kNarrow.addEventListener("change", redraw);
    await redraw();
  } catch (trouble) {
    complain(trouble);
  }
}

/// The end of a page.
function footer(data) {
  return element("footer", {}, `palpate ${data.version}; method: Sun and Min 2021, arXiv:2110.09593; drawn with plotly.js (MIT).`);
}
