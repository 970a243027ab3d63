// SPDX-License-Identifier: MIT
// What all pages use. Text of a config reaches the page in two ways only: as text of an element, or through plain()
// into a plot, which would take some markup for its own.

/// Bytes of a packed element of this page, decompressed.
async function unpack(id) {
  const packed = atob(document.getElementById(id).textContent);
  const bytes = Uint8Array.from(packed, (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

async function unpackText(id) {
  return new TextDecoder().decode(await unpack(id));
}

/// Runs plotly, which then is the global Plotly.
async function loadPlotly() {
  const script = document.createElement("script");
  script.textContent = await unpackText("plotly");
  document.head.append(script);
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

/// Text for a title, a label or a hover of a plot, in which plotly would see tags and entities.
function plain(text) {
  const direction = /[\u200e\u200f\u202a-\u202e\u2066-\u2069]/g;
  return String(text)
    .replace(/&/g, "&amp;")
    .replace(/</g, "&lt;")
    .replace(/>/g, "&gt;")
    .replace(/[\n\r\t]+/g, " ")
    .replace(direction, "");
}

/// A table whose cells are texts or elements. The first `left` columns are set to the left.
function table(header, rows, left = header.length) {
  const line = (tag, cells) =>
    element("tr", {}, ...cells.map((cell, i) => element(tag, i < left ? {} : { class: "number" }, cell)));
  return element(
    "div",
    { class: "scroll" },
    element("table", {}, element("thead", {}, line("th", header)), element("tbody", {}, ...rows.map((row) => line("td", row)))),
  );
}

/// A heading and what belongs to it.
function section(title, ...children) {
  return element("section", {}, element("h2", {}, title), ...children);
}

/// A place for a plot, under its caption.
function figure(id, caption) {
  return element("figure", {}, element("figcaption", {}, caption), element("div", { id, class: "plot" }));
}

/// A number for people: `digits` significant ones, nothing for null.
function shown(value, digits = 4) {
  if (value === null || value === undefined) return "–";
  if (typeof value !== "number") return String(value);
  if (value !== 0 && (Math.abs(value) < 1e-3 || Math.abs(value) >= 1e6)) return value.toExponential(digits - 1);
  return String(Number(value.toPrecision(digits)));
}

/// "1 setting", "3 settings"
function many(count, what) {
  return `${count} ${what}${count === 1 ? "" : "s"}`;
}

/// In which unit a quantity is shown, and how many of it are one SI unit; told by the end of its name.
function unitOf(name) {
  if (name.endsWith("_m")) return { unit: "cm", factor: 100 };
  if (name.endsWith("_seconds") || name.startsWith("compute.")) return { unit: "s", factor: 1 };
  if (name.endsWith("_bytes")) return { unit: "MB", factor: 1e-6 };
  return { unit: "", factor: 1 };
}

function withUnit(name) {
  const { unit } = unitOf(name);
  return unit ? `${name} [${unit}]` : name;
}

/// Colours that people with any kind of colour vision tell apart (Okabe and Ito 2008).
const kColours = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"];
const kGrey = "#9a9a9a";

/// What all plots have in common.
function layout(more = {}) {
  return {
    margin: { l: 54, r: 12, t: 8, b: 42 },
    font: { family: "system-ui, sans-serif", size: 12 },
    paper_bgcolor: "rgba(0,0,0,0)",
    plot_bgcolor: "#ffffff",
    hoverlabel: { align: "left" },
    ...more,
  };
}

const kPlotConfig = { responsive: true, displaylogo: false, displayModeBar: false };

/// Says on the page what went wrong; what comes next may still be drawn.
function complain(trouble) {
  document.body.prepend(element("p", { class: "trouble" }, `Something could not be drawn: ${trouble}`));
  console.error(trouble);
}

/// Unpacks the page's data and lets `draw` fill it; what goes wrong is said on the page.
async function openPage(draw) {
  try {
    const [json, maps] = await Promise.all([unpackText("data"), unpack("maps"), loadPlotly()]);
    await draw(JSON.parse(json), maps);
  } catch (trouble) {
    complain(trouble);
  }
}
