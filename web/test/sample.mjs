// Runs made up for tests, in the form that FORMAT.md describes:
//   node test/sample.mjs rod|ball|snapped|wide|breaking|touching|periodic|large TEMPLATE OUTPUT
import { readFile, writeFile } from "node:fs/promises";
import { pathToFileURL } from "node:url";
import { gzipSync } from "node:zlib";

/** The block under construction: puts arrays into it and returns what JSON says of them. */
export class Block {
  parts = [];
  size = 0;

  add(bytes) {
    const offset = this.size, room = (4 - (bytes.length % 4)) % 4;
    this.parts.push(bytes, new Uint8Array(room));
    this.size += bytes.length + room;
    return offset;
  }

  plain(type, values) {
    const typed = new (type === "u32" ? Uint32Array : Float32Array)(values);
    return { offset: this.add(new Uint8Array(typed.buffer)), type, count: typed.length };
  }

  /** Integers as they are stored: differences between frames, u16 in planes of bytes. */
  integers(type, q, frame) {
    const bits = type === "u16" ? 0xffff : 0xff;
    const coded = q.map((v, k) => (k >= frame ? (v - q[k - frame]) & bits : v));
    const low = Uint8Array.from(coded, (v) => v & 255);
    const bytes = type === "u16" ? Buffer.concat([low, Uint8Array.from(coded, (v) => v >> 8)]) : low;
    return { offset: this.add(bytes), type, count: q.length, delta: frame };
  }

  /** Whole numbers as they are. */
  kinds(type, q, frame) { return { ...this.integers(type, q, frame), low: 0, step: 1 }; }

  /** Values of one field, low and step over all frames. */
  field(values, frame) {
    let low = Infinity, high = -Infinity;
    for (const v of values) { low = Math.min(low, v); high = Math.max(high, v); }
    const step = (high - low) / 255;
    const q = Array.from(values, (v) => (step ? Math.round((v - low) / step) : 0));
    return { ...this.integers("u8", q, frame), low, step };
  }

  /** values[frame][component][particle], low and step for each component. */
  displacement(values, particles, frames) {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    const component = (k) => Math.floor(k / particles) % 3;
    values.forEach((v, k) => { const c = component(k); low[c] = Math.min(low[c], v); high[c] = Math.max(high[c], v); });
    const step = low.map((l, c) => (high[c] - l) / 65535);
    const q = Array.from(values, (v, k) => { const c = component(k); return step[c] ? Math.round((v - low[c]) / step[c]) : 0; });
    return { ...this.integers("u16", q, 3 * particles), count: 3 * particles * frames, low, step };
  }

  base64() { return gzipSync(Buffer.concat(this.parts)).toString("base64"); }
}

/** The page of a run: template with JSON and block in place of its one line. */
export function page(template, json, base64) {
  const escapes = { "<": "\\u003c", ">": "\\u003e", "&": "\\u0026" };
  const text = JSON.stringify(json).replace(/[<>&]/g, (c) => escapes[c]);
  return template.replace("<!-- run -->", () =>
    `<script type="application/json" id="run">${text}</script>\n<script type="text/plain" id="data">${base64}</script>`);
}

const bond_fields = [["elongation", "Elongation of the bond, relative", "", true], ["bend", "Bend angle of the bond", "rad", false],
                     ["twist", "Twist of the bond", "rad", true], ["U_L", "Energy of stretching", "J", false],
                     ["U_B", "Energy of bending and shear", "J", false], ["U_T", "Energy of torsion", "J", false]];

