// Bundles the page into ../static and says there what it was built from; scripts/page_is_built.py holds it to that.
import { createHash } from "node:crypto";
import { copyFileSync, readdirSync, readFileSync, writeFileSync } from "node:fs";
import { build } from "esbuild";

const out = "../static";
const sources = [
  "build.mjs",
  "index.html",
  "package-lock.json",
  "package.json",
  "page.css",
  ...readdirSync("src").map((name) => `src/${name}`),
  "tsconfig.json",
].sort();
const digest = createHash("sha256");
for (const name of sources) digest.update(`${name}\0`).update(readFileSync(name)).update("\0");
const built = { sources: digest.digest("hex") };

await build({
  entryPoints: { page: "src/main.ts", post: "src/post.ts" },
  bundle: true,
  minify: true,
  format: "esm",
  target: "es2022",
  legalComments: "none",
  outdir: out,
  define: { BUILD: JSON.stringify(built.sources) },
  plugins: [
    {
      name: "no-collada", // robots are drawn with STL alone
      setup: (bundler) => {
        bundler.onResolve({ filter: /ColladaLoader/ }, () => ({ path: "collada", namespace: "none" }));
        bundler.onLoad({ filter: /.*/, namespace: "none" }, () => ({ contents: "export class ColladaLoader {}" }));
      },
    },
  ],
});
for (const name of ["index.html", "page.css"]) copyFileSync(name, `${out}/${name}`);
for (const name of ["index.html", "page.css", "page.js", "post.js"])
  built[name] = createHash("sha256")
    .update(readFileSync(`${out}/${name}`))
    .digest("hex");
writeFileSync(`${out}/built.json`, `${JSON.stringify(built, null, 2)}\n`);
