// SPDX-License-Identifier: MIT
// A player that shows a run tap by tap.

/// A button that moves a slider through the taps. The player starts at the current tap of the slider, or before the
/// first tap if the slider is at its end. The player stops at the last tap, or when the reader moves the slider.
class Player {
  constructor(slider) {
    this.slider = slider;
    this.playing = false;
    this.button = element("button", { type: "button", id: "play" });
    this.button.addEventListener("click", () => (this.playing ? this.stop() : this.play()));
    slider.input.addEventListener("input", () => this.stop());
    this.stop();
  }

  stop() {
    this.playing = false;
    this.label("▶", "play");
  }

  label(sign, word) {
    this.button.textContent = sign;
    this.button.title = word;
    this.button.setAttribute("aria-label", word);
  }

  async play() {
    const kLookAtEach = 400;  // milliseconds between taps; the time of drawing is added
    const { input } = this.slider;
    const turn = {};  // A later click replaces this object in this.playing, and this loop then ends.
    this.playing = turn;
    this.label("⏸", "pause");
    if (input.value === input.max) {
      input.value = 0;
      await this.slider.show();
    }
    while (this.playing === turn && Number(input.value) < Number(input.max)) {
      await pause(kLookAtEach);
      if (this.playing !== turn) return;
      input.value = Number(input.value) + 1;
      await this.slider.show();
    }
    if (this.playing === turn) this.stop();
  }
}
