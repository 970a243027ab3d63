// SPDX-License-Identifier: MIT
// Light or dark theme. The page follows the system until the reader chooses a theme. style.css defines the named
// colours of both themes, which plots also use.

const kThemeKey = "palpate-theme";
const kSystemDark = matchMedia("(prefers-color-scheme: dark)");

/// Returns the theme that the reader chose on an earlier page, "light" or "dark". Returns null if no theme was chosen,
/// or if the browser stores nothing.
function rememberedTheme() {
  try {
    return localStorage.getItem(kThemeKey);
  } catch {
    return null;
  }
}

/// Stores the chosen theme for all pages; null removes it. If the browser stores nothing, the choice is valid while the
/// page is open.
function rememberTheme(theme) {
  try {
    if (theme) localStorage.setItem(kThemeKey, theme);
    else localStorage.removeItem(kThemeKey);
  } catch {
    // Without storage, the choice is valid for this page only.
  }
}

/// Returns the shown theme, "light" or "dark".
const theme = () => document.documentElement.dataset.theme ?? (kSystemDark.matches ? "dark" : "light");

/// Sets the theme. null means the theme of the system.
function setTheme(chosen) {
  if (chosen) document.documentElement.dataset.theme = chosen;
  else delete document.documentElement.dataset.theme;
}

/// Returns the colour `--name` of style.css in the current theme.
function themed(name) {
  themed.probe ??= document.documentElement.appendChild(Object.assign(document.createElement("span"), { hidden: true }));
  themed.probe.style.color = `var(--${name})`;
  return getComputedStyle(themed.probe).color;
}

const lineColour = (i) => kColours.lines[theme()][i % kColours.lines.light.length];

/// Returns the button that switches the theme. `redraw` is called after every change of colours, by the button or by
/// the system.
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
    // If the choice equals the theme of the system, nothing is stored, so that the page follows the system again.
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
