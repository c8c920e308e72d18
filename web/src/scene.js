// The body in 3D. Draws only when asked to; knows nothing of time, playing or the page around it.
import { BufferAttribute, BufferGeometry, DataTexture, DoubleSide, DynamicDrawUsage, FloatType, GLSL3, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial,
         NearestFilter, PerspectiveCamera, Points, PointsMaterial, RawShaderMaterial, RGBAFormat, Scene, TOUCH, UnsignedByteType, Vector3, Vector4,
         WebGLRenderer } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { cause_colours } from "./palette.js";
import { in_edges } from "./cell.js";
import { Marks } from "./marks.js";
import { bond_fragment, bond_vertex, contact_vertex, face_fragment, face_vertex, sphere_fragment, sphere_vertex } from "./shaders.js";

const smooth_up_to = 5000;      // particles; with more, pixels are not doubled, edges not smoothed, spheres flat in depth
const texture_width = 1024;
export const widest_bond = 1.6; // over the usual width; colour.a = 1 stands for it
const widest_contact = 2.4;     // half width of the strongest contact, over the usual one of a bond

/**
 * `count` quads without attributes: a shader finds number and corner from gl_VertexID. The order of the indices is
 * the order of drawing. Not instances: software GL takes some 20 us for each of those, however small.
 */
function quads(count) {
  const geometry = new BufferGeometry();
  geometry.setIndex(new BufferAttribute(new Uint32Array(6 * count), 1).setUsage(DynamicDrawUsage));
  for (let k = 0; k < count; ++k) put_quad(geometry.index.array, k, k);
  return geometry;
}

function put_quad(indices, place, k) {
  const at = 6 * place, v = 4 * k;
  indices[at] = v; indices[at + 1] = v + 1; indices[at + 2] = v + 2;
  indices[at + 3] = v; indices[at + 4] = v + 2; indices[at + 5] = v + 3;
}

/** A texture as a table with four numbers for each entry; `array` is what to write to. */
function table(array_type, count) {
  const rows = Math.max(1, Math.ceil(count / texture_width)), array = new array_type(4 * texture_width * rows);
  const texture = new DataTexture(array, texture_width, rows, RGBAFormat,
                                  array_type === Float32Array ? FloatType : UnsignedByteType);
  texture.minFilter = texture.magFilter = NearestFilter;
  texture.needsUpdate = true;
  return { array, texture };
}

/** Usual half width of a bond, where it does not touch as a capsule: a quarter of the mean radius, but no less than 2 % of the mean length. */
function bond_width(run) {
  const n = run.ends.length / 2, sequence = run.sequences[0], r = sequence.reference, cell = sequence.cell?.at(0, 1);
  let length = 0;
  for (let b = 0; b < n; ++b) {
    const i = 3 * run.ends[2 * b], j = 3 * run.ends[2 * b + 1], [x, y, z] = sequence.to_image(b, cell);
    length += Math.hypot(r[j] - r[i] + x, r[j + 1] - r[i + 1] + y, r[j + 2] - r[i + 2] + z) / n;
  }
  const radius = run.radius.reduce((sum, x) => sum + x, 0) / run.radius.length;
  return Math.max(0.25 * radius, 0.02 * length);
}

const buckets = 2048;

/** Puts the numbers of the quads in ascending order of `key`, to 1/2048 of its range. */
function sort_by(geometry, count, key) {
  const keys = new Float32Array(count), starts = new Uint32Array(buckets + 1);
  let low = Infinity, high = -Infinity;
  for (let k = 0; k < count; ++k) {
    const v = (keys[k] = key(k));
    if (v < low) low = v;
    if (v > high) high = v;
  }
  const factor = high > low ? (buckets - 1) / (high - low) : 0;
  const bucket = (k) => Math.floor((keys[k] - low) * factor);
  for (let k = 0; k < count; ++k) ++starts[bucket(k) + 1];
  for (let b = 0; b < buckets; ++b) starts[b + 1] += starts[b];
  for (let k = 0; k < count; ++k) put_quad(geometry.index.array, starts[bucket(k)]++, k);
  geometry.index.needsUpdate = true;
}

