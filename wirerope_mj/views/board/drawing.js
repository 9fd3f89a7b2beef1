// A scene drawn in one view, to scale: lengths in mm, pixels on the screen. What is written is always text.

const SPACE = [[44, 24], [20, 24]]; // of rulers and chains of dimensions: left, right; above, below [px]
const [LETTER, LINE] = [6.3, 14]; // mean width of a letter, height of a line [px]
const STEPS = [1, 10, 100, 1000, 1e4].flatMap((ten) => [ten, 2 * ten, 5 * ten]); // of grids and rulers [mm]
const ORDER = ["deck", "envelope", "mass", "mount", "stop", "point", "centre"]; // from behind
const AMID = [0, 0]; // of words about what they name, as the others
const SPOTS = [[0, -1], [0, 1], [1, 0], [-1, 0], [1, -1], [-1, -1], [1, 1], [-1, 1]];
// Of a mount in halves of its space across its bars, along them and along its axis; its edges in turn.
const HEXAGON = [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [1, 1, 1], [-1, 1, 1], [-1, -1, 1]];
const LOOP = Array.from({ length: 24 }, (_, k) => k * Math.PI / 12).map((a) => [Math.cos(a), 0, Math.sin(a)]);
const BARS = [-1, 1].map((side) => [[0, -1, side], [0, 1, side]]);

/** Add a multiple of a vector. */
export const plus = (a, b, times = 1) => a.map((value, k) => value + times * b[k]);
const cross = ([a, b, c], [d, e, f]) => [b * f - c * e, c * d - a * f, a * e - b * d];
// Rectangles are left, top, right and bottom ends.
const around = (middle, reach) => [...plus(middle, reach, -1), ...plus(middle, reach)];
const apart = (a, b) => a[2] <= b[0] || b[2] <= a[0] || a[3] <= b[1] || b[3] <= a[1];
const lies = (a, b) => a[0] >= b[0] && a[1] >= b[1] && a[2] <= b[2] && a[3] <= b[3];
const lengthText = (value) => String(Math.round(value * 10) / 10).replace("-", "\u2212");
const pointText = (point, axes) => axes.map((axis) => `${"xyz"[axis]} ${lengthText(point[axis])}`).join(" ");
const percent = (used) => (typeof used === "number" ? `${Math.round(100 * used)} %` : "");
const pair = (point, n) => (n ? "L" : "M") + point.map((length) => length.toFixed(1));
const through = (points) => points.map(pair).join("");
const rectangle = ([a, b, c, d]) => `M${a} ${b}H${c}V${d}H${a}Z`;
const across = (k, at, from, to) => (k ? `M${from} ${at}H${to}` : `M${at} ${from}V${to}`); // axis k of a view

function svg(name, attributes, ...children) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) if (value !== "") made.setAttribute(key, value);
  made.append(...children);
  return made;
}

const text = ([x, y], words, kind) => svg("text", { x, y, class: kind }, words);
const path = (d, kind, fill = "") => svg("path", { d, class: kind, fill });

/** Tell how millimetres and pixels of a view go together; `axes` are those to the right and up. */
export function frameOf(drawing, axes, { scale, centre }) {
  const { width, height } = drawing.getBoundingClientRect(), size = [width, height], signs = [scale, -scale];
  const spans = size.map((length, k) => [SPACE[k][0], length - SPACE[k][1]]);
  const middle = spans.map(([from, to]) => (from + to) / 2);
  const pixel = (k, value) => middle[k] + (value - centre[axes[k]]) * signs[k];
  const value = (k, at) => centre[axes[k]] + (at - middle[k]) / signs[k];
  const at = (point) => axes.map((axis, k) => pixel(k, point[axis]));
  const pixels = (vector) => axes.map((axis, k) => vector[axis] * signs[k]);
  const point = (at) => axes.reduce((found, axis, k) => found.with(axis, value(k, at[k])), centre);
  return { axes, scale, size, spans, pixel, value, at, pixels, point };
}

/** List what a scene shows, each with its kind, as a preview has it and as far as it has moved. */
export function itemsOf(scene, preview, moving) {
  const { centre, stiffness_centre: stiffness, collides } = { ...scene, ...preview };
  const centres = [["stiffness", stiffness], ["mass", centre]]
    .map(([mark, position]) => ({ label: `of ${mark}`, mark, position }));
  const { mounts, boxes, stops, points } = scene;
  const kinds = Object.entries({ mount: mounts, box: boxes, stop: stops, point: points, centre: centres });
  const all = kinds.flatMap(([kind, of]) => of.map((item) => ({ kind, position: item.centre, ...item })));
  return all.filter(({ position }) => position).map((item) => ({
    ...item, ...preview?.mounts?.[item.name], collides: collides?.includes(item.name),
    position: moving?.names.includes(item.name) ? plus(item.position, moving.by) : item.position,
  }));
}

