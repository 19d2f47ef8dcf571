import assert from "node:assert/strict";
import { test } from "node:test";
import { marginText } from "./margin.ts";

test("an adaptive margin is its floor, what the network adds, and the lag", () => {
  const report = { inflation: 0.024, sigma: 0, margin_parts: { floor: 0.01, innovation: 0.019, spread: 0.002, lag: 0.005 } };
  assert.equal(marginText(report), "margin 24 = 10 least + 5 lag + 9 network");
});

test("at the floor there is nothing to explain", () => {
  assert.equal(marginText({ inflation: 0.01, sigma: 0, margin_parts: { floor: 0.01, innovation: 0.001, spread: 0 } }), "margin 10");
  assert.equal(marginText({ inflation: 0.01, sigma: 0, margin_parts: { floor: 0.01, innovation: 0, spread: 0, lag: 1e-5 } }), "margin 10");
});

test("the paper's margin is of delay and jitter", () => {
  assert.equal(marginText({ inflation: 0, sigma: 0.03, margin_parts: { delay: 0.02, jitter: 0.01 } }), "margin 30 = 20 delay + 10 jitter");
});

test("parts that are rounded still add up", () => {
  const text = marginText({ inflation: 0.0106, sigma: 0.0107, margin_parts: { delay: 0.0053, jitter: 0.0054, floor: 0.0106 } });
  const [sum, ...parts] = [...text.matchAll(/\d+/g)].map(Number);
  assert.equal(
    sum,
    parts.reduce((all, each) => all + each, 0),
  );
});

test("without parts there is only the margin", () => {
  assert.equal(marginText({ inflation: 0.02, sigma: 0 }), "margin 20");
});
