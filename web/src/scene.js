// The body in 3D. Draws only when asked to; knows nothing of time, playing or the page around it.
import { BufferAttribute, DataTexture, DynamicDrawUsage, FloatType, GLSL3, InstancedBufferAttribute, InstancedBufferGeometry, Mesh,
         NearestFilter, PerspectiveCamera, RawShaderMaterial, RGBAFormat, Scene, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { bond_fragment, bond_vertex, sphere_fragment, sphere_vertex } from "./shaders.js";

const smooth_up_to = 5000;      // particles; with more, edges are not smoothed and pixels not doubled
const texture_width = 1024;
export const widest_bond = 1.6; // over the usual width; colour.a = 1 stands for it

function quads(corners, attributes) {
  const geometry = new InstancedBufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(corners), 3));
  geometry.setIndex([0, 1, 2, 0, 2, 3]);
  for (const [name, attribute] of Object.entries(attributes)) geometry.setAttribute(name, attribute);
  return geometry;
}

function colours(count) {
  return new InstancedBufferAttribute(new Uint8Array(4 * count), 4, true).setUsage(DynamicDrawUsage);
}

/** Usual half width of a bond: a quarter of the mean radius, but no less than 2 % of the mean length. */
function bond_width(run) {
  const n = run.ends.length / 2, r = run.sequences[0].reference;
  let length = 0;
  for (let b = 0; b < n; ++b) {
    const i = 3 * run.ends[2 * b], j = 3 * run.ends[2 * b + 1];
    length += Math.hypot(r[j] - r[i], r[j + 1] - r[i + 1], r[j + 2] - r[i + 2]) / n;
  }
  const radius = run.radius.reduce((sum, x) => sum + x, 0) / run.radius.length;
  return Math.max(0.25 * radius, 0.02 * length);
}

export class BodyScene {
  /** Throws if there is no WebGL2. `drawn` is called after each picture. */
  constructor(canvas, run, drawn) {
    Object.assign(this, { canvas, run, drawn, pictures: 0, wanted: false });
    this.smooth = run.particles <= smooth_up_to;
    this.renderer = new WebGLRenderer({ canvas, antialias: this.smooth, alpha: true });
    this.camera = new PerspectiveCamera(28, 1, 0.1, 100);
    this.scene = new Scene();
    this.make_spheres();
    this.make_bonds();
  }

  make_spheres() {
    const rows = Math.max(1, Math.ceil(this.run.particles / texture_width));
    this.place = new Float32Array(4 * texture_width * rows);
    this.run.radius.forEach((radius, k) => { this.place[4 * k + 3] = radius; });
    this.places = new DataTexture(this.place, texture_width, rows, RGBAFormat, FloatType);
    this.places.minFilter = this.places.magFilter = NearestFilter;
    this.sphere_colours = colours(this.run.particles);
    const geometry = quads([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0], { colour: this.sphere_colours });
    geometry.instanceCount = this.run.particles;
    this.spheres = this.add(geometry, sphere_vertex, sphere_fragment, { size: { value: 1 }, smooth_edge: { value: this.smooth } });
  }

  make_bonds() {
    this.bond_colours = colours(this.run.ends.length / 2);
    const ends = new InstancedBufferAttribute(new Float32Array(this.run.ends), 2);   // exact below 2^24 particles
    const geometry = quads([-1, 0, 0, 1, 0, 0, 1, 1, 0, -1, 1, 0], { ends, colour: this.bond_colours });
    this.bonds = this.add(geometry, bond_vertex, bond_fragment, { width: { value: widest_bond * bond_width(this.run) } });
  }

  add(geometry, vertexShader, fragmentShader, uniforms) {
    uniforms.places = { value: this.places };
    const material = new RawShaderMaterial({ glslVersion: GLSL3, vertexShader, fragmentShader, uniforms, side: 2,
                                             alphaToCoverage: this.smooth });
    const mesh = new Mesh(geometry, material);
    mesh.frustumCulled = false;
    this.scene.add(mesh);
    return mesh;
  }

  /** Positions of the frame and how many bonds there are in it. */
  place_body(sequence, frame, factor) {
    sequence.positions(frame, factor, this.place, 4);
    this.places.needsUpdate = true;
    this.bonds.geometry.instanceCount = sequence.bonds_at(frame);
    this.bonds.visible = sequence.bonds_at(frame) > 0;
    this.request();
  }

  /** After the colour arrays were written. Spheres shrink to `size` so that bonds can be seen. */
  colours_changed(size) {
    this.sphere_colours.needsUpdate = this.bond_colours.needsUpdate = true;
    this.spheres.material.uniforms.size.value = size;
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
    this.turned = false;   // by hand, since this look
    this.controls.addEventListener("start", () => { this.turned = true; });
    this.controls.addEventListener("change", () => this.request());
    this.controls.update();
    this.request();
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
    this.renderer.render(this.scene, this.camera);
    ++this.pictures;
    this.drawn();
  }
}