/** Find the lowest and the highest coordinates of items without decks and centres. */
export function extentOf(items) {
  const solid = items.filter(({ kind }) => kind !== "deck" && kind !== "centre");
  const ends = solid.flatMap(({ position, height = 0, size = [height, height, height] }) => (
    [plus(position, size, -0.5), plus(position, size, 0.5)]));
  if (!ends.length) ends.push([-500, -500, -500], [500, 500, 500]);
  return [Math.min, Math.max].map((most) => [0, 1, 2].map((k) => most(...ends.map((end) => end[k]))));
}

/** Say an item of a scene in words. */
export function describe({ kind, label, part, position, used }) {
  const share = percent(used) && `${percent(used)} used`;
  return [`${kind} ${label}`, part, `${pointText(position, [0, 1, 2])} mm`, share].filter(Boolean).join(", ");
}

function drawBox(frame, { kind, position, size }) {
  const bounds = around(frame.at(position), frame.pixels(size).map((length) => Math.abs(length) / 2));
  const hatched = kind === "deck" && frame.axes[1] === 2;
  return { bounds, shapes: [path(rectangle(bounds), "shape", hatched ? "url(#hatch)" : "")] };
}

// Draw a mount as it stands: its space, a loop of its rope, its two bars.
function drawMount(frame, { axial, bars, height, width, length = width, position }) {
  const sized = [[cross(bars, axial), width], [bars, length], [axial, height]], middle = frame.at(position);
  const halves = sized.map(([direction, size]) => frame.pixels(direction).map((part) => part * size / 2));
  const line = (sides, places) => through(places.map((place) => (
    place.reduce((sum, times, n) => plus(sum, sides[n], times), middle))));
  const turning = halves.map(([x, y]) => (y < 0 || (y === 0 && x < 0) ? [-x, -y] : [x, y]))
    .sort((a, b) => Math.atan2(a[1], a[0]) - Math.atan2(b[1], b[0]));
  const reach = halves.reduce((sum, half) => plus(sum, half.map(Math.abs)), [0, 0]);
  const shapes = [path(`${line(turning, HEXAGON)}Z`, "shape"), path(`${line(halves, LOOP)}Z`, "rope")];
  shapes.push(path(BARS.map((bar) => line(halves, bar)).join(""), "bar"));
  return { bounds: around(middle, reach), shapes };
}

// Draw a stop, a point or a centre with its mark, which the page has.
function drawMark(frame, { kind, mark = kind, position }) {
  const [x, y] = frame.at(position), shape = svg("use", { x, y, href: `#mark-${mark}`, class: "shape" });
  return { bounds: around([x, y], [7, 7]), shapes: [shape] };
}

const SHAPES = { mount: drawMount, stop: drawMark, point: drawMark, centre: drawMark };

// Write each beside its bounds, or inside them, where nothing else stands; fewer words if not all fit.
function addTexts({ spans: [[west, east], [north, south]] }, marks, wanted) {
  const written = [];
  return wanted.flatMap(({ bounds, choices, kind, inside }) => {
    const spots = choices.flatMap((words) => SPOTS.map((spot) => [words, spot]));
    spots.push([choices.at(-1), AMID]);
    const tries = spots.map(([words, spot]) => {
      const half = words.length * LETTER / 2, away = inside ? [-half - 4, -9] : [half + 4, 8];
      const at = spot.map((side, k) => (
        (bounds[k] + bounds[k + 2]) / 2 + side * ((bounds[k + 2] - bounds[k]) / 2 + away[k])));
      const others = spot === AMID && !inside ? written : [...marks, ...written];
      return { words, at, taken: around(at, [half, LINE / 2]), others };
    });
    const found = tries.find(({ taken, others }) => lies(taken, [west, north, east, south])
      && (!inside || lies(taken, bounds)) && others.every((other) => apart(taken, other)));
    if (!found) return [];
    written.push(found.taken);
    return [text(found.at, found.words, kind)];
  });
}

// Find multiples of a step, so many pixels or more, that are seen along an axis of a view, and their pixels.
function multiples(frame, k, pixels, least = 1) {
  const step = STEPS.find((length) => length >= least && length * frame.scale >= pixels) ?? STEPS.at(-1);
  const [low, high] = frame.spans[k].map((end) => frame.value(k, end) / step).sort((a, b) => a - b);
  const numbers = Array.from({ length: Math.floor(high) - Math.ceil(low) + 1 }, (_, n) => Math.ceil(low) + n);
  return numbers.map((number) => [number * step, frame.pixel(k, number * step)]);
}

function drawGrid(frame, kind, pixels, least) {
  const lines = [0, 1].flatMap((k) => multiples(frame, k, pixels, least)
    .map(([, at]) => across(k, at.toFixed(1), ...frame.spans[1 - k])));
  return path(lines.join(""), kind);
}

