"use strict";
// Shares are written as `percent` and `bound` of tables.py write them: halves are rounded up, 0 and 100 are exact.
const tenths = (v) => (Math.min(Math.max(Math.floor(1000 * v + 0.5), 1), 999) / 10).toFixed(1);
const pc = (v) => ((v > 0 && v < 0.01) || (v > 0.99 && v < 1) ? tenths(v) : String(Math.floor(100 * v + 0.5)));
const bound = (v) => (v > 0 && v < 1 ? tenths(v) : pc(v));
const number = (v, digits) => v.toFixed(digits).replace("-", "−");
const mm = (v) => number(1000 * v, v !== 0 && Math.abs(v) < 0.001 ? 1 : 0);
const clamp = (v) => Math.max(0, Math.min(1, v));
const measured = (f) => f.n - (f.crashed || 0);
// Which measure, how it is written, and how bad it is from 0 (good) to 1 (bad): the colour goes from pale to full.
const MEASURES = {
  safe: { of: (f) => (f.safeOf || 0) / f.n, says: "safe, %", text: pc, bad: (v) => clamp((1 - v) / 0.5), worst: "50 % and less", best: "all runs" },
  done: { of: (f) => (f.doneOf || 0) / f.n, says: "safe and done, %", text: pc, bad: (v) => clamp((1 - v) / 0.8), worst: "20 % and less", best: "all runs" },
  evades: { of: (f) => (measured(f) ? (f.couldEvade || 0) / measured(f) : null), says: "runs with a violation that the robot could have evaded, %", text: pc, bad: (v) => clamp(v / 0.5), worst: "50 % and more", best: "none" },
  depth: { says: "deepest violation, mm", text: mm, bad: (v) => clamp(v / 0.2), worst: "200 mm and more", best: "none" },
  least: { says: "smallest clearance, mm", text: mm, bad: (v) => clamp((0.03 - v) / 0.15), worst: "−120 mm and less", best: "30 mm and more", maybe: true },
  tool: { says: "smallest clearance of the tool's sphere, mm", text: mm, bad: (v) => clamp((0.03 - v) / 0.15), worst: "−120 mm and less", best: "30 mm and more", maybe: true },
  time: { says: "time over the ideal operator's", text: (v) => v.toFixed(2), bad: (v) => clamp((v - 1) / 2), worst: "three times", best: "as quick", maybe: true },
  path: { says: "way over the ideal operator's", text: (v) => v.toFixed(2), bad: (v) => clamp((v - 1) / 1), worst: "twice", best: "as short", maybe: true },
  filtered: { says: "ticks in which the operator's side changed the wish, %", text: pc, bad: (v) => v, worst: "all", best: "none" },
  guarded: { says: "time in which the guard acted, %", text: pc, bad: (v) => v, worst: "all", best: "none" },
  stops: { says: "latched stops a run", text: (v) => v.toFixed(1), bad: (v) => clamp(v / 5), worst: "5 and more", best: "none" },
  smoothness: { says: "smoothness (spectral arc length)", text: (v) => number(v, 1), bad: (v) => clamp((-v - 2) / 6), worst: "−8 and less", best: "−2", maybe: true },
};
const FULL = 0.68; // what is worse than this has a colour on which the other ink reads better
const state = { operator: BOARD.operators[0], measure: "safe", by: "scenes", other: "*", sort: null, down: false, cell: { method: BOARD.methods.includes("both") ? "both" : BOARD.methods[0], scene: "*", network: "*" } };
const at = (id) => document.getElementById(id);
const make = (tag, set = {}, ...inner) => { const e = Object.assign(document.createElement(tag), set); e.append(...inner); return e; };
const keyed = (e, key) => { e.dataset.key = key; return e; };
const found = (key) => [...document.querySelectorAll("[data-key]")].find((e) => e.dataset.key === key);
const cellOf = (method, column) => {
  const [scene, network] = state.by === "scenes" ? [column, state.other] : [state.other, column];
  return { method, scene, network, figures: BOARD.cells[[state.operator, method, scene, network].join("|")] };
};
const valueOf = (cell) => {
  if (!cell.figures || !cell.figures.n) return null;
  const measure = MEASURES[state.measure], v = cell.figures[state.measure];
  if (measure.of) return measure.of(cell.figures);
  if (!measured(cell.figures)) return null;
  return v === undefined ? (measure.maybe ? null : 0) : v;
};

function tabs(title, values, name) {
  const row = make("div", { className: "tabs" });
  for (const value of values) {
    const button = keyed(make("button", { textContent: value, onclick: () => { state[name] = value; if (name === "by") { state.other = "*"; state.sort = null; } show(); } }), `${name}=${value}`);
    button.setAttribute("aria-pressed", state[name] === value);
    row.append(button);
  }
  return make("fieldset", {}, make("legend", { textContent: title }), row);
}

function choice(title, values, name) {
  const select = keyed(make("select", { onchange: () => { state[name] = select.value; show(); } }), name);
  for (const [value, text] of values) select.append(make("option", { value, textContent: text, selected: state[name] === value }));
  return make("label", {}, title, select);
}

// Everything is made anew, so that the keyboard's focus goes to what stands where it was.
function show() {
  const key = document.activeElement && document.activeElement.dataset.key;
  build();
  const again = key && found(key);
  if (again) again.focus({ preventScroll: true });
}

function build() {
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
    make("td", { className: "name", title: BOARD.says[m] }, make("b", { textContent: m }), make("span", { textContent: BOARD.says[m] })),
    ...columns.map((c) => drawn(cellOf(m, c), c === "*"))));
  at("board").replaceChildren(make("thead", {}, head), make("tbody", {}, ...body));
  at("legend").replaceChildren(`${measure.says}: ${measure.best} `, make("span", { className: "ramp" }), ` ${measure.worst}. ▾: violations, and the deepest in mm.`);
  detail();
}

