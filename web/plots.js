// Curves over time, drawn by uPlot, with one playhead, one time axis and the events.
"use strict";

erard.colours = 7;  // --c0 ... in report.css; from the eighth curve on they come again, dashed
erard.css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/// What is drawn: plots of curves; a curve is a column with a factor.
erard.plot_list = function (run) {
  const { bodies, contacts, roles } = run.scene;
  const live = bodies.filter(b => !b.hidden);
  const plots = [{ title: "finger force", unit: "N", curves: [{ label: "finger", column: "force_N", factor: 1 }] }];
  const key = [{ label: "key y", column: "y_m", factor: 1e3 }];
  if (run.drive !== "force") key.push({ label: run.drive === "key" ? "prescribed" : "piston Y", column: "input", factor: 1e3 });
  plots.push({ title: "key and piston, down", unit: "mm", curves: key });
  if (roles.string >= 0)
    plots.push({ title: "hammer to string", unit: "mm", curves: [{ label: "distance", column: `delta_${contacts[roles.string].name}_m`, factor: -1e3 }] });
  plots.push({ title: "angles of the bodies, absolute", unit: "rad", curves: live.map(b => ({ label: b.slide ? b.name + " [m]" : b.name, title: b.label, column: "theta_" + b.name, factor: 1 })) });
  const first = [roles.let_off, roles.escapement, roles.front_rail, roles.backcheck].filter(c => c >= 0);
  const active = contacts.map((c, i) => ({ label: c.name, title: c.label, column: `normal_${c.name}_N`, factor: 1, hidden: first.length > 0 && !first.includes(i), active: c.active }));
  if (active.some(c => c.active)) plots.push({ title: "contact forces", unit: "N", curves: active.filter(c => c.active) });
  const dry = live.filter(b => b.dry > 0 && !b.held);
  if (dry.length > 0)
    plots.push({ title: "hinge friction over its limit: within ±1 the hinge sticks", unit: "", curves: dry.map(b => ({ label: b.name, title: b.label, column: `hinge_${b.name}_N_m`, factor: 1 / b.dry })) });
  return plots;
};

