"use strict";
// Which measure, how it is written, and how bad it is from 0 (good) to 1 (bad): the colour is one hue, pale to full.
const pc = (v) => (v === 0 ? "0" : v > 0.99 && v < 1 ? Math.min(99.9, 100 * v).toFixed(1) : v < 0.01 ? (100 * v).toFixed(1) : (100 * v).toFixed(0));
const mm = (v) => (1000 * v).toFixed(v !== 0 && Math.abs(v) < 0.001 ? 1 : 0);
const clamp = (v) => Math.max(0, Math.min(1, v));
const MEASURES = {
  safe: { says: "safe, %", text: pc, bad: (v) => clamp((1 - v) / 0.5), worst: "50 % and less", best: "all runs" },
  done: { says: "safe and done, %", text: pc, bad: (v) => clamp((1 - v) / 0.8), worst: "20 % and less", best: "all runs" },
  evades: { says: "runs with a violation that the robot could have evaded, %", text: pc, bad: (v) => clamp(v / 0.5), worst: "50 % and more", best: "none" },
  depth: { says: "deepest violation, mm", text: mm, bad: (v) => clamp(v / 0.2), worst: "200 mm and more", best: "none" },
  least: { says: "smallest clearance, mm", text: mm, bad: (v) => clamp((0.03 - v) / 0.15), worst: "−120 mm and less", best: "30 mm and more" },
  tool: { says: "smallest clearance of the tool's sphere, mm", text: mm, bad: (v) => clamp((0.03 - v) / 0.15), worst: "−120 mm and less", best: "30 mm and more" },
  time: { says: "time over the ideal operator's", text: (v) => v.toFixed(2), bad: (v) => clamp((v - 1) / 2), worst: "three times", best: "as quick", maybe: true },
  path: { says: "way over the ideal operator's", text: (v) => v.toFixed(2), bad: (v) => clamp((v - 1) / 1), worst: "twice", best: "as short", maybe: true },
  filtered: { says: "ticks in which the operator's side changed the wish, %", text: pc, bad: (v) => v, worst: "all", best: "none" },
  guarded: { says: "time in which the guard acted, %", text: pc, bad: (v) => v, worst: "all", best: "none" },
  stops: { says: "latched stops a run", text: (v) => v.toFixed(1), bad: (v) => clamp(v / 5), worst: "5 and more", best: "none" },
  smoothness: { says: "smoothness (spectral arc length)", text: (v) => v.toFixed(1), bad: (v) => clamp((-v - 2) / 6), worst: "−8 and less", best: "−2", maybe: true },
};
const state = { operator: BOARD.operators[0], measure: "safe", by: "scenes", other: "*", sort: null, down: false, cell: { method: BOARD.methods.includes("both") ? "both" : BOARD.methods[0], scene: "*", network: "*" } };
const at = (id) => document.getElementById(id);
const make = (tag, set = {}, ...inner) => { const e = Object.assign(document.createElement(tag), set); e.append(...inner); return e; };
const cellOf = (method, column) => {
  const [scene, network] = state.by === "scenes" ? [column, state.other] : [state.other, column];
  return { method, scene, network, figures: BOARD.cells[[state.operator, method, scene, network].join("|")] };
};
const valueOf = (cell) => {
  if (!cell.figures || !cell.figures.n) return null;
  const v = cell.figures[state.measure];
  return v === undefined ? (MEASURES[state.measure].maybe ? null : 0) : v;
};

function tabs(title, values, name) {
  const row = make("div", { className: "tabs" });
  for (const value of values) {
    const button = make("button", { textContent: value, onclick: () => { state[name] = value; if (name === "by") { state.other = "*"; state.sort = null; } show(); } });
    button.setAttribute("aria-pressed", state[name] === value);
    row.append(button);
  }
  return make("fieldset", {}, make("legend", { textContent: title }), row);
}

function choice(title, values, name) {
  const select = make("select", { onchange: () => { state[name] = select.value; show(); } });
  for (const [value, text] of values) select.append(make("option", { value, textContent: text, selected: state[name] === value }));
  return make("label", {}, title, select);
}

function show() {
  const columns = ["*", ...BOARD[state.by]], measure = MEASURES[state.measure];
  const other = state.by === "scenes" ? "networks" : "scenes";
  at("controls").replaceChildren(
    tabs("operator", BOARD.operators, "operator"),
    choice("shown", Object.entries(MEASURES).map(([k, m]) => [k, m.says]), "measure"),
    tabs("columns", ["scenes", "networks"], "by"),
    choice(other, [["*", `all ${other}`], ...BOARD[other].map((n) => [n, n])], "other"),
  );
  const methods = [...BOARD.methods];
  if (state.sort !== null) {
    const key = (m) => { const v = state.sort === "name" ? m : valueOf(cellOf(m, state.sort)); return v === null ? -Infinity : v; };
    methods.sort((a, b) => (key(a) < key(b) ? -1 : key(a) > key(b) ? 1 : 0) * (state.down ? -1 : 1));
  }
  const head = make("tr", {}, heading("method", "name", "name"), ...columns.map((c) => heading(c === "*" ? "all" : c, c, "")));
  const body = methods.map((m) => make("tr", {},
    make("td", { className: "name" }, make("b", { textContent: m }), make("span", { textContent: BOARD.says[m] })),
    ...columns.map((c) => drawn(cellOf(m, c), c === "*"))));
  at("board").replaceChildren(make("thead", {}, head), make("tbody", {}, ...body));
  at("legend").replaceChildren(`${measure.says}: ${measure.best} `, make("span", { className: "ramp" }), ` ${measure.worst}. ▾: violations, and the deepest in mm.`);
  detail();
}