export class BodyScene {
  /** Throws if there is no WebGL2. `drawn` is called after each picture. */
  constructor(canvas, run, drawn) {
    this.canvas = canvas;
    this.run = run;
    this.drawn = drawn;
    this.pictures = 0;
    this.wanted = false;
    this.cut = new Vector4();
    this.some_hidden = false;
    this.smooth = run.particles <= smooth_up_to;
    this.renderer = new WebGLRenderer({ canvas, antialias: this.smooth, alpha: false });   // opaque: smoothed edges leave alpha below 1
    this.renderer.sortObjects = false;   // spheres before bonds; and the quads have no positions to sort by
    this.camera = new PerspectiveCamera(28, 1, 0.1, 100);
    this.scene = new Scene();
    this.usual_width = bond_width(run);
    this.periodic = run.sequences.some(({ cell }) => cell);
    this.make_spheres();
    this.make_bonds();
    const most = Math.max(...run.sequences.map(({ broken }) => broken.list.length));
    if (most) this.make_faces(most);
    if (this.periodic) this.make_cell();
    const touching = run.sequences.find(({ contacts }) => contacts);
    if (touching) this.make_contacts(touching.contacts.most);
    const walled = run.sequences.find(({ walls }) => walls);
    if (walled) this.make_walls(walled.walls);
  }

  /** Triangles that the body is seen through; modes have none. */
  make_walls({ corners, triangles }) {
    const geometry = new BufferGeometry();
    geometry.setIndex(new BufferAttribute(triangles, 1));
    geometry.setAttribute("position", new BufferAttribute(new Float32Array(corners.length), 3).setUsage(DynamicDrawUsage));
    this.walls = new Mesh(geometry, new MeshBasicMaterial({ color: 0x8090a0, transparent: true, opacity: 0.25, depthWrite: false, side: DoubleSide }));
    this.walls.frustumCulled = false;
    this.scene.add(this.walls);
  }

  place_walls({ walls }, frame) {
    if (!this.walls) return;
    this.walls.visible = !!walls;
    if (!walls) return;
    const { position } = this.walls.geometry.attributes;
    walls.positions(frame, position.array);
    position.needsUpdate = true;
  }

  make_spheres() {
    this.places = table(Float32Array, this.run.particles);
    this.run.radius.forEach((radius, k) => { this.places.array[4 * k + 3] = radius; });
    this.sphere_colours = table(Uint8Array, this.run.particles);
    this.spheres = this.add(quads(this.run.particles), sphere_vertex, sphere_fragment,
      { size: { value: 1 }, smooth_edge: { value: this.smooth }, paints: { value: this.sphere_colours.texture } });
  }

  make_bonds() {
    const count = this.run.ends.length / 2, ends = table(Float32Array, count);
    this.bond_widths = new Float32Array(count);   // half of each
    for (let b = 0; b < count; ++b) {
      this.bond_widths[b] = this.run.bond_radius?.[b] || this.usual_width;
      ends.array.set([...this.run.ends_of(b), this.bond_widths[b], 0], 4 * b);
    }
    this.bond_colours = table(Uint8Array, count);
    if (this.periodic) this.bond_shifts = table(Float32Array, count);
    this.bonds = this.add(quads(count), bond_vertex, bond_fragment,
      { widest: { value: widest_bond }, ends: { value: ends.texture }, paints: { value: this.bond_colours.texture },
        ...(this.periodic && { shifts: { value: this.bond_shifts.texture } }) });
  }

