// A scene drawn in one view, to scale: lengths in mm, pixels on the screen. What is written is always text.

const SPACE = [[44, 24], [20, 24]]; // of rulers and chains of dimensions: left, right; above, below [px]
const [LETTER, LINE] = [6.3, 14]; // mean width of a letter, height of a line [px]
const STEPS = [1, 10, 100, 1000, 1e4].flatMap((ten) => [ten, 2 * ten, 5 * ten]); // of grids and rulers [mm]
const ORDER = ["deck", "envelope", "mass"]; // of boxes, from behind
const AMID = [0, 0]; // of words about what they name, as the others
const SPOTS = [[0, -1], [0, 1], [1, 0], [-1, 0], [1, -1], [-1, -1], [1, 1], [-1, 1], AMID];

export const lengthText = (value) => String(Math.round(value * 10) / 10).replace("-", "\u2212");
export const pointText = (point) => point.map((value, k) => `${"xyz"[k]} ${lengthText(value)}`).join(" ");
export const positionOf = (item) => item.position ?? item.centre;
const percent = (used) => (typeof used === "number" ? `${Math.round(100 * used)} %` : "");
const pair = ([x, y], n) => `${n ? "L" : "M"}${x.toFixed(1)} ${y.toFixed(1)}`;
const through = (points) => points.map(pair).join("");
const plus = (a, b, times = 1) => a.map((value, k) => value + times * b[k]);
const cross = ([a, b, c], [d, e, f]) => [b * f - c * e, c * d - a * f, a * e - b * d];
const across = (k, at, from, to) => (k ? `M${from} ${at}H${to}` : `M${at} ${from}V${to}`); // axis k of a view

function svg(name, attributes, ...children) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) if (value !== "") made.setAttribute(key, value);
  made.append(...children);
  return made;
}

const text = (x, y, words, kind, more) => svg("text", { x, y, class: kind, ...more }, words);
const path = (d, kind, more) => svg("path", { d, class: kind, ...more });

/** Tell how millimetres and pixels of a view go together; `axes` are those to the right and up. */
export function frameOf(drawing, axes, { scale, centre }) {
  const { width, height } = drawing.getBoundingClientRect(), size = [width, height], signs = [scale, -scale];
  const spans = size.map((length, k) => [SPACE[k][0], length - SPACE[k][1]]);
  const pixel = (k, value) => (spans[k][0] + spans[k][1]) / 2 + (value - centre[axes[k]]) * signs[k];
  const value = (k, at) => centre[axes[k]] + (at - (spans[k][0] + spans[k][1]) / 2) / signs[k];
  const at = (point) => axes.map((axis, k) => pixel(k, point[axis]));
  return { axes, scale, size, spans, pixel, value, at };
}

/** Find the lowest and the highest coordinates of a scene without its decks. */
export function extentOf({ boxes, mounts, stops, points }) {
  const sized = boxes.filter((box) => box.kind !== "deck").map((box) => [box.centre, box.size]);
  const marks = [...mounts, ...stops, ...points].map(({ position, height: h = 0 }) => [position, [h, h, h]]);
  const all = sized.length + marks.length ? [...sized, ...marks] : [[[0, 0, 0], [1000, 1000, 1000]]];
  const ends = (side, k) => all.map(([point, size]) => point[k] + side * size[k] / 2);
  return [[0, 1, 2].map((k) => Math.min(...ends(-1, k))), [0, 1, 2].map((k) => Math.max(...ends(1, k)))];
}

/** Say an item of a scene in words. */
export function describe(item, used = item.used, position = positionOf(item)) {
  const kind = item.part ? "mount" : item.axial ? "stop" : item.kind ?? "point";
  const share = percent(used) && `${percent(used)} used`;
  return [`${kind} ${item.label}`, item.part, `${pointText(position)} mm`, share].filter(Boolean).join(", ");
}

// Draw the outline of a box with three edges: the edges in the order of their angles, there and back.
function outlineOf(frame, centre, edges) {
  const flat = edges.map((edge) => frame.axes.map((axis, k) => edge[axis] * frame.scale * (k ? -1 : 1)))
    .map(([x, y]) => (y < 0 || (y === 0 && x < 0) ? [-x, -y] : [x, y]))
    .sort((a, b) => Math.atan2(a[1], a[0]) - Math.atan2(b[1], b[0]));
  let corner = flat.reduce((sum, edge) => plus(sum, edge, -0.5), frame.at(centre));
  const corners = [...flat, ...flat.map(([x, y]) => [-x, -y])].map((edge) => (corner = plus(corner, edge)));
  const ends = (least) => [0, 1].map((k) => least(...corners.map((point) => point[k])));
  return { d: `${through(corners)}Z`, bounds: [...ends(Math.min), ...ends(Math.max)] };
}

