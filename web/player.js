// Time: one instant for the drawing, the curves and the tables.
"use strict";

erard.speeds = [1, 1 / 2, 1 / 5, 1 / 10, 1 / 20, 1 / 50, 1 / 100, 1 / 200, 1 / 500, 1 / 1000];

erard.Player = class {
  constructor(run) {
    this.run = run;
    this.time = run.start;
    this.speed = 1 / 20;
    this.is_playing = false;
    this.listeners = [];
    this.frame_times = [];  // of the last frames while playing [ms], for the tests
    this.events = [...run.events].sort((a, b) => a.time_s - b.time_s);
  }

  get row() { return this.run.row(this.time); }
  listen(listener) { this.listeners.push(listener); }
  tell() { for (const listener of this.listeners) listener(this); }

  go(time) {
    this.time = Math.max(this.run.start, Math.min(this.run.end, time));
    this.tell();
  }
  go_to_row(row) {
    this.pause();
    this.go(this.run.time(Math.max(0, Math.min(this.run.count - 1, row))));
  }
  step(rows) { this.go_to_row(this.row + rows); }
  go_to_event(event) { this.go_to_row(this.run.row(event.time_s)); }

  /// The next event after the row at hand, or the one before.
  jump(direction) {
    const rows = this.events.map(e => this.run.row(e.time_s));
    const row = direction > 0 ? rows.find(r => r > this.row) : rows.filter(r => r < this.row).pop();
    if (row !== undefined) this.go_to_row(row);
  }

  set_speed(speed) {
    this.speed = speed;
    this.tell();
  }
  change_speed(steps) {
    const k = erard.speeds.indexOf(this.speed) - steps;
    if (k >= 0 && k < erard.speeds.length) this.set_speed(erard.speeds[k]);
  }

  toggle() { this.is_playing ? this.pause() : this.play(); }
  pause() {
    this.is_playing = false;
    this.tell();
  }
  play() {
    if (this.is_playing) return;
    if (this.time >= this.run.end) this.time = this.run.start;
    this.is_playing = true;
    let last = null;
    const frame = now => {
      if (!this.is_playing) return;
      if (last !== null) {
        this.frame_times.push(now - last);
        if (this.frame_times.length > 600) this.frame_times.shift();
        this.time = Math.min(this.run.end, this.time + 1e-3 * (now - last) * this.speed);
      }
      last = now;
      if (this.time >= this.run.end) this.is_playing = false;
      this.tell();
      if (this.is_playing) requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
    this.tell();
  }
};