function heading(text, column, kind) {
  const button = make("button", { textContent: text, title: "sort", onclick: () => {
    state.down = state.sort === column ? !state.down : column !== "name"; state.sort = column; show(); } });
  const th = make("th", { className: kind, scope: "col" }, button);
  if (state.sort === column) { th.setAttribute("aria-sort", state.down ? "descending" : "ascending"); button.append(state.down ? " ↓" : " ↑"); }
  return th;
}

function drawn(cell, all) {
  const value = valueOf(cell);
  if (value === null) return make("td", { className: "none", textContent: "–" });
  const measure = MEASURES[state.measure], bad = measure.bad(value), f = cell.figures;
  const button = make("button", { onclick: () => { state.cell = cell; show(); } }, measure.text(value));
  if (f.violations) button.append(make("small", { textContent: `▾ ${mm(f.depth || 0)}` }));
  button.style.background = `rgba(var(--accent-rgb), ${(0.05 + 0.95 * bad).toFixed(3)})`;
  if (bad > 0.5) button.style.color = "var(--on-accent)";
  const same = state.cell && ["method", "scene", "network"].every((k) => state.cell[k] === cell[k]);
  button.setAttribute("aria-current", Boolean(same));
  button.title = `${f.n} runs`;
  return make("td", { className: all ? "cell all" : "cell" }, button);
}

const quoted = (name) => (/^[\w.-]+$/.test(name) ? name : `"${name}"`);
function command(cell, task) {
  const parts = ["farhand benchmark safety"];
  if (cell.network !== "*") parts.push(`--networks ${quoted(cell.network)}`);
  else if (BOARD.subset.networks) parts.push(...BOARD.subset.networks.map((n) => `--networks ${quoted(n)}`));
  if (cell.scene !== "*") parts.push(`--scenes ${cell.scene}`);
  else if (BOARD.subset.scenes) parts.push(`--scenes ${BOARD.subset.scenes}`);
  parts.push(`--methods ${cell.method}`, `--operators ${state.operator}`);
  parts.push(task !== undefined ? `--task ${task}` : BOARD.only !== null ? `--task ${BOARD.only}` : `--tasks ${BOARD.tasks}`);
  return [...parts, `--seed ${BOARD.seed}`].join(" ");
}

function line(title, text) {
  const copy = make("button", { textContent: "copy", onclick: async () => { try { await navigator.clipboard.writeText(text); copy.textContent = "copied"; } catch { copy.textContent = "select it"; } } });
  return make("div", {}, make("div", { className: "said", textContent: title }), make("div", { className: "command" }, make("code", { textContent: text }), copy));
}

function detail() {
  const cell = state.cell && BOARD.cells[[state.operator, state.cell.method, state.cell.scene, state.cell.network].join("|")];
  if (!cell) { at("detail").replaceChildren(make("p", { className: "said", textContent: "No cell is chosen." })); return; }
  const c = state.cell, range = ([a, b]) => `${(100 * (a || 0)).toFixed(1)} to ${(100 * b).toFixed(1)} %`;
  const or = (v, text) => (v === undefined ? "–" : text(v));
  const entries = [
    ["runs", `${cell.n}${cell.crashed ? `, ${cell.crashed} crashed` : ""}`],
    ["safe", `${cell.safeOf || 0}: ${range(cell.safeIn)}`],
    ["safe and done", `${cell.doneOf || 0}: ${range(cell.doneIn)}`],
    ["violations", cell.violations ? `${cell.violations}, up to ${mm(cell.depth || 0)} mm, ${cell.seconds || 0} s in all` : "none"],
    ["could be evaded", cell.violations ? `${cell.evadable || 0}, in ${cell.couldEvade || 0} runs; run over in a latched stop: ${cell.runOver || 0}` : "–"],
    ["clearance, least and median", `${or(cell.least, mm)} and ${or(cell.median, mm)} mm`],
    ["of the tool's sphere, least", or(cell.tool, (v) => `${mm(v)} mm`)],
    ["time over the ideal's", or(cell.time, (v) => v.toFixed(3))],
    ["way over the ideal's", or(cell.path, (v) => v.toFixed(3))],
    ["the operator's side changed", `${pc(cell.filtered || 0)} % of the ticks, by ${pc(cell.strength || 0)} % of the wish`],
    ["the guard acted", `${pc(cell.guarded || 0)} % of the time${cell.guardStrength ? `, by ${cell.guardStrength.toFixed(2)} m/s` : ""}`],
    ["latched stops a run", (cell.stops || 0).toFixed(1)],
    ["smoothness (spectral arc length)", or(cell.smoothness, (v) => v.toFixed(2))],
  ];
  const worst = cell.worst ? { ...c, network: cell.worst[0], scene: cell.worst[1] } : null;
  at("detail").replaceChildren(
    make("h2", { textContent: [c.method, c.scene === "*" ? "all scenes" : c.scene, c.network === "*" ? "all networks" : c.network, state.operator].join(" · ") }),
    make("dl", {}, ...entries.map(([k, v]) => make("div", {}, make("dt", { textContent: k }), make("dd", { textContent: v })))),
    line("these runs again", command(c)),
    ...(worst ? [line("the worst of them alone", command(worst, cell.worst[2]))] : []),
  );
}
show();
