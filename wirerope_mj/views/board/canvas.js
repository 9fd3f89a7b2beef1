// Pointer, wheel and keys on the views of the board, and the buttons above them.

import { draw, frameOf, plus } from "./drawing.js";

const [COARSE, FINE] = [10, 1]; // steps of what is moved, without and with Shift [mm]
const NEAR = 4; // travel that makes a press a drag [px]
const ROOM = [70, 56]; // for labels around what fits into a view, across and up [px]
const NONE = [0, 0, 0];
const ARROWS = { // axes and directions
  arrowleft: [0, -1], arrowright: [0, 1], arrowdown: [1, -1], arrowup: [1, 1],
  "alt+arrowdown": [2, -1], "alt+arrowup": [2, 1],
};
export const at = (id) => document.getElementById(id);

/** Run the canvas: `act` sends an action, `pass` one that a later may replace. */
export function createCanvas({ act, pass }) {
  const drawings = [...document.querySelectorAll(".drawing")], view = { scale: 0, centre: NONE };
  const board = { scene: null, selected: [], moving: null, band: null, view };
  let items = [], press = null, pans = false, fitted = true, frame = 0;

  const edits = () => board.scene?.movable;
  const itemOf = (name) => items.find((item) => item.name === name);
  const drawnShift = (name) => (board.scene.names.includes(name) ? board.scene.by : NONE);
  const pointerIn = (drawing, { clientX, clientY }) => plus([clientX, clientY], frameOf(drawing, view).corner, -1);

  // Tell how far an item is from where the scene has it, which may be where a drag was some time ago.
  const shiftOf = (name) => (
    plus(board.moving?.names.includes(name) ? board.moving.by : NONE, drawnShift(name), -1));

  function paint() {
    frame = 0;
    at("hatch").setAttribute("patternTransform", `scale(${1 / view.scale})`);
    for (const drawing of drawings) if (drawing.clientWidth) draw(drawing, { ...board, shiftOf });
  }

  const redraw = () => (frame ||= view.scale && requestAnimationFrame(paint));

  function fit() {
    const { views, middle } = board.scene;
    for (const drawing of drawings) drawing.style.flexGrow = views[drawing.id].grows;
    view.centre = middle;
    const scales = (drawing) => frameOf(drawing, view).spans.map(([from, to], k) => (
      Math.max(to - from - ROOM[k], 20) / views[drawing.id].size[k]));
    view.scale = Math.min(...drawings.filter((drawing) => drawing.clientWidth).flatMap(scales));
    fitted = true;
  }

  // Select items, say which, mark them and enable what can be done with them.
  function select(selected) {
    board.selected = selected;
    const chosen = selected.map(itemOf), labels = chosen.map(({ label }) => label).join(", ");
    const words = chosen[1] ? `${chosen.length} selected: ${labels}` : chosen[0]?.words ?? "Nothing selected";
    if (at("here").textContent !== words) at("here").textContent = words;
    for (const each of document.querySelectorAll("[data-name]")) {
      each.classList.toggle("selected", selected.includes(each.dataset.name));
    }
    for (const button of document.querySelectorAll("[data-least]")) {
      button.disabled = !edits() || selected.length < button.dataset.least;
    }
  }

  function begin(name) {
    const from = plus(itemOf(name).position, drawnShift(name), -1);
    board.moving = { names: [...board.selected], name, from, by: NONE, sent: false };
  }

  // Hold what moves at a distance from where it stood, and ask what that would give.
  function moveBy(by) {
    if (by.join() === board.moving.by.join()) return;
    board.moving.by = by;
    pass({ do: "drag", names: board.moving.names, by });
  }

  // Let go: it stays there until the scene that follows says so, too.
  function settle() {
    const { moving } = board;
    if (!moving || moving.sent) return;
    if (moving.by.some(Boolean)) act({ do: "move", names: moving.names, by: moving.by });
    else board.moving = null;
    moving.sent = true;
  }

  // Draw what was let go where its scene has it: a new one, or the old one if nothing came of the move.
  function release() {
    if (board.moving?.sent) [board.moving = null, redraw()];
  }

  function cancel() {
    if (board.moving && !board.moving.sent) moveBy(NONE);
    [board.moving, board.band, press] = [null, null, null];
  }

  function down(event) {
    const drawing = event.currentTarget, { clientX, clientY, button } = event;
    if (button > 1) return;
    event.preventDefault();
    settle();
    const under = document.elementsFromPoint(clientX, clientY); // from the top
    const names = under.map((element) => element.closest("[data-name]")?.dataset.name).filter(Boolean);
    const name = names.find((lying) => board.selected.includes(lying)) ?? names[0];
    const kind = button === 1 || pans ? "pan" : name && edits() ? "move" : "band";
    const adds = event.ctrlKey || event.shiftKey, from = pointerIn(drawing, event), { centre } = view;
    press = { drawing, kind, name, adds, from, centre, frame: frameOf(drawing, view), travels: false };
    drawing.focus({ preventScroll: true });
    drawing.setPointerCapture(event.pointerId);
  }

  function travel(event) {
    if (!press) return;
    const { drawing, kind, name, from, adds, travels } = press, to = pointerIn(drawing, event);
    if (!travels && Math.hypot(...plus(to, from, -1)) < NEAR) return;
    press.travels = true;
    const by = plus(press.frame.point(to), press.frame.point(from), -1);
    if (kind === "pan") [view.centre, fitted] = [plus(press.centre, by, -1), false];
    else if (kind === "band") board.band = { drawing, from, to };
    else {
      if (!travels && !board.selected.includes(name)) select(adds ? [...board.selected, name] : [name]);
      if (!travels) begin(name);
      const step = event.shiftKey ? FINE : COARSE; // without travel along an axis it stays as it is there
      moveBy(board.moving.from.map((value, k) => (Math.abs(by[k]) < step / 2 ? 0
        : Math.round((value + by[k]) / step) * step - value)));
    }
  }

  function up() {
    if (!press) return;
    const { drawing, kind, name, adds, travels } = press, { selected, band } = board;
    [press, board.band] = [null, null];
    if (band) {
      const { from, to } = band, { at: seen } = frameOf(drawing, view);
      const within = (item) => seen(item.position).every((end, k) => (end - from[k]) * (end - to[k]) < 0);
      const found = items.filter(within).map((item) => item.name);
      select(adds ? [...new Set([...selected, ...found])] : found);
    } else if (!travels && kind !== "pan" && (name || !adds)) {
      const others = selected.filter((kept) => kept !== name);
      select(!adds ? [name].filter(Boolean) : selected.includes(name) ? others : [...selected, name]);
    }
    settle();
  }

  function zoom(event) {
    event.preventDefault();
    const drawing = event.currentTarget, pointer = pointerIn(drawing, event), before = frameOf(drawing, view);
    view.scale = Math.min(Math.max(view.scale * Math.exp(-event.deltaY / 500), 0.005), 20);
    view.centre = plus(view.centre, plus(before.point(pointer), frameOf(drawing, view).point(pointer), -1));
    fitted = false;
  }

  function step(by) {
    const now = items.findIndex((item) => item.name === board.selected.at(-1));
    if (items.length) select([items.at(now < 0 && by < 0 ? -1 : (now + by) % items.length).name]);
  }

  const does = { // what needs no server, by buttons and keys
    fit,
    toggle: (button) => (button.ariaPressed = at("canvas").classList.toggle(button.value)),
    keys: () => at("keys").showModal(),
    "ctrl+a": () => select(items.filter(({ kind }) => kind === "mount").map((mount) => mount.name)),
    escape: () => (press || board.moving ? cancel() : select([])),
    pagedown: () => step(1),
    pageup: () => step(-1),
  };

  // Do what a key says and tell whether it says anything.
  function key(name, event) {
    const [axis, side] = ARROWS[name.replace("shift+", "")] ?? [];
    if (name === " " && drawings.includes(event.target)) pans = true;
    else if (side && board.selected.length && !press && edits()) {
      if (!board.moving || board.moving.sent) begin(board.selected[0]);
      moveBy(board.moving.by.with(axis, board.moving.by[axis] + side * (event.shiftKey ? FINE : COARSE)));
    } else if (does[name]) does[name]();
    else return false;
    return true;
  }

  function lift(event) {
    pans = false;
    if (!press && (event.type === "blur" || event.key.startsWith("Arrow"))) settle();
  }

  const listeners = {
    pointerdown: down, pointermove: travel, pointerup: up, pointercancel: cancel, wheel: zoom, dblclick: fit,
    blur: lift,
  };
  for (const drawing of drawings) {
    for (const [name, listener] of Object.entries(listeners)) {
      drawing.addEventListener(name, (event) => [listener(event), redraw()]);
    }
    new ResizeObserver(() => [view.scale && fitted && fit(), redraw()]).observe(drawing);
  }
  document.addEventListener("keyup", lift);
  document.addEventListener("focusin", ({ target, relatedTarget }) => {
    if (drawings.includes(relatedTarget)) return; // Tab leads through the tables, and what is selected stays
    const name = target.closest("tr[data-name]")?.dataset.name;
    if (itemOf(name) && !board.selected.includes(name)) select([name]);
  });
  document.addEventListener("click", ({ target }) => does[target.dataset.canvas]?.(target));
  for (const name of ["click", "keydown", "keyup", "focusin"]) document.addEventListener(name, redraw);

  function show({ scene, selected }) {
    if (scene) {
      board.scene = scene;
      items = scene.items.filter(({ movable }) => movable);
      for (const drawing of drawings) drawing.children[1].innerHTML = scene.views[drawing.id].shapes;
      if (!scene.names.length) release();
    }
    if (board.moving && !board.moving.names.every(itemOf)) cancel();
    select((selected ?? board.selected).filter(itemOf));
    if (scene && !view.scale) fit();
    if (view.scale) paint(); // at once: what is pressed next must lie where it is drawn
  }
  return { show, key, settle, release, selected: () => board.selected };
}
