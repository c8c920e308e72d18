// What lies under the pointer, and its numbers.
import { Vector3 } from "three";
import { causes } from "./palette.js";
import { element, number, with_unit } from "./text.js";

const slack = 4;   // pixels beside a bond

/** How far along the ray from `eye` in the unit direction `way` a sphere is hit; Infinity if it is not. */
export function sphere_hit(eye, way, centre, radius) {
  const to = centre.clone().sub(eye), along = to.dot(way), rest = radius * radius - to.lengthSq() + along * along;
  return rest < 0 || along < 0 ? Infinity : along - Math.sqrt(rest);
}

/** The same of the line from a to b with this half width, and `widening` more for each unit of distance. */
export function line_hit(eye, way, a, b, width, widening) {
  const line = b.clone().sub(a), from = a.clone().sub(eye);
  const c = line.dot(way), length2 = line.lengthSq(), across = length2 - c * c;
  const s = across > 1e-12 * length2 ? Math.max(0, Math.min(1, (c * from.dot(way) - line.dot(from)) / across)) : 0.5;
  const nearest = from.addScaledVector(line, s), along = nearest.dot(way);
  return along > 0 && nearest.lengthSq() - along * along < (width + widening * along) ** 2 ? along - width : Infinity;
}

/** The same of a disc. */
export function disc_hit(eye, way, centre, normal, radius) {
  const along = centre.clone().sub(eye).dot(normal) / way.dot(normal);
  return along > 0 && along < Infinity && eye.clone().addScaledVector(way, along).distanceTo(centre) < radius ? along : Infinity;
}

/** The same of its widest line, for a disc seen from its side. */
function edge_hit(eye, way, centre, normal, radius, widening) {
  const across = new Vector3().crossVectors(normal, way).normalize().multiplyScalar(radius);
  return line_hit(eye, way, centre.clone().sub(across), centre.clone().add(across), 0, widening);
}

/** {kind: "particle" or "bond", number} at these coordinates (-1 to 1) of the picture, or null. */
export function picked_at(scene, sequence, frame, x, y) {
  const { camera, run, places: { array } } = scene, eye = camera.position;
  const way = new Vector3(x, y, 0.5).unproject(camera).sub(eye).normalize();
  const place = (k) => new Vector3(array[4 * k], array[4 * k + 1], array[4 * k + 2]);
  const widening = (slack * 2 * Math.tan((Math.PI / 360) * camera.fov)) / scene.canvas.clientHeight;
  let best = null, least = Infinity;
  const take = (kind, k, along) => { if (along < least) { least = along; best = { kind, number: k }; } };
  for (let k = 0; k < run.particles; ++k) if (!scene.is_gone(k)) take("particle", k, sphere_hit(eye, way, place(k), run.radius[k] * scene.sphere_size));
  for (let bond = 0; bond < sequence.bonds_at(frame); ++bond) {
    if (sequence.broken.cause(frame, bond) || run.ends_of(bond).some((k) => scene.is_gone(k))) continue;
    take("bond", bond, line_hit(eye, way, ...scene.ends_of_bond(bond), scene.bond_widths[bond], widening));
  }
  for (const lost of sequence.broken.until(frame)) {
    const [i, j] = run.ends_of(lost.bond), [a, b] = scene.ends_of_bond(lost.bond), normal = b.clone().sub(a).normalize();
    const from_end = Math.min(sequence.broken.half_length(lost), 0.5 * a.distanceTo(b)), radius = scene.face_radius([i, j]);
    for (const [end, centre] of [[i, a.addScaledVector(normal, from_end)], [j, b.addScaledVector(normal, -from_end)]]) {
      if (!scene.is_gone(end)) take("bond", lost.bond, Math.min(disc_hit(eye, way, centre, normal, radius), edge_hit(eye, way, centre, normal, radius, widening)));
    }
  }
  return best;
}

function particle_numbers(run, sequence, frame, k) {
  const at = [0, 1, 2].map((c) => sequence.json.origin[c] + sequence.reference[3 * k + c] + sequence.displacement(frame, k, c));
  return [["Place x, y, z", at.map((x) => number(x, 6)).join(", ") + (run.length_unit && ` ${run.length_unit}`)],
          ["Radius", with_unit(run.radius[k], run.length_unit)]];
}

/**
 * Name and numbers of what was picked, in the frame: [title, [[label, text], ...]].
 * @returns {[string, string[][]]}
 */
export function numbers_of(run, sequence, frame, { kind, number: k }) {
  const words = ({ value, classes, unit, on }) => (classes && on === "bonds" ? classes[value(frame, k)] : with_unit(value(frame, k), unit, 3));
  const all = sequence.quantities.filter((q) => q.on === `${kind}s`).map((q) => [q.label, words(q)]);
  if (kind === "particle") return [`Particle ${k}`, [...particle_numbers(run, sequence, frame, k), ...(run.holds_in(sequence, frame)?.words(k) ?? []), ...all]];
  const title = `Bond ${k}, of particles ${run.ends_of(k).join(" and ")}`;
  if (k >= sequence.bonds_at(frame)) return [title, [["State", "not made yet"]]];
  const cause = sequence.broken.cause(frame, k);
  return [title, cause ? [["State", `broken by ${causes[cause]}`]] : all];
}

/** A box with them; `closed` is called by its button. `sentence`: more to say, or nothing. */
export function numbers_box([title, numbers], sentence, closed) {
  return element("div", { class: "picked", role: "status" },
    element("header", {}, element("h3", {}, title), element("button", { type: "button", "aria-label": "Close the numbers", onclick: closed }, "×")),
    element("dl", {}, ...numbers.map(([label, text]) => element("div", {}, element("dt", {}, label), element("dd", {}, text)))),
    sentence ? element("p", { class: "note" }, sentence) : null);
}
