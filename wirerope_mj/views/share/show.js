"use strict";
// The web viewer of rerun without its own page, which would ask other servers for fonts. It shows the recording of the folder
// above, at the instant [s] behind the # of the address.

const TIMELINE = "sim_time";
let handle = null;

// A number as protobuf writes it, seven bits a byte.
function varint(value) {
  const bytes = [];
  for (let rest = BigInt(value); ; rest >>= 7n) {
    if (rest < 128n) return [...bytes, Number(rest)];
    bytes.push(Number(rest & 127n) | 128);
  }
}

function field(number, bytes) {
  return [number * 8 + 2, ...varint(bytes.length), ...bytes];
}

// ViewerControlRequest of rerun 0.41, set_time_cursor (6): timeline (2: name), time (3: nanoseconds), paused (5: 1).
function atInstant(seconds) {
  const name = field(1, [...new TextEncoder().encode(TIMELINE)]);
  const time = [8, ...varint(Math.max(0, Math.round(seconds * 1e9)))];
  return new Uint8Array(field(6, [...field(2, name), ...field(3, time), 40, 1]));
}

async function go(tries) {
  const instant = Number.parseFloat(location.hash.slice(1));
  if (!handle || !Number.isFinite(instant)) return;
  try {
    await handle.viewer_control(atInstant(instant));
  } catch (error) {
    if (tries > 0) setTimeout(() => go(tries - 1), 250);  // the recording is still being read
  }
}

async function start() {
  const recording = fetch("../run.rrd").then((answer) => {
    if (!answer.ok) throw new Error(`run.rrd: ${answer.status}`);
    return answer.arrayBuffer();
  });
  await wasm_bindgen({ module_or_path: fetch("re_viewer_bg.wasm") });
  handle = new wasm_bindgen.WebHandle({
    url: [], hide_welcome_screen: true, enable_history: false, notebook: false, persist: false, theme: "dark",
  });
  await handle.start(document.getElementById("canvas"));
  document.getElementById("state").remove();
  handle.open_channel("run", "run.rrd");
  handle.send_rrd_to_channel("run", new Uint8Array(await recording));
  handle.close_channel("run");
  setTimeout(() => go(40), 250);
}

window.addEventListener("hashchange", () => go(4));
start().catch((error) => {
  const state = document.getElementById("state");
  if (state) state.textContent = `The viewer does not start: ${error}. A web server must hand out this folder.`;
});
