// SPDX-License-Identifier: Apache-2.0
// Starts the report page.
import "./style.css";

import {fail, PageView} from "./page_view";

try {
  const view = new PageView();
  Object.defineProperty(window, "isoatlas", {value: view.api});
  view.start().catch(fail);
} catch (reason) {
  fail(reason);
}
