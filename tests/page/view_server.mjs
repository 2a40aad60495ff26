// SPDX-License-Identifier: Apache-2.0
// A small server with the interface of `isoatlas view`, for tests of its page that need no tool:
// made-up volumes, and faults on request. Meshes are those of surface nets, not certified ones.
import {createServer} from "node:http";

import {html} from "./view_browser.mjs";

/** Samples of a function of the sample index. */
function sampled(size, value) {
  const samples = new Float32Array(size[0] * size[1] * size[2]);
  let at = 0;
  for (let k = 0; k < size[2]; ++k)
    for (let j = 0; j < size[1]; ++j)
      for (let i = 0; i < size[0]; ++i) samples[at++] = value(i, j, k);
  return samples;
}

/** What the page may do, as with the tool. */
const POLICY =
  "default-src 'none'; script-src 'unsafe-inline' 'wasm-unsafe-eval'; style-src 'unsafe-inline'; " +
  "img-src 'self' data: blob:; connect-src 'self'; base-uri 'none'; form-action 'none'";

const ball = (x, y, z, r) => (i, j, k) => r - Math.hypot(i - x, j - y, k - z);
const balls = (...all) => {
  const values = all.map((one) => ball(...one));
  return (i, j, k) => Math.max(...values.map((value) => value(i, j, k)));
};
const identity = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]];

/** Volumes whose isosurfaces are known. */
export const volumes = {
  /** The isosurface at v is a ball of radius 20 - v around (31.5, 23.5, 15.5). */
  ball: () => ({size: [64, 48, 40], value: ball(31.5, 23.5, 19.5, 20), isovalue: 6}),
  /** Two balls of radius 10 - v and 7 - v. */
  two: () => ({size: [60, 40, 40], isovalue: 2,
    value: balls([16, 20, 20, 10], [44, 20, 20, 7])}),
  /** Balls of radius 10 - v, 8 - v and 6 - v. */
  three: () => ({size: [66, 32, 32], isovalue: 2,
    value: balls([14, 16, 16, 10], [38, 16, 16, 8], [56, 16, 16, 6])}),
  /** Balls of radius 10 - v, 9 - v, 8 - v, 7 - v and 6 - v. */
  five: () => ({size: [70, 50, 32], isovalue: 2, value: balls([14, 14, 16, 10], [38, 14, 16, 9],
    [58, 14, 16, 8], [14, 38, 16, 7], [38, 38, 16, 6])}),
  /** A ball with NaN where i < 12. */
  nan: () => {
    const value = ball(16, 16, 16, 12);
    return {size: [33, 33, 33], isovalue: 4, value: (i, j, k) => (i < 12 ? NaN : value(i, j, k))};
  },
  /** Far from the origin, turned by 30 degrees about z, spacing 0.5 x 0.5 x 2, of a patient. */
  far: () => {
    const [c, s] = [Math.cos(Math.PI / 6), Math.sin(Math.PI / 6)];
    return {
      size: [60, 60, 20],
      value: (i, j, k) => 12 - Math.hypot((i - 30) / 2, (j - 30) / 2, 2 * (k - 10)),
      isovalue: 2,
      spacing: [0.5, 0.5, 2],
      unit: "mm",
      anatomical: true,
      index_to_world: [[0.5 * c, -0.5 * s, 0, 1e5], [0.5 * s, 0.5 * c, 0, -2e5], [0, 0, 2, 3e4]],
    };
  },
  /** Whole numbers. */
  bytes: () => ({size: [40, 40, 40], sample_type: "uint8", isovalue: 99.5,
    value: (i, j, k) => Math.max(0, Math.round(200 - 10 * Math.hypot(i - 20, j - 20, k - 20)))}),
};

function describe(name, {size, samples, ...given}) {
  const finite = samples.filter(Number.isFinite);
  const minimum = finite.reduce((a, b) => Math.min(a, b), Infinity);
  const maximum = finite.reduce((a, b) => Math.max(a, b), -Infinity);
  const integers = given.sample_type === "uint8";
  const width = integers ? 1 : (maximum - minimum) / 256;
  const counts = new Array(integers ? maximum - minimum + 1 : 256).fill(0);
  for (const v of finite)
    ++counts[Math.min(Math.floor((v - minimum) / width), counts.length - 1)];
  const {value: _, ...more} = given;
  return {
    schema: "isoatlas-view-1", version: "test", title: `${name}.nrrd`, path: `${name}.nrrd`, size,
    sample_type: "float32", samples_text: "", minimum, maximum,
    not_finite: samples.length - finite.length, spacing: [1, 1, 1], unit: "",
    index_to_world: identity, anatomical: false,
    histogram: {lowest: minimum, width, of_integers: integers, counts},
    suggested: [{isovalue: given.isovalue, reason: "splits the samples into two classes (Otsu)"}],
    inside: "above", roi: null, warnings: [],
    formats: ["ply", "stl", "3mf", "glb", "obj", "off", "vtp", "gii"],
    defaults: {"max-distance": "0.5vx"},
    ...more,
  };
}

