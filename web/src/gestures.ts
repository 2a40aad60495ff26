// SPDX-License-Identifier: Apache-2.0
// Mouse and touch on the picture. One pointer rotates; two pointers, the right or middle button, or
// Shift pan; wheel and pinch zoom.
import type {Camera} from "./camera";

interface Point {
  x: number;
  y: number;
}

const middle = ([a, b]: Point[]): Point => ({x: (a.x + b.x) / 2, y: (a.y + b.y) / 2});
const apart = ([a, b]: Point[]): number => Math.max(Math.hypot(a.x - b.x, a.y - b.y), 1);

export function listen(canvas: HTMLCanvasElement, camera: Camera): void {
  const down = new Map<number, Point>();
  let pans = false;

  const at = (event: MouseEvent): Point => {
    const box = canvas.getBoundingClientRect();
    return {x: event.clientX - box.left, y: event.clientY - box.top};
  };

  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    down.set(event.pointerId, at(event));
    pans = event.button !== 0 || event.shiftKey || event.ctrlKey;
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = down.get(event.pointerId);
    if (!before) return;
    const now = at(event);
    if (down.size === 1) {
      down.set(event.pointerId, now);
      if (pans) camera.pan(now.x - before.x, now.y - before.y);
      else camera.rotate(now.x - before.x, now.y - before.y);
    } else {
      const old = [...down.values()].slice(0, 2);
      down.set(event.pointerId, now);
      const [from, to] = [old, [...down.values()].slice(0, 2)];
      camera.pan(middle(to).x - middle(from).x, middle(to).y - middle(from).y);
      camera.zoomAt(apart(to) / apart(from), middle(to).x, middle(to).y);
    }
  });
  const up = (event: PointerEvent): void => {
    down.delete(event.pointerId);
    if (down.size === 1) pans = false;
  };
  canvas.addEventListener("pointerup", up);
  canvas.addEventListener("pointercancel", up);
  canvas.addEventListener("lostpointercapture", up);
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      const lines =
        event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? event.deltaY : 30 * event.deltaY;
      const {x, y} = at(event);
      // A pinch on a touchpad is reported as a wheel event with Ctrl, in smaller steps.
      camera.zoomAt(
        Math.exp(-Math.min(Math.max(lines, -240), 240) * (event.ctrlKey ? 0.008 : 0.0016)),
        x,
        y,
      );
    },
    {passive: false},
  );
}
