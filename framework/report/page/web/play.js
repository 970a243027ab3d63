// SPDX-License-Identifier: MIT
// Playback of a run's taps.

/// A button that moves a slider through the taps. It starts at the slider's tap, or after the last tap at the first,
/// and stops at the last tap or when the reader moves the slider.
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
    const kLookAtEach = 400;  // milliseconds between taps, without the time of drawing
    const { input } = this.slider;
    const turn = {};  // a later click has another object
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