/** A sequence from a function that moves particle k in frame f by [dx, dy, dz]. */
function sequence(block, { frames, points, bonds, bonds_at, move, ...about }) {
  const n = points.length, moved = new Float64Array(3 * n * frames);
  for (let f = 0; f < frames; ++f) {
    for (let k = 0; k < n; ++k) move(f, k).forEach((d, c) => { moved[(3 * f + c) * n + k] = d; });
  }
  const at = (f, k, c) => points[k][c] + moved[(3 * f + c) * n + k];
  const values = (of) => {
    const out = new Float64Array(frames * bonds.length);
    for (let f = 0; f < frames; ++f) bonds.forEach((ends, b) => { out[f * bonds.length + b] = b < bonds_at(f) ? of(f, ...ends, b) : 0; });
    return out;
  };
  const stretch = values((f, i, j) => Math.hypot(...[0, 1, 2].map((c) => at(f, j, c) - at(f, i, c)))
                                      / Math.hypot(...[0, 1, 2].map((c) => points[j][c] - points[i][c])) - 1);
  const turn = values((f, i, j) => 6 * Math.abs(at(f, j, 2) - at(f, i, 2) - points[j][2] + points[i][2]));
  const by_key = { elongation: stretch, bend: turn, twist: stretch.map((s, k) => 3 * s - turn[k] / 9), U_L: stretch.map((s) => s * s),
                   U_B: turn.map((t) => 0.01 * t * t), U_T: turn.map((t) => 0.001 * t * t) };
  return {
    kind: "run", name: "Run", note: "", loop: false, origin: [0, 0, 0], ...about,
    frames: Array.from({ length: frames }, (_, f) => ({ step: 100 * f, time: 0.5 * f, stage: f < frames / 2 ? "push" : "hold", bonds: bonds_at(f) })),
    reference: block.plain("f32", points.flat()),
    displacement: block.displacement(moved, n, frames),
    particle_fields: [{ key: "speed", label: "Speed", unit: "m/s",
                        array: block.field(Float64Array.from({ length: frames * n }, (_, k) => Math.abs(moved[3 * n * Math.floor(k / n) + 2 * n + (k % n)])), n) }],
    bond_fields: bond_fields.map(([key, label, unit, signed]) => ({ key, label, unit, signed, array: block.field(by_key[key], bonds.length) })),
    bond_range: { ...block.integers("u8", Array.from(turn, (t) => (t > 1.5 ? 2 : t > 0.75 ? 1 : 0)), bonds.length), low: 0, step: 1 },
  };
}

/** Rows every ten steps. Shortening comes back, so that it does not ascend with time. */
function history(frames) {
  const names = [["step", ""], ["time", "s"], ["kinetic_translation", "J"], ["kinetic_rotation", "J"], ["U_L", "J"], ["U_B", "J"], ["U_T", "J"],
                 ["contact", "J"], ["dissipated", "J"], ["total", "J"], ["balance_error", ""], ["displacement.9.x", "m"], ["axial_force.rod", "N"]];
  const rows = Array.from({ length: 10 * frames - 9 }, (_, r) => {
    const t = r / (10 * frames - 10), bent = Math.sin(Math.PI * t) ** 2;
    const parts = [1e-4 * t * Math.exp(-3 * t), 2e-5 * bent, 3e-4 * t, 8e-4 * bent, 5e-5 * bent, 0, 2e-4 * t * t];
    const total = parts.slice(0, 6).reduce((a, b) => a + b);
    return [10 * r, 0.05 * r, ...parts, total, r ? 1e-9 * Math.sin(40 * t) * t : null, -0.4 * Math.sin(Math.PI * t), -3e-4 * Math.tanh(9 * bent) * (1 - 0.3 * t)];
  });
  return { columns: names.map(([name, unit]) => ({ name, unit })), rows_in_file: 12345, values: names.map((_, c) => rows.map((row) => row[c])) };
}

function json(block, base, sequences, bonds, radius, frames) {
  return { format: 1, program: "vbond 0.0.0", units: "SI", radius, bonds: block.plain("u32", bonds.flat()), sequences,
           facts: [["Specimen", `${base.particles} particles, ${bonds.length} bonds`], ["Law", "V-model"], ["Time step", "0.01 s, 12 % of the critical step"]],
           results: [["Critical force of stage \"push\"", "3.078e-4 N"], ["Largest error of the energy balance", "1e-9"]], warnings: [],
           rerun: { command: "vbond run resolved.toml", case: "title = \"sample\"\n[[specimen]]\nkind = \"rod\"\n" },
           left_out: ["Displacements are rounded to 1/65535 of their range, colours to 1/255."],
           history: history(frames), plots: [{ title: "Force against shortening", x: "displacement.9.x", y: ["axial_force.rod"] }], ...base };
}

