// SPDX-License-Identifier: MIT
// Light or dark: as the system has it, until whoever reads switches. Colours stand in style.css, each under a name, for
// both; the plots take theirs from there.

const kThemeKey = "palpate-theme";
const kSystemDark = matchMedia("(prefers-color-scheme: dark)");

/// What was chosen on a page before, "light" or "dark": null where nothing was, or the browser keeps nothing for pages.
function rememberedTheme() {
  try {
    return localStorage.getItem(kThemeKey);
  } catch {
    return null;
  }
}

/// Keeps the choice for all pages; null forgets it. Where nothing may be kept it holds as long as this page is open.
function rememberTheme(theme) {
  try {
    if (theme) localStorage.setItem(kThemeKey, theme);
    else localStorage.removeItem(kThemeKey);
  } catch {
    // Nothing is lost but the memory.
  }
}

/// The theme that is shown, "light" or "dark".
const theme = () => document.documentElement.dataset.theme ?? (kSystemDark.matches ? "dark" : "light");

/// null goes with the system again.
function setTheme(chosen) {
  if (chosen) document.documentElement.dataset.theme = chosen;
  else delete document.documentElement.dataset.theme;
}

/// The colour that style.css has under `--name`, as it is now.
function themed(name) {
  themed.probe ??= document.documentElement.appendChild(Object.assign(document.createElement("span"), { hidden: true }));
  themed.probe.style.color = `var(--${name})`;
  return getComputedStyle(themed.probe).color;
}

const lineColour = (i) => kColours.lines[theme()][i % kColours.lines.light.length];

/// The switch; `redraw` is called whenever the colours have changed, by it or by the system.
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
    // What the system has anyway need not be remembered: then the page goes on following it.
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
