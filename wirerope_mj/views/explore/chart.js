"use strict";
// Curves over time as one SVG: what was measured wide and pale, over it the run before dashed and this run solid.

const HEIGHT = 240, LEFT = 46, RIGHT = 20, TOP = 24, BOTTOM = 34;

function svg(name, attributes, text) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== undefined) element.textContent = text;
  return element;
}

// About `count` round numbers between two values.
function ticks(low, high, count) {
  const rough = (high - low) / count, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((one) => one >= rough);
  const found = [];
  for (let n = Math.ceil(low / step - 1e-9); n <= Math.floor(high / step + 1e-9); n++) found.push(n * step);
  return [found, Math.max(0, -Math.floor(Math.log10(step) + 1e-9))];
}

function shown(value, decimals) {
  return value.toFixed(decimals).replace("-", "\u2212");
}

// A curve as a figure of a width [px], in which letters have the size that they have in the page.
function chart(curve, width) {
  const ys = curve.lines.flatMap((line) => line.y), xs = curve.lines.flatMap((line) => line.x);
  let low = Math.min(0, ...ys.map(Number)), high = Math.max(0, ...ys);
  // A limit far beyond the curve would press it flat: only one that is near is drawn.
  const near = curve.limits.filter((limit) => limit >= 1.6 * low - 1e-9 && limit <= 1.6 * high + 1e-9);
  low = Math.min(low, ...near); high = Math.max(high, ...near);
  const margin = 0.06 * (high - low || 1);
  low -= low < 0 ? margin : 0; high += margin;
  const first = Math.min(...xs), last = Math.max(...xs);
  const x = (value) => LEFT + (width - LEFT - RIGHT) * (value - first) / (last - first || 1);
  const y = (value) => HEIGHT - BOTTOM - (HEIGHT - TOP - BOTTOM) * (value - low) / (high - low || 1);

  const figure = document.createElement("figure");
  const caption = document.createElement("figcaption");
  caption.textContent = curve.title;
  const peaks = curve.lines.map((line) => {
    const extreme = line.y.reduce((most, value) => (Math.abs(value) > Math.abs(most) ? value : most), 0);
    return `${line.name}: at most ${shown(extreme, 2)} ${curve.unit}`;
  });
  const picture = svg("svg", {
    viewBox: `0 0 ${width} ${HEIGHT}`, role: "img", "aria-label": `${curve.title}. ${peaks.join("; ")}.`,
  });

  const [levels, decimals] = ticks(low, high, 5);
  for (const level of levels) {
    const zero = Math.abs(level) < 1e-9 * (high - low);
    picture.append(svg("line", {
      class: zero ? "zero" : "grid", x1: LEFT, x2: width - RIGHT, y1: y(level), y2: y(level),
    }));
    picture.append(svg("text", { x: LEFT - 6, y: y(level) + 4, "text-anchor": "end" }, shown(level, decimals)));
  }
  const [instants, places] = ticks(first, last, 5);
  for (const instant of instants) {
    picture.append(svg("line", { class: "grid", x1: x(instant), x2: x(instant), y1: TOP, y2: HEIGHT - BOTTOM }));
    const text = svg("text", { x: x(instant), y: HEIGHT - BOTTOM + 15, "text-anchor": "middle" }, shown(instant, places));
    picture.append(text);
  }
  picture.append(svg("text", { x: (LEFT + width - RIGHT) / 2, y: HEIGHT - 4, "text-anchor": "middle" }, "time [ms]"));
  for (const limit of near) {
    picture.append(svg("line", { class: "limit", x1: LEFT, x2: width - RIGHT, y1: y(limit), y2: y(limit) }));
    picture.append(svg("text", {
      class: "limit", x: width - RIGHT - 2, y: y(limit) + (limit < 0 ? 12 : -4), "text-anchor": "end",
    }, curve.limit));
  }
  for (const line of curve.lines) {
    const points = line.x.map((value, n) => `${x(value).toFixed(1)},${y(line.y[n]).toFixed(1)}`);
    picture.append(svg("polyline", { class: `line ${line.role}`, points: points.join(" ") }));
  }
  [...curve.lines].reverse().forEach((line, n) => {
    const text = (line.role === "before" ? "\u2505 " : "\u2501 ") + line.name;
    picture.append(svg("text", { class: line.role, x: LEFT + 4 + 90 * n, y: 15 }, text));
  });
  figure.append(caption, picture);
  return figure;
}
