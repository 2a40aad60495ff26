// SPDX-License-Identifier: Apache-2.0
// The stages of the tool, which messages about the progress name.

/** What the tool does in each stage, for the user. */
const STAGES: Record<string, string> = {
  read: "reading",
  surface: "finding the surface",
  components: "choosing components",
  coarsen: "simplifying",
  cover: "placing vertices",
  certify: "certifying",
  mesh: "making triangles",
  check: "checking",
  refine: "refining",
  write: "writing the file",
};

/** What is being done, and the stage unless it is "". */
export function progressText(start: string, stage: string): string {
  return `${start}${stage ? `: ${STAGES[stage] ?? stage}` : ""} …`;
}
