// Spheres and bonds are impostors: one quad each, the rest is done per pixel. Software GL draws
// them some 20 times faster than meshes, and a sphere stays round however near it is.
// FLAT gives all of a sphere one depth, so that what lies behind need not be shaded: for many particles,
// drawn from front to back. Spheres that overlap then do not cut each other as spheres do.

const light = `
const vec3 towards_light = normalize(vec3(-0.35, 0.55, 1.0));   // fixed to the viewer
vec3 lit(vec3 colour, vec3 normal) {
  return colour * (0.5 + 0.5 * max(dot(normal, towards_light), 0.0));
}`;

/** Tables: position (xyz) and radius (w) of particles, colours and widths, ends of bonds; one texel each. */
const tables = `
uniform highp sampler2D places, paints, ends;
#ifdef PERIODIC
uniform highp sampler2D shifts;   // from the second particle of a bond to the image of it that the bond joins
#endif
vec4 of(sampler2D table, int k) { int w = textureSize(table, 0).x; return texelFetch(table, ivec2(k % w, k / w), 0); }
uniform vec4 cut;   // a plane: what is centred beyond it is not drawn
bool is_gone(vec4 place) { return place.w < 0.0 || dot(cut.xyz, place.xyz) > cut.w; }
const vec4 nowhere = vec4(0.0, 0.0, 2.0, 1.0);   // outside of every picture
int number() { return gl_VertexID / 4; }
vec2 quad_corner() { int c = gl_VertexID % 4; return vec2(c == 1 || c == 2 ? 1.0 : -1.0, c >= 2 ? 1.0 : -1.0); }`;

export const sphere_vertex = `
precision highp float;
uniform mat4 viewMatrix, projectionMatrix;
uniform float size;
${tables}
out vec3 at;
out vec2 corner;
flat out vec3 centre, paint;
flat out float radius;
void main() {
  vec2 position = quad_corner();
  vec4 p = of(places, number());
  centre = (viewMatrix * vec4(p.xyz, 1.0)).xyz;
  radius = p.w * size;
  paint = of(paints, number()).rgb;
  float d = length(centre);
  vec3 forward = centre / d, right = normalize(cross(forward, vec3(0.0, 1.0, 0.0))), up = cross(right, forward);
  // The cone that touches the sphere, and some room for the smoothed edge. Nothing if the eye is inside.
  float reach = d > radius ? 1.04 * radius * d / sqrt(d * d - radius * radius) : 0.0;
  at = centre + reach * (position.x * right + position.y * up);
  gl_Position = projectionMatrix * vec4(at, 1.0);
#ifdef FLAT
  corner = 1.04 * position;
  vec4 front = projectionMatrix * vec4(centre * (1.0 - 0.9 * radius / d), 1.0);   // before its own bonds
  gl_Position.z = front.z / front.w * gl_Position.w;
#endif
  if (is_gone(p)) gl_Position = nowhere;
}`;

export const sphere_fragment = `
precision highp float;
uniform mat4 projectionMatrix;
uniform bool smooth_edge;
in vec3 at;
in vec2 corner;
flat in vec3 centre, paint;
flat in float radius;
out vec4 pixel;
${light}
#ifdef FLAT
void main() {
  float rest = 1.0 - dot(corner, corner);
  if (rest < 0.0) discard;
  pixel = vec4(lit(paint, vec3(corner, sqrt(rest))), 1.0);
}
#else
void main() {
  vec3 ray = normalize(at);
  float along = dot(ray, centre);
  vec3 beside = along * ray - centre;
  float inside = radius * radius - dot(beside, beside);
  float edge = smooth_edge ? clamp(inside / fwidth(inside) + 0.5, 0.0, 1.0) : step(0.0, inside);
  if (edge <= 0.0) discard;
  vec3 hit = (along - sqrt(max(inside, 0.0))) * ray;
  vec4 clip = projectionMatrix * vec4(hit, 1.0);
  gl_FragDepth = 0.5 * clip.z / clip.w + 0.5;
  pixel = vec4(lit(paint, (hit - centre) / radius), edge);
}
#endif`;

