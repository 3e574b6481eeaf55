// Builds the page for a static host, or with --mode file as one HTML file with the data and the pictures in it.

import { fileURLToPath } from "node:url";
import { defineConfig } from "vite";
import { viteSingleFile } from "vite-plugin-singlefile";

const repository = fileURLToPath(new URL("../..", import.meta.url));

export default defineConfig(({ mode }) => ({
  base: "./", // it works in any folder of a host
  plugins: mode === "file" ? [viteSingleFile()] : [],
  resolve: {
    // the page draws with the code that the validation draws with, and compares with the effects that it compares with
    alias: { "@validation": `${repository}validation` },
    // those files are outside of this folder, and would not find its packages
    dedupe: ["three", "postprocessing"],
  },
  server: { fs: { allow: [repository] } },
}));
