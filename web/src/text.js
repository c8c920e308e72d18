// Elements and numbers. Data reach the document as text nodes and attributes only, never as HTML.

/** Makes an element: element("p", { class: "note", style: { color: "red" } }, "text", child, ...). */
export function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key === "style") Object.assign(made.style, value);   // the page allows no style in attributes
    else if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (value !== false && value != null) made.setAttribute(key, value === true ? "" : value);
  }
  made.append(...children.filter((c) => c != null));
  return made;
}

export function capital(text) { return text.charAt(0).toUpperCase() + text.slice(1); }

/** A number with so many significant digits, without trailing zeros: 0.0123, 1.23e-7. */
export function number(value, digits = 4) {
  if (value == null || Number.isNaN(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  const plain = size >= 1e-3 && size < 1e5;
  const text = plain ? String(Number(value.toPrecision(digits)))
    : value.toExponential(digits - 1).replace(/\.?0+e/, "e").replace("e+", "e");
  return text.replaceAll("-", "−");
}

export function with_unit(value, unit, digits) {
  if (!unit) return number(value, digits);
  return unit === "°" ? `${number(value, digits)}°` : `${number(value, digits)} ${unit}`;
}

/** A name that may be used for a file. */
export function file_name(text, ending) {
  const stem = text.toLowerCase().replace(/[^a-z0-9]+/g, "_").replace(/^_+|_+$/g, "").slice(0, 60);
  return `${stem || "vbond"}.${ending}`;
}

export function download(blob, name) {
  const address = URL.createObjectURL(blob);
  element("a", { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
}