function heading(text, column, kind) {
  const button = keyed(make("button", { textContent: text, title: "sort", onclick: () => {
    state.down = state.sort === column ? !state.down : column !== "name"; state.sort = column; show(); } }), `sort=${column}`);
  const th = make("th", { className: kind, scope: "col" }, button);
  if (state.sort === column) { th.setAttribute("aria-sort", state.down ? "descending" : "ascending"); button.append(state.down ? " ↓" : " ↑"); }
  return th;
}

function drawn(cell, all) {
  const value = valueOf(cell);
  if (value === null) return make("td", { className: "none", textContent: "–" });
  const measure = MEASURES[state.measure], bad = measure.bad(value), f = cell.figures;
  const button = keyed(make("button", { onclick: () => { state.cell = cell; show(); reveal(); } }, measure.text(value)), ["cell", cell.method, cell.scene, cell.network].join("|"));
  if (f.violations) button.append(make("small", { textContent: `▾ ${mm(f.depth || 0)}` }));
  button.style.background = ramp(bad);
  button.style.color = bad > FULL ? "var(--on-full)" : "var(--on-pale)";
  const same = state.cell && ["method", "scene", "network"].every((k) => state.cell[k] === cell[k]);
  button.setAttribute("aria-current", Boolean(same));
  button.title = `${f.n} runs`;
  return make("td", { className: all ? "cell all" : "cell" }, button);
}

// Pale to middle to full, as the legend's gradient.
function ramp(bad) {
  const [from, to, share] = bad <= 0.5 ? ["pale", "middle", 2 * bad] : ["middle", "full", 2 * bad - 1];
  return `color-mix(in srgb, var(--${to}) ${(100 * share).toFixed(1)}%, var(--${from}))`;
}

// On a small screen the figures are far below the cell that was chosen.
function reveal() {
  const panel = at("detail"), { top, bottom } = panel.getBoundingClientRect();
  if (top > innerHeight - 120 || bottom < 60) panel.scrollIntoView({ block: "nearest" });
}

const quoted = (name) => (/^[\w.-]+$/.test(name) ? name : `"${name}"`);
function command(cell, task) {
  const parts = ["farhand benchmark safety"];
  if (cell.network !== "*") parts.push(`--networks ${quoted(cell.network)}`);
  else if (BOARD.subset.networks) {
    const plain = BOARD.subset.networks.filter((n) => quoted(n) === n), specs = BOARD.subset.networks.filter((n) => quoted(n) !== n);
    parts.push(...[...(plain.length ? [plain.join(",")] : []), ...specs.map(quoted)].map((n) => `--networks ${n}`));
  }
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
  const c = state.cell, rate = (k, [low, high]) => `${k || 0} of ${cell.n} (${bound(low)}–${bound(high)} %)`;
  const seen = (text) => (measured(cell) ? text() : "–");
  const causes = (some) => (some || []).map(([text, count]) => `${count} × ${BOARD.texts[text]}`);
  const or = (v, text) => (v === undefined ? "–" : text(v));
  const entries = [
    ["runs", `${cell.n}`],
    ["safe", rate(cell.safeOf, cell.safeIn)],
    ["safe and done", rate(cell.doneOf, cell.doneIn)],
    ["violations", seen(() => cell.violations ? `${cell.violations}, up to ${mm(cell.depth || 0)} mm, ${cell.seconds || 0} s in all` : "none")],
    ["could be evaded", cell.violations ? `${cell.evadable || 0}, in ${cell.couldEvade || 0} runs; run over in a latched stop: ${cell.runOver || 0}` : "–"],
    ["clearance, least and median", or(cell.least, (v) => `${mm(v)} and ${mm(cell.median)} mm`)],
    ["of the tool's sphere, least", or(cell.tool, (v) => `${mm(v)} mm`)],
    ["time over the ideal's", or(cell.time, (v) => v.toFixed(3))],
    ["way over the ideal's", or(cell.path, (v) => v.toFixed(3))],
    ["the operator's side changed", seen(() => `${pc(cell.filtered || 0)} % of the ticks, by ${pc(cell.strength || 0)} % of the wish`)],
    ["the guard acted", seen(() => `${pc(cell.guarded || 0)} % of the time${cell.guardStrength ? `, by ${number(cell.guardStrength, 2)} m/s` : ""}`)],
    ["latched stops a run", seen(() => (cell.stops || 0).toFixed(1))],
    ["smoothness (spectral arc length)", or(cell.smoothness, (v) => number(v, 2))],
  ];
  const lists = [
    ["not done because", causes(cell.why)],
    [`crashed: ${cell.crashed || 0}`, causes(cell.error)],
  ];
  const worst = cell.worst ? { ...c, network: cell.worst[0], scene: cell.worst[1] } : null;
  at("detail").replaceChildren(
    make("h2", { textContent: [c.method, c.scene === "*" ? "all scenes" : c.scene, c.network === "*" ? "all networks" : c.network, state.operator].join(" · ") }),
    make("p", { className: "said", textContent: BOARD.says[c.method] }),
    make("dl", {},
      ...entries.map(([k, v]) => make("div", {}, make("dt", { textContent: k }), make("dd", { textContent: v }))),
      ...lists.filter(([, v]) => v.length).map(([k, v]) => make("div", { className: "row" }, make("dt", { textContent: k }), ...v.map((textContent) => make("dd", { textContent }))))),
    line(cell.made ? `these runs again, among ${cell.made}` : "these runs again", command(c)),
    ...(worst ? [line("the worst of them alone", command(worst, cell.worst[2]))] : []),
  );
}
if (matchMedia("(max-width: 600px)").matches) at("words").open = false;
show();
