// The mechanism as SVG elements that follow a run. A scene, as the program writes it, in mm and rad:
//   view [left, bottom, right, top]; views [{name, box}]
//   bodies [{name, label, parent (-1: ground), slide, origin (in the parent), direction, dry, hidden, held, label_at, spring}]
//   parts [{body, name, material, path, at (in the body), upright}] in drawing order; fingertip: one more
//   contacts [{name, label, a, b, shape_a, shape_b, mu, felt ("a", "b": its carrier, or null), active}]
"use strict";

erard.sliding_share = 0.999;  // of the bound, from which a contact or hinge counts as sliding
erard.svg = function (tag, attributes = {}) {
  const node = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  return node;
};

erard.arrow_path = function (length, unit) {
  const head = Math.min(3.2 * unit, 0.6 * length), half = 0.45 * head, shaft = 0.5 * unit;
  return `M0 ${-shaft}L${length - head} ${-shaft}L${length - head} ${-half}L${length} 0L${length - head} ${half}L${length - head} ${shaft}L0 ${shaft}Z`;
};

erard.circle_mark = "M1.1 0A1.1 1.1 0 0 1-1.1 0A1.1 1.1 0 0 1 1.1 0Z";
erard.marks = {
  open: erard.circle_mark,
  closed: erard.circle_mark,
  stick: "M-1.1-1.1L1.1-1.1L1.1 1.1L-1.1 1.1Z",
  slide: "M-1.2-1.1L1.4 0L-1.2 1.1Z",
};

/// "open", "closed", or with friction "stick", "slide".
erard.contact_state = function (contact, value) {
  const normal = value(`normal_${contact.name}_N`);
  if (normal <= 0) return "open";
  if (contact.mu <= 0) return "closed";
  return Math.abs(value(`tangential_${contact.name}_N`)) >= erard.sliding_share * contact.mu * normal ? "slide" : "stick";
};

/// "free" (no dry friction), "stick" or "slide".
erard.hinge_state = function (body, value) {
  if (body.dry <= 0 || body.held) return "free";
  return Math.abs(value(`hinge_${body.name}_N_m`)) >= erard.sliding_share * body.dry ? "slide" : "stick";
};