/** `about`: other JSON; `packed(block)`: more of it, with arrays in the block. */
export function rod(about = {}, packed = () => ({})) {
  const block = new Block(), n = 10, frames = 60;
  const points = Array.from({ length: n }, (_, k) => [k, 0, 0]);
  const bonds = points.slice(1).map((_, k) => [k, k + 1]);
  const bend = (f, k) => { const t = f / (frames - 1); return [-0.8 * t * t * k / 9, 0, 2.2 * t * Math.sin((Math.PI * k) / 9)]; };
  const swing = (f, k) => [0, 0, Math.sin((2 * Math.PI * f) / 40) * Math.sin((2 * Math.PI * k) / 9)];
  const all = { points, bonds, bonds_at: () => 9 };
  const sequences = [sequence(block, { ...all, frames, move: bend, bonds_at: (f) => (f < 10 ? 8 : 9) }),
                     sequence(block, { ...all, frames: 40, move: swing, kind: "mode", loop: true, name: "Buckling mode 1 of stage \"critical\"",
                                       note: "critical force 3.078e-4 N" })];
  return { json: json(block, { title: "A rod that bends", particles: n, ...about, ...packed(block) }, sequences, bonds, 0.45, frames), base64: block.base64() };
}

/** The rod with supports and loads in its first stage, "push". */
export function held() {
  return rod({}, (block) => ({ stages: [{ name: "push", held: block.plain("u32", [0, 9]), how: block.plain("u32", [63, 6]), loaded: block.plain("u32", [9, 4]),
                                          loads: block.plain("f32", [-2, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0.5, 0]) }] }));
}

/** The rod again, with all that must warn, and markup in every text. */
export function snapped() {
  const markup = "<script>document.title='run'</script><img src=x onerror=\"document.title='run'\">&lt;b&gt;";
  return rod({ title: `Rod ${markup}`, facts: [[markup, markup]], results: [[markup, markup]], left_out: [markup],
               warnings: [{ level: "error", text: "3 of 9 bonds have snapped: they turned past 90 degrees and are drawn to a wrong rest state. Results after step 4100 are not to be trusted." },
                          { level: "warning", text: `The time step is 95 % of the critical step ${markup}` }],
               rerun: { command: "vbond run resolved.toml", case: `# ${markup}\n` } });
}

/** The rod with energies over 25 decades. */
export function wide() {
  const made = rod(), { columns, values } = made.json.history;
  const at = (name) => columns.findIndex((column) => column.name === name);
  values[at("U_L")] = values[0].map((_, k) => 1e-22 * 10 ** (25 * k / (values[0].length - 1)));
  values[at("U_B")].fill(1e-22);
  values[at("kinetic_rotation")].fill(0);
  return made;
}

const cause_of = (bond) => 1 + (bond % 4);

/**
 * A beam of 12 x 4 x 1 that parts in its middle, bond by bond from below: bond `lost[k]`, of the column of bonds there,
 * is gone from frame 10 + 5 k on. `about`: other JSON.
 */
