// The numbers of a run: what the block #run holds, and how to ask for a value at a time.
"use strict";
const erard = {};

/// 32-bit floats, little-endian, from base64.
erard.floats = function (text) {
  const bytes = Uint8Array.from(atob(text), c => c.charCodeAt(0));
  return new Float32Array(bytes.buffer);
};

/// A run with its columns: rows of equal distance in time, the names those of trajectory.csv, SI units.
erard.Run = class {
  constructor(json) {
    Object.assign(this, json);
    const { count, start_s, period_s, stride, columns, data } = json.rows;
    const all = erard.floats(data);
    this.count = count;
    this.start = start_s;
    this.spacing = period_s * stride;
    this.column = new Map(columns.map((name, k) => [name, all.subarray(k * count, (k + 1) * count)]));
    delete this.rows.data;
  }
  get end() { return this.time(this.count - 1); }
  time(row) { return this.start + row * this.spacing; }
  /// The row nearest to a time, within the run.
  row(time) { return Math.max(0, Math.min(this.count - 1, Math.round((time - this.start) / this.spacing))); }
  /// Values between rows by straight lines, at one time: a function of the column's name.
  at(time) {
    const place = Math.max(0, Math.min(this.count - 1, (time - this.start) / this.spacing));
    const low = Math.min(Math.floor(place), Math.max(0, this.count - 2));
    const part = place - low;
    return name => {
      const column = this.column.get(name);
      if (!column) return 0;
      return part > 0 ? column[low] + part * (column[low + 1] - column[low]) : column[low];
    };
  }
};

erard.event_words = {
  jack_meets_let_off: "let-off", escapement: "escapement", key_meets_front_rail: "key bottom",
  hammer_meets_string: "string", hammer_checked: "check", jack_returned: "jack back", repetition_ready: "ready",
};
erard.event_word = event => erard.event_words[event.name] || event.name.replace(/_/g, " ");

/// Element with attributes, text and children.
erard.element = function (tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  node.append(...children);
  return node;
};

/// Three or four digits that count, as a technician reads them.
erard.short = function (value) {
  if (value === null || !Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  return value.toFixed(size >= 100 ? 0 : size >= 10 ? 1 : 2);
};
