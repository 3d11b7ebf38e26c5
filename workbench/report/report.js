"use strict";
// What the page does beyond being read: zoom, values under the cursor, traces on and off, tables sorted by a column.
// Without this script all of the page is there. A drawing is made ready when the pointer or the keyboard first reaches it.

const part = (name, attributes, text) => {
  const made = document.createElementNS(document.querySelector(".drawing svg").namespaceURI, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== undefined) made.textContent = text;
  return made;
};
const button = (text, act) => {
  const made = document.createElement("button");
  made.type = "button";
  made.textContent = text;
  made.addEventListener("click", act);
  return made;
};
const RAISED = { "-": "\u207b", 0: "\u2070", 1: "\u00b9", 2: "\u00b2", 3: "\u00b3", 4: "\u2074", 5: "\u2075", 6: "\u2076", 7: "\u2077", 8: "\u2078", 9: "\u2079" };

// A number as a person reads it, with so many significant figures.
function shown(value, figures = 4) {
  if (!Number.isFinite(value)) return "\u2013";
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e5)) {
    const [digits, power] = value.toExponential(figures - 1).split("e");
    const raised = [...String(Number(power))].map((c) => RAISED[c]).join("");
    return `${String(Number(digits))} \u00d7 10${raised}`.replace(/^-/, "\u2212").replace(/^1 \u00d7 /, "");
  }
  return String(Number(value.toPrecision(figures))).replace("-", "\u2212");
}

// --- one scale of a graph: from places in the drawing to values, over the part that is in view ----------------------

class Scale {
  constructor(known, from, to) {
    Object.assign(this, known, { from, to, low: from, high: to }); // from, to: its ends; low, high: what is in view
    this.log = this.kind === "log";
    this.ends = this.log ? this.limits.map(Math.log10) : this.limits;
  }
  get free() { return this.kind === "linear" || this.log; }
  value(place) { // of a place in the whole drawing
    const v = this.ends[0] + ((place - this.from) / (this.to - this.from)) * (this.ends[1] - this.ends[0]);
    return this.log ? 10 ** v : v;
  }
  place(value) {
    const v = this.log ? Math.log10(value) : value;
    return this.from + ((v - this.ends[0]) / (this.ends[1] - this.ends[0])) * (this.to - this.from);
  }
  get factor() { return (this.to - this.from) / (this.high - this.low); }
  seen(place) { return this.from + (place - this.low) * this.factor; } // where it lies after zooming
  whole(place) { return this.low + (place - this.from) / this.factor; } // and back
  ticks() {
    const [a, b] = [this.value(this.low), this.value(this.high)].sort((x, y) => x - y);
    if (this.log && b / a > 30) {
      const every = Math.max(1, Math.ceil(Math.log10(b / a) / 6));
      const found = [];
      for (let e = Math.ceil(Math.log10(a)); e <= Math.log10(b); e += every) found.push(10 ** e);
      return found;
    }
    const rough = (b - a) / 5;
    const ten = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 5, 10].map((k) => k * ten).find((s) => s >= rough);
    const found = [];
    for (let k = Math.ceil(a / step); k * step <= b; k++) found.push(Number((k * step).toPrecision(12)));
    return found;
  }
}

// --- one drawing ----------------------------------------------------------------------------------------------------