export function breaking(about = {}) {
  const block = new Block(), [nx, ny] = [12, 4], n = nx * ny, frames = 40;
  const points = Array.from({ length: n }, (_, k) => [Math.floor(k / ny), k % ny, 0]);
  const bonds = near_pairs(points, 1.1), lost = bonds.flatMap(([i, j], b) => (points[i][0] === 5 && points[j][0] === 6 ? [b] : []));
  const gone = (f, b) => lost.includes(b) && f >= 10 + 5 * lost.indexOf(b);
  const parted = (f) => gone(f, lost.at(-1));
  const move = (f, k) => { const t = f / (frames - 1), right = k >= 6 * ny; return [(right ? 2 : -1) * t * t * (4 - (points[k][1])) / 4, -0.5 * t, 0]; };
  const made = sequence(block, { frames, points, bonds, bonds_at: () => bonds.length, move });
  const of_bonds = (value) => Float64Array.from({ length: frames * bonds.length }, (_, k) => value(Math.floor(k / bonds.length), k % bonds.length));
  const fields = [["utilisation", "utilisation of the strength", "", false, 1], ["axial_force", "axial force, tension is positive", "N", true, 200],
                  ["shear_force", "shear force", "N", false, 20], ["bending_moment", "bending moment at the middle", "N m", false, 3],
                  ["torque", "torque", "N m", true, -0.4]];
  for (const [key, label, unit, signed, size] of fields) {
    const values = of_bonds((f, b) => (gone(f, b) ? 0 : (size * (b + 1) * f) / (bonds.length * frames)));
    made.bond_fields.push({ key, label, unit, signed, array: block.field(values, bonds.length) });
  }
  made.bond_broken = block.kinds("u8", [...of_bonds((f, b) => (gone(f, b) ? cause_of(b) : 0))], bonds.length);
  made.fragment = block.kinds("u16", Array.from({ length: frames * n }, (_, k) => (parted(Math.floor(k / n)) && k % n >= 6 * ny ? 1 : 0)), n);
  const first = lost.map((bond, k) => ({ step: 1000 + 500 * k - 20, when: `t = ${0.5 * (10 + 5 * k) - 0.2} s`, bond, i: bonds[bond][0], j: bonds[bond][1], mode: cause_of(bond), energy: 0.01 * (k + 1),
                                         cause: `N/A + M_b r/J = 9 + 3.1 = 12.1 of 12 MPa, and ${k}` }));
  const json_of_run = json(block, { title: "A beam that parts", particles: n, ...about }, [made], bonds, 0.5, frames);
  const { columns, values } = json_of_run.history, broken = values[0].map((step) => lost.filter((_, k) => step >= 1000 + 500 * k - 40).length);
  columns.push({ name: "released", unit: "J" }, { name: "broken", unit: "" }, { name: "fragments", unit: "" }, { name: "largest_fragment", unit: "" });
  values.push(broken.map((count) => 0.005 * count * (count + 1)), broken, broken.map((count) => (count === lost.length ? 2 : 1)), broken.map(() => 1));
  return { json: { ...json_of_run, breaks: { count: 240, words: "240 bonds broke: 200 in tension, 40 in shear", first } }, base64: block.base64(), lost, bonds };
}

/** A sheet that repeats along x and y, is sheared, and drifts out of its cell by more than the cell is wide. */
export function periodic() {
  const block = new Block(), side = 5, frames = 20, n = side * side, points = [], bonds = [], images = [];
  for (let k = 0; k < n; ++k) points.push([k % side, Math.floor(k / side), 0]);
  for (const [x, y] of points) {
    bonds.push([y * side + x, y * side + ((x + 1) % side)], [y * side + x, ((y + 1) % side) * side + x]);
    images.push(x + 1 === side ? 1 : 0, 0, 0, 0, y + 1 === side ? 1 : 0, 0);
  }
  const shear = (f) => (0.5 * f) / (frames - 1), drift = (f) => (1.3 * side * f) / (frames - 1);
  const move = (f, k) => [drift(f) + shear(f) * points[k][1], 0, 0];
  const made = sequence(block, { frames, points, bonds, bonds_at: () => bonds.length, move });
  const cells = Array.from({ length: frames }, (_, f) => [side, 0, 0, shear(f) * side, side, 0, 0, 0, 1, -0.5, -0.5, 0]);
  made.cell = { edges: block.plain("f32", cells.flat()), periodic: [true, true, false] };
  const all = json(block, { title: "A sheet without an edge", particles: n }, [made], bonds, 0.3, frames);
  return { json: { ...all, bond_image: block.plain("f32", images) }, base64: block.base64() };
}

function near_pairs(points, distance) {
  const pairs = [];
  for (let i = 0; i < points.length; ++i) {
    for (let j = i + 1; j < points.length; ++j) {
      if (Math.hypot(...points[i].map((x, c) => x - points[j][c])) < distance) pairs.push([i, j]);
    }
  }
  return pairs;
}