// Draw rulers above and left; chains of distances between neighbouring mounts below and right.
function drawEdges(frame, positions) {
  const { axes, spans: [[left, right], [top, bottom]], size } = frame, lines = [];
  const made = [path(rectangle([0, 0, ...size]) + rectangle([left, top, right, bottom]), "edge")];
  made.push(text([left / 2, top / 2], `${"xyz"[axes[0]]}, ${"xyz"[axes[1]]} mm`, "tick"));
  for (const k of [0, 1]) {
    const ruler = [top, left][k], row = [bottom, right][k] + 8, chain = row + 7, [from, to] = frame.spans[k];
    const write = (at, beside, value, kind) => (
      made.push(text(k ? [beside, at] : [at, beside], lengthText(value), k ? `tick ${kind}` : "tick")));
    for (const [value, at] of multiples(frame, k, 60).filter(([, pixel]) => pixel > from + 14)) {
      lines.push(across(k, at, ruler, ruler - 5));
      write(at, ruler - (k ? 7 : 12), value, "end");
    }
    const sorted = positions.map((point) => point[axes[k]]).sort((a, b) => a - b);
    const ends = sorted.filter((value, n) => !n || value - sorted[n - 1] >= 0.5)
      .map((value) => [value, frame.pixel(k, value)]).filter(([, at]) => at >= from && at <= to);
    ends.forEach(([value, at], n) => {
      lines.push(across(k, at, chain - 4, chain + 4));
      if (!n) return;
      const [before, start] = ends[n - 1], distance = value - before;
      lines.push(across(1 - k, chain, start, at));
      if (Math.abs(at - start) < lengthText(distance).length * LETTER + 4) return;
      write((at + start) / 2, row, distance, "upright");
    });
  }
  return [...made, path(lines.join(""), "line")];
}

/** Draw items into a view: those that are selected, the one that is held and how far it has moved, too. */
export function draw(drawing, axes, { items, selected, moving, band, view }) {
  const frame = frameOf(drawing, axes, view);
  const order = (a, b) => ORDER.indexOf(a.kind) - ORDER.indexOf(b.kind) || (a.used ?? -1) - (b.used ?? -1);
  const drawn = items.toSorted(order).map((item) => {
    const { bounds, shapes } = (SHAPES[item.kind] ?? drawBox)(frame, item), words = describe(item);
    const { kind, tone, name = "", movable = name !== "" } = item;
    const kinds = [kind, tone, !movable && "still", selected.includes(name) && "selected",
      item.collides && "collides"].filter(Boolean).join(" ");
    const more = { class: kinds, "data-name": movable ? name : "", role: "img", "aria-label": words };
    return { item, bounds, made: svg("g", more, svg("title", {}, words), ...shapes) };
  });
  const of = (...kinds) => drawn.filter(({ item }) => kinds.includes(item.kind));
  const [mounts, marks, centres] = [of("mount"), of("stop", "point"), of("centre")];
  const ends = centres.map(({ item }) => frame.at(item.position)), labels = [];
  const held = drawn.find(({ item }) => moving && item.name === moving.name);
  if (held) {
    const words = `by ${pointText(moving.by, axes)} to ${pointText(held.item.position, axes)}`;
    labels.push({ bounds: held.bounds, choices: [words], kind: "label travel" });
  }
  if (ends[1]) {
    const words = `${lengthText(Math.hypot(...plus(ends[0], ends[1], -1)) / frame.scale)} mm`;
    const choices = [`stiffness off the centre of mass by ${words}`, `off by ${words}`, words];
    labels.push({ bounds: centres[1].bounds, choices, kind: "label distance" });
  }
  for (const { bounds, item: { label, tone, used } } of mounts.toReversed()) { // the most used first
    labels.push({ bounds, choices: [`${label} ${percent(used)}`.trim(), label], kind: `label ${tone}` });
  }
  for (const { bounds, item: { label, size } } of [...marks, ...of("mass", "envelope", "deck")]) {
    labels.push({ bounds, choices: [label], kind: "label quiet", inside: size });
  }
  const texts = addTexts(frame, [...mounts, ...marks, ...centres].map(({ bounds }) => bounds), labels);
  const edges = drawEdges(frame, mounts.map(({ item }) => item.position));
  const rest = band?.drawing === drawing ? [path(rectangle([...band.from, ...band.to]), "band")] : [];
  drawing.replaceChildren(
    drawGrid(frame, "grid", 8, 10), drawGrid(frame, "grid major", 60), path(through(ends), "between"),
    ...drawn.map(({ made }) => made),
    svg("g", { class: "texts", "aria-hidden": "true" }, ...texts, ...edges, ...rest),
  );
}
