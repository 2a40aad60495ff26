// SPDX-License-Identifier: Apache-2.0
// Parts of the facts: sections, tables and check marks.
import {element, type Child} from "./dom";

export function table(
  attributes: Record<string, string>,
  caption: string,
  head: Child[],
  rows: HTMLTableRowElement[],
): HTMLElement {
  const out = element("table", attributes);
  if (caption) out.append(element("caption", {}, caption));
  out.append(
    element(
      "thead",
      {},
      element("tr", {}, ...head.map((text) => element("th", {scope: "col"}, text))),
    ),
    element("tbody", {}, ...rows),
  );
  return element("div", {class: "table"}, out);
}

export function row(
  attributes: Record<string, string>,
  first: Child | Child[],
  ...rest: Child[]
): HTMLTableRowElement {
  return element(
    "tr",
    attributes,
    element("th", {scope: "row"}, ...(Array.isArray(first) ? first : [first])),
    ...rest.map((cell) => element("td", {}, cell)),
  );
}

export const check = (good: boolean): HTMLElement =>
  element(
    "span",
    {class: good ? "good" : "bad", role: "img", "aria-label": good ? "yes" : "no"},
    good ? "✓" : "✗",
  );

export function section(title: string, ...children: Child[]): HTMLElement {
  return element("section", {"aria-label": title}, element("h2", {}, title), ...children);
}

/** Explanations of words, folded away. */
export function explained(words: [string, string][]): HTMLElement {
  return element(
    "details",
    {class: "explained"},
    element("summary", {}, "In plain words"),
    element(
      "dl",
      {},
      ...words.flatMap(([word, text]) => [element("dt", {}, word), element("dd", {}, text)]),
    ),
  );
}
