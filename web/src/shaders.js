// Spheres and bonds are impostors: one quad each, the rest is done per pixel. Software GL draws
// them some 20 times faster than meshes, and a sphere stays round however near it is.

const light = `
const vec3 towards_light = normalize(vec3(-0.35, 0.55, 1.0));   // fixed to the viewer
vec3 lit(vec3 colour, vec3 normal) {
  return colour * (0.5 + 0.5 * max(dot(normal, towards_light), 0.0));
}`;

/** Position (xyz) and radius (w) of a particle from the texture, one texel each. */
const place = `
uniform highp sampler2D places;
vec4 place(int k) { int w = textureSize(places, 0).x; return texelFetch(places, ivec2(k % w, k / w), 0); }`;

export const sphere_vertex = `
precision highp float;
uniform mat4 viewMatrix, projectionMatrix;
uniform float size;
${place}
in vec3 position;
in vec4 colour;
out vec3 at;
flat out vec3 centre, paint;
flat out float radius;
void main() {
  vec4 p = place(gl_InstanceID);
  centre = (viewMatrix * vec4(p.xyz, 1.0)).xyz;
  radius = p.w * size;
  paint = colour.rgb;
  float d = length(centre);
  vec3 forward = centre / d, right = normalize(cross(forward, vec3(0.0, 1.0, 0.0))), up = cross(right, forward);
  // The cone that touches the sphere, and some room for the smoothed edge. Nothing if the eye is inside.
  float reach = d > radius ? 1.04 * radius * d / sqrt(d * d - radius * radius) : 0.0;
  at = centre + reach * (position.x * right + position.y * up);
  gl_Position = projectionMatrix * vec4(at, 1.0);
}`;

export const sphere_fragment = `
precision highp float;
uniform mat4 projectionMatrix;
uniform bool smooth_edge;
in vec3 at;
flat in vec3 centre, paint;
flat in float radius;
out vec4 pixel;
${light}
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
}`;

/** A ribbon that faces the viewer, shaded as a cylinder. colour.a is its width over the largest. */
export const bond_vertex = `
precision highp float;
uniform mat4 viewMatrix, projectionMatrix;
uniform float width;
${place}
in vec3 position;
in vec2 ends;
in vec4 colour;
out float across;
flat out vec3 side, front, paint;
void main() {
  vec3 a = (viewMatrix * vec4(place(int(ends.x)).xyz, 1.0)).xyz;
  vec3 b = (viewMatrix * vec4(place(int(ends.y)).xyz, 1.0)).xyz;
  vec3 c = cross(b - a, a + b);
  side = c / max(length(c), 1e-30);   // seen end on it has no width; its particles hide it then
  front = normalize(cross(side, b - a));
  if (front.z < 0.0) front = -front;
  across = position.x;
  paint = colour.rgb;
  // Nearer by most of the radius, as the cylinder's surface is: else it and the rim of a sphere are at one depth.
  vec3 p = mix(a, b, position.y) + width * colour.a * (across * side + 0.8 * front);
  gl_Position = projectionMatrix * vec4(p, 1.0);
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