/**
 * Four balls, a row of two above another. The first frame tells of no contacts, in the second nothing touches, in the third
 * the lower row is pressed twice as hard as the upper one, in the fourth ball 0 is pressed on a floor as well.
 */
export function touching() {
  const block = new Block(), points = [[0, 0, 0], [1, 0, 0], [0, 0, 2], [1, 0, 2]], frames = 4;
  const bonds = [[0, 1]], made = sequence(block, { frames, points, bonds, bonds_at: () => 1, move: (f) => [0, 0, 0.01 * f] });
  [null, [0, 0, 0, 0], [2, 0, 1, 1 / 255], [3, 1, 0, 4 / 255]].forEach((c, f) => {   // how many, with a wall, forces
    if (c) made.frames[f].contacts = { count: c[0], placed: c[1], low: c[2], step: c[3] };
  });
  const plain = (type, q) => ({ ...block.kinds(type, q, q.length) });
  made.contacts = { unit: "N", i: plain("u16", [0, 2, 0, 2, 0]), j: plain("u16", [1, 3, 1, 3, 0]), force: plain("u8", [255, 0, 255, 0, 51]),
                    shift: { ...plain("u8", [0, 0, 0, 0, 0, 10]), low: 0, step: -0.05 } };
  return { json: json(block, { title: "Balls that touch", particles: 4 }, [made], bonds, 0.5, frames), base64: block.base64() };
}

export function ball() {
  const block = new Block(), n = 458, frames = 60;
  const points = Array.from({ length: n }, (_, k) => {   // spiral of Fibonacci, radius 6
    const z = 1 - (2 * k + 1) / n, phi = k * Math.PI * (3 - Math.sqrt(5)), r = Math.sqrt(1 - z * z);
    return [6 * r * Math.cos(phi), 6 * r * Math.sin(phi), 6 * z];
  });
  const bonds = near_pairs(points, 1.25);
  const dent = (f, k) => {
    const [x, y, z] = points[k], t = f / (frames - 1), depth = 9 * t * Math.exp(-(x * x + y * y) / 9) * (z > 0 ? 1 : 0);
    return [0.05 * x * t, 0.05 * y * t, -depth];
  };
  const sequences = [sequence(block, { frames, points, bonds, bonds_at: () => bonds.length, move: dent })];
  return { json: json(block, { title: "A ball with a dent", particles: n }, sequences, bonds, block.plain("f32", new Array(n).fill(0.45)), frames), base64: block.base64() };
}

/** 20,000 particles in a lattice of 50 x 20 x 20, 100 frames. */
export function large() {
  const block = new Block(), [nx, ny, nz] = [50, 20, 20], frames = 100, points = [], bonds = [];
  const index = (i, j, k) => (i * ny + j) * nz + k;
  for (let i = 0; i < nx; ++i) {
    for (let j = 0; j < ny; ++j) {
      for (let k = 0; k < nz; ++k) {
        points.push([i, j, k]);
        if (i + 1 < nx) bonds.push([index(i, j, k), index(i + 1, j, k)]);
        if (j + 1 < ny) bonds.push([index(i, j, k), index(i, j + 1, k)]);
        if (k + 1 < nz) bonds.push([index(i, j, k), index(i, j, k + 1)]);
      }
    }
  }
  const move = (f, k) => {
    const [x, y] = points[k], t = f / (frames - 1);
    return [0.3 * Math.sin(0.2 * x + 3 * t), 0.4 * Math.sin(0.3 * y - 5 * t), 10 * t * (x / nx) ** 2 + 0.2 * Math.sin(x + y + 20 * t)];
  };
  const sequences = [sequence(block, { frames, points, bonds, bonds_at: () => bonds.length, move })];
  return { json: json(block, { title: "A large beam", particles: points.length }, sequences, bonds, 0.48, frames), base64: block.base64() };
}

export const samples = { rod, ball, snapped, wide, breaking, touching, periodic, large };

if (import.meta.url === pathToFileURL(process.argv[1] ?? "").href) {
  const [name, template, output] = process.argv.slice(2);
  const { json: run, base64 } = samples[name]();
  await writeFile(output, page(await readFile(template, "utf8"), run, base64));
}
