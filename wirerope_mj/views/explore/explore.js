"use strict";
// Sliders to runs and back: one request at a time, and of those that wait only the last is sent.

const TOKEN = new URLSearchParams(location.search).get("token") ?? "";
const QUIET = 700; // pause [ms] after which the recording is fetched: while a slider moves there is no use for one
const RECORDINGS = 8; // that the viewer has in memory, 20 MB each, before it is started afresh
const STEPS = 400; // positions of a slider
const PATIENCE = 120e3; // time [ms] after which the viewer is given up: without a graphics card it takes ten seconds

const at = (id) => document.getElementById(id);
const fields = new Map(); // sliders by key: what they are, their inputs, their value
let wanted = null, busy = false, shownRun = null, curves = [], pause = 0;
let viewing = false, recording = false, recorded = "", recordings = 0;

function element(name, text = "", className = "") {
  const made = document.createElement(name);
  made.textContent = text;
  if (className) made.className = className;
  return made;
}

async function asked(path, content) {
  const options = { headers: { "X-Token": TOKEN } };
  if (content) Object.assign(options, { method: "POST", body: JSON.stringify(content) });
  const reply = await fetch(path, options);
  if (reply.status === 409) return null; // somebody asked later, and has the answer
  if (!reply.ok) throw new Error((await reply.json()).error);
  return reply;
}

// Factors stand on a logarithmic scale: half and twice are equally far from one.
function valueAt(slider, position) {
  const { minimum, maximum, nominal, unit } = slider;
  if (unit === "°") return 5 * Math.round((minimum + (maximum - minimum) * position / STEPS) / 5);
  const value = Number((minimum * (maximum / minimum) ** (position / STEPS)).toFixed(2));
  return Math.abs(value - nominal) < 0.015 * nominal ? nominal : value;
}

function positionOf(slider, value) {
  const { minimum, maximum, unit } = slider;
  if (unit === "°") return STEPS * (value - minimum) / (maximum - minimum);
  return STEPS * Math.log(value / minimum) / Math.log(maximum / minimum);
}

function addField(slider) {
  const box = element("div", "", "field"), head = element("div", "", "head"), id = `slider-${fields.size}`;
  const label = element("label", slider.label), range = element("input"), number = element("input");
  const value = element("span", "", "value"), ends = element("div", "", "ends"), about = element("details");
  label.htmlFor = range.id = id;
  const units = slider.unit === "°" ? "degrees" : "times";
  Object.assign(range, { type: "range", min: 0, max: STEPS, step: 1, name: slider.key });
  range.setAttribute("aria-describedby", `${id}-note`);
  Object.assign(number, { type: "number", min: slider.minimum, max: slider.maximum, step: "any" });
  number.setAttribute("aria-label", `${slider.label}, as a number [${units}]`);
  if (slider.unit === "°") value.append(number, " °");
  else value.append("× ", number);
  const text = (end) => (slider.unit === "°" ? `${end}°`.replace("-", "\u2212") : `× ${end}`);
  ends.append(element("span", text(slider.minimum)), about, element("span", text(slider.maximum)));
  about.append(element("summary", "on what"), element("p", slider.note, "note"));
  about.id = `${id}-note`;
  head.append(label, value);
  box.append(head, range, ends);
  at("fields").append(box);
  const field = { slider, box, range, number, value: slider.nominal };
  fields.set(slider.key, field);
  range.addEventListener("input", () => { put(field, valueAt(slider, range.value), range); ask(true); });
  range.addEventListener("change", () => ask(false));
  number.addEventListener("change", () => {
    const given = number.value.trim() === "" ? Number.NaN : Number(number.value);
    const kept = Number.isFinite(given) ? Math.min(Math.max(given, slider.minimum), slider.maximum) : field.value;
    put(field, kept, number);
    number.value = kept;
    ask(false);
  });
}

