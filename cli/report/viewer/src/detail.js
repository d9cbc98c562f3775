// SPDX-License-Identifier: GPL-3.0-or-later
// Fluent on any machine: while the view moves, only as much of scan and leaves is drawn, and with as few pixels, as one
// frame has time for; at rest all of it, again.
const FRAME_MS = 28;   // 30 frames a second, with something to spare
const REST_MS = 160;   // without a move after a frame: at rest; longer where all of it takes long
const LEAST = 0.02;    // of the whole

export class Detail {
  /// `parts`: objects with setDetail(share). `resolve(factor)` sets the share of the screen's pixels a side.
  constructor(renderer, parts, resolve, redraw) {
    Object.assign(this, { renderer, parts, resolve, redraw, share: 1, shown: 1, factor: 1, took: 0, whole: 0, drawn: 0, moving: false });
  }

  /// Called at every move, before the frame is drawn.
  moved() {
    clearTimeout(this.timer);
    if (this.moving) return;
    this.moving = true;
    this.apply(this.share);
  }

  rest() {
    this.moving = false;
    this.apply(1);
    this.redraw();
  }

  /// Draws a frame; while moving, waits for it and learns from the time it took. So does the second frame of all (the
  /// first compiles shaders): the first move is fluent, too.
  frame(draw) {
    ++this.drawn;
    if (!this.moving && this.drawn !== 2) {
      draw();
      return;
    }
    const began = performance.now();
    draw();
    const gl = this.renderer.getContext();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));  // returns when the frame is done
    this.took = performance.now() - began;
    const room = Math.min(1.5, Math.max(0.1, FRAME_MS / Math.max(this.took, 1)));
    if (room <= 0.9 || room >= 1.1) this.share = Math.min(1, Math.max(LEAST, this.share * room));
    if (this.drawn === 2) this.whole = this.took;
    if (!this.moving) return;
    this.apply(this.share);
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.rest(), REST_MS + Math.min(1000, 0.3 * this.whole));
  }

  apply(share) {
    this.shown = share;
    for (const part of this.parts) part.setDetail(share);
    // Fewer pixels only where the least is drawn already and still takes too long, in steps: each costs new buffers.
    const factor = !this.moving ? 1 : share <= LEAST ? 0.5 : share < 0.1 ? Math.min(this.factor, 0.7) : share > 0.5 ? 1 : this.factor;
    if (factor === this.factor) return;
    this.factor = factor;
    this.resolve(factor);
  }
}
