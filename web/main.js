// Puts the page together.
"use strict";

{
  const id = name => document.getElementById(name);
  const run = new erard.Run(JSON.parse(id("run").textContent));
  const other = JSON.parse(id("other").textContent);
  const other_run = other && other.run ? new erard.Run(other.run) : null;
  const player = new erard.Player(run);

  // what the curves ask of the other run; a measured force has no more than that
  const other_curves = !other ? null : other_run ? {
    has: column => other_run.column.has(column),
    at: (t, column) => t < other_run.start || t > other_run.end ? null : other_run.at(t)(column),
  } : (() => {
    const times = other.time_s, force = erard.floats(other.force_N);
    let k = 0;
    return {
      has: column => column === "force_N",
      at: t => {
        if (t < times[0] || t > times[times.length - 1]) return null;
        if (t < times[k]) k = 0;
        while (k + 2 < times.length && times[k + 1] <= t) ++k;
        return force[k] + (force[k + 1] - force[k]) * (t - times[k]) / (times[k + 1] - times[k]);
      },
    };
  })();

  const facts = () => {
    id("title").textContent = run.scene.name || run.action;
    document.title = `${run.keystroke} on ${run.scene.name || run.action}`;
    const rows = run.rows.stride > 1 ? `, every ${run.rows.stride}th row is shown` : "";
    id("run-facts").textContent = `${run.keystroke} on ${run.action}, drive ${run.drive}, ${(run.end - run.start).toFixed(3)} s at ` +
      `${run.rate_Hz} Hz with ${run.substeps} steps a row${rows}; peak ${erard.short(run.peak_force_N)} N; ` +
      `${run.linearisations_a_step} linearisations and ${run.sweeps_a_step} sweeps a step; erard ${run.version}`;
    id("status").textContent = run.status.text + (run.events_lost ? `; ${run.events_lost} events beyond those listed` : "");
    id("status").className = run.status.level;
    id("signs").innerHTML = "";
    const sign = (kind, mark, text) => {
      const svg = erard.svg("svg", { class: "drawing sign", viewBox: "-2 -2 4 4" });
      svg.append(erard.svg("path", { class: kind, d: mark }));
      id("signs").append(erard.element("span", {}, svg, text));
    };
    sign("mark-open", erard.marks.open, "open");
    sign("mark-closed", erard.marks.closed, "closed");
    sign("mark-stick", erard.marks.stick, "sticking");
    sign("mark-slide", erard.marks.slide, "sliding");
    sign("pin-stick", erard.circle_mark, "hinge sticks");
    sign("pin-slide", erard.circle_mark, "hinge turns");
    id("signs").append(erard.element("span", {}, `Arrows: force on the part that is pushed, length as √force. Dark: pressed felt, ${run.scene.felt_magnification} times as deep.`));
  };

  const make_drawing = () => {
    const svg = id("drawing"), [left, bottom, right, top] = run.scene.view;
    svg.style.aspectRatio = Math.max(0.8, Math.min(4, (right - left) / (top - bottom)));
    const flipped = erard.svg("g", { transform: "scale(1,-1)" });
    svg.append(flipped);
    const picture = new erard.Picture(flipped, run, false);
    const ghost = other_run ? new erard.Picture(flipped, other_run, true) : null;
    const update = () => {
      picture.update(player.time);
      if (ghost) ghost.update(player.time);
    };
    const view = new erard.View(svg, run.scene, node => picture.describe(node), unit => {
      picture.unit = Math.min(4.4, unit);
      update();
    });
    player.listen(update);
    return view;
  };

  const make_transport = () => {
    const actions = { first: () => player.go_to_row(0), back: () => player.step(-1), play: () => player.toggle(), forward: () => player.step(1),
      "previous-event": () => player.jump(-1), "next-event": () => player.jump(1) };
    for (const [name, action] of Object.entries(actions)) id(name).addEventListener("click", action);
    for (const speed of erard.speeds)
      id("speed").append(erard.element("option", { value: speed }, speed === 1 ? "1" : `1/${Math.round(1 / speed)}`));
    id("speed").addEventListener("change", () => player.set_speed(Number(id("speed").value)));
    const scrubber = id("scrubber");
    scrubber.max = run.count - 1;
    scrubber.addEventListener("input", () => player.go_to_row(Number(scrubber.value)));
    const buttons = player.events.map((event, k) => {
      const button = erard.element("button", { type: "button", "data-event": event.name, title: `strike ${event.strike}, key down ${(1e3 * event.y_m).toFixed(2)} mm` + (k < 9 ? ` (${k + 1})` : "") },
        erard.event_word(event), erard.element("small", {}, (1e3 * event.time_s).toFixed(1) + " ms"));
      button.addEventListener("click", () => player.go_to_event(event));
      id("events").append(button);
      const place = 100 * run.row(event.time_s) / Math.max(1, run.count - 1);
      id("ticks").append(erard.element("i", { style: `left: ${place.toFixed(3)}%`, title: erard.event_word(event) }));
      return button;
    });
    player.listen(() => {
      id("play").textContent = player.is_playing ? "pause" : "play";
      id("speed").value = String(player.speed);
      scrubber.value = player.row;
      id("clock").textContent = `${(1e3 * player.time).toFixed(1)} ms`;
      buttons.forEach((button, k) => button.classList.toggle("here", run.row(player.events[k].time_s) === player.row));
    });
  };

  const make_keys = view => {
    const keys = {
      " ": () => player.toggle(), ArrowLeft: e => player.step(e.shiftKey ? -10 : -1), ArrowRight: e => player.step(e.shiftKey ? 10 : 1),
      Home: () => player.go_to_row(0), End: () => player.go_to_row(run.count - 1), n: () => player.jump(1), p: () => player.jump(-1),
      "[": () => player.change_speed(-1), "]": () => player.change_speed(1), "+": () => view.zoom(0.7), "=": () => view.zoom(0.7),
      "-": () => view.zoom(1 / 0.7), 0: () => view.show(view.whole), d: () => id("theme").click(),
    };
    document.addEventListener("keydown", event => {
      if (event.ctrlKey || event.metaKey || event.altKey || event.target.tagName === "SELECT") return;
      // a button under the focus keeps its space bar
      if (event.key === " " && event.target.closest("button, summary, input[type=checkbox]")) return;
      const digit = "123456789".indexOf(event.key);
      const action = digit >= 0 ? () => digit < player.events.length && player.go_to_event(player.events[digit]) : keys[event.key];
      if (!action) return;
      event.preventDefault();
      action(event);
    });
  };

  const make_theme = plots => {
    const root = document.documentElement, wish = new URLSearchParams(location.hash.slice(1)).get("theme");
    const set = theme => {
      root.dataset.theme = theme;
      plots.redraw();
    };
    const system = matchMedia("(prefers-color-scheme: dark)");
    set(wish || (system.matches ? "dark" : "light"));
    system.addEventListener("change", () => set(system.matches ? "dark" : "light"));
    id("theme").addEventListener("click", () => set(root.dataset.theme === "dark" ? "light" : "dark"));
    id("names").checked = innerWidth >= 700;
    const names = () => id("drawing").classList.toggle("nameless", !id("names").checked);
    id("names").addEventListener("change", names);
    names();
  };

  facts();
  const view = make_drawing();
  make_transport();
  const plots = new erard.Plots(id("plots"), player, other_curves, other_run ? other_run.events : []);
  erard.fill_measures(id("measures"), run.measures);
  id("summary").hidden = run.measures.length === 0;
  if (other) erard.fill_comparison(id("comparison"), other, run, other_run);
  const now = new erard.Now(id("now"), run), columns = new erard.Columns(id("all"), run, other_run);
  player.listen(() => { now.update(player); columns.update(player); });
  make_keys(view);
  make_theme(plots);
  const wish = new URLSearchParams(location.hash.slice(1));
  const box = run.scene.views.find(v => v.name === wish.get("view"));
  if (box) view.show(box.box);
  player.go(wish.has("t") ? Number(wish.get("t")) : run.start);
  erard.page = { run, other_run, player, view, plots };  // for the tests and the console
}