function drawBox(frame, { kind, size: [a, b, c] }, centre) {
  const { d, bounds } = outlineOf(frame, centre, [[a, 0, 0], [0, b, 0], [0, 0, c]]);
  const hatched = kind === "deck" && frame.axes[1] === 2;
  return { bounds, shapes: [path(d, "shape", { fill: hatched ? "url(#hatch)" : "" })] };
}

// Draw a mount as it stands: its space, a loop of its rope, its two bars.
function drawMount(frame, { axial, bars, height, width, length = width }, position) {
  const sized = [[cross(bars, axial), width], [bars, length], [axial, height]];
  const [roll, along, up] = sized.map(([direction, size]) => direction.map((part) => part * size / 2));
  const { d, bounds } = outlineOf(frame, position, [roll, along, up].map((half) => plus(half, half)));
  const angles = Array.from({ length: 24 }, (_, k) => k * Math.PI / 12);
  const line = (places) => through(places.map(([x, y, z]) => frame.at(
    plus(plus(plus(position, roll, x), along, y), up, z))));
  const rope = line(angles.map((angle) => [Math.cos(angle), 0, Math.sin(angle)]));
  const ends = line([[0, -1, -1], [0, 1, -1]]) + line([[0, -1, 1], [0, 1, 1]]);
  return { bounds, shapes: [path(d, "shape"), path(`${rope}Z`, "rope"), path(ends, "bar")] };
}

// Draw a stop as a circle, a point as a cross, the centre of mass as a quartered disc, of stiffness crossed.
function drawMark(frame, item, position) {
  const [cx, cy] = frame.at(position), disc = (r, kind) => svg("circle", { cx, cy, r, class: kind });
  const plain = path(`M${cx - 7} ${cy}h14M${cx} ${cy - 7}v14`, "shape");
  const quarters = path(`M${cx} ${cy}h7a7 7 0 0 0 -7 -7zh-7a7 7 0 0 0 7 7z`, "quarters");
  const shapes = item.kind === "centre" ? [disc(7, "disc"), item.label === "of mass" ? quarters : plain]
    : [disc(10, "ground"), item.axial ? disc(5, "shape") : plain];
  return { bounds: [cx - 7, cy - 7, cx + 7, cy + 7], shapes };
}

// Join mounts that lie behind each other under one label, with the most used of them.
function labelsOf(mounts) {
  const groups = Object.groupBy(mounts, ({ bounds }) => bounds.map((value) => Math.round(value / 2)).join());
  return Object.values(groups).map((parts) => { // the most used comes last
    const { bounds, tone, used, item } = parts.at(-1);
    const label = item.label + (parts.length > 1 ? ` +${parts.length - 1}` : "");
    return { bounds, choices: [`${label} ${percent(used)}`.trim(), label], kind: `label ${tone}` };
  });
}

