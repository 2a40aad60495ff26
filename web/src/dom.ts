// SPDX-License-Identifier: Apache-2.0
// Creates elements and formats numbers.
export type Child = Node | string;

export function element<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Record<string, string> = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const out = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) out.setAttribute(name, value);
  out.append(...children);
  return out;
}

export function drawn<K extends keyof SVGElementTagNameMap>(
  tag: K,
  attributes: Record<string, string | number> = {},
  ...children: Child[]
): SVGElementTagNameMap[K] {
  const out = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) out.setAttribute(name, `${value}`);
  out.append(...children);
  return out;
}

export const count = (n: number): string => n.toLocaleString("en");
export const number = (n: number, digits = 3): string => {
  const rounded = Number(n.toPrecision(digits));
  return Math.abs(rounded) >= 1e4 && Math.abs(rounded) < 1e15
    ? rounded.toLocaleString("en")
    : `${rounded}`;
};
export const percent = (share: number): string => `${share === 0 ? "0" : number(100 * share, 2)} %`;
export const plural = (n: number, one: string, many = `${one}s`): string =>
  `${count(n)} ${n === 1 ? one : many}`;

/** An object whose properties are computed when they are read. */
export function readOnly(getters: Record<string, () => unknown>): object {
  const properties = Object.entries(getters).map(([name, get]) => [name, {get, enumerable: true}]);
  return Object.freeze(Object.defineProperties({}, Object.fromEntries(properties)));
}
