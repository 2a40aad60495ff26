// SPDX-License-Identifier: Apache-2.0
// A button that copies a text that the page shows.
import {button} from "./controls";

/** @param holder the element with the text */
export function copyButton(holder: HTMLElement, id = "copy"): HTMLButtonElement {
  const out = button(id, "Copy", () => {
    const done = (): void => void (out.textContent = "Copied");
    const select = (): void => {
      getSelection()?.selectAllChildren(holder);
      out.textContent = "Selected";
    };
    // A page opened as a file may not write to the clipboard.
    if (navigator.clipboard)
      navigator.clipboard.writeText(holder.textContent ?? "").then(done, select);
    else select();
  });
  return out;
}