// Write each beside its bounds, or inside them, where nothing else stands; fewer words if not all fit.
function addTexts({ spans: [[west, east], [north, south]] }, marks, wanted) {
  const written = [], apart = (a, b) => a[2] <= b[0] || b[2] <= a[0] || a[3] <= b[1] || b[3] <= a[1];
  return wanted.flatMap(({ bounds: [left, top, right, bottom], choices, kind, inside }) => {
    for (const words of choices) {
      const half = words.length * LETTER / 2, gap = inside ? -half - 4 : half + 4, rise = inside ? -9 : 8;
      if (inside && (right - left < -2 * gap || bottom - top < 18)) continue;
      for (const spot of SPOTS) {
        const x = (left + right) / 2 + spot[0] * ((right - left) / 2 + gap);
        const y = (top + bottom) / 2 + spot[1] * ((bottom - top) / 2 + rise);
        const [a, b, c, d] = [x - half, y - LINE / 2, x + half, y + LINE / 2];
        const amid = spot === AMID && !inside;
        if (a < west || b < north || c > east || d > south || (amid && words !== choices.at(-1))) continue;
        if (![...(amid ? [] : marks), ...written].every((other) => apart([a, b, c, d], other))) continue;
        written.push([a, b, c, d]);
        return [text(x, y, words, kind)];
      }
    }
    return [];
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
  const { axes, spans: [[left, right], [top, bottom]], size: [width, height] } = frame;
  const made = [path(`M0 0H${width}V${height}H0ZM${left} ${top}V${bottom}H${right}V${top}Z`, "edge")];
  made.push(text(left / 2, top / 2, `${"xyz"[axes[0]]}, ${"xyz"[axes[1]]} mm`, "tick"));
  for (const k of [0, 1]) {
    const ruler = [top, left][k], row = [bottom, right][k] + 8, chain = row + 7, [from, to] = frame.spans[k];
    for (const [value, at] of multiples(frame, k, 60).filter(([, pixel]) => pixel > from + 14)) {
      const words = lengthText(value);
      made.push(path(across(k, at, ruler, ruler - 5), "line"));
      made.push(k ? text(left - 7, at, words, "tick end") : text(at, top - 12, words, "tick"));
    }
    const sorted = positions.map((point) => point[axes[k]]).sort((a, b) => a - b);
    const ends = sorted.filter((value, n) => !n || value - sorted[n - 1] >= 0.5)
      .map((value) => [value, frame.pixel(k, value)]).filter(([, at]) => at >= from && at <= to);
    const lines = ends.map(([, at]) => across(k, at, chain - 4, chain + 4));
    ends.slice(1).forEach(([value, at], n) => {
      const before = ends[n], words = lengthText(value - before[0]), middle = (at + before[1]) / 2;
      lines.push(across(1 - k, chain, before[1], at));
      if (Math.abs(at - before[1]) < words.length * LETTER + 4) return;
      made.push(k ? text(row, middle, words, "tick", { transform: `rotate(-90 ${row} ${middle})` })
        : text(middle, row, words, "tick"));
    });
    if (lines.length > 1) made.push(path(lines.join(""), "line"));
  }
  return made;
}

/** Draw a board into a view: its scene, what is selected, what moves and how far, what a preview says. */
export function draw(drawing, axes, { scene, preview, selected, moving, band, view }) {
  const frame = frameOf(drawing, axes, view);
  const { centre, stiffness_centre: stiffness } = { ...scene, ...preview };
  const drawn = (kind, shape) => (item) => {
    const position = moving?.names.includes(item.name) ? plus(positionOf(item), moving.by) : positionOf(item);
    const { used, tone } = { ...item, ...preview?.mounts?.[item.name] };
    const still = !item.name || item.movable === false;
    const { bounds, shapes } = shape(frame, item, position), words = describe(item, used, position);
    const state = { [kind ?? item.kind]: true, [tone]: tone, still, selected: selected.includes(item.name),
      collides: preview?.collides?.includes(item.name) };
    const names = Object.keys(state).filter((name) => state[name]).join(" ");
    const more = { class: names, "data-name": still ? "" : item.name, role: "img", "aria-label": words };
    return { item, position, used, tone, bounds, made: svg("g", more, svg("title", {}, words), ...shapes) };
  };
  const ordered = [...scene.boxes].sort((a, b) => ORDER.indexOf(a.kind) - ORDER.indexOf(b.kind));
  const boxes = ordered.map(drawn(null, drawBox));
  const mounts = scene.mounts.map(drawn("mount", drawMount)).sort((a, b) => (a.used ?? -1) - (b.used ?? -1));
  const marks = [...scene.stops.map(drawn("stop", drawMark)), ...scene.points.map(drawn("point", drawMark))];
  const centres = [["of stiffness", stiffness], ["of mass", centre]].filter(([, position]) => position)
    .map(([label, position]) => ({ label, position, kind: "centre" })).map(drawn("centre", drawMark));
  const line = path(through(centres.map((part) => frame.at(part.position))), "between");
  const labels = labelsOf(mounts);
  if (centres.length === 2) {
    const words = `${lengthText(Math.hypot(...axes.map((axis) => centre[axis] - stiffness[axis])))} mm`;
    labels.unshift({ bounds: centres[1].bounds, choices: [words], kind: "label distance" });
  }
  const held = moving && [...boxes, ...mounts, ...marks].find((part) => part.item.name === moving.name);
  if (held) { // how far it has moved and where it is
    const said = (point) => axes.map((axis) => `${"xyz"[axis]} ${lengthText(point[axis])}`).join(" ");
    const choices = [`by ${said(moving.by)} to ${said(held.position)}`];
    labels.unshift({ bounds: held.bounds, choices, kind: "label travel" });
  }
  const quiet = ({ bounds, item }) => ({ bounds, choices: [item.label], kind: "label quiet" });
  labels.push(...marks.map(quiet), ...boxes.map((box) => ({ ...quiet(box), inside: true })));
  const over = addTexts(frame, [...mounts, ...marks, ...centres].map((part) => part.bounds), labels);
  over.push(...drawEdges(frame, mounts.map((part) => part.position)));
  const [from, to] = band?.drawing === drawing ? [band.from, band.to] : [];
  if (from) over.push(path(`M${from}H${to[0]}V${to[1]}H${from[0]}Z`, "band"));
  drawing.replaceChildren(
    drawGrid(frame, "grid", 8, 10), drawGrid(frame, "grid major", 60),
    ...[...boxes, ...mounts, ...marks].map((part) => part.made), line, ...centres.map((part) => part.made),
    svg("g", { class: "texts", "aria-hidden": "true" }, ...over),
  );
}
