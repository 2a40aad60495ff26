// SPDX-License-Identifier: Apache-2.0
import {drawn} from "./dom";

function icon(...shapes: SVGElement[]): SVGElement {
  return drawn(
    "svg",
    {viewBox: "0 0 20 20", width: 20, height: 20, "aria-hidden": "true", class: "icon"},
    ...shapes,
  );
}

/** A half-filled circle: light and dark. */
export const halfMoon = (): SVGElement =>
  icon(
    drawn("circle", {cx: 10, cy: 10, r: 7.25}),
    drawn("path", {d: "M10 2.75a7.25 7.25 0 0 1 0 14.5z", class: "filled"}),
  );

/** The four corners of a screen. */
export const corners = (): SVGElement =>
  icon(drawn("path", {d: "M3 7V3h4M13 3h4v4M17 13v4h-4M7 17H3v-4"}));
