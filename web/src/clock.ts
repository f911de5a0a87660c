/** The time shown: set by hand, or running. */

export class Clock {
  time = 0;
  duration = 0;
  speed = 1;
  repeat = false;
  private last: number | null = null;

  constructor(private readonly changed: () => void) {}

  get running(): boolean {
    return this.last !== null;
  }

  /** Begins anew with a motion of another duration. */
  reset(duration: number): void {
    this.duration = duration;
    this.time = 0;
    this.last = null;
    this.changed();
  }

  seek(time: number): void {
    this.time = Math.min(Math.max(time, 0), this.duration);
    this.changed();
  }

  toggle(): void {
    if (this.running || this.duration === 0) {
      this.last = null;
    } else {
      if (this.time >= this.duration) this.time = 0;
      this.last = performance.now();
      requestAnimationFrame(this.step);
    }
    this.changed();
  }

  private readonly step = (): void => {
    if (this.last === null) return;
    const now = performance.now();
    let time = this.time + ((now - this.last) / 1000) * this.speed;
    this.last = now;
    if (time >= this.duration) {
      if (this.repeat) time %= this.duration;
      else this.last = null;
    }
    this.seek(time);
    if (this.running) requestAnimationFrame(this.step);
  };
}
