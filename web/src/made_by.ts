// SPDX-License-Identifier: Apache-2.0
// How a result was made: the command and its parameters.
import {copyButton} from "./copying";
import type {Result} from "./data";
import {element, number, type Child} from "./dom";
import {row, section, table} from "./tables";

function value(of: unknown): string {
  if (of === null || of === undefined) return "–";
  if (typeof of === "string") return of;
  if (typeof of === "number") return number(of, 7);
  if (typeof of === "boolean") return of ? "yes" : "no";
  if (Array.isArray(of)) {
    if (of.length === 0) return "–";
    return of.every((x) => typeof x === "number")
      ? of
          .map((x) => number(x, 7))
          .join(" × ")
          .replaceAll(" × ", of.every((x) => Number.isInteger(x) && x > 0) ? " × " : ", ")
      : of.map(value).join("; ");
  }
  const {quantity, bound} = of as Record<string, unknown>;
  if (typeof quantity === "string") return `${quantity} ${value(bound)}`;
  return Object.entries(of).map(([key, inner]) => `${key} ${value(inner)}`).join(", ");
}

function made(result: Result): Child[] {
  const out: Child[] = [];
  if (result.command) {
    const code = element("code", {}, result.command);
    out.push(
      element("pre", {tabindex: "0", "aria-label": "Command", id: "command"}, code),
      copyButton(code),
    );
  } else {
    out.push(element("p", {class: "soft"}, "The file does not contain the command."));
  }
  const groups: HTMLElement[] = [];
  for (const [name, part] of [
    ["Input", result.input],
    ["Surface", result.surface],
    ["Parameters", result.parameters],
  ] as const) {
    const entries = Object.entries(part ?? {});
    if (entries.length > 0) {
      groups.push(
        table(
          {},
          name,
          ["Name", "Value"],
          entries.map(([key, of]) => row({}, key.replaceAll("_", " "), value(of))),
        ),
      );
    }
  }
  if (groups.length > 0) {
    out.push(
      element("details", {id: "parameters"}, element("summary", {}, "Parameters"), ...groups),
    );
  } else {
    out.push(element("p", {class: "soft"}, "The file does not contain the parameters."));
  }
  return out;
}

export function madeBy(result: Result): HTMLElement {
  return section("Made by", ...made(result));
}
