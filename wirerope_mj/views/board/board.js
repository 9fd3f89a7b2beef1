// The page of the board: a socket to its server, fragments of HTML, buttons, fields and keys with actions.

import { at, createCanvas } from "./canvas.js";

const AGAIN = 1000; // pause before it connects again [ms]
const KEPT = ["open", "aria-invalid"]; // attributes that are of the page alone
const { title } = document;
const client = crypto.getRandomValues(new Uint32Array(2)).join("-");
const unanswered = new Map(); // actions by id and what they come from; sent again over a new connection
let socket, count = 0;

function say(words, tone = "") {
  at("said").replaceChildren(words);
  at("said").className = tone;
}

function transmit(action) {
  const message = { ...action, id: `${client}.${(count += 1)}` };
  if (socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify(message));
  return message;
}

function act(action, element = null) {
  const message = transmit(action);
  unanswered.set(message.id, { message, element });
  document.body.dataset.waits = true;
}

const pass = (action) => transmit({ ...action, passing: true }); // the next action may take its turn
const canvas = createCanvas({ act, pass });

function connect() {
  socket = new WebSocket(new URL(`/socket${location.search}`, location.href.replace(/^http/, "ws")));
  socket.addEventListener("open", () => {
    say("");
    for (const { message } of unanswered.values()) socket.send(JSON.stringify(message));
    transmit({ do: "judge" });
  });
  socket.addEventListener("message", ({ data }) => receive(JSON.parse(data)));
  socket.addEventListener("close", async () => {
    const anew = (await fetch(location).catch(() => ({}))).status === 403; // its token is another
    say(at("said").dataset[anew ? "anew" : "lost"], "bad");
    if (!anew) setTimeout(connect, AGAIN);
  });
}

function receive(message) {
  const { html = {}, said, tone, ask, done, refused, word } = message, state = document.body.dataset;
  if (refused) answer(refused, said, word); // before fragments, for them to leave its field as it is
  for (const [id, fragment] of Object.entries(html)) replace(at(id), fragment);
  canvas.show(message);
  if (said !== undefined) say(said, tone);
  for (const name of ["stale", "dirty"]) if (name in message) state[name] = message[name];
  document.title = (state.dirty === "true" ? "\u2022 " : "") + title;
  if (done) answer(done);
  if (message.open) openBeside(new URL(message.open, location.href));
  if (ask) act(ask);
}

function openBeside(href) {
  href.searchParams.set("token", new URLSearchParams(location.search).get("token"));
  if (window.open(href, "_blank")) return; // a browser may refuse a tab so long after the click
  say(Object.assign(document.createElement("a"), { href, target: "_blank", textContent: "Ready: open it" }), "good");
}

// Show below an element why its action was refused, or take that away and have it as the board now has it.
function answer(id, reason, word) {
  const { message, element } = unanswered.get(id) ?? {};
  unanswered.delete(id);
  document.body.dataset.waits = unanswered.size > 0;
  if (message?.do === "move") canvas.release();
  if (!element) return;
  acquit(element);
  if (!reason) {
    if (element.value === message.value) element.value = element.defaultValue ?? element.value;
    return;
  }
  element.ariaInvalid = "true";
  if ("adds" in element.dataset) element.value ||= message.value;
  const refusal = document.createElement("p");
  element.after(Object.assign(refusal, { className: "refusal", role: "alert", tabIndex: 0, textContent: reason }));
  const start = element.type === "text" && word ? element.value.indexOf(word) : -1;
  if (start >= 0) element.setSelectionRange(start, start + word.length);
}

function acquit(element) {
  if (isRefusal(element.nextSibling)) element.nextSibling.remove();
  element.ariaInvalid = null;
}

function replace(element, innerHTML) {
  const template = Object.assign(document.createElement("template"), { innerHTML });
  if (element) match(element, template.content);
}

const isRefusal = (node) => node?.className === "refusal";
const keyOf = (node) => node.nodeName + (node.dataset?.column || node.id || node.dataset?.name || "");

// Give a parent the children of another and keep those that stay, with focus, caret and what is unfolded.
function match(parent, made) {
  const present = new Set([...parent.childNodes].filter((node) => !isRefusal(node)));
  const keys = new Set([...made.childNodes].map(keyOf)), renamed = (node) => node.nodeName === "TR" && !keys.has(keyOf(node));
  const wanted = [...made.childNodes].map((node) => {
    const same = [...present].find((each) => keyOf(each) === keyOf(node));
    const old = same ?? (node.nodeName === "TR" && [...present].find(renamed)); // a row with another name
    present.delete(old);
    if (old) resemble(old, node);
    return old || node;
  });
  for (const node of present) node.remove();
  let next = parent.firstChild;
  for (const node of wanted) {
    while (isRefusal(next)) next = next.nextSibling;
    if (node === next) next = next.nextSibling;
    else parent.insertBefore(node, next);
  }
}

function resemble(old, made) {
  if (old.nodeType !== Node.ELEMENT_NODE) return void (old.data = made.data);
  const waits = old.ariaInvalid || [...unanswered.values()].some(({ element }) => element === old);
  const typed = (waits || old === document.activeElement) && old.value !== (old.defaultValue ?? old.value);
  const gone = old.getAttributeNames().filter((name) => !KEPT.includes(name) && !made.hasAttribute(name));
  for (const name of gone) old.removeAttribute(name);
  for (const { name, value } of made.attributes) if (!KEPT.includes(name)) old.setAttribute(name, value);
  match(old, made);
  if (!old.matches("input:not([type=file]), select, textarea")) return;
  old.checked = made.checked;
  if (old.value !== made.value && !typed) old.value = made.value;
}

// Read the action of an element from its data attributes; one for so many selected, at least, names them.
function actionOf({ dataset: { keys, live, least, adds, ...action } }) {
  return least ? { ...action, names: canvas.selected() } : action;
}

const typedIn = (field) => ({ ...actionOf(field), value: field.type === "checkbox" ? field.checked : field.value });
document.addEventListener("click", ({ target }) => {
  const button = target.closest("button[data-do]");
  if (button) act(actionOf(button), button);
});
document.addEventListener("change", ({ target }) => {
  const adds = "adds" in target.dataset;
  if (target.dataset.do && (target.value || !adds)) act(typedIn(target), target);
  if (adds) target.value = ""; // the next one may be typed
});
document.addEventListener("input", ({ target }) => "live" in target.dataset && pass(typedIn(target)));
document.addEventListener("keydown", (event) => {
  const { target } = event, modifiers = [event.ctrlKey || event.metaKey, event.altKey, event.shiftKey];
  const name = ["ctrl+", "alt+", "shift+"].filter((_, k) => modifiers[k]).join("") + event.key.toLowerCase();
  const typed = target.closest("input:not([type=range], [type=checkbox]), textarea");
  const button = document.querySelector(`[data-keys~="${CSS.escape(name)}"]`);
  if (name === "enter" && typed?.ariaInvalid) typed.dispatchEvent(new Event("change", { bubbles: true })); // right by now?
  if (name === "escape" && typed) [typed.value = typed.defaultValue, acquit(typed)];
  if (document.querySelector("dialog[open]") || (typed && name !== "ctrl+s")) return;
  if (name === "ctrl+s") [target.blur(), target.focus()]; // what is typed is sent before it is saved
  if (!(button && name.startsWith("ctrl+")) && target.closest("header, aside")) return;
  if (!button && !canvas.key(name, event)) return;
  event.preventDefault();
  if (button) [canvas.settle(), button.click()];
});
addEventListener("beforeunload", (event) => document.body.dataset.dirty === "true" && event.preventDefault());
connect();