class Drawing {
  constructor(place) {
    this.place = place;
    this.svg = place.querySelector("svg");
    const known = JSON.parse(this.svg.dataset.graphs);
    this.names = known.traces;
    this.graphs = known.plots.map((one, k) => new Graph(this, one, this.svg.querySelector(`[data-plot="${k}"]`)));
    for (const graph of this.graphs) {
      graph.x = this.graphs[graph.shares[0]].x; // what shares a scale moves together
      graph.y = this.graphs[graph.shares[1]].y;
    }
    this.readout = document.createElement("output");
    this.readout.className = "readout";
    place.after(this.tools(), this.readout);
    this.listen();
  }
  tools() {
    const row = document.createElement("div");
    row.className = "tools";
    row.setAttribute("role", "group");
    row.setAttribute("aria-label", "Tools of this drawing");
    this.zooms = this.graphs.some((g) => g.x.free && g.y.free); // bars stand for themselves
    if (this.zooms) {
      row.append(button("Zoom in", () => this.zoom(0.5)), button("Zoom out", () => this.zoom(2)), button("Whole", () => this.whole()));
    }
    this.names.forEach((name, k) => {
      const made = button(name, () => this.toggle(k, made));
      made.setAttribute("aria-pressed", "true");
      row.append(made);
    });
    return row;
  }
  toggle(key, made) {
    const on = made.getAttribute("aria-pressed") !== "true";
    made.setAttribute("aria-pressed", String(on));
    for (const one of this.svg.querySelectorAll(`[data-trace="${key}"]`)) one.style.display = on ? "" : "none";
  }
  at(event) { // the pointer in the drawing's own pixels
    const matrix = this.svg.getScreenCTM().inverse();
    const p = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix);
    const graph = this.graphs.find((g) => p.x >= g.x.from && p.x <= g.x.to && p.y >= g.y.to && p.y <= g.y.from);
    return { graph, x: p.x, y: p.y };
  }
  listen() {
    this.svg.addEventListener("pointermove", (event) => this.moved(event));
    this.svg.addEventListener("pointerleave", () => this.left());
    this.svg.addEventListener("pointerdown", (event) => this.begun(event));
    this.svg.addEventListener("pointerup", (event) => this.ended(event));
    this.svg.addEventListener("pointercancel", () => this.stopped());
    this.svg.addEventListener("dblclick", () => this.whole());
    this.place.addEventListener("keydown", (event) => this.key(event));
  }
  key(event) {
    const act = { "+": () => this.zoom(0.5), "-": () => this.zoom(2), 0: () => this.whole(), Escape: () => this.stopped() }[event.key];
    if (act) { act(); event.preventDefault(); }
    if (["ArrowLeft", "ArrowRight"].includes(event.key) && this.graphs.length) { // the cursor by the keyboard
      const graph = this.cursor?.graph ?? this.graphs[0];
      const step = (event.key === "ArrowLeft" ? -1 : 1) * (graph.x.to - graph.x.from) / 100;
      const x = Math.min(Math.max((this.cursor?.x ?? graph.x.from) + step, graph.x.from), graph.x.to);
      this.point({ graph, x, y: (graph.y.from + graph.y.to) / 2 });
      event.preventDefault();
    }
  }
  begun(event) {
    const at = this.at(event);
    if (event.button || event.pointerType === "touch" || !at.graph || event.target.closest("text")) return;
    this.drag = at;
    this.frame = part("rect", { class: "frame", width: 0, height: 0 });
    this.svg.append(this.frame);
    event.preventDefault();
  }
  moved(event) {
    const at = this.at(event);
    if (this.drag) {
      const [x0, x1, y0, y1] = this.dragged(at);
      for (const [key, value] of Object.entries({ x: x0, y: y0, width: x1 - x0, height: y1 - y0 })) this.frame.setAttribute(key, value);
    } else if (at.graph) {
      this.point(at);
    } else {
      this.left();
    }
  }
  // The frame that was drawn: along a direction in which it is thin, or that has names, it takes the whole graph.
  dragged(at) {
    const { graph, x, y } = this.drag;
    const within = (v, a, b) => Math.min(Math.max(v, Math.min(a, b)), Math.max(a, b));
    const ends = (a, b, scale) => {
      const pair = [a, within(b, scale.from, scale.to)].sort((u, v) => u - v);
      return scale.free && pair[1] - pair[0] >= 6 ? pair : [scale.from, scale.to].sort((u, v) => u - v);
    };
    return [...ends(x, at.x, graph.x), ...ends(y, at.y, graph.y)];
  }
  ended(event) {
    if (!this.drag) return;
    const at = this.at(event);
    const { graph } = this.drag;
    const [x0, x1, y0, y1] = this.dragged(at);
    const far = Math.hypot(at.x - this.drag.x, at.y - this.drag.y) >= 6;
    this.stopped();
    if (!far) return;
    [graph.x.low, graph.x.high] = [x0, x1].map((v) => graph.x.whole(v));
    [graph.y.low, graph.y.high] = [y1, y0].map((v) => graph.y.whole(v));
    this.draw();
  }
  stopped() {
    this.frame?.remove();
    this.drag = this.frame = null;
  }
  zoom(factor) { // about the cursor, along x; a graph whose x has names, along y
    const graph = this.cursor?.graph ?? this.graphs[0];
    const scale = graph.x.free ? graph.x : graph.y;
    const about = this.cursor ? scale.whole(graph.x.free ? this.cursor.x : this.cursor.y) : (scale.low + scale.high) / 2;
    const ends = [scale.low, scale.high].map((v) => about + (v - about) * factor);
    const [least, most] = [scale.from, scale.to].sort((a, b) => a - b);
    [scale.low, scale.high] = ends.map((v) => Math.min(Math.max(v, least), most));
    this.draw();
  }
  whole() {
    for (const { x, y } of this.graphs) for (const s of [x, y]) [s.low, s.high] = [s.from, s.to];
    this.draw();
  }
  draw() {
    for (const graph of this.graphs) graph.draw();
    this.left();
  }
  left() {
    this.hair?.remove();
    this.readout.textContent = "";
  }
  point(at) { // the cross and the values at one place
    this.cursor = at;
    this.hair?.remove();
    const { x, y } = at.graph;
    this.hair = part("path", { class: "hair", d: `M${at.x} ${y.from}V${y.to}M${x.from} ${at.y}H${x.to}` });
    this.svg.append(this.hair);
    this.readout.textContent = at.graph.values(at).join(" \u00b7 ");
  }
}

