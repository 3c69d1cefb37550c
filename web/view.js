// Pan and zoom of the drawing; names of what is pointed at.
"use strict";

erard.View = class {
  /// @param on_change  called with the size of signs [mm] whenever what is seen changes
  constructor(svg, scene, describe, on_change) {
    this.svg = svg;
    this.whole = scene.view;
    this.on_change = on_change;
    this.tip = document.getElementById("tip");
    this.pointers = new Map();
    this.show(this.whole);
    new ResizeObserver(() => this.apply()).observe(svg);
    svg.addEventListener("wheel", e => { e.preventDefault(); this.zoom(Math.exp(0.0015 * e.deltaY), e.clientX, e.clientY); }, { passive: false });
    svg.addEventListener("pointerdown", e => { this.pointers.set(e.pointerId, e); svg.setPointerCapture(e.pointerId); });
    for (const kind of ["pointerup", "pointercancel"]) svg.addEventListener(kind, e => this.pointers.delete(e.pointerId));
    svg.addEventListener("pointermove", e => this.pointers.has(e.pointerId) ? this.drag(e) : this.point(e, describe));
    svg.addEventListener("pointerleave", () => { this.tip.hidden = true; });
    svg.addEventListener("click", e => this.point(e, describe));
    svg.addEventListener("dblclick", () => this.show(this.whole));
    this.make_buttons(scene);
  }

  make_buttons(scene) {
    const bar = document.getElementById("views");
    const add = (text, title, action) => {
      const button = erard.element("button", { type: "button", title }, text);
      button.addEventListener("click", action);
      bar.append(button);
    };
    add("+", "closer (+)", () => this.zoom(0.7));
    add("−", "farther (-)", () => this.zoom(1 / 0.7));
    add("whole", "all of it (0)", () => this.show(this.whole));
    for (const view of scene.views) add(view.name, "look at: " + view.name, () => this.show(view.box));
  }

  show([left, bottom, right, top]) {
    this.box = { x: left, y: -top, w: right - left, h: top - bottom };
    this.apply();
  }

  apply() {
    const { x, y, w, h } = this.box;
    this.svg.setAttribute("viewBox", `${x} ${y} ${w} ${h}`);
    this.on_change(3.4 * this.scale());
  }

  /// Millimetres per pixel.
  scale() {
    const rect = this.svg.getBoundingClientRect();
    return rect.width > 0 ? Math.max(this.box.w / rect.width, this.box.h / rect.height) : this.box.w / 800;
  }

  /// Zooms about a point of the window, or about the middle.
  zoom(factor, client_x, client_y) {
    const rect = this.svg.getBoundingClientRect(), scale = this.scale();
    const widest = 2 * (this.whole[2] - this.whole[0]);
    const f = Math.min(widest / this.box.w, Math.max(1 / this.box.w, factor));
    const dx = client_x === undefined ? 0 : scale * (client_x - rect.left - rect.width / 2);
    const dy = client_y === undefined ? 0 : scale * (client_y - rect.top - rect.height / 2);
    const cx = this.box.x + this.box.w / 2 + dx * (1 - f), cy = this.box.y + this.box.h / 2 + dy * (1 - f);
    this.box = { x: cx - f * this.box.w / 2, y: cy - f * this.box.h / 2, w: f * this.box.w, h: f * this.box.h };
    this.apply();
  }

  drag(event) {
    const before = this.pointers.get(event.pointerId);
    const others = [...this.pointers.values()].filter(p => p.pointerId !== event.pointerId);
    if (others.length > 0) {
      const gap = p => Math.hypot(p.clientX - others[0].clientX, p.clientY - others[0].clientY);
      this.zoom(gap(before) / Math.max(1, gap(event)), (event.clientX + others[0].clientX) / 2, (event.clientY + others[0].clientY) / 2);
    } else {
      const scale = this.scale();
      this.box.x -= scale * (event.clientX - before.clientX);
      this.box.y -= scale * (event.clientY - before.clientY);
      this.apply();
    }
    this.pointers.set(event.pointerId, event);
  }

  point(event, describe) {
    const under = document.elementFromPoint(event.clientX, event.clientY);
    const node = under && under.closest("#drawing path");
    const text = node ? describe(node) : "";
    this.tip.hidden = !text;
    if (!text) return;
    this.tip.textContent = text;
    const frame = this.svg.parentElement.getBoundingClientRect();
    const left = Math.min(event.clientX - frame.left + 12, frame.width - this.tip.offsetWidth - 4);
    this.tip.style.left = Math.max(0, left) + "px";
    this.tip.style.top = Math.max(0, event.clientY - frame.top - this.tip.offsetHeight - 10) + "px";
  }
};