function slice({size, samples}, axis, index) {
  const strides = [1, size[0], size[0] * size[1]];
  const [fast, slow] = [0, 1, 2].filter((a) => a !== axis);
  const out = new Float32Array(size[fast] * size[slow]);
  for (let b = 0, at = 0; b < size[slow]; ++b)
    for (let a = 0; a < size[fast]; ++a)
      out[at++] = samples[index * strides[axis] + a * strides[fast] + b * strides[slow]];
  return Buffer.from(out.buffer);
}

/** Surface nets: a vertex per grid cell with corners on both sides, a square per crossed edge. */
function surfaceNet({size, samples}, rule, ends) {
  const inside = (v) =>
    Number.isNaN(v)
      ? rule.nan === rule.inside
      : rule.inside === "above" ? v >= rule.isovalue : v <= rule.isovalue;
  const strides = [1, size[0], size[0] * size[1]];
  const at = (p) => p[0] + p[1] * strides[1] + p[2] * strides[2];
  const side = Uint8Array.from(samples, inside);
  const corners = Array.from({length: 8}, (_, bits) => at([bits & 1, (bits >> 1) & 1, bits >> 2]));
  const vertexOf = new Map();
  const positions = [];
  const triangles = [];
  const each = (last, visit) => {
    for (let k = ends[2][0]; k <= ends[2][1] - last; ++k)
      for (let j = ends[1][0]; j <= ends[1][1] - last; ++j)
        for (let i = ends[0][0]; i <= ends[0][1] - last; ++i) visit([i, j, k]);
  };
  each(1, (cell) => {
    const start = at(cell);
    if (corners.every((offset) => side[start + offset] === side[start])) return;
    const sum = [0, 0, 0];
    let crossings = 0;
    for (let axis = 0; axis < 3; ++axis) {
      for (let corner = 0; corner < 4; ++corner) {
        const p = [...cell];
        p[(axis + 1) % 3] += corner & 1;
        p[(axis + 2) % 3] += corner >> 1;
        const [a, b] = [samples[at(p)], samples[at(p) + strides[axis]]];
        if (inside(a) === inside(b)) continue;
        const t = (rule.isovalue - a) / (b - a);
        p[axis] += t >= 0 && t <= 1 ? t : 0.5;
        p.forEach((v, i) => (sum[i] += v));
        ++crossings;
      }
    }
    vertexOf.set(start, positions.length);
    positions.push(sum.map((v) => v / crossings));
  });
  each(0, (p) => {
    for (let axis = 0; axis < 3; ++axis) {
      if (p[axis] === ends[axis][1]) continue;
      const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
      const a = side[at(p)];
      if (a === side[at(p) + strides[axis]]) continue;
      const corner = (x, y) => vertexOf.get(at(p) - x * strides[u] - y * strides[v]);
      if (p[u] === ends[u][0] || p[v] === ends[v][0]) continue;
      const square = [corner(1, 1), corner(0, 1), corner(0, 0), corner(1, 0)];
      if (square.includes(undefined)) continue;
      const [c, d, e, f] = a ? square : [...square].reverse();
      triangles.push([c, d, e], [c, e, f]);
    }
  });
  return {positions, triangles};
}

/** Components of triangles, largest first. */
function componentsOf({positions, triangles}) {
  const parent = positions.map((_, v) => v);
  const root = (v) => (parent[v] === v ? v : (parent[v] = root(parent[v])));
  for (const [a, b, c] of triangles) (parent[root(a)] = root(b)), (parent[root(b)] = root(c));
  const parts = new Map();
  for (const triangle of triangles) {
    const r = root(triangle[0]);
    if (!parts.has(r)) parts.set(r, []);
    parts.get(r).push(triangle);
  }
  return [...parts.values()].sort((a, b) => b.length - a.length);
}

/** As --keep-components, --keep-near and --drop-near. */
function chosen(net, options) {
  const parts = componentsOf(net);
  const all = (name) => options.filter(([n]) => n === name).map(([, text]) => text);
  const nearest = (text) => {
    const to = text.split(",").map(Number);
    const distance = (part) =>
      Math.min(...part.flat().map((v) =>
        Math.hypot(...net.positions[v].map((x, i) => x - to[i]))));
    return parts.reduce((best, part) => (distance(part) < distance(best) ? part : best));
  };
  const keep = all("keep-near").map(nearest);
  const drop = all("drop-near").map(nearest);
  const most = Number(all("keep-components")[0] ?? Infinity);
  const kept = parts.filter((part, i) =>
    i < most && (keep.length === 0 || keep.includes(part)) && !drop.includes(part));
  return {kept, dropped: parts.filter((part) => !kept.includes(part))};
}

