// SPDX-License-Identifier: MIT
// Functions that all pages use. Texts of a config reach a page only as the text of an element, or in a plot through
// plain(), because plots interpret some markup.

/// Decompresses bytes in base64. Returns a Response, from which the caller reads the bytes.
function inflate(text, format) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream(format)));
}

/// Decompresses a packed element of this page. Returns a Response, from which the caller reads the bytes.
function unpack(id) {
  const { type, textContent } = document.getElementById(id);
  return inflate(textContent, type.replace("application/", ""));
}

/// Executes the script of plotly, which sets the global variable Plotly.
async function loadPlotly() {
  document.head.append(element("script", {}, await unpack("plotly").text()));
}

/// Returns whether this browser can draw in three dimensions.
function hasWebGL() {
  const canvas = document.createElement("canvas");
  return Boolean(canvas.getContext("webgl2") || canvas.getContext("webgl"));
}

/// Returns an element with attributes. Children that are not elements become text nodes.
function element(tag, attributes = {}, ...children) {
  const out = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) out.setAttribute(name, value);
  out.append(...children);
  return out;
}

/// Returns an element with text of a config. The element isolates the text, so that its control characters for the
/// direction of writing do not affect other text.
function foreign(text) {
  return element("bdi", { class: "foreign" }, String(text));
}

/// Returns text on one line, without control characters for the direction of writing.
function oneLine(text) {
  return String(text)
    .replace(/[\n\r\t]+/g, " ")
    .replace(/[\u200e\u200f\u202a-\u202e\u2066-\u2069]/g, "");
}

/// Returns a title, label or hover text for a plot, with the characters &, < and > escaped.
function plain(text) {
  return oneLine(text).replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");
}

/// Returns a row of a table. The first `left` cells are left-aligned, all others right-aligned.
function tableRow(tag, cells, left = cells.length) {
  return element("tr", {}, ...cells.map((cell, i) => element(tag, i < left ? {} : { class: "number" }, cell)));
}

/// Returns a table whose cells are texts or elements.
function table(header, rows, left) {
  const head = element("thead", {}, tableRow("th", header, left));
  const body = element("tbody", {}, ...rows.map((row) => tableRow("td", row, left)));
  return element("div", { class: "scroll" }, element("table", {}, head, body));
}

/// Returns a table from a part {titles, rows, left} of the page's data. The texts may come from a config.
function dataTable({ titles, rows, left }) {
  return table(titles, rows.map((row) => row.map((cell, i) => (i < left ? foreign(cell) : cell))), left);
}

/// Returns a list element of values with their names.
function factList(facts) {
  const items = facts.map(([value, name]) => element("li", {}, element("b", {}, String(value)), element("span", {}, name)));
  return element("ul", { class: "facts" }, ...items);
}

/// Returns an array with the list element of the warnings, or an empty array if there are none. Each warning is an
/// array of texts and elements.
function warningList(warnings) {
  const items = warnings.map((words) => element("li", {}, ...words));
  return items.length > 0 ? [element("ul", { class: "warnings", id: "warnings" }, ...items)] : [];
}

/// Returns a section with a heading.
function section(title, ...children) {
  return element("section", {}, element("h2", {}, title), ...children);
}

/// Returns an element for a plot, with a caption below it. The wheel scrolls the page, even over plots. A plot receives
/// wheel events only while Ctrl is pressed.
function figure(id, caption) {
  const place = element("div", { id, class: "plot" });
  const scrolls = (event) => !event.ctrlKey && !event.metaKey;
  place.addEventListener("wheel", (event) => scrolls(event) && event.stopPropagation(), { capture: true, passive: true });
  return element("figure", {}, element("figcaption", {}, caption), place);
}

/// Text for a missing value.
const kNothing = "–";

/// Returns a number with `digits` significant digits.
function shown(value, digits = 4) {
  if (value === null || value === undefined) return kNothing;
  if (typeof value !== "number") return String(value);
  if (value !== 0 && (Math.abs(value) < 1e-4 || Math.abs(value) >= 1e6)) return value.toExponential(digits - 1);
  return String(Number(value.toPrecision(digits)));
}

