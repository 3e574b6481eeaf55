// Builds the page for a static host or, with --mode file, as one HTML file that contains the data and the images.

import { fileURLToPath } from "node:url";
import { defineConfig } from "vite";
import { viteSingleFile } from "vite-plugin-singlefile";

const repository = fileURLToPath(new URL("../..", import.meta.url));

export default defineConfig(({ mode }) => ({
  base: "./", // the page works in any folder of a host
  plugins: mode === "file" ? [viteSingleFile()] : [],
  resolve: {
    // the page draws with the code of the validation, and shows the effects with which the validation compares
    alias: { "@validation": `${repository}validation` },
    // those files are outside this folder, and would not find its packages otherwise
    dedupe: ["three", "postprocessing"],
  },
  server: { fs: { allow: [repository] } },
}));
