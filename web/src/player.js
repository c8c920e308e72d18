// Which frame is shown, and its progress in time. No drawing, no elements.

const frames_per_second = 20;     // at speed 1
const seconds_per_swing = 2;

export class Player {
  /** `changed` is called with this player after each change. */
  constructor(changed) {
    this.changed = changed;
    this.frame = 0;
    this.count = 1;
    this.playing = false;
    this.swings = false;
    this.speed = 1;
  }

  open(sequence) {
    this.pause();
    this.count = sequence.frames.length;
    this.swings = !!sequence.json.loop;
    this.show(this.swings ? this.count / 4 : this.count - 1);   // a swing is highest after a quarter
  }

  show(frame) {
    this.frame = Math.max(0, Math.min(this.count - 1, Math.round(frame)));
    this.changed(this);
  }

  /** One frame on or back, by hand: stops playing. */
  move(frames) {
    this.pause();
    this.show(this.frame + frames);
  }

  set_speed(speed) {
    this.speed = speed;
    if (this.playing) this.start_clock();
  }

  toggle() { this.playing ? this.pause() : this.play(); }

  pause() {
    if (!this.playing) return;
    this.playing = false;
    this.ask();
    this.changed(this);
  }

  play() {
    if (this.playing || this.count < 2) return;
    this.playing = true;
    if (!this.swings && this.frame === this.count - 1) this.frame = 0;
    this.start_clock();
    this.changed(this);
    this.ask();
  }

  /** Asks for the next tick while playing; what was asked for before is called off, so that there is one loop at most. */
  ask() {
    cancelAnimationFrame(this.asked);
    this.asked = this.playing ? requestAnimationFrame((now) => this.tick(now)) : null;
  }

  start_clock() {
    this.start = { frame: this.frame, time: performance.now() };
  }

  /** The frame that is due; a slow machine leaves frames out instead of playing slowly. */
  tick(now) {
    const rate = this.speed * (this.swings ? this.count / seconds_per_swing : frames_per_second);
    const due = this.start.frame + Math.floor(Math.max(0, now - this.start.time) * 1e-3 * rate);
    if (!this.swings && due >= this.count - 1) this.playing = false;
    const frame = this.swings ? due % this.count : Math.min(due, this.count - 1);
    if (frame !== this.frame || !this.playing) this.show(frame);
    this.ask();
  }
}
