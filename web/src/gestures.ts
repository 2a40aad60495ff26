// SPDX-License-Identifier: Apache-2.0
// Mouse and touch on a picture. One pointer rotates; two pointers, the right or middle button, or
// Shift pan; wheel and pinch zoom; a click or a tap is a press without a drag.

/** In CSS pixels from the upper left corner of the canvas. */
export interface Point {
  x: number;
  y: number;
}

/** What is moved, by pixels of the picture. */
export interface Movable {
  rotate: (right: number, down: number) => void;
  pan: (right: number, down: number) => void;
  zoomAt: (factor: number, x: number, y: number) => void;
}

/** Follows a pointer that drags something in the picture. */
export interface Drag {
  move: (to: Point) => void;
  end: () => void;
}

export interface Listener {
  clicked: (at: Point) => void;
  /** Called while no button is pressed; null: the pointer has left the picture. */
  pointedAt: (at: Point | null) => void;
  /** What a pressed pointer drags in place of the picture; null: nothing. */
  grabbed?: (at: Point, event: PointerEvent) => Drag | null;
  /** @returns whether the wheel did something in place of zooming */
  wheeled?: (event: WheelEvent) => boolean;
}

/** A pointer that moves farther, in CSS pixels, drags. */
const DRAG = 5;

const middle = ([a, b]: Point[]): Point => ({x: (a.x + b.x) / 2, y: (a.y + b.y) / 2});
const apart = ([a, b]: Point[]): number => Math.max(Math.hypot(a.x - b.x, a.y - b.y), 1);

export function listen(canvas: HTMLCanvasElement, camera: Movable, listener: Listener): void {
  const down = new Map<number, Point>();
  const drags = new Map<number, Drag>();
  let pans = false;
  let pressed: Point | null = null;  // where the only pointer went down, if it has not dragged

  const at = (event: MouseEvent): Point => {
    const box = canvas.getBoundingClientRect();
    return {x: event.clientX - box.left, y: event.clientY - box.top};
  };

  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    const drag = down.size === 0 ? listener.grabbed?.(at(event), event) : null;
    if (drag) {
      drags.set(event.pointerId, drag);
      listener.pointedAt(null);
      return;
    }
    down.set(event.pointerId, at(event));
    pans = event.button !== 0 || event.shiftKey || event.ctrlKey;
    pressed = pans || down.size > 1 ? null : at(event);
    listener.pointedAt(null);
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = down.get(event.pointerId);
    const now = at(event);
    const drag = drags.get(event.pointerId);
    if (drag) {
      drag.move(now);
      return;
    }
    if (!before) {
      listener.pointedAt(now);
      return;
    }
    if (pressed) {
      if (Math.hypot(now.x - pressed.x, now.y - pressed.y) <= DRAG) return;
      pressed = null;
    }
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
    drags.get(event.pointerId)?.end();
    drags.delete(event.pointerId);
    down.delete(event.pointerId);
    if (down.size === 1) pans = false;
  };
  canvas.addEventListener("pointerup", (event) => {
    if (pressed) listener.clicked(pressed);
    pressed = null;
    up(event);
  });
  canvas.addEventListener("pointerleave", (event) => {
    // A finger leaves with every tap; what it tapped stays described.
    if (event.pointerType !== "touch") listener.pointedAt(null);
  });
  canvas.addEventListener("pointercancel", (event) => {
    pressed = null;
    up(event);
  });
  canvas.addEventListener("lostpointercapture", up);
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      if (listener.wheeled?.(event)) return;
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