const valueOf = (options, name, otherwise) =>
  options.find(([n]) => n === name)?.[1] ?? otherwise;

function meshBytes(volume, world, options, reduction) {
  const rule = {
    isovalue: Number(valueOf(options, "iso")),
    inside: valueOf(options, "inside", "above"),
    nan: valueOf(options, "nan", "below"),
  };
  const roi = valueOf(options, "roi", ":,:,:").split(",").map((text, axis) => {
    const [first, last] = text.split(":");
    return [Number(first || 0), last ? Number(last) : volume.size[axis] - 1];
  });
  const net = surfaceNet(volume, rule, roi);
  if (net.triangles.length === 0) return null;
  net.positions = net.positions.map(([i, j, k]) =>
    world.map(([a, b, c, t]) => a * i + b * j + c * k + t));
  const {kept, dropped} = chosen(net, options);
  const triangles = kept.flat();
  const used = [...new Set(triangles.flat())];
  const numberOf = new Map(used.map((v, i) => [v, i]));
  const points = used.map((v) => net.positions[v]);
  const low = [0, 1, 2].map((a) => points.reduce((m, p) => Math.min(m, p[a]), Infinity));
  const high = [0, 1, 2].map((a) => points.reduce((m, p) => Math.max(m, p[a]), -Infinity));
  const centre = low.map((v, a) => (v + high[a]) / 2);
  const header = {
    vertices: points.length, triangles: triangles.length, centre,
    half: low.map((v, a) => (high[a] - v) / 2), unit: "mm", seconds: 0.01, reduction,
    isovalue: `${rule.isovalue}`,
    facts: {level: 0, vertices: points.length, triangles: triangles.length,
      components: kept.length, manifold: true, euler_characteristic: null, genus: null,
      boundary_loops: null, certificate: {passed: true, cells_checked: 1, arcs_checked: 1,
        triples_checked: 1, repair_sites: 0}},
    kept: kept.length, dropped: dropped.length,
    dropped_components: dropped.slice(0, 50).map((part) => ({
      size: part.length, position: net.positions[part[0][0]], triangles: null})),
  };
  let json = JSON.stringify(header);
  json += " ".repeat((4 - (Buffer.byteLength(json) % 4)) % 4);
  const head = Buffer.alloc(4);
  head.writeUInt32LE(Buffer.byteLength(json));
  const positions = Float32Array.from(points.flatMap((p) => p.map((v, a) => v - centre[a])));
  const corners = Uint32Array.from(triangles.flatMap((t) => t.map((v) => numberOf.get(v))));
  return Buffer.concat([head, Buffer.from(json), Buffer.from(positions.buffer),
    Buffer.from(corners.buffer)]);
}

/** Volumes with their samples, and what the page gets to know about them, by name. */
const made = new Map();

function madeVolume(name) {
  if (!made.has(name)) {
    const volume = volumes[name]();
    volume.samples = sampled(volume.size, volume.value);
    made.set(name, {volume, json: describe(name, volume)});
  }
  return made.get(name);
}

/**
 * Serves a volume.
 * @param faults what goes wrong or is slow; may be changed while it serves:
 *   delay       ms until a mesh is made
 *   preview     whether a mesh of a "reduced" volume comes first
 *   coarse      whether previews have only the largest component
 *   holds       whether final meshes and files wait until they are cancelled
 *   refuse      the error of each command and mesh
 *   lateSlices  ms until the next slices arrive
 *   late        ms until the next requests for a mesh arrive, the last one first
 *   violated    whether files violate a bound
 *   refusePages the error of each request for messages
 *   fail        the message with which each mesh fails
 * @returns address, the requests that were received, the number of meshes that were replaced before
 *          they were made, and what ends it
 */
