// SPDX-License-Identifier: Apache-2.0
// Runs `isoatlas view` for the tests, and makes volumes whose isosurfaces are known.
//   ISOATLAS_TOOL=PATH        the tool
//   ISOATLAS_TEST_DATA=DIR    real volumes (default: ../shared/data beside the repository)
import {spawn} from "node:child_process";
import {closeSync, existsSync, openSync, readFileSync, writeSync} from "node:fs";
import {join, resolve} from "node:path";

import {repository} from "./modules.mjs";

export const tool = process.env.ISOATLAS_TOOL;
export const data = resolve(process.env.ISOATLAS_TEST_DATA ?? join(repository, "../shared/data"));

/** Options of a test that needs a real volume: skipped without it. */
export const needs = (...names) =>
  !tool
    ? {skip: "ISOATLAS_TOOL is not set"}
    : names.every((name) => existsSync(join(data, name)))
      ? {}
      : {skip: `${data} does not have ${names.join(" and ")}`};

/** Starts the server. @param words after `isoatlas view` */
export async function startView(...words) {
  const process = spawn(tool, ["view", ...words, "--no-browser"], {
    stdio: ["ignore", "pipe", "pipe"],
  });
  let output = "";
  const ended = new Promise((done) =>
    process.on("close", (code, signal) => done({code, signal, output})),
  );
  const address = await new Promise((done, failed) => {
    const read = (chunk) => {
      output += chunk;
      const found = output.match(/http:\/\/127\.0\.0\.1:\d+\/\S+/);
      if (found) done(found[0]);
    };
    process.stdout.on("data", read);
    process.stderr.on("data", read);
    void ended.then(() => failed(new Error(`isoatlas view has ended: ${output}`)));
  });
  return {
    address,
    ended,
    stop: () => {
      process.kill("SIGINT");
      return ended;
    },
    /** Memory in bytes. */
    memory: () =>
      1024 * Number(readFileSync(`/proc/${process.pid}/status`, "utf8").match(/VmRSS:\s+(\d+)/)[1]),
  };
}

/** Writes a .nrrd slice by slice. @param value of the sample index; @param header more lines */
export function writeVolume(path, size, type, value, header = []) {
  const make = {uint8: Uint8Array, float: Float32Array}[type];
  const file = openSync(path, "w");
  writeSync(
    file,
    ["NRRD0004", `type: ${type}`, "dimension: 3", `sizes: ${size.join(" ")}`, "encoding: raw",
      "endian: little", ...header, "", ""].join("\n"),
  );
  const slice = new make(size[0] * size[1]);
  for (let k = 0; k < size[2]; ++k) {
    for (let j = 0, at = 0; j < size[1]; ++j)
      for (let i = 0; i < size[0]; ++i) slice[at++] = value(i, j, k);
    writeSync(file, slice);
  }
  closeSync(file);
  return path;
}

