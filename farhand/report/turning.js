// The path in 3-D, turned by mouse, finger or arrow keys. Without it the drawings beside tell the same.
"use strict";
document.querySelectorAll("canvas.turning").forEach((canvas) => {
  const scene = JSON.parse(document.getElementById(canvas.dataset.scene).textContent);
  const [low, high] = scene.box;
  const middle = low.map((value, k) => (value + high[k]) / 2);
  const reach = Math.hypot(...low.map((value, k) => high[k] - value)) / 2;
  let turn = -0.9, tilt = 0.5, zoom = 0, held = null;
  canvas.closest(".turns").hidden = false;

  const look = (name) => getComputedStyle(canvas).getPropertyValue(name).trim();
  function hull(points) {  // Andrew's chain
    const sorted = points.slice().sort((p, q) => p[0] - q[0] || p[1] - q[1]);
    if (sorted.length < 3) return sorted;
    const half = (list) => {
      const out = [];
      for (const p of list) {
        while (out.length > 1) {
          const [a, b] = out.slice(-2);
          if ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) > 0) break;
          out.pop();
        }
        out.push(p);
      }
      return out.slice(0, -1);
    };
    return [...half(sorted), ...half(sorted.reverse())];
  }

  function draw() {
    const ratio = window.devicePixelRatio || 1;
    const width = canvas.clientWidth, height = canvas.clientHeight;
    canvas.width = width * ratio;
    canvas.height = height * ratio;
    const pen = canvas.getContext("2d");
    pen.scale(ratio, ratio);
    const [ct, st, cp, sp] = [Math.cos(turn), Math.sin(turn), Math.cos(tilt), Math.sin(tilt)];
    const flat = (p) => {
      const [x, y, z] = p.map((value, k) => value - middle[k]);
      return [ct * x + st * y, cp * z + sp * (-st * x + ct * y)];
    };
    const corner = (k) => [0, 1, 2].map((axis) => scene.box[(k >> axis) & 1][axis]);
    const small = 0.48 * Math.min(width, height) / reach;
    if (!zoom) {  // as large as all of the box is seen
      const [across, up] = [0, 1].map((k) => Math.max(...[...Array(8).keys()].map((c) => flat(corner(c))[k])));
      zoom = 0.47 * Math.min(width / across, height / up) / small;
    }
    const size = zoom * small;
    const place = (p) => {
      const [across, up] = flat(p);
      return [width / 2 + size * across, height / 2 - size * up];
    };
    const line = (points, colour, thick) => {
      pen.strokeStyle = colour;
      pen.lineWidth = thick;
      pen.beginPath();
      let fresh = true;
      for (const p of points) {
        if (p === null) { fresh = true; continue; }
        if (fresh) pen.moveTo(...place(p)); else pen.lineTo(...place(p));
        fresh = false;
      }
      pen.stroke();
    };
    const dot = (p, radius, colour, fill) => {
      pen.beginPath();
      pen.arc(...place(p), radius, 0, 7);
      pen[fill ? "fillStyle" : "strokeStyle"] = colour;
      pen.lineWidth = 2;
      if (fill) pen.fill(); else pen.stroke();
    };
    pen.clearRect(0, 0, width, height);
    pen.lineJoin = pen.lineCap = "round";
    for (let k = 0; k < 8; k++)
      for (const axis of [1, 2, 4])
        if (!(k & axis)) line([corner(k), corner(k | axis)], look("--grid"), 1);
    pen.fillStyle = look("--dim");
    pen.font = "12px system-ui, sans-serif";
    ["x", "y", "z"].forEach((name, axis) => pen.fillText(name, ...place(corner(1 << axis))));
    for (const [grown, colour] of [[scene.around, look("--keep")], [0, look("--body")]])
      for (const body of scene.bodies) {
        const outline = hull(body.points.map(place));
        const soft = new Path2D();
        outline.forEach((p, k) => (k ? soft.lineTo(...p) : soft.moveTo(...p)));
        soft.closePath();
        pen.fillStyle = pen.strokeStyle = colour;
        pen.lineWidth = Math.max(0.1, 2 * size * (body.radius + grown));
        pen.stroke(soft);
        pen.fill(soft);
      }
    line(scene.path, look("--tool"), 2);
    for (const p of scene.near) dot(p, 2.5, look("--stop"), true);
    for (const p of scene.targets) dot(p, 5, look("--good"), true);
    const first = scene.path.find((p) => p !== null);
    if (first) {
      const [x, y] = place(first);
      pen.strokeStyle = look("--tool");
      pen.lineWidth = 2;
      pen.strokeRect(x - 7, y - 7, 14, 14);
    }
    if (scene.nearest) dot(scene.nearest, 7, look("--stop"), false);
  }

  canvas.addEventListener("pointerdown", (event) => {
    held = [event.clientX, event.clientY];
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointerup", () => { held = null; });
  canvas.addEventListener("pointercancel", () => { held = null; });
  canvas.addEventListener("pointermove", (event) => {
    if (!held) return;
    turn += (event.clientX - held[0]) * 0.01;
    tilt = Math.min(1.57, Math.max(-1.57, tilt + (event.clientY - held[1]) * 0.01));
    held = [event.clientX, event.clientY];
    draw();
  });
  canvas.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] }[event.key];
    if (step) { turn += step[0]; tilt += step[1]; }
    else if (event.key === "+") zoom *= 1.1;
    else if (event.key === "-") zoom /= 1.1;
    else return;
    event.preventDefault();
    draw();
  });
  new ResizeObserver(draw).observe(canvas);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
  addEventListener("beforeprint", draw);
  draw();
});
