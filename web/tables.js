// What is read: the technician's summary, the comparison, the values at the cursor.
"use strict";

/// "inside", "low", "high" of one value against a usual range, or "none" without range.
erard.verdict = function (measure, value) {
  if (measure.low === null && measure.high === null) return "none";
  if (measure.low !== null && value < measure.low) return "low";
  return measure.high !== null && value > measure.high ? "high" : "inside";
};
erard.verdict_signs = { inside: ["✓", "usual"], low: ["▼", "below the usual"], high: ["▲", "above the usual"], none: ["", ""] };

erard.range_text = function ({ low, high }) {
  if (low === null && high === null) return "–";
  if (high === null) return `${low} or more`;
  return low === null ? `${high} or less` : `${low} to ${high}`;
};

erard.fill_measures = function (table, measures) {
  const { element } = erard;
  table.append(element("thead", {}, element("tr", {}, ...["", "here", "usual", ""].map(t => element("th", {}, t)))));
  const body = element("tbody");
  for (const m of measures) {
    const verdicts = m.values.map(v => erard.verdict(m, v));
    const worst = verdicts.find(v => v === "low" || v === "high") || verdicts[0] || "none";
    const [sign, words] = erard.verdict_signs[worst];
    const weight = m.scale_g && m.values.length ? ` (${m.values.map(v => (v * m.scale_g).toFixed(0)).join(", ")} g)` : "";
    const here = m.values.length ? m.values.map(erard.short).join(", ") + " " + m.unit + weight : "not in this run";
    const name = element("td", { title: m.how }, m.name, element("small", {}, m.how));
    const usual = element("td", { title: m.source }, erard.range_text(m), element("small", {}, m.source));
    body.append(element("tr", { class: worst, "data-measure": m.name }, name, element("td", { class: "number" }, here), usual,
      element("td", { class: "verdict", title: words, "aria-label": words }, sign)));
  }
  table.append(body);
  const box = document.getElementById("sources");
  box.addEventListener("change", () => table.classList.toggle("explained", box.checked));
};

/// The same event of the other run: same name, same strike.
erard.matching = (event, events) => events.find(e => e.name === event.name && e.strike === event.strike);

erard.fill_comparison = function (section, other, run, other_run) {
  const { element } = erard;
  const box = section.querySelector("#compared");
  section.hidden = false;
  const eta = other.eta === undefined ? "" : `: η = ${(100 * other.eta).toFixed(2)} % of the force until ${other.until_s.toFixed(3)} s (thesis 6.3)`;
  box.append(element("p", {}, element("b", { class: "other-name" }, other.name), eta));
  if (!other_run) {
    box.append(element("p", { class: "hint" }, "A force curve alone: dotted in the first plot."));
    return;
  }
  box.append(element("p", { class: "hint" }, `Dotted curves and the outlined ghost: ${other_run.action}, ${other_run.keystroke}. Differences: here less the other.`));
  const table = element("table"), body = element("tbody");
  table.append(element("thead", {}, element("tr", {}, ...["event", "strike", "here ms", "other ms", "Δ ms", "Δ m/s", "Δ y mm", "Δ N"].map(t => element("th", {}, t)))), body);
  const signed = (value, digits) => (value > 0 ? "+" : "") + value.toFixed(digits);
  for (const e of run.events) {
    const o = erard.matching(e, other_run.events);
    const cells = [erard.event_word(e), e.strike, (1e3 * e.time_s).toFixed(1), o ? (1e3 * o.time_s).toFixed(1) : "–"];
    if (o) cells.push(signed(1e3 * (e.time_s - o.time_s), 2), signed(e.hammer_speed_m_per_s - o.hammer_speed_m_per_s, 3), signed(1e3 * (e.y_m - o.y_m), 2), signed(e.force_N - o.force_N, 2));
    else cells.push("–", "–", "–", "–");
    body.append(element("tr", { "data-event": e.name }, ...cells.map(c => element("td", {}, String(c)))));
  }
  for (const o of other_run.events.filter(e => !erard.matching(e, run.events)))
    body.append(element("tr", {}, ...[erard.event_word(o), o.strike, "–", (1e3 * o.time_s).toFixed(1), "–", "–", "–", "–"].map(c => element("td", {}, String(c)))));
  box.append(element("div", { class: "wide" }, table));
};

/// The few values beside the drawing.
erard.Now = class {
  constructor(list, run) {
    this.run = run;
    const { roles, contacts, bodies } = run.scene;
    this.entries = [["time", "ms", () => 1e3 * this.t, 3], ["finger", "N", v => v("force_N"), 3]];
    if (run.scene.finger.body >= 0) this.entries.push(["key down", "mm", v => 1e3 * v("y_m"), 3]);
    if (roles.string >= 0) this.entries.push(["hammer to string", "mm", v => -1e3 * v(`delta_${contacts[roles.string].name}_m`), 3]);
    if (roles.hammer >= 0) {
      const contact = contacts[roles.string];
      const shape = contact && (contact.a === roles.hammer ? contact.shape_a : contact.shape_b);
      if (shape) this.entries.push(["hammer speed", "m/s", v => 1e-3 * Math.hypot(...shape.centre) * Math.abs(v("omega_" + bodies[roles.hammer].name)), 3]);
    }
    this.entries.push(["row", "", () => this.row * run.rows.stride, 0]);
    for (const entry of this.entries) {
      entry.cell = erard.element("dd", { "data-now": entry[0] });
      list.append(erard.element("div", {}, erard.element("dt", {}, entry[0]), entry.cell));
    }
  }
  update(player) {
    this.row = player.row;
    this.t = this.run.time(this.row);
    const value = name => this.run.column.get(name)[this.row];
    for (const entry of this.entries) entry.cell.textContent = `${entry[2](value).toFixed(entry[3])} ${entry[1]}`;
  }
};

/// Every column at the cursor, filled while it is open.
erard.Columns = class {
  constructor(details, run, other_run) {
    this.details = details;
    this.run = run;
    this.other_run = other_run;
    const body = erard.element("tbody");
    this.cells = [...run.column.keys()].map(name => {
      const cell = erard.element("td", { class: "number", "data-column": name });
      const other = erard.element("td", { class: "number" });
      body.append(erard.element("tr", {}, erard.element("td", {}, name), cell, other));
      return { name, cell, other };
    });
    details.querySelector("table").append(body);
    details.addEventListener("toggle", () => this.player && this.update(this.player));
  }
  update(player) {
    this.player = player;
    if (!this.details.open) return;
    const row = player.row, time = this.run.time(row);
    for (const { name, cell, other } of this.cells) {
      cell.textContent = this.run.column.get(name)[row].toPrecision(8);
      if (this.other_run && this.other_run.column.has(name)) other.textContent = this.other_run.at(time)(name).toPrecision(8);
    }
  }
};