/// Returns "1 setting", "3 settings".
function counted(count, what) {
  return `${count} ${what}${count === 1 ? "" : "s"}`;
}

/// Returns the least and the greatest of the values.
const extent = (values) => [values.reduce((a, b) => Math.min(a, b), Infinity), values.reduce((a, b) => Math.max(a, b), -Infinity)];

// Pages show positions, heights and their standard deviations in centimetres (config/display_units.hpp).
const kCentimetres = 100;

// The colour scale of uncertainties, and the colour scale of values that show where to tap.
const kUnknown = kColours.cividis;
const kWhere = kColours.viridis;

/// The units of all columns, from data.units.
let units = {};

/// Returns the unit in which a column of a record is shown. A value in SI units times `factor` is the value in that
/// unit.
const unitOf = (name) => units[name] ?? { unit: "", factor: 1 };

/// Returns a value of a column with its unit: "2.61 mm".
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

/// Media query: whether the page is as narrow as on a phone. style.css has the same limit.
const kNarrow = matchMedia("(max-width: 640px)");
/// Media query: whether the pointer is a finger. Fingers scroll the page instead of selecting areas of plots.
const kFingers = matchMedia("(pointer: coarse)");

/// Returns the layout that all plots share, changed by `more`.
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

/// Returns an axis of a plot or of a scene.
function axis(title, more = {}) {
  const [lines, grid] = ["soft", "grid"].map(themed);
  return { title: { text: title }, zeroline: false, gridcolor: grid, linecolor: lines, tickcolor: lines, ...more };
}

/// Returns the layout of a plot that can be turned. The ranges of the axes determine the scale of the plot, because
/// plotly would otherwise enlarge a flat surface until it fills the plot.
function turntable(scene) {
  return {
    margin: { l: 0, r: 0, t: 0, b: kNarrow.matches ? 56 : 0 },
    showlegend: false,
    uirevision: "keep the view",
    scene: { dragmode: "turntable", aspectmode: "manual", ...scene },
  };
}

/// Returns the colour bar next to a plot.
const colourBar = (title, more = {}) => ({ title: { text: title, side: "right" }, thickness: 12, outlinecolor: themed("line"), ...more });

/// Returns a trace of points. `text` has the hover texts.
function points(name, x, y, text, marker, more = {}) {
  return { type: "scatter", mode: "markers", name, x, y, text, marker, hovertemplate: "%{text}<extra></extra>", ...more };
}

/// Draws a plot into the figure `id`. `more` changes the layout.
function plot(id, traces, more = {}) {
  return Plotly.react(id, traces, layout(more), { responsive: true, displaylogo: false, displayModeBar: false });
}

/// Shows an error on the page. Later drawings are still possible.
function showError(trouble) {
  document.body.prepend(element("p", { class: "trouble" }, `A part of this page could not be drawn: ${trouble}`));
  console.error(trouble);
}

/// Calls `draw` after the previous drawing has ended.
function inTurn(draw) {
  inTurn.last = (inTurn.last ?? Promise.resolve()).then(draw).catch(showError);
  return inTurn.last;
}

/// Calls `draw` for each change of an input. If the input changes several times during one drawing, only the last
/// change is drawn.
function drawLatest(input, draw) {
  const wanted = input.value;
  return inTurn(() => (wanted === input.value ? draw(Number(wanted)) : undefined));
}

/// Publishes a description of the current drawing. Tests wait for this description.
function publishDrawn(what) {
  document.body.dataset.drawn = String(what);
}

/// Unpacks the page's data and passes it to `draw`. `draw` fills the page and returns a function that redraws all plots
/// in the colours of the current theme. If `draw` fails, the page shows the error.
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
    showError(trouble);
  }
}

/// Returns the footer of a page.
function footer(data) {
  return element("footer", {}, `palpate ${data.version}; method: Sun and Min 2021, arXiv:2110.09593; drawn with plotly.js (MIT).`);
}
