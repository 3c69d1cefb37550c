// Where bodies and contacts are. The same formulas as frames.hpp and distance.hpp, in mm.
"use strict";

erard.unit = angle => [Math.cos(angle), Math.sin(angle)];

/// A point of a body in the ground frame.
erard.placed = (frame, [x, y]) => [frame.x + frame.c * x - frame.s * y, frame.y + frame.s * x + frame.c * y];

/// Frames of all bodies from their absolute angles; frames[-1] is the ground.
erard.place_bodies = function (scene, value) {
  const frames = [];
  frames[-1] = { x: 0, y: 0, angle: 0, c: 1, s: 0 };
  scene.bodies.forEach((body, i) => {
    const parent = frames[body.parent];
    const [x, y] = erard.placed(parent, body.origin);
    const coordinate = value("theta_" + body.name);
    const frame = { x, y, angle: body.slide ? parent.angle : coordinate };
    if (body.slide) {
      const [dx, dy] = erard.unit(parent.angle + body.direction);
      frame.x += 1e3 * coordinate * dx;
      frame.y += 1e3 * coordinate * dy;
    }
    [frame.c, frame.s] = erard.unit(frame.angle);
    frames[i] = frame;
  });
  return frames;
};

erard.nearest_on_core = function (shape, frame, point) {
  const centre = erard.placed(frame, shape.centre);
  if (!shape.segment) return centre;
  const [ux, uy] = erard.unit(frame.angle + shape.direction);
  const along = ux * (point[0] - centre[0]) + uy * (point[1] - centre[1]);
  const s = Math.max(-shape.half, Math.min(shape.half, along));
  return [centre[0] + s * ux, centre[1] + s * uy];
};

/// Normal from A to B, the points of the two surfaces and the gap of the uncompressed primitives [mm].
erard.locate_contact = function (contact, frames) {
  const a = contact.shape_a, b = contact.shape_b;
  const core_b = erard.nearest_on_core(b, frames[contact.b], erard.placed(frames[contact.a], a.centre));
  const core_a = erard.nearest_on_core(a, frames[contact.a], core_b);
  const dx = core_b[0] - core_a[0], dy = core_b[1] - core_a[1];
  const distance = Math.hypot(dx, dy);
  const n = distance > 0 ? [dx / distance, dy / distance] : [0, 1];
  return {
    normal: n,
    gap: distance - a.radius - b.radius,
    point_a: [core_a[0] + a.radius * n[0], core_a[1] + a.radius * n[1]],
    point_b: [core_b[0] - b.radius * n[0], core_b[1] - b.radius * n[1]],
  };
};
