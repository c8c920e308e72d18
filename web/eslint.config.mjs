// Rules of the linter: test/run check.
import js from "@eslint/js";
import globals from "globals";

export default [
  js.configs.recommended,
  { rules: { eqeqeq: ["error", "always", { null: "ignore" }], "no-var": "error", "prefer-const": "error", "no-implicit-globals": "error" } },
  { files: ["src/**"], languageOptions: { globals: globals.browser }, rules: { "no-shadow": "error" } },
  { files: ["*.mjs", "test/**"], languageOptions: { globals: { ...globals.node, ...globals.browser } } },   // tests send functions into pages
];
