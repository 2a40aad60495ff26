// SPDX-License-Identifier: Apache-2.0
// One shader program draws all views. Edges are drawn from the barycentric coordinates of each
// triangle, so that they cannot flicker against the surface. Places are interpolated inside their
// triangles (centroid), so that no pixel of a removed part remains.

export const VERTEX = `
precision highp float;
in vec3 position;
in vec4 normal;
in vec4 corners;  // palette entries of the triangle's three corners
uniform mat4 modelViewMatrix;
uniform mat4 projectionMatrix;
uniform mat3 normalMatrix;
centroid out vec3 vPlace;
out vec3 vPixel;  // the same at the centre of the pixel, for differences between pixels
out vec3 vNormal;
out vec3 vWeight;
flat out vec3 vCorners;

void main() {
  int corner = gl_VertexID % 3;
  vWeight = vec3(corner == 0, corner == 1, corner == 2);
  vCorners = corners.xyz;
  vPlace = position;
  vPixel = position;
  vNormal = normalMatrix * normal.xyz;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

export const FRAGMENT = `
precision highp float;
centroid in vec3 vPlace;
in vec3 vPixel;
in vec3 vNormal;
in vec3 vWeight;
flat in vec3 vCorners;
uniform int mode;            // 0 plain, 1 blended between corners, 2 of the nearest corner
uniform sampler2D palette;
uniform vec3 cutAt;
uniform vec3 cutSide;        // 1: keep the side below; -1: keep the side above; 0: not cut
uniform bool facesInward;    // the mesh as a whole faces inward
uniform bool solid;          // closed and not cut: the inside is not visible
uniform float linesFrom;     // lines are drawn right of this pixel; left of it, shaded surface
uniform float pixelRatio;
uniform vec3 clay, inside, paper, paperInside, ink, section;
out vec4 result;

vec3 linear(vec3 c) { return pow(c, vec3(2.2)); }

vec3 coloured() {
  float at = dot(vCorners, vWeight);
  if (mode == 2) {
    vec3 w = vWeight;
    at = w.x >= w.y && w.x >= w.z ? vCorners.x : (w.y >= w.z ? vCorners.y : vCorners.z);
  }
  return texelFetch(palette, ivec2(clamp(int(at * 255.0 + 0.5), 0, 255), 0), 0).rgb;
}

vec3 shaded(vec3 albedo, vec3 n) {
  // Lights fixed to the camera: sky, a warm light from above left, a cool one from the right, and a
  // rim light from behind.
  vec3 light = mix(vec3(0.26, 0.24, 0.235), vec3(0.40, 0.42, 0.44), n.y * 0.5 + 0.5);
  light += vec3(0.78, 0.76, 0.72) * max(dot(n, normalize(vec3(-0.5, 0.62, 0.7))), 0.0);
  light += vec3(0.13, 0.15, 0.18) * max(dot(n, normalize(vec3(0.85, -0.1, 0.5))), 0.0);
  float edge = 1.0 - clamp(n.z, 0.0, 1.0);
  light += vec3(0.30, 0.31, 0.33) * edge * edge * edge * max(n.y * 0.6 + 0.4, 0.0);
  float gloss = pow(max(dot(n, normalize(vec3(-0.27, 0.34, 0.9))), 0.0), 48.0);
  return pow(clamp(linear(albedo) * light + 0.045 * gloss, 0.0, 1.0), vec3(1.0 / 2.2));
}

void main() {
  vec3 fromCut = cutSide * (cutAt - vPlace);
  vec3 perPixel = fwidth(vPixel);
  vec3 across = dFdx(vWeight);
  vec3 along = dFdy(vWeight);
  if (any(lessThan(fromCut, vec3(0.0)))) discard;

  bool front = solid || gl_FrontFacing != facesInward;
  bool lines = gl_FragCoord.x >= linesFrom;
  vec3 colour = mode == 0 || !front ? (front ? clay : inside) : coloured();
  if (lines) {
    vec3 background = front ? paper : paperInside;
    colour = mode == 0 || !front ? background : colour;
    // The triangles on both sides of an edge draw half of it each. Short edges are lighter, because
    // small triangles would be black otherwise. The length of an edge in pixels follows from the
    // area and the height, so that it is the same in both triangles.
    vec3 slope = sqrt(across * across + along * along);
    vec3 length = slope / max(abs(across.x * along.y - across.y * along.x), 1e-9);
    vec3 toSides = vWeight / max(slope, vec3(1e-9));
    vec3 near = 1.0 - smoothstep(0.2 * pixelRatio, 0.2 * pixelRatio + 0.7, toSides);
    near *= mix(vec3(0.3), vec3(front ? 1.0 : 0.5), smoothstep(2.0, 16.0, length / pixelRatio));
    // The colour scales are light in both themes.
    vec3 drawnWith = mode == 0 || !front ? ink : vec3(0.12, 0.14, 0.16);
    colour = mix(colour, drawnWith, max(near.x, max(near.y, near.z)));
  } else {
    vec3 n = normalize((solid ? !facesInward : gl_FrontFacing) ? vNormal : -vNormal);
    // An interpolated normal may point away from the viewer where the surface does not.
    if (!(n.z > 0.02)) n = normalize(vec3(n.xy, 0.02));
    colour = shaded(colour, n);
  }
  // The line of the cut.
  vec3 onCut = step(fromCut, 1.3 * pixelRatio * perPixel) * abs(cutSide);
  if (max(onCut.x, max(onCut.y, onCut.z)) > 0.0) colour = mix(colour, section, 0.85);
  result = vec4(colour, 1.0);
}`;

// Filled cuts (caps.ts): surfaces are counted beyond one plane, whatever their depth.
// @param place how positions are interpolated: "centroid", or "" at the centre of the pixel
export const countVertex = (place: string): string => `
precision highp float;
in vec3 position;
uniform mat4 modelViewMatrix;
uniform mat4 projectionMatrix;
${place} out vec3 vPlace;

void main() {
  vPlace = position;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  gl_Position.z = 0.0;  // never outside the near and far planes
}`;

export const countFragment = (place: string): string => `
precision highp float;
${place} in vec3 vPlace;
uniform vec3 cutAt;
uniform vec3 cutSide;
uniform vec3 axis;  // of the plane: 1 in one component
out vec4 result;

void main() {
  if (dot(axis, cutSide * (cutAt - vPlace)) < 0.0) discard;
  result = vec4(0.0);
}`;

export const CAP_VERTEX = `
precision highp float;
in vec3 position;
uniform mat4 modelViewMatrix;
uniform mat4 projectionMatrix;
uniform mat3 normalMatrix;
uniform vec3 axis;
centroid out vec3 vPlace;
flat out float vFacing;  // cosine of the angle between the plane's normal and the line of sight

void main() {
  vPlace = position;
  vFacing = abs((normalMatrix * axis).z);
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

export const CAP_FRAGMENT = `
precision highp float;
centroid in vec3 vPlace;
flat in float vFacing;
uniform vec3 cutAt;
uniform vec3 cutSide;
uniform vec3 axis;
uniform vec3 cap;
out vec4 result;

void main() {
  // Other cuts remove parts of this one.
  vec3 fromCut = (vec3(1.0) - axis) * cutSide * (cutAt - vPlace);
  if (any(lessThan(fromCut, vec3(0.0)))) discard;
  result = vec4(cap * mix(0.8, 1.0, vFacing), 1.0);
}`;
