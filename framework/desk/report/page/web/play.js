// SPDX-License-Identifier: MIT
// Goes through the taps of a run by itself.

/// A button beside a slider: begins at the slider's tap, or, from the last one, with the first, and ends at the last one,
/// or when somebody moves the slider.
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
    const kLookAtEach = 400;  // milliseconds, beside what drawing takes
    const { input } = this.slider;
    const turn = {};  // of a later click there is another one
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
