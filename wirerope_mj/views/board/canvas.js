// Pointer, wheel and keys on the two views of the board, and the buttons above them.

import { describe, draw, extentOf, frameOf, positionOf } from "./drawing.js";

const [COARSE, FINE] = [10, 1]; // steps of what is moved, without and with Shift [mm]
const NEAR = 4; // travel that makes a press a drag [px]
const ROOM = [70, 56]; // for labels around what fits into a view, across and up [px]
const SIDE = [[0, 2], "Side view: x right, z up", "End view"];
const END = [[1, 2], "End view: y right, z up", "Side view"];
const ARROWS = {
  arrowleft: [-1, 0, 0], arrowright: [1, 0, 0], arrowup: [0, 1, 0], arrowdown: [0, -1, 0],
  "alt+arrowup": [0, 0, 1], "alt+arrowdown": [0, 0, -1],
};
const at = (id) => document.getElementById(id);

/** Run the canvas: `act` sends an action, `pass` one that a later may replace. */
export function createCanvas({ act, pass }) {
  const [plan, elevation] = [at("plan"), at("elevation")], drawings = [plan, elevation];
  const view = { scale: 1, centre: [0, 0, 0] };
  const board = { scene: null, preview: null, selected: [], moving: null, band: null, view };
  let shown = SIDE, press = null, pans = false, fitted = true, frame = 0;

  const axesOf = (drawing) => (drawing === plan ? [0, 1] : shown[0]);
  const frameAt = (drawing) => frameOf(drawing, axesOf(drawing), view);
  const items = ({ mounts, boxes, stops, points } = board.scene) => (
    [...mounts, ...boxes.filter((box) => box.movable), ...stops, ...points]);
  const itemOf = (name) => items().find((item) => item.name === name);
  const edits = () => board.scene.movable !== false;
  const pointerIn = (drawing, { clientX, clientY }) => {
    const { left, top } = drawing.getBoundingClientRect();
    return [clientX - left, clientY - top];
  };

  function redraw() {
    frame ||= requestAnimationFrame(() => {
      frame = 0;
      if (board.scene) for (const drawing of drawings) draw(drawing, axesOf(drawing), board);
    });
  }

  function fit() {
    if (!board.scene) return;
    const [low, high] = extentOf(board.scene), lengths = high.map((value, k) => Math.max(value - low[k], 50));
    const share = Math.min(Math.max(lengths[1] / (lengths[1] + lengths[2]), 0.35), 0.65);
    [plan.style.flexGrow, elevation.style.flexGrow, fitted] = [share, 1 - share, true];
    view.centre = high.map((value, k) => (value + low[k]) / 2);
    const scales = (drawing) => frameAt(drawing).spans.map(([from, to], k) => (
      Math.max(to - from - ROOM[k], 20) / lengths[axesOf(drawing)[k]]));
    view.scale = Math.min(...drawings.flatMap(scales));
    redraw();
  }

  // Say what is selected, mark its rows and enable what can be done with it.
  function tell() {
    const { selected } = board, chosen = selected.map(itemOf), labels = chosen.map((item) => item.label);
    const words = labels[1] ? `${labels.length} selected: ${labels.join(", ")}`
      : labels[0] ? describe(chosen[0]) : "Nothing selected";
    if (at("here").textContent !== words) at("here").textContent = words;
    for (const row of document.querySelectorAll("tr[data-name]")) {
      row.classList.toggle("selected", selected.includes(row.dataset.name));
    }
    for (const button of document.querySelectorAll("[data-least]")) {
      button.disabled = !edits() || selected.length < button.dataset.least;
    }
  }

  function select(names, told = false) {
    if (names.join() === board.selected.join()) return;
    board.selected = names;
    if (!told) act({ do: "select", names });
    tell();
    redraw();
  }

  const begin = (name) => (board.moving = { names: [...board.selected], name, by: [0, 0, 0], sent: false });

  // Hold what moves at a distance from where it stood, and ask what that would give.
  function moveBy(by) {
    if (by.join() === board.moving.by.join()) return;
    board.moving.by = by;
    pass({ do: "drag", names: board.moving.names, by });
    redraw();
  }

  // Let go: it stays there until the scene that follows says so, too.
  function settle() {
    const { moving } = board;
    if (!moving || moving.sent) return;
    if (moving.by.some(Boolean)) act({ do: "move", names: moving.names, by: moving.by });
    else board.moving = null;
    moving.sent = true;
    redraw();
  }

  // Draw what was let go where its scene has it: a new one, or the old one if nothing came of the move.
  function release() {
    if (board.moving?.sent) board.moving = null;
    redraw();
  }

  function cancel() {
    if (board.moving && !board.moving.sent) moveBy([0, 0, 0]);
    [board.moving, board.band, press] = [null, null, null];
    redraw();
  }

  function down(event) {
    const drawing = event.currentTarget, { clientX, clientY, button } = event;
    if (!board.scene || button > 1) return;
    event.preventDefault();
    settle();
    const under = document.elementsFromPoint(clientX, clientY); // from the top
    const names = under.map((element) => element.closest("[data-name]")?.dataset.name).filter(Boolean);
    const name = names.find((lying) => board.selected.includes(lying)) ?? names[0];
    const kind = button === 1 || pans ? "pan" : name && edits() ? "move" : "band";
    const adds = event.ctrlKey || event.shiftKey, from = pointerIn(drawing, event), centre = [...view.centre];
    press = { drawing, kind, name, adds, from, centre, frame: frameAt(drawing), travels: false };
    drawing.focus({ preventScroll: true });
    drawing.setPointerCapture(event.pointerId);
  }

  function travel(event) {
    if (!press) return;
    const { drawing, kind, name, from, adds, travels } = press, to = pointerIn(drawing, event);
    if (!travels && Math.hypot(to[0] - from[0], to[1] - from[1]) < NEAR) return;
    const by = [0, 0, 0], along = (k) => press.frame.value(k, to[k]) - press.frame.value(k, from[k]);
    axesOf(drawing).forEach((axis, k) => (by[axis] = along(k)));
    press.travels = true;
    if (kind === "pan") {
      view.centre = press.centre.map((value, k) => value - by[k]);
      fitted = false;
    } else if (kind === "band") board.band = { drawing, from, to };
    else {
      if (!travels && !board.selected.includes(name)) select(adds ? [...board.selected, name] : [name]);
      if (!travels) begin(name);
      const step = event.shiftKey ? FINE : COARSE; // without travel along an axis it stays as it is there
      moveBy(positionOf(itemOf(name)).map((value, k) => (Math.abs(by[k]) < step / 2 ? 0
        : Math.round((value + by[k]) / step) * step - value)));
    }
    redraw();
  }

  function up() {
    if (!press) return;
    const { drawing, kind, name, adds, travels } = press, { selected, band } = board;
    [press, board.band] = [null, null];
    if (band) {
      const { at: seen } = frameAt(drawing), { from, to } = band;
      const within = (item) => seen(positionOf(item)).every((end, k) => (end - from[k]) * (end - to[k]) < 0);
      const found = items().filter(within).map((item) => item.name);
      select(adds ? [...new Set([...selected, ...found])] : found);
    } else if (!travels && kind !== "pan" && (name || !adds)) {
      const others = selected.filter((kept) => kept !== name);
      select(!adds ? [name].filter(Boolean) : selected.includes(name) ? others : [...selected, name]);
    }
    settle();
    redraw();
  }

  function zoom(event) {
    event.preventDefault();
    const drawing = event.currentTarget, pointer = pointerIn(drawing, event), before = frameAt(drawing);
    view.scale = Math.min(Math.max(view.scale * Math.exp(-event.deltaY / 500), 0.005), 20);
    const after = frameAt(drawing), shift = (k) => before.value(k, pointer[k]) - after.value(k, pointer[k]);
    axesOf(drawing).forEach((axis, k) => (view.centre[axis] += shift(k)));
    fitted = false;
    redraw();
  }

  function step(by) {
    const names = items().map((item) => item.name), now = names.indexOf(board.selected.at(-1));
    if (names.length) select([names.at(now < 0 && by < 0 ? -1 : (now + by) % names.length)]);
  }

  const does = { // what needs no server, by buttons and keys
    fit,
    grid: (button) => (button.ariaPressed = !at("canvas").classList.toggle("plain")),
    elevation(button) {
      shown = shown === SIDE ? END : SIDE;
      [, elevation.ariaLabel, button.textContent] = shown;
      fit();
    },
    keys: () => at("keys").showModal(),
    "ctrl+a": () => select(board.scene.mounts.map((mount) => mount.name)),
    escape: () => (press || board.moving ? cancel() : select([])),
    pagedown: () => step(1), n: () => step(1), pageup: () => step(-1), p: () => step(-1),
  };

  // Do what a key says and tell whether it says anything.
  function key(name, event) {
    const along = ARROWS[name.replace("shift+", "")];
    if (name === " " && drawings.includes(event.target)) pans = true;
    else if (along && board.selected.length && !press && edits()) {
      if (!board.moving || board.moving.sent) begin(board.selected[0]);
      moveBy(board.moving.by.map((value, k) => value + along[k] * (event.shiftKey ? FINE : COARSE)));
    } else if (does[name] && board.scene) does[name]();
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
    for (const [name, listener] of Object.entries(listeners)) drawing.addEventListener(name, listener);
    new ResizeObserver(() => (fitted ? fit() : redraw())).observe(drawing);
  }
  document.addEventListener("keyup", lift);
  document.addEventListener("focusin", ({ target }) => {
    const name = target.closest("tr[data-name]")?.dataset.name;
    if (board.scene && itemOf(name) && !board.selected.includes(name)) select([name]);
  });
  document.addEventListener("click", ({ target }) => {
    const { canvas, least, keys, degrees, ...more } = target.closest("[data-canvas]")?.dataset ?? {};
    if (degrees) more.degrees = Number(degrees);
    if (does[canvas]) does[canvas](target);
    else if (canvas) act({ do: canvas, names: board.selected, ...more });
  });

  function show({ scene, preview, selected }) {
    const first = scene && !board.scene;
    if (scene) Object.assign(board, { scene, preview: null });
    if (scene) release();
    if (preview) board.preview = preview;
    if (!board.scene) return;
    if (board.moving && !board.moving.names.every(itemOf)) cancel();
    if (selected || scene) select((selected ?? board.selected).filter(itemOf), Boolean(selected));
    tell();
    if (first) fit();
    redraw();
  }
  return { show, key, settle, release, selected: () => board.selected };
}