function put(field, value, source) {
  const { slider, box, range, number } = field;
  field.value = value;
  if (source !== range) range.value = positionOf(slider, value);
  if (source !== number) number.value = slider.unit === "°" ? value : Number(value.toFixed(3));
  range.setAttribute("aria-valuetext", slider.unit === "°" ? `${value} degrees` : `${value} times the scenario's`);
  box.classList.toggle("changed", value !== slider.nominal);
}

function ask(passing, exact = false) {
  const values = Object.fromEntries([...fields].map(([key, field]) => [key, field.value]));
  wanted = { values, passing, exact };
  clearTimeout(pause);
  answerAll();
}

async function answerAll() {
  if (busy) return;
  busy = true;
  at("verdict").classList.add("busy");
  at("result").setAttribute("aria-busy", "true");
  while (wanted) {
    const request = wanted, began = performance.now();
    wanted = null;
    const progress = () => {
      const doing = request.exact ? "Simulating with a step chosen for the accuracy" : "Simulating";
      at("state").textContent = `${doing} … ${((performance.now() - began) / 1e3).toFixed(1)} s`;
    };
    const clock = setInterval(progress, 100);
    progress();
    try {
      const reply = await asked("/run", request);
      if (reply) draw(await reply.json());
      else at("state").textContent = "Another page asked for another run; this page shows the one before.";
      at("failure").hidden = true;
    } catch (error) {
      fail(error);
    } finally {
      clearInterval(clock);
    }
  }
  busy = false;
  at("verdict").classList.remove("busy");
  at("result").setAttribute("aria-busy", "false");
  record();
}

function fail(error) {
  const lost = error instanceof TypeError; // what `fetch` throws where nobody answers
  at("failure").textContent = lost
    ? "wirerope explore does not answer: it was ended, or its terminal says why. What stands below is the last that it said."
    : `This cannot be simulated: ${error.message} What stands below is the run before.`;
  at("failure").hidden = false;
  at("state").textContent = "";
}

// A table of content: its cells are text and tone, the first of a row its heading.
function tableOf({ id, title, note, columns, rows }) {
  const box = element("div", "", "wide"), table = element("table"), head = table.createTHead().insertRow();
  const body = table.createTBody(), sides = columns.map((column) => (column.align === "right" ? "r" : ""));
  table.id = id;
  table.createCaption().textContent = title;
  columns.forEach((column, n) => {
    const cell = element("th", column.title, sides[n]);
    cell.scope = "col";
    head.append(cell);
  });
  for (const cells of rows) {
    const row = body.insertRow();
    cells.forEach(([text, tone], n) => {
      const cell = element(n ? "td" : "th", text, `${sides[n]} ${tone}`.trim());
      if (!n) cell.scope = "row";
      row.append(cell);
    });
  }
  box.append(table);
  if (note) box.append(element("p", note, "note"));
  return box;
}

function changesOf(run) {
  const changes = Object.entries(run.changes).map(([label, value]) => `${label} ${value}`);
  return changes.length ? changes : ["as in the scenario"];
}

function draw(answer) {
  const { now, before } = answer;
  shownRun = now;
  at("headline").textContent = now.headline;
  at("verdict").className = `verdict ${now.tone}${busy ? " busy" : ""}`;
  at("state").textContent = `${now.name}, ${changesOf(now).join(", ")}; simulated and judged in ${now.seconds.toFixed(2)} s`;
  at("step").textContent = now.step;
  at("check").disabled = now.exact;
  at("lines").replaceChildren(...now.lines.map((line) => element("li", line)));
  at("warnings").replaceChildren(...now.warnings.map((line) => element("li", line)));
  at("now-name").textContent = `now: ${now.name}`;
  at("before-name").textContent = before ? `before: ${before.name}` : "before: none yet";
  at("changed-now").textContent = changesOf(now).join(", ");
  at("changed-before").textContent = before ? changesOf(before).join(", ") : "";
  at("tables").replaceChildren(...answer.tables.map(tableOf));
  curves = answer.curves;
  drawCurves();
}

