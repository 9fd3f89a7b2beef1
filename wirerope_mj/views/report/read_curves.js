"use strict";
// Shows what the curves of a chart have at the pointer: the nearest point of each along the axis across.
const shown = document.createElement("div");
shown.className = "read";
shown.setAttribute("role", "status");
shown.hidden = true;
document.body.append(shown);

const points = new WeakMap();

function pointsOf(path) {
  if (!points.has(path)) {
    const numbers = path.getAttribute("d").replaceAll(/h[\d.]+/g, " ").match(/-?[\d.]+/g).map(Number);
    points.set(path, numbers.length % 2 ? [] : numbers);
  }
  return points.get(path);
}

function value(place, first, length, low, high, log) {
  const part = (place - first) / length;
  return log ? low * (high / low) ** part : low + (high - low) * part;
}

function read(svg, event) {
  const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
  for (const panel of svg.querySelectorAll(".panel")) {
    const [left, top, width, height] = panel.dataset.area.split(" ").map(Number);
    if (at.x < left || at.x > left + width || at.y < top || at.y > top + height) continue;
    const [x0, x1, y0, y1] = panel.dataset.ranges.split(" ").map(Number);
    const log = panel.dataset.log;
    const lines = [];
    for (const path of [...panel.querySelectorAll("path[data-name]:not(.limit)")].reverse()) {
      const xy = pointsOf(path);
      let best = -1, least = Infinity;
      for (let i = 0; i < xy.length; i += 2) {
        const away = panel.dataset.xunit === "mm" ? Math.hypot(xy[i] - at.x, xy[i + 1] - at.y) : Math.abs(xy[i] - at.x);
        if (away < least) [least, best] = [away, i];
      }
      if (best < 0 || lines.length > 8 || path.classList.contains("others")) continue;
      const x = value(xy[best], left, width, x0, x1, log.includes("x"));
      const y = value(xy[best + 1], top + height, -height, y0, y1, log.includes("y"));
      if (!lines.length) lines.push(`${x.toPrecision(4)} ${panel.dataset.xunit}`);
      lines.push(`${path.dataset.name}: ${y.toPrecision(3)} ${panel.dataset.unit}`);
    }
    shown.textContent = lines.join("\n");
    shown.hidden = !lines.length;
    shown.style.left = `${Math.min(event.clientX + 14, window.innerWidth - shown.offsetWidth - 8)}px`;
    shown.style.top = `${Math.max(event.clientY - shown.offsetHeight - 12, 4)}px`;
    return;
  }
  shown.hidden = true;
}

for (const svg of document.querySelectorAll("svg.chart")) {
  svg.addEventListener("pointermove", (event) => read(svg, event));
  svg.addEventListener("pointerdown", (event) => read(svg, event));
  svg.addEventListener("pointerleave", () => { shown.hidden = true; });
}