// --- one graph of a drawing -----------------------------------------------------------------------------------------

class Graph {
  constructor(drawing, known, group) {
    const [left, top, right, bottom] = known.box;
    this.drawing = drawing;
    this.group = group;
    this.shares = known.shares;
    this.x = new Scale(known.x, left, right);
    this.y = new Scale(known.y, bottom, top);
    this.named = [known.x.named, known.y.named];
    this.label = known.x.label;
    this.yLabel = known.y.label;
    this.moving = null;
  }
  // Everything that moves when the scales do, its clip on a group about it, which does not.
  parts() {
    if (this.moving) return this.moving;
    this.moving = [];
    for (const one of this.group.querySelectorAll("[clip-path]")) {
      if (one.closest(".xtick, .ytick, .legend")) continue;
      const frame = part("g", { "clip-path": one.getAttribute("clip-path") });
      one.removeAttribute("clip-path");
      one.replaceWith(frame);
      frame.append(one);
      const marks = [...one.querySelectorAll("use")];
      const area = one.closest("[data-trace], g")?.parentNode && marks.length && marks.every((m) => Number(m.getAttribute("x")) === 0);
      if (marks.length && !area) {
        for (const mark of marks) this.moving.push({ mark, x: Number(mark.getAttribute("x")), y: Number(mark.getAttribute("y")) });
      } else {
        this.moving.push({ shape: one });
      }
    }
    return this.moving;
  }
  draw() {
    const { x, y } = this;
    const zoomed = [x, y].map((s) => s.low !== s.from || s.high !== s.to);
    const matrix = `matrix(${x.factor} 0 0 ${y.factor} ${x.from - x.low * x.factor} ${y.from - y.low * y.factor})`;
    for (const { shape, mark, ...at } of this.parts()) {
      if (shape) {
        shape.setAttribute("transform", matrix);
        shape.classList.add("scaled");
      } else {
        mark.setAttribute("x", x.seen(at.x));
        mark.setAttribute("y", y.seen(at.y));
      }
    }
    for (const note of this.group.querySelectorAll(".note")) note.style.display = zoomed.some(Boolean) ? "none" : "";
    this.group.querySelectorAll(".own").forEach((one) => one.remove());
    [".xtick", ".ytick"].forEach((kind, k) => {
      for (const tick of this.group.querySelectorAll(kind)) tick.style.display = zoomed[k] && [x, y][k].free ? "none" : "";
    });
    if (zoomed[0] && x.free) this.ticks(x, (v) => ({ line: `M${v} ${y.from}V${y.to}`, text: { x: v, y: y.from + 12, "text-anchor": "middle" } }), this.named[0]);
    if (zoomed[1] && y.free) this.ticks(y, (v) => ({ line: `M${x.from} ${v}H${x.to}`, text: { x: x.from - 7, y: v + 3, "text-anchor": "end" } }), this.named[1]);
  }
  ticks(scale, made, named) {
    const group = part("g", { class: "own" });
    for (const value of scale.ticks()) {
      const { line, text } = made(scale.seen(scale.place(value)));
      group.append(part("path", { d: line }));
      if (named) group.append(part("text", text, shown(value, 4)));
    }
    this.group.prepend(group);
  }
  // Lines of the graph as points in the whole drawing.
  lines() {
    this.known ??= [...this.group.querySelectorAll("[data-trace]")].flatMap((one) => {
      const marks = [...one.querySelectorAll("use")].map((u) => [Number(u.getAttribute("x")), Number(u.getAttribute("y"))]);
      const path = one.querySelector("path[style*='fill: none']")?.getAttribute("d");
      const points = path ? [...path.matchAll(/[ML]\s*(-?[\d.]+)[ ,]+(-?[\d.]+)/g)].map((m) => [Number(m[1]), Number(m[2])]) : marks;
      const held = points.length > 1 || marks.length ? [{ one, key: Number(one.dataset.trace), points }] : [];
      return held;
    });
    return this.known;
  }
  values(at) {
    const said = [];
    const own = (label, value) => {
      const m = /^(.*) \(([^()]*)\)$/.exec(label) ?? [0, label, ""];
      return `${m[1]} ${shown(value)}${m[2] ? "\u00a0" + m[2] : ""}`;
    };
    const place = this.x.whole(at.x);
    const label = this.label || this.drawing.graphs.map((g) => g.label).filter(Boolean).at(-1) || "x";
    if (this.x.free) said.push(own(label, this.x.value(place)));
    let any = false;
    for (const { one, key, points } of this.lines()) {
      if (one.style.display === "none") continue;
      const xs = points.map((p) => p[0]);
      if (!this.x.free || place < Math.min(...xs) - 3 || place > Math.max(...xs) + 3) continue;
      const near = points.reduce((best, p) => (Math.abs(p[0] - place) < Math.abs(best[0] - place) ? p : best));
      if (!this.y.free) continue;
      said.push(`${this.drawing.names[key]}: ${shown(this.y.value(near[1]))}`);
      any = true;
    }
    if (!any && this.y.free) said.push(own(this.yLabel || "y", this.y.value(this.y.whole(at.y))));
    return said;
  }
}

