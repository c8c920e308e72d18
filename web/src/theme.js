// Light or dark: as the system has it until the reader chooses.
import { element } from "./text.js";

const system = matchMedia("(prefers-color-scheme: dark)");
let chosen = null;

export function apply_theme() {
  document.documentElement.dataset.theme = chosen ?? (system.matches ? "dark" : "light");
}

/** A button that changes sides; `changed` is called after each change. */
export function theme_button(changed) {
  const button = element("button", { type: "button", class: "theme" });
  const update = () => {
    apply_theme();
    button.textContent = document.documentElement.dataset.theme === "dark" ? "Light" : "Dark";
    changed();
  };
  button.addEventListener("click", () => {
    chosen = document.documentElement.dataset.theme === "dark" ? "light" : "dark";
    update();
  });
  system.addEventListener("change", update);
  button.textContent = document.documentElement.dataset.theme === "dark" ? "Light" : "Dark";
  return button;
}
