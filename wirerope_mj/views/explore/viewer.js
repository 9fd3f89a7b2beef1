"use strict";
// The web viewer of rerun without its own page, which would ask other servers for fonts. It is told by the page around it
// what to show: { name, content } with the content of a .rrd file.

const PAGE = [`http://127.0.0.1:${location.port}`, `http://localhost:${location.port}`];

function tell(message) {
  for (const origin of PAGE) if (origin !== location.origin) window.parent.postMessage(message, origin);
}

async function start() {
  await wasm_bindgen({ module_or_path: fetch("/re_viewer_bg.wasm") });
  const handle = new wasm_bindgen.WebHandle({
    url: [], hide_welcome_screen: true, enable_history: false, notebook: false, persist: false, theme: "dark",
  });
  await handle.start(document.getElementById("canvas"));
  document.getElementById("state").remove();
  window.addEventListener("message", (event) => {
    if (!PAGE.includes(event.origin)) return;
    const { name, content } = event.data;
    handle.open_channel(name, name);
    handle.send_rrd_to_channel(name, new Uint8Array(content));
    handle.close_channel(name);
    tell({ kind: "shown" });
  });
  tell({ kind: "ready" });
}

start().catch((error) => {
  document.getElementById("state").textContent = `The viewer does not run in this browser: ${error}`;
  tell({ kind: "failed", message: `the viewer does not run in this browser: ${error}` });
});