  /** Lines along the edges of the cell of a periodic body. */
  make_cell() {
    const { cell } = this.run.sequences.find((sequence) => sequence.cell), geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(new Float32Array(cell.lines(cell.at(0, 1))), 3).setUsage(DynamicDrawUsage));
    this.cell = new LineSegments(geometry, new LineBasicMaterial({ color: 0x5f7f9f }));
    this.cell.frustumCulled = false;
    this.scene.add(this.cell);
  }

  /** The cell of the frame, particles in it if they are `wrapped`, and where bonds go to. */
  place_cell(sequence, frame, factor, wrapped) {
    this.images = null;   // that are shown in place of particles
    if (!this.periodic) return;
    const cell = sequence.cell?.at(frame, factor), { array } = this.bond_shifts;
    this.cell_now = cell;
    this.cell.visible = !!cell;
    if (cell) {
      const { position } = this.cell.geometry.attributes;
      position.array.set(sequence.cell.lines(cell));
      position.needsUpdate = true;
      if (wrapped) {
        this.images = sequence.cell.images(cell, this.places.array, this.run.particles, 4);
        sequence.cell.bring(cell, this.images, this.places.array, 4);
      }
    }
    for (let b = 0; b < this.bonds_shown; ++b) {
      const to_image = sequence.to_image(b, cell), between_shown = this.between_images(...this.run.ends_of(b));
      for (let c = 0; c < 3; ++c) array[4 * b + c] = to_image[c] + between_shown[c];
    }
    this.bond_shifts.texture.needsUpdate = true;
  }

  /** From the image of particle j that is shown to the one that goes with the image of particle i that is shown. */
  between_images(i, j) {
    if (!this.images) return [0, 0, 0];
    return in_edges(this.cell_now, [0, 1, 2].map((k) => this.images[3 * i + k] - this.images[3 * j + k]));
  }

  /** The two ends of the line of a bond. */
  ends_of_bond(b) {
    const shift = this.bond_shifts ? this.bond_shifts.array.slice(4 * b, 4 * b + 3) : [0, 0, 0];
    const [a, end] = this.run.ends_of(b).map((k) => new Vector3().fromArray(this.places.array, 4 * k));
    return [a, end.add(new Vector3(...shift))];
  }

  /** Two for each broken bond, one at each of its particles. */
  make_faces(count) {
    this.face_ends = table(Float32Array, count);
    this.face_colours = table(Uint8Array, count);
    if (this.periodic) this.face_shifts = table(Float32Array, count);
    this.faces = this.add(quads(2 * count), face_vertex, face_fragment,
      { ends: { value: this.face_ends.texture }, paints: { value: this.face_colours.texture },
        ...(this.periodic && { shifts: { value: this.face_shifts.texture } }) });
  }

  /** A face nearly fills the section between the particles. */
  face_radius([i, j]) { return 0.9 * Math.min(this.run.radius[i], this.run.radius[j]); }

  fill_faces({ broken }) {
    broken.list.forEach((lost, k) => {
      const ends = this.run.ends_of(lost.bond);
      this.face_ends.array.set([...ends, broken.half_length(lost), this.face_radius(ends)], 4 * k);
      this.face_colours.array.set([...cause_colours[lost.cause], 255], 4 * k);
    });
    this.face_ends.texture.needsUpdate = this.face_colours.texture.needsUpdate = true;
  }

  place_faces(sequence, frame) {
    if (!this.faces) return;
    if (this.faces_of !== sequence) this.fill_faces(this.faces_of = sequence);
    const count = sequence.broken.count(frame);
    if (this.face_shifts) {
      sequence.broken.until(frame).forEach(({ bond }, k) => this.face_shifts.array.set(this.bond_shifts.array.subarray(4 * bond, 4 * bond + 4), 4 * k));
      this.face_shifts.texture.needsUpdate = true;
    }
    this.faces.geometry.setDrawRange(0, 2 * 6 * count);
    this.faces.visible = count > 0;
  }

  /** A line for each contact; modes have none. */
  make_contacts(most) {
    this.contact_ends = table(Float32Array, 2 * most);
    this.contact_colours = table(Uint8Array, most);
    this.contacts = this.add(quads(most), contact_vertex, bond_fragment,
      { ends: { value: this.contact_ends.texture }, paints: { value: this.contact_colours.texture } });
  }

  /** The contacts of the frame, or none without `widest`: the force, and all beyond it, of the widest lines; alone: without faces. After place_body. */
  place_contacts({ contacts }, frame, widest, alone) {
    if (this.faces && alone) this.faces.visible = false;
    if (!this.contacts) return;
    this.contacts.visible = widest != null;
    if (!this.contacts.visible) return;
    const { array } = this.contact_ends, places = this.places.array, half_width = widest_contact * this.usual_width;
    for (let k = 0; k < contacts.count(frame); ++k) {
      const between = contacts.between(frame, k), moved = contacts.ends(frame, k), is_gone = between.some((p) => this.is_gone(p));
      const shift = [0, 0, 0, ...this.between_images(...between)];
      for (let c = 0; c < 6; ++c) array[8 * k + c + (c > 2 ? 1 : 0)] = places[4 * between[c > 2 ? 1 : 0] + (c % 3)] + (moved?.[c] ?? 0) + shift[c];
      array[8 * k + 3] = is_gone || !widest ? 0 : half_width * Math.min(1, Math.abs(contacts.force(frame, k)) / widest);
    }
    this.contact_ends.texture.needsUpdate = true;
    this.contacts.geometry.setDrawRange(0, 6 * contacts.count(frame));
  }

  add(geometry, vertexShader, fragmentShader, uniforms) {
    uniforms.places = { value: this.places.texture };
    uniforms.cut = { value: this.cut };
    const material = new RawShaderMaterial({ glslVersion: GLSL3, vertexShader, fragmentShader, uniforms, side: DoubleSide,
                                             alphaToCoverage: this.smooth, defines: { ...(!this.smooth && { FLAT: 1 }), ...(uniforms.shifts && { PERIODIC: 1 }) } });
    const mesh = new Mesh(geometry, material);
    mesh.frustumCulled = false;
    this.scene.add(mesh);
    return mesh;
  }

  set_ground(colour) {
    this.renderer.setClearColor(colour);
    this.request();
  }

  /** The undeformed body: its bonds as thin lines, of a body without bonds the centres. */
  place_ghost(sequence, shown) {
    if (!shown && !this.ghost) return;
    if (this.ghost_of !== sequence) {
      this.ghost?.removeFromParent();
      this.ghost?.geometry.dispose();
      this.ghost?.material.dispose();
      const geometry = new BufferGeometry(), look = { color: 0x808890, transparent: true, opacity: 0.55 };
      const through_faces = this.run.ends.length && this.run.bond_image;   // each bond then has two points of its own
      geometry.setAttribute("position", new BufferAttribute(through_faces ? this.reference_of_bonds(sequence) : sequence.reference, 3));
      if (this.run.ends.length && !through_faces) geometry.setIndex(new BufferAttribute(this.run.ends, 1));
      this.ghost = this.run.ends.length ? new LineSegments(geometry, new LineBasicMaterial(look))
        : new Points(geometry, new PointsMaterial({ ...look, size: 3, sizeAttenuation: false }));
      this.ghost.frustumCulled = false;
      this.scene.add(this.ghost);
      this.ghost_of = sequence;
    }
    this.ghost.visible = shown;
    if (this.run.ends.length) this.ghost.geometry.setDrawRange(0, 2 * this.bonds_shown);
  }

  /** Both ends of all bonds in the undeformed body. */
  reference_of_bonds(sequence) {
    const { ends } = this.run, { reference } = sequence, cell = sequence.cell?.at(0, 1), places = new Float32Array(3 * ends.length);
    ends.forEach((k, at) => {
      const to_image = at % 2 ? sequence.to_image((at - 1) / 2, cell) : [0, 0, 0];
      for (let c = 0; c < 3; ++c) places[3 * at + c] = reference[3 * k + c] + to_image[c];
    });
    return places;
  }

  /** Supports and loads of the frame's stage, if they are wanted. Returns which kinds there are. */
  place_marks(sequence, frame, wanted) {
    const holds = wanted ? this.run.holds_in(sequence, frame) : undefined;
    if (this.marks?.holds !== holds) {
      this.marks?.close();
      this.marks = holds && new Marks(holds, sequence.reference);
      if (holds) this.scene.add(...this.marks.objects);
    }
    const { array } = this.places;
    this.marks?.put((k) => new Vector3(array[4 * k], array[4 * k + 1], array[4 * k + 2]));
    return this.marks?.kinds ?? [];
  }

  /** Whether particle k is not there, or the plane of the cut takes it away. */
  is_gone(k) {
    const { array } = this.places, { x, y, z, w } = this.cut;
    return this.hidden?.(k) || x * array[4 * k] + y * array[4 * k + 1] + z * array[4 * k + 2] > w;
  }

  /**
   * Positions of the frame and how many bonds there are in it; what is beyond the plane `cut` is not drawn. `wrapped`:
   * particles of a periodic body stand in its cell.
   */
  place_body(sequence, frame, factor, cut, ghost, wrapped) {
    this.cut.fromArray(cut);
    sequence.positions(frame, factor, this.places.array, 4);
    this.hidden = sequence.there && ((k) => !sequence.is_there(frame, k));
    this.some_hidden ||= Boolean(sequence.there);   // in this sequence, or in one shown before
    if (this.some_hidden) this.run.radius.forEach((radius, k) => { this.places.array[4 * k + 3] = this.hidden?.(k) ? -1 : radius; });   // below 0: not drawn
    this.places.texture.needsUpdate = true;
    this.bonds_shown = sequence.bonds_at(frame);
    this.place_cell(sequence, frame, factor, wrapped);
    this.bonds.geometry.setDrawRange(0, 6 * this.bonds_shown);
    this.bonds.visible = this.bonds_shown > 0;
    this.place_faces(sequence, frame);
    this.place_walls(sequence, frame);
    this.place_ghost(sequence, ghost);
    this.request();
  }

  /** After the colour arrays were written. Spheres shrink to `size` so that bonds can be seen. */
  colours_changed(size) {
    this.sphere_colours.texture.needsUpdate = this.bond_colours.texture.needsUpdate = true;
    if (this.contacts) this.contact_colours.texture.needsUpdate = true;
    this.sphere_size = this.spheres.material.uniforms.size.value = size;
    this.request();
  }

  resize(width, height) {
    this.renderer.setPixelRatio(this.smooth ? Math.min(2, devicePixelRatio) : 1);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
  }

  /** Looks at the box {centre, half} with a sphere of `radius` about it from `direction` (towards the viewer) with `up` upwards, all of it in the picture. */
  look(box, direction, up) {
    const { centre, half, radius } = box, away = direction.clone().normalize();
    const right = new Vector3().crossVectors(up, away).normalize(), top = new Vector3().crossVectors(away, right);
    const extent = (v) => Math.min(radius, Math.abs(v.x) * half.x + Math.abs(v.y) * half.y + Math.abs(v.z) * half.z);
    const tangent = Math.tan((Math.PI / 360) * this.camera.fov);
    const distance = 1.12 * Math.max(extent(top) / tangent, extent(right) / (tangent * this.camera.aspect)) + extent(away);
    this.reach = half.length();
    this.camera.up.copy(up);
    this.camera.position.copy(centre).addScaledVector(away, distance);
    this.controls?.dispose();   // OrbitControls reads `up` when made, and only then
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.target.copy(centre);
    const held = (does) => (document.activeElement === this.canvas ? does : null);   // fingers scroll the page until the body is tapped
    this.controls.touches = { get ONE() { return held(TOUCH.ROTATE); }, get TWO() { return held(TOUCH.DOLLY_PAN); } };
    this.turned = false;   // by hand, since this look
    this.controls.addEventListener("start", () => { this.turned = true; });
    this.controls.addEventListener("change", () => this.request());
    this.controls.update();
    this.request();
  }

  /** Where the reader has turned and moved the body to. */
  camera_now() { return { position: this.camera.position.toArray(), target: this.controls.target.toArray() }; }

  /** After a look in the same direction of up. */
  restore({ position, target }) {
    this.camera.position.fromArray(position);
    this.controls.target.fromArray(target);
    this.controls.update();
    this.turned = true;
    this.request();
  }

  /** Nothing can be drawn any more. */
  close() {
    this.wanted = false;
    this.controls?.dispose();
    this.controls = null;
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }

  /** Front to back, so that hidden pixels are not shaded. */
  sort() {
    const { array } = this.places, { ends } = this.run, towards = this.camera.getWorldDirection(new Vector3());
    const depth = (k) => array[4 * k] * towards.x + array[4 * k + 1] * towards.y + array[4 * k + 2] * towards.z;
    sort_by(this.spheres.geometry, this.run.particles, depth);
    sort_by(this.bonds.geometry, this.bonds_shown, (b) => depth(ends[2 * b]) + depth(ends[2 * b + 1]));
  }

  request() {
    if (this.wanted) return;
    this.wanted = true;
    requestAnimationFrame(() => { if (this.wanted) this.draw(); });
  }

  draw() {
    this.wanted = false;
    if (!this.controls) return;
    const distance = this.camera.position.distanceTo(this.controls.target);
    this.camera.far = distance + 4 * this.reach;
    this.camera.near = Math.max(distance - 2 * this.reach, 0.002 * this.camera.far);
    this.camera.updateProjectionMatrix();
    if (!this.smooth) this.sort();
    this.renderer.render(this.scene, this.camera);
    ++this.pictures;
    this.drawn();
  }
}
