// A view to scale: its shapes are the server's, in mm; grid, rulers, dimensions and labels stand around them in pixels.

const SPACE = [[44, 24], [20, 24]]; // of rulers and chains of dimensions: left, right; above, below [px]
const [LETTER, LINE] = [6.3, 14]; // mean width of a letter, height of a line [px]
const STEPS = [1, 10, 100, 1000, 1e4].flatMap((ten) => [ten, 2 * ten, 5 * ten]); // of grids and rulers [mm]
const AMID = [0, 0]; // of words about what they name, as the others
const SPOTS = [[0, -1], [0, 1], [1, 0], [-1, 0], [1, -1], [-1, -1], [1, 1], [-1, 1]];

/** Add a multiple of a vector. */
export const plus = (a, b, times = 1) => a.map((value, k) => value + times * b[k]);
// Rectangles are left, top, right and bottom ends.
const apart = (a, b) => a[2] <= b[0] || b[2] <= a[0] || a[3] <= b[1] || b[3] <= a[1];
const lies = (a, b) => a[0] >= b[0] && a[1] >= b[1] && a[2] <= b[2] && a[3] <= b[3];
const lengthText = (value) => String(Math.round(value * 10) / 10).replace("-", "\u2212");
const pointText = (point, axes) => axes.map((axis) => `${"xyz"[axis]} ${lengthText(point[axis])}`).join(" ");
const rectangle = ([a, b, c, d]) => `M${a} ${b}H${c}V${d}H${a}Z`;
const across = (k, at, from, to) => (k ? `M${from} ${at}H${to}` : `M${at} ${from}V${to}`); // axis k of a view

const path = (d, kind) => `<path d="${d}" class="${kind}"/>`;
const text = ([x, y], html, kind) => `<text x="${x}" y="${y}" class="${kind}">${html}</text>`; // as the server escaped it

/** Tell how millimetres and pixels of a view go together; its axes are those to the right and up. */
export function frameOf(drawing, { scale, centre }) {
  const { left, top, width, height } = drawing.getBoundingClientRect(), size = [width, height];
  const axes = [...drawing.dataset.axes].map(Number), signs = [scale, -scale];
  const spans = size.map((length, k) => [SPACE[k][0], length - SPACE[k][1]]);
  const middle = spans.map(([from, to]) => (from + to) / 2);
  const pixel = (k, value) => middle[k] + (value - centre[axes[k]]) * signs[k];
  const value = (k, at) => centre[axes[k]] + (at - middle[k]) / signs[k];
  const at = (point) => axes.map((axis, k) => pixel(k, point[axis]));
  const point = (at) => axes.reduce((found, axis, k) => found.with(axis, value(k, at[k])), centre);
  return { axes, scale, corner: [left, top], size, spans, pixel, value, at, point };
}

// Write each beside its bounds, or inside them, where nothing else stands; fewer words if not all fit.
function addTexts({ spans: [[west, east], [north, south]] }, marks, wanted) {
  const written = [];
  return wanted.flatMap(({ bounds, choices, kind, inside }) => {
    const spots = choices.flatMap((words) => SPOTS.map((spot) => [words, spot]));
    spots.push([choices.at(-1), AMID]);
    const tries = spots.map(([words, spot]) => {
      const reach = [words.length * LETTER / 2, LINE / 2];
      const away = inside ? [-reach[0] - 4, -9] : [reach[0] + 4, 8];
      const at = spot.map((side, k) => (
        (bounds[k] + bounds[k + 2]) / 2 + side * ((bounds[k + 2] - bounds[k]) / 2 + away[k])));
      const others = spot === AMID && !inside ? written : [...marks, ...written];
      return { words, at, taken: [...plus(at, reach, -1), ...plus(at, reach)], others };
    });
    const found = tries.find(({ taken, others }) => lies(taken, [west, north, east, south])
      && (!inside || lies(taken, bounds)) && others.every((other) => apart(taken, other)));
    if (!found) return [];
    written.push(found.taken);
    return [text(found.at, found.words, `label ${kind}`)];
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

/** Draw a view: shapes shifted as far as they have moved, and how far the one that is held has moved. */
export function draw(drawing, { scene, moving, band, view, shiftOf }) {
  const frame = frameOf(drawing, view), [under, shapes, over] = drawing.children, groups = [...shapes.children];
  shapes.setAttribute("transform", `translate(${frame.at([0, 0, 0])}) scale(${view.scale})`);
  shapes.style.setProperty("--scale", view.scale);
  for (const group of groups) {
    const { name } = group.dataset, shift = shiftOf(name);
    group.setAttribute("transform", `translate(${shift[frame.axes[0]]} ${-shift[frame.axes[1]]})`);
  }
  const bounds = groups.map((group) => {
    const { left, top, right, bottom } = group.querySelector(".shape").getBoundingClientRect();
    return plus([left, top, right, bottom], [...frame.corner, ...frame.corner], -1);
  });
  const labels = scene.views[drawing.id].labels.map(({ of, ...label }) => ({ bounds: bounds[of], ...label }));
  const held = groups.findIndex((group) => moving && group.dataset.name === moving.name);
  if (held >= 0) {
    const words = `by ${pointText(moving.by, frame.axes)} to ${pointText(plus(moving.from, moving.by), frame.axes)}`;
    labels.unshift({ bounds: bounds[held], choices: [words], kind: "travel" });
  }
  const solid = bounds.filter((_, n) => groups[n].matches(".mount, .stop, .point, .centre"));
  const mounts = scene.items.filter(({ kind }) => kind === "mount");
  const edges = drawEdges(frame, mounts.map(({ name, position }) => plus(position, shiftOf(name))));
  const rest = band?.drawing === drawing ? [path(rectangle([...band.from, ...band.to]), "band")] : [];
  under.innerHTML = drawGrid(frame, "grid", 8, 10) + drawGrid(frame, "grid major", 60);
  over.innerHTML = [...addTexts(frame, solid, labels), ...edges, ...rest].join("");
}