function drawCurves() {
  const space = at("curves").clientWidth, columns = space >= 864 ? 2 : 1; // as the style sheet has it
  const width = Math.floor((space - 24 * (columns - 1)) / columns);
  at("curves").replaceChildren(...curves.map((curve) => chart(curve, width)));
}

// The recording takes longer than the run: it comes when the sliders rest.
function record() {
  clearTimeout(pause);
  if (viewing) pause = setTimeout(fetchRecording, QUIET);
}

async function fetchRecording() {
  const { number, name } = shownRun;
  if (name === recorded || busy || recording) return;
  recording = true;
  at("viewer-state").textContent = `Recording ${name} …`;
  const began = performance.now();
  try {
    const reply = await asked(`/recording/${number}`);
    if (!reply || shownRun.number !== number) return;
    recorded = name;
    await showRecording(name, await reply.arrayBuffer());
    at("viewer-state").textContent = `${name}, here after ${((performance.now() - began) / 1e3).toFixed(1)} s. ` +
      "Drag the time cursor below, or press the space bar.";
  } catch (error) {
    at("viewer-state").textContent = `No recording: ${error.message}`;
  } finally {
    recording = false;
    if (shownRun.number !== number) record(); // what came in the meantime
  }
}

// The viewer has this machine's other name: so browsers give it a process of its own, and it cannot hold up the page.
const OTHER = `${location.protocol}//${location.hostname === "localhost" ? "127.0.0.1" : "localhost"}:${location.port}`;

// Wait for a message of the viewer.
function told(kind) {
  return new Promise((resolve, reject) => {
    const end = (settle, value) => {
      window.removeEventListener("message", listen);
      clearTimeout(timeout);
      settle(value);
    };
    const listen = (event) => {
      if (event.origin !== OTHER) return;
      if (event.data.kind === kind) end(resolve);
      else if (event.data.kind === "failed") end(reject, new Error(event.data.message));
    };
    const timeout = setTimeout(() => end(reject, new Error("the viewer does not answer.")), PATIENCE);
    window.addEventListener("message", listen);
  });
}

async function showRecording(name, content) {
  if (recordings % RECORDINGS === 0) {
    const ready = told("ready");
    at("frame").src = `${OTHER}/viewer.html`;
    await ready;
  }
  recordings += 1;
  const shown = told("shown");
  at("frame").contentWindow.postMessage({ name, content }, OTHER, [content]);
  await shown;
}

function startViewer() {
  viewing = true;
  at("viewer-choice").hidden = true;
  at("frame").hidden = false;
  record();
}

// Whether something faster than the processor draws.
function hasGraphics() {
  const context = document.createElement("canvas").getContext("webgl2");
  const about = context?.getExtension("WEBGL_debug_renderer_info");
  const renderer = about ? context.getParameter(about.UNMASKED_RENDERER_WEBGL) : "";
  return Boolean(context) && !/swiftshader|llvmpipe|software|basic render/i.test(renderer);
}

async function begin() {
  const start = await (await asked("/start")).json();
  document.title = `What if: ${start.title}`;
  at("title").textContent = start.title;
  at("question").textContent = start.question;
  start.sliders.forEach(addField);
  for (const [key, field] of fields) put(field, start.answer.now.values[key], null);
  at("viewer").hidden = !start.viewer;
  at("reset").addEventListener("click", () => {
    for (const field of fields.values()) put(field, field.slider.nominal, null);
    ask(false);
  });
  at("check").addEventListener("click", () => ask(false, true));
  draw(start.answer);
  window.addEventListener("resize", drawCurves);
  if (!start.viewer) return;
  at("viewer-start").addEventListener("click", startViewer);
  if (hasGraphics()) startViewer();
  else at("viewer-choice").hidden = false;
}

begin().catch(fail);
