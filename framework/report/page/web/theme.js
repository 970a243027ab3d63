// SPDX-License-Identifier: MIT
// Light or dark theme: the system's, until the reader switches. style.css defines the colours of both by name; plots
// use them, too.

const kThemeKey = "palpate-theme";
const kSystemDark = matchMedia("(prefers-color-scheme: dark)");

/// Returns the theme that the reader chose on an earlier page, "light" or "dark"; null if there is none, or if the
/// browser stores nothing.
function rememberedTheme() {
  try {
    return localStorage.getItem(kThemeKey);
  } catch {
    return null;
  }
}

/// Stores the choice for all pages; null removes it. Without storage the choice holds while the page is open.
function rememberTheme(theme) {
  try {
    if (theme) localStorage.setItem(kThemeKey, theme);
    else localStorage.removeItem(kThemeKey);
  } catch {
    // Only the memory of the choice is lost.
  }
}

/// Returns the shown theme, "light" or "dark".
const theme = () => document.documentElement.dataset.theme ?? (kSystemDark.matches ? "dark" : "light");

/// Sets the theme; null follows the system.
function setTheme(chosen) {
  if (chosen) document.documentElement.dataset.theme = chosen;
  else delete document.documentElement.dataset.theme;
}

/// Returns the present colour `--name` of style.css.
function themed(name) {
  themed.probe ??= document.documentElement.appendChild(Object.assign(document.createElement("span"), { hidden: true }));
  themed.probe.style.color = `var(--${name})`;
  return getComputedStyle(themed.probe).color;
}

const lineColour = (i) => kColours.lines[theme()][i % kColours.lines.light.length];

/// Returns the switch. `redraw` is called after every change of colours, by the switch or by the system.
function themeSwitch(redraw) {
  const other = () => (theme() === "dark" ? "light" : "dark");
  const button = document.createElement("button");
  Object.assign(button, { type: "button", id: "theme" });
  const name = () => (button.textContent = `${other()} colours`);
  const follow = () => {
    name();
    redraw();
  };
  button.addEventListener("click", () => {
    // A choice equal to the system's theme is not stored, so the page follows the system again.
    const chosen = (other() === "dark") === kSystemDark.matches ? null : other();
    rememberTheme(chosen);
    setTheme(chosen);
    follow();
  });
  kSystemDark.addEventListener("change", follow);
  name();
  return button;
}

setTheme(rememberedTheme());