export async function serveVolume(name, faults = {}) {
  const {volume, json} = madeVolume(name);
  const meshes = new Map();
  const files = new Map();
  const pages = new Set();
  const received = [];
  const counts = {replaced: 0};
  let lastId = 0;
  let current = null;
  const messages = [];
  const write = (page, id) => page.write(`id: ${id}\ndata: ${messages[id]}\n\n`);
  const send = (message) => {
    messages.push(JSON.stringify(message));
    for (const page of pages) write(page, messages.length - 1);
  };
  /** Breaks the connections of pages, which connect again after a moment. */
  const breakStreams = () => {
    for (const page of pages) page.destroy();
    pages.clear();
  };
  const sendMesh = (request, options, reduction, final) => {
    const used =
      reduction > 1 && faults.coarse ? [...options, ["keep-components", "1"]] : options;
    const bytes = meshBytes(volume, json.index_to_world, used, reduction);
    if (!bytes) {
      send({type: "failed", request, message: "no sample is inside"});
      return;
    }
    meshes.set(++lastId, bytes);
    for (const id of meshes.keys()) if (meshes.size > 4) meshes.delete(id);
    send({type: "mesh", request, id: lastId, reduction, final});
    if (current?.request === request) current.hasMesh = true;
  };
  const makeMesh = ({request, options}) => {
    clearTimeout(current?.timer);
    if (current && !current.hasMesh) ++counts.replaced;
    if (faults.fail) {
      send({type: "failed", request, message: faults.fail});
      return;
    }
    const finish = () => sendMesh(request, options, 1, true);
    current = {request, timer: setTimeout(() => {
      if (!faults.preview && !faults.holds) return finish();
      if (faults.preview) sendMesh(request, options, 2, false);
      send({type: "progress", request, stage: "certify", fraction: 0.4});
      if (!faults.holds) current.timer = setTimeout(finish, faults.delay ?? 0);
    }, faults.delay ?? 0)};
  };
  const commandOf = ({options, format}) =>
    ["isoatlas extract", json.path,
      ...options.flatMap(([n, v]) => [`--${n}`, ...(v === "" ? [] : [v])]),
      "-o", `${name}.${format}`].join(" ");
  const makeFile = (body) => {
    const {request, format} = body;
    send({type: "progress", request, stage: "refine", fraction: 0.5});
    if (faults.holds) return;
    files.set(++lastId, Buffer.from(commandOf(body)));
    const violated = faults.violated ? "; violated: max-distance" : "";
    send({type: "saved", request, id: lastId, name: `${name}.${format}`, bytes: 1234,
      satisfied: !faults.violated, summary: `  surface       as on the command line\n` +
        `  level 1       8,627 vertices, 17,146 triangles, max-distance 0.663362${violated}\n`});
  };
  const posts = {
    mesh: (body) => (setImmediate(makeMesh, body), {}),
    save: (body) => (setImmediate(makeFile, body), {}),
    cancel: ({request}) => {
      if (current?.request === request) clearTimeout(current.timer);
      setImmediate(send, {type: "cancelled", request});
      return {};
    },
    command: (body) => ({command: commandOf(body)}),
  };
  const server = createServer(async (request, response) => {
    const path = request.url.replace(/^\/token\//, "");
    const reply = (status, type, body) => {
      response.writeHead(status, {"Content-Type": type, "Cache-Control": "no-store",
        "Content-Security-Policy": POLICY});
      response.end(body);
    };
    const bytes = (body) => reply(200, "application/octet-stream", body);
    if (request.method === "POST") {
      const chunks = [];
      for await (const chunk of request) chunks.push(chunk);
      const body = JSON.parse(Buffer.concat(chunks).toString());
      const late = path === "mesh" ? faults.late?.pop() : 0;
      if (late) await new Promise((done) => setTimeout(done, late));
      received.push({path, ...body});
      const error = path === "cancel" ? null : faults.refuse;
      return reply(error ? 400 : 200, "application/json",
        JSON.stringify(error ? {error} : posts[path](body)));
    }
    if (path === "") return reply(200, "text/html; charset=utf-8", html());
    if (path === "volume") return reply(200, "application/json", JSON.stringify(json));
    if (path === "events" && faults.refusePages)
      return reply(503, "application/json", JSON.stringify({error: faults.refusePages}));
    if (path === "events") {
      response.writeHead(200, {"Content-Type": "text/event-stream"});
      response.write("retry: 300\n\n");
      const last = request.headers["last-event-id"];
      for (let id = Number(last) + 1; id < messages.length; ++id) write(response, id);
      pages.add(response);
      request.on("close", () => pages.delete(response));
      return;
    }
    const [kind, first, second] = path.split("/");
    if (kind === "slices" && faults.lateSlices)
      await new Promise((done) => setTimeout(done, faults.lateSlices));
    if (kind === "slices") return bytes(slice(volume, Number(first), Number(second)));
    if (kind === "meshes" && meshes.has(Number(first))) return bytes(meshes.get(Number(first)));
    if (kind === "files" && files.has(Number(first))) {
      response.setHeader("Content-Disposition", `attachment; filename="mesh"`);
      return bytes(files.get(Number(first)));
    }
    reply(404, "application/json", JSON.stringify({error: "there is no such file"}));
  });
  await new Promise((done) => server.listen(0, "127.0.0.1", done));
  const stop = () => {
    server.closeAllConnections();
    return new Promise((done) => server.close(done));
  };
  return {
    address: `http://127.0.0.1:${server.address().port}/token/`,
    volume: json,
    received,
    counts,
    faults,
    send,
    breakStreams,
    stop,
  };
}