/** A ribbon from a to b, as the camera has them, that faces the viewer, shaded as a cylinder. */
const ribbon = `
out float across;
flat out vec3 side, front, paint;
vec4 ribbon(vec3 a, vec3 b, float half_width) {
  vec3 c = cross(b - a, a + b);
  side = c / max(length(c), 1e-30);   // seen end on it has no width; its particles hide it then
  front = normalize(cross(side, b - a));
  if (front.z < 0.0) front = -front;
  vec2 position = quad_corner();
  across = position.x;
  // Nearer by most of the radius, as the cylinder's surface is: else it and the rim of a sphere are at one depth.
  vec3 p = (position.y < 0.0 ? a : b) + half_width * (across * side + 0.8 * front);
  return projectionMatrix * vec4(p, 1.0);
}`;

/** Alpha of a bond's colour is its width over the largest. */
export const bond_vertex = `
precision highp float;
uniform mat4 viewMatrix, projectionMatrix;
uniform float widest;
${tables}
${ribbon}
void main() {
  vec3 ij = of(ends, number()).xyz;   // two particles, half width
  vec4 colour = of(paints, number());
  vec3 a = (viewMatrix * vec4(of(places, int(ij.x)).xyz, 1.0)).xyz;
  vec4 end = of(places, int(ij.y));
#ifdef PERIODIC
  end += vec4(of(shifts, number()).xyz, 0.0);
#endif
  vec3 b = (viewMatrix * vec4(end.xyz, 1.0)).xyz;
  paint = colour.rgb;
  gl_Position = ribbon(a, b, ij.z * widest * colour.a);
  if (is_gone(of(places, int(ij.x))) || is_gone(end)) gl_Position = nowhere;
}`;

/** The line of a contact: where it begins and its half width, and where it ends. */
export const contact_vertex = `
precision highp float;
uniform mat4 viewMatrix, projectionMatrix;
${tables}
${ribbon}
void main() {
  vec4 from = of(ends, 2 * number()), to = of(ends, 2 * number() + 1);
  paint = of(paints, number()).rgb;
  gl_Position = ribbon((viewMatrix * vec4(from.xyz, 1.0)).xyz, (viewMatrix * vec4(to.xyz, 1.0)).xyz, from.w);
}`;

export const bond_fragment = `
precision highp float;
in float across;
flat in vec3 side, front, paint;
out vec4 pixel;
${light}
void main() {
  pixel = vec4(lit(paint, across * side + sqrt(max(1.0 - across * across, 0.0)) * front), 1.0);
}`;

/**
 * A disc across the line of two particles that a broken bond held, at the distance from one of them that half the bond
 * had, or between both if they are nearer. Seen from its side it still has a width.
 */
export const face_vertex = `
precision highp float;
uniform mat4 viewMatrix, projectionMatrix;
const float thinnest = 0.15;   // of its radius
${tables}
out vec2 corner;
flat out vec3 normal, paint;
void main() {
  vec4 face = of(ends, number() / 2);   // two particles, half length, radius
  vec3 a = (viewMatrix * vec4(of(places, int(face.x)).xyz, 1.0)).xyz;
  vec4 end = of(places, int(face.y));
#ifdef PERIODIC
  end += vec4(of(shifts, number() / 2).xyz, 0.0);
#endif
  vec3 b = (viewMatrix * vec4(end.xyz, 1.0)).xyz;
  float apart = max(length(b - a), 1e-30), from_end = min(face.z, 0.5 * apart);
  normal = (b - a) / apart;
  vec3 centre = number() % 2 == 0 ? a + from_end * normal : b - from_end * normal;
  vec3 sight = normalize(centre), u = cross(normal, sight);
  u = length(u) > 1e-4 ? normalize(u) : normalize(cross(normal, abs(normal.x) < 0.7 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0)));
  float facing = dot(normal, sight);
  vec3 v = cross(normal, u), along = -sign(dot(v, sight) * facing + 1e-30) * normal;
  v += max(0.0, thinnest - abs(facing)) * along;
  if (facing > 0.0) normal = -normal;
  corner = quad_corner();
  paint = of(paints, number() / 2).rgb;
  gl_Position = projectionMatrix * vec4(centre + face.w * (corner.x * u + corner.y * v), 1.0);
  if (is_gone(number() % 2 == 0 ? of(places, int(face.x)) : end)) gl_Position = nowhere;
}`;

export const face_fragment = `
precision highp float;
in vec2 corner;
flat in vec3 normal, paint;
out vec4 pixel;
${light}
void main() {
  float inside = 1.0 - dot(corner, corner);
  if (inside <= 0.0) discard;
  pixel = vec4(lit(paint, normalize(normal + vec3(0.0, 0.0, 1.0))), 1.0);   // its colour must be told seen from its side, too
}`;