erard.Plots = class {
  /// @param other  null, or {at(t, column): value or null}
  constructor(parent, player, other, other_events) {
    this.player = player;
    this.run = player.run;
    this.other = other;
    this.other_events = other_events;
    this.plots = [];
    this.x = Float64Array.from({ length: this.run.count }, (_, k) => 1e3 * this.run.time(k));
    erard.plot_list(this.run).forEach((plot, k) => this.add(parent, plot, k === 0));
    player.listen(() => this.update());
  }

  add(parent, plot, is_first) {
    const figure = erard.element("figure", { class: "plot" });
    const caption = erard.element("figcaption", {}, erard.element("b", {}, plot.title + (plot.unit ? ` [${plot.unit}]` : "")));
    const box = erard.element("div", { class: "canvas" });
    figure.append(caption, box);
    parent.append(figure);
    const data = [this.x], series = [{}];
    plot.curves.forEach((curve, k) => this.add_curve(curve, k, data, series, caption));
    const is_tall = is_first && this.player.events.length > 0;  // room for the names of the events
    const options = {
      width: Math.max(200, box.clientWidth), height: is_tall ? 214 : 140, padding: [is_tall ? 70 : 17, 26, 0, 0],
      scales: { x: { time: false } }, legend: { show: false }, series,
      cursor: { points: { show: false }, y: false, drag: { x: true, y: true, uni: 30 } },
      axes: [this.axis({ size: 26, values: (u, ticks) => ticks.map(t => t + (t === ticks[ticks.length - 1] ? " ms" : "")) }), this.axis({ size: 52 })],
      hooks: { draw: [u => this.draw_events(u, is_first)], setScale: [(u, scale) => this.share_time(u, scale)] },
    };
    const chart = new uPlot(options, data, box);
    const head = erard.element("div", { class: "playhead" });
    chart.over.append(head);
    this.plots.push({ chart, head, box, plot });
    this.listen(chart);
    plot.curves.forEach((curve, k) => this.wire_switch(curve, chart));
    new ResizeObserver(() => {
      const width = Math.floor(box.clientWidth);
      if (width > 0 && width !== chart.width) chart.setSize({ width, height: chart.height });
      this.update();
    }).observe(box);
  }

  axis(more) {
    return {
      stroke: () => erard.css("--ink-soft"), font: "11px system-ui, sans-serif",
      grid: { stroke: () => erard.css("--grid"), width: 1 }, ticks: { stroke: () => erard.css("--grid"), width: 1 }, ...more,
    };
  }

  add_curve(curve, k, data, series, caption) {
    const column = this.run.column.get(curve.column);
    const colour = `--c${k % erard.colours}`, dash = k >= erard.colours ? [7, 3] : undefined;
    curve.index = data.length;
    curve.values = Float64Array.from(column, v => curve.factor * v);
    data.push(curve.values);
    series.push({ label: curve.label, stroke: () => erard.css(colour), width: 1.6, dash, show: !curve.hidden, points: { show: false } });
    if (this.other && this.other.has(curve.column)) {
      curve.other = Array.from(this.x, t => { const v = this.other.at(1e-3 * t, curve.column); return v === null ? null : curve.factor * v; });
      curve.other_index = data.length;
      data.push(curve.other);
      series.push({ label: curve.label + ", other", stroke: () => erard.css(colour), width: 1.3, dash: [2, 3], alpha: 0.85, show: !curve.hidden, points: { show: false } });
    }
    const swatch = erard.element("i", { class: dash ? "swatch dashed" : "swatch", style: `color: var(${colour})` });
    curve.readout = erard.element("span", { class: "value", "data-column": curve.column });
    curve.button = erard.element("button", { type: "button", class: "curve", "aria-pressed": String(!curve.hidden), title: curve.title || curve.label }, swatch, curve.label, curve.readout);
    caption.append(curve.button);
  }

  wire_switch(curve, chart) {
    curve.button.addEventListener("click", () => {
      const show = curve.button.getAttribute("aria-pressed") !== "true";
      curve.button.setAttribute("aria-pressed", String(show));
      chart.setSeries(curve.index, { show });
      if (curve.other_index) chart.setSeries(curve.other_index, { show });
    });
  }

  /// A click that is no drag moves the playhead.
  listen(chart) {
    let down = null;
    chart.over.addEventListener("pointerdown", e => { down = e; });
    chart.over.addEventListener("click", e => {
      if (!down || Math.hypot(e.clientX - down.clientX, e.clientY - down.clientY) > 4) return;
      const left = e.clientX - chart.over.getBoundingClientRect().left;
      this.player.go_to_row(this.run.row(1e-3 * chart.posToVal(left, "x")));
    });
  }

  share_time(source, scale) {
    if (scale !== "x" || this.is_sharing) return;
    this.is_sharing = true;
    const { min, max } = source.scales.x;
    for (const { chart } of this.plots)
      if (chart !== source && min !== null) chart.setScale("x", { min, max });
    this.is_sharing = false;
    queueMicrotask(() => this.update());
  }

  draw_events(u, is_first) {
    const { ctx, bbox } = u, ratio = uPlot.pxRatio;
    const rows = Array(is_first ? 5 : 1).fill(-Infinity);
    ctx.save();
    ctx.font = `${11 * ratio}px system-ui, sans-serif`;
    ctx.textAlign = "left";
    ctx.textBaseline = "alphabetic";
    ctx.lineWidth = ratio;
    const line = (time, colour, dash) => {
      const x = Math.round(u.valToPos(1e3 * time, "x", true)) + 0.5;
      if (x < bbox.left - 1 || x > bbox.left + bbox.width + 1) return null;
      ctx.strokeStyle = colour;
      ctx.setLineDash(dash.map(d => d * ratio));
      ctx.beginPath();
      ctx.moveTo(x, bbox.top);
      ctx.lineTo(x, bbox.top + bbox.height);
      ctx.stroke();
      return x;
    };
    for (const event of this.other_events) line(event.time_s, erard.css("--ghost"), [2, 4]);
    ctx.fillStyle = erard.css("--ink-soft");
    for (const event of this.player.events) {
      const x = line(event.time_s, erard.css("--mark"), [4, 3]);
      const word = erard.event_word(event);
      const row = rows.findIndex(end => x > end);
      if (x === null || row < 0) continue;
      const width = ctx.measureText(word).width;
      const left = Math.min(x, bbox.left + bbox.width + 8 * ratio - width);
      ctx.fillText(word, left, bbox.top - (4 + 13 * row) * ratio);
      rows[row] = left + width + 5 * ratio;
    }
    ctx.restore();
  }

  update() {
    const row = this.player.row, t = 1e3 * this.player.time;
    for (const { chart, head, plot } of this.plots) {
      if (chart.scales.x.min === null || chart.scales.x.min === undefined) continue;
      const left = chart.valToPos(t, "x");
      head.style.transform = `translateX(${left.toFixed(1)}px)`;
      head.style.visibility = left >= 0 && left <= chart.over.clientWidth ? "visible" : "hidden";
      for (const curve of plot.curves) {
        const other = curve.other ? curve.other[row] : null;
        const text = erard.digits(curve.values[row]) + (other === null ? "" : " | " + erard.digits(other));
        if (curve.readout.textContent !== text) curve.readout.textContent = text;
      }
    }
  }

  redraw() { for (const { chart } of this.plots) chart.redraw(false); }
};

/// A value in a space that does not jump: four digits.
erard.digits = function (value) {
  const size = Math.abs(value);
  return size === 0 ? "0" : size >= 1e5 || size < 5e-4 ? value.toExponential(2) : value.toFixed(size >= 100 ? 1 : size >= 10 ? 2 : size >= 1 ? 3 : 4);
};