// --- tables ---------------------------------------------------------------------------------------------------------

const PREFIX = { p: 1e-12, n: 1e-9, "\u00b5": 1e-6, m: 1e-3, k: 1e3, M: 1e6, G: 1e9 };

// What a cell is sorted by: its first number, with its power of ten and the prefix of its unit; else its text.
function worth(text) {
  const plain = text.replace(/[\u202f]/g, "").replace(/\u2212/g, "-").replace(/^[(\u2264\u2265]\s*/, "");
  const m = /^[+]?(-?\d+(?:\.\d+)?)/.exec(plain);
  if (!m) return /^(never|\u221e|none)/.test(plain) ? Infinity : NaN;
  const raised = /10([\u207b\u2070\u00b9\u00b2\u00b3\u2074-\u2079]+)/.exec(plain);
  const power = raised ? Number([...raised[1]].map((c) => Object.keys(RAISED).find((k) => RAISED[k] === c)).join("")) : 0;
  const prefix = /\d\u00a0([pn\u00b5mkMG])(?:s|rad|m|N|Hz|A|V)(?![a-z])/.exec(plain);
  return Number(m[1]) * 10 ** power * (prefix ? PREFIX[prefix[1]] : 1);
}

function sortable(table) {
  const body = table.tBodies[0];
  if (!body || body.rows.length < 2) return;
  [...table.tHead.rows[0].cells].forEach((head, column) => {
    if (!head.textContent.trim()) return; // a button without a name says nothing to those who hear it
    const made = button("", () => sorted(table, head, column));
    made.append(...head.childNodes);
    head.append(made);
  });
}

function sorted(table, head, column) {
  const body = table.tBodies[0];
  const rows = [...body.rows];
  rows.reduce((above, row) => { // a name that stands for several rows goes with each
    if (!row.cells[0].textContent.trim()) row.cells[0].textContent = above;
    return row.cells[0].textContent;
  }, "");
  const down = head.getAttribute("aria-sort") === "ascending";
  const text = (row) => row.cells[column].textContent.trim();
  const order = (a, b) => {
    const [u, v] = [worth(text(a)), worth(text(b))];
    if (Number.isNaN(u) || Number.isNaN(v)) return text(a).localeCompare(text(b), "en");
    return u === v ? 0 : u - v;
  };
  rows.sort((a, b) => (down ? order(b, a) : order(a, b)));
  for (const one of table.tHead.rows[0].cells) one.removeAttribute("aria-sort");
  head.setAttribute("aria-sort", down ? "descending" : "ascending");
  body.append(...rows);
}

// --- the page -------------------------------------------------------------------------------------------------------

document.addEventListener("DOMContentLoaded", () => {
  for (const place of document.querySelectorAll(".drawing")) {
    let made = null;
    const ready = () => (made ??= new Drawing(place));
    place.addEventListener("pointerenter", ready, { once: true });
    place.addEventListener("focus", ready, { once: true });
    new IntersectionObserver((seen, watch) => {
      if (!seen.some((s) => s.isIntersecting)) return;
      watch.disconnect();
      ready();
    }).observe(place);
  }
  document.querySelectorAll("main table").forEach(sortable);
});