erard.Picture = class {
  /// @param parent  <g> whose y points up  @param run  an erard.Run  @param is_ghost  outlines alone
  constructor(parent, run, is_ghost) {
    this.run = run;
    this.scene = run.scene;
    this.is_ghost = is_ghost;
    this.unit = 1;  // size of signs [mm]
    this.root = erard.svg("g", { class: is_ghost ? "ghost" : "run" });
    parent.append(this.root);
    this.make_parts();
    if (!is_ghost) this.make_signs();
  }

  path(parent, kind, d, name) {
    const node = erard.svg("path", { class: kind, d });
    if (name) node.dataset.name = name;
    parent.append(node);
    return node;
  }

  make_parts() {
    this.groups = [];
    let last = null;
    for (const part of this.scene.parts) {
      if (this.is_ghost && (part.body < 0 || part.material === "grain")) continue;
      if (!last || last.body !== part.body || last.upright || part.upright) {
        last = { body: part.body, upright: part.upright, at: part.upright ? part.at : [0, 0], node: erard.svg("g") };
        this.root.append(last.node);
        this.groups.push(last);
      }
      const node = this.path(last.node, part.material, part.path, part.name);
      if (!part.upright && (part.at[0] || part.at[1])) node.setAttribute("transform", `translate(${part.at})`);
    }
    const tip = this.scene.fingertip;
    if (tip && this.run.drive !== "none") this.fingertip = this.path(this.root, tip.material, tip.path, tip.name);
  }

  make_signs() {
    const { bodies, contacts } = this.scene;
    this.springs = bodies.map(b => b.spring && !b.hidden ? this.path(this.root, "spring", "M0 0", `spring of ${b.label}`) : null);
    const is_drawn = c => c.active && ![c.a, c.b].some(i => i >= 0 && bodies[i].hidden);
    this.pressed = contacts.map(c => is_drawn(c) && c.felt ? this.path(this.root, "pressed", "M0 0") : null);
    this.pins = bodies.map(b => b.hidden || b.slide ? null : this.path(this.root, "pin", "M1.7 0A1.7 1.7 0 0 1-1.7 0A1.7 1.7 0 0 1 1.7 0Z"));
    this.pins.forEach((pin, i) => { if (pin) pin.dataset.body = i; });
    this.arrows = contacts.map(c => is_drawn(c) ? this.path(this.root, "arrow-closed", "M0 0") : null);
    this.contact_marks = contacts.map(c => is_drawn(c) ? this.path(this.root, "mark-open", "M0 0") : null);
    for (const list of [this.pressed, this.arrows, this.contact_marks])
      list.forEach((node, c) => { if (node) node.dataset.contact = c; });
    this.finger_arrow = this.scene.finger.body >= 0 ? this.path(this.root, "arrow-finger", "M0 0", "force of the finger") : null;
    this.labels = bodies.map(b => {
      if (!b.label_at || b.hidden) return null;
      const group = erard.svg("g", { class: "label", "pointer-events": "none" });
      for (const kind of ["halo", "name"]) {
        const text = erard.svg("text", { class: kind, dy: "0.35em" });
        text.textContent = b.label;
        group.append(text);
      }
      this.root.append(group);
      return group;
    });
  }

  /// Puts everything where it is at `time` [s].
  update(time) {
    const value = this.run.at(time);
    this.value = value;
    const frames = erard.place_bodies(this.scene, value);
    this.frames = frames;
    for (const group of this.groups) {
      const frame = frames[group.body];
      const [x, y] = erard.placed(frame, group.at);
      group.node.setAttribute("transform", `translate(${x.toFixed(4)} ${y.toFixed(4)})` +
        (group.upright ? "" : `rotate(${(frame.angle * 180 / Math.PI).toFixed(5)})`));
    }
    this.update_finger(value, frames);
    if (this.is_ghost) return;
    this.scene.bodies.forEach((body, i) => this.update_body(body, i, value, frames));
    this.scene.contacts.forEach((contact, c) => { if (this.contact_marks[c]) this.update_contact(contact, c, value, frames); });
  }

  update_body(body, i, value, frames) {
    if (this.springs[i]) {
      const { coil, to, radius: r } = body.spring;
      const [x, y] = erard.placed(frames[body.parent], coil), [ex, ey] = erard.placed(frames[i], to);
      this.springs[i].setAttribute("d", `M${x} ${y + r}A${r} ${r} 0 1 0 ${x} ${y - r}A${r} ${r} 0 0 0 ${x} ${y + r}L${ex} ${ey}`);
    }
    if (this.pins[i]) {
      const state = erard.hinge_state(body, value);
      this.pins[i].setAttribute("class", state === "free" ? "pin" : "pin-" + state);
      this.pins[i].setAttribute("transform", `translate(${frames[i].x} ${frames[i].y})scale(${this.unit})`);
    }
    if (this.labels[i]) {
      const [x, y] = erard.placed(frames[i], body.label_at);
      this.labels[i].setAttribute("transform", `translate(${x} ${y})scale(${this.unit},${-this.unit})`);
    }
  }

  update_contact(contact, c, value, frames) {
    const at = erard.locate_contact(contact, frames);
    const [nx, ny] = at.normal;
    const d = this.scene.felt_magnification * 1e3 * value(`delta_${contact.name}_m`);
    if (this.pressed[c]) {
      const on_a = contact.felt === "a";
      const half = 1.5 + 1.2 * d;
      const point = on_a ? at.point_a : at.point_b;
      const angle = on_a ? Math.atan2(-ny, -nx) : Math.atan2(ny, nx);
      this.pressed[c].setAttribute("d", d > 0 ? `M0 ${-half}Q${2 * d} 0 0 ${half}Z` : "M0 0");
      this.pressed[c].setAttribute("transform", `translate(${point})rotate(${angle * 180 / Math.PI})`);
    }
    const state = erard.contact_state(contact, value);
    const point = contact.felt === "a" ? at.point_b : at.point_a;
    const normal = value(`normal_${contact.name}_N`), tangential = value(`tangential_${contact.name}_N`);
    const side = contact.b < 0 ? -1 : 1;
    const fx = side * (normal * nx - tangential * ny), fy = side * (normal * ny + tangential * nx);
    const mark = this.contact_marks[c];
    const turn = Math.atan2(nx, -ny) + (tangential < 0 ? Math.PI : 0);
    mark.setAttribute("class", "mark-" + state);
    mark.setAttribute("d", erard.marks[state]);
    mark.setAttribute("transform", `translate(${point})rotate(${turn * 180 / Math.PI})scale(${this.unit})`);
    this.set_arrow(this.arrows[c], "arrow-" + state, point, fx, fy);
  }

  set_arrow(arrow, kind, [x, y], fx, fy) {
    const force = Math.hypot(fx, fy);
    const length = Math.min(70, this.scene.arrow_length * Math.sqrt(force)) * this.unit;
    arrow.setAttribute("class", kind);
    arrow.setAttribute("d", force > 1e-3 ? erard.arrow_path(length, this.unit) : "M0 0");
    arrow.setAttribute("transform", `translate(${x} ${y})rotate(${Math.atan2(fy, fx) * 180 / Math.PI})`);
    return length;
  }

  update_finger(value, frames) {
    const { finger, fingertip } = this.scene;
    if (finger.body < 0) return;
    const local = fingertip ? fingertip.at : [finger.arm, 0];
    const [x, y] = erard.placed(frames[finger.body], local);
    if (this.fingertip) {
      const indent = this.run.drive === "force" ? 0 : 1e3 * (value("input") - value("y_m"));
      this.fingertip.setAttribute("transform", `translate(${x} ${y - indent})`);
    }
    if (!this.finger_arrow) return;
    const force = value("force_N");
    const length = Math.min(70, this.scene.arrow_length * Math.sqrt(Math.abs(force))) * this.unit;
    this.set_arrow(this.finger_arrow, "arrow-finger", [x, y + (force > 0 ? length : 0)], 0, -force);
  }

  /// What is under the pointer, in words.
  describe(node) {
    const value = this.value;
    if (node.dataset.contact !== undefined) {
      const contact = this.scene.contacts[node.dataset.contact];
      const words = { open: "open", closed: "closed", stick: "closed, sticking", slide: "closed, sliding" };
      const state = erard.contact_state(contact, value), d = 1e3 * value(`delta_${contact.name}_m`);
      return `${contact.name}, ${contact.label}: ${words[state]}` + (state === "open" ? `, ${(-d).toFixed(2)} mm apart` :
        `, ${value(`normal_${contact.name}_N`).toFixed(2)} N` + (contact.felt ? `, felt ${d.toFixed(3)} mm` : ""));
    }
    if (node.dataset.body !== undefined) {
      const body = this.scene.bodies[node.dataset.body];
      const words = { free: "no dry friction", stick: "sticks", slide: "turns" };
      return `joint of ${body.label}: ${words[erard.hinge_state(body, value)]}, ${value("omega_" + body.name).toFixed(2)} rad/s`;
    }
    return node.dataset.name || "";
  }
};
