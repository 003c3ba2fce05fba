// Bundles the 3D view and three.js into one script, ../viewer.bundle.js, with three.js' licence on top.
import { readFileSync } from "node:fs";
import { build } from "esbuild";

const licence = readFileSync("node_modules/three/LICENSE", "utf8").trim();

await build({
  entryPoints: ["main.js"],
  outfile: "../viewer.bundle.js",
  bundle: true,
  minify: true,
  format: "iife",
  target: "es2020",
  legalComments: "none",
  charset: "ascii",
  banner: { js: `/*! Contains three.js (https://threejs.org).\n${licence}\n*/` },
});
