"use strict";
// The web viewer of rerun without its own page, which would ask other servers for fonts. It shows the recording of the folder
// above, at the instant [s] behind the # of the address, or the number on a timeline, as in "#point@34".

const state = document.getElementById("state");
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

function text(number, content) {
  return field(number, [...new TextEncoder().encode(content)]);
}

// ViewerControlRequest of rerun 0.41, set_time_cursor (6): recording (1), timeline (2: name), time (3: nanoseconds or number),
// paused (5: 1).
function cursorAt(timeline, value, recording) {
  const time = [8, ...varint(Math.max(0, Math.round(value)))];
  const of = recording ? text(1, recording) : [];
  return new Uint8Array(field(6, [...of, ...field(2, text(1, timeline)), ...field(3, time), 40, 1]));
}

// Whether the cursor is moved; a recording may still be being read, so that it takes some tries.
async function moved(tries, ...cursor) {
  for (let left = tries; left >= 0; left--) {
    try {
      await handle.viewer_control(cursorAt(...cursor));
      return true;
    } catch (error) {
      await new Promise((resolve) => setTimeout(resolve, 250));
    }
  }
  return false;
}

async function go(tries) {
  const [timeline, number] = location.hash.slice(1).split("@");
  const value = Number.parseFloat(number ?? timeline);
  if (!handle || !Number.isFinite(value)) return;
  const done = await (number ? moved(tries, timeline, value) : moved(tries, "sim_time", value * 1e9));
  if (number || !done) return;
  // With its unit the address is another one than the report's link, which moves the cursor back when it is followed again.
  history.replaceState(null, "", `#${value}s`);
  document.title = `Timeline at ${value.toFixed(4)} s`;
}

// The content of a file, with how much of it is there shown on the way. As bytes the program starts whatever type the server
// calls it.
async function content(address) {
  const answer = await fetch(address);
  if (!answer.ok) throw new Error(`${address}: ${answer.status} ${answer.statusText}`);
  const pieces = [];
  const reader = answer.body.getReader();
  for (let size = 0; ; ) {
    const { done, value } = await reader.read();
    if (done) return new Uint8Array(await new Blob(pieces).arrayBuffer());
    pieces.push(value);
    size += value.length;
    state.textContent = `Loading ${address.split("/").pop()}: ${(size / 1e6).toFixed(1)} MB`;
  }
}

async function start() {
  if (location.protocol === "file:") {
    throw new Error("a browser gives a page that was opened from the disk no other file. In the folder above this one: " +
      "python -m http.server --bind 127.0.0.1, and open localhost:8000");
  }
  const recording = await content("../run.rrd");
  await wasm_bindgen({ module_or_path: await content("re_viewer_bg.wasm") });
  handle = new wasm_bindgen.WebHandle({
    url: [], hide_welcome_screen: true, enable_history: false, notebook: false, persist: false, theme: "dark",
  });
  await handle.start(document.getElementById("canvas"));
  state.textContent = "";
  handle.open_channel("run", "run.rrd");
  handle.send_rrd_to_channel("run", recording);
  handle.close_channel("run");
  // of several recordings in a file; a large one takes the viewer a while
  for (const cursor of globalThis.OPENINGS ?? []) moved(240, ...cursor);
  go(240);
}

window.addEventListener("hashchange", () => go(4));
start().catch((error) => {
  state.textContent = `The viewer does not start: ${error.message ?? error}`;
});
