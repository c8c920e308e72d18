// PNG of the 3D view and of plots, with what is needed to read them without the page.
import { name_of } from "./head.js";
import { download, file_name, number } from "./text.js";

export function colour_of(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

/** A canvas of the size of `source` with room above and below it, on the ground of the page. */
export function framed(source, above, below) {
  const canvas = document.createElement("canvas");
  canvas.width = source.width;
  canvas.height = source.height + above + below;
  const pen = canvas.getContext("2d");
  pen.fillStyle = colour_of("--ground");
  pen.fillRect(0, 0, canvas.width, canvas.height);
  pen.drawImage(source, 0, above);
  pen.fillStyle = colour_of("--ink");
  pen.textBaseline = "middle";
  return { canvas, pen };
}

export function save(canvas, title) {
  canvas.toBlob((blob) => download(blob, file_name(title, "png")), "image/png");
}

function draw_scale(pen, { table, ends }, unit, x, y, width, height) {
  for (let k = 0; k < 256; ++k) {
    pen.fillStyle = `rgb(${table.slice(3 * k, 3 * k + 3).join(" ")})`;
    pen.fillRect(x + (k * width) / 256, y, width / 256 + 1, height);
  }
  pen.fillStyle = colour_of("--ink");
  pen.textAlign = "right";
  pen.fillText(number(ends[0], 3), x - height / 2, y + height / 2);
  pen.textAlign = "left";
  pen.fillText(`${number(ends[1], 3)} ${unit}`, x + width + height / 2, y + height / 2);
}

export function save_picture(view) {
  view.scene.draw();   // in the same task as reading it: the browser clears the canvas afterwards
  const source = view.canvas, line = Math.max(20, Math.round(source.width / 36));
  const { canvas, pen } = framed(source, 2 * line, 3 * line);
  const small = `${Math.round(0.6 * line)}px system-ui, sans-serif`;
  pen.font = `600 ${Math.round(0.7 * line)}px system-ui, sans-serif`;
  pen.fillText(`${name_of(view.run.json)}: ${view.words()}`, line, line, canvas.width - 2 * line);
  pen.font = small;
  const y = canvas.height - 2 * line;
  if (view.scale.classes) {
    const words = view.quantity.on === "bonds" ? `${view.scale.classes.join(", ")} (blue, amber, crimson)` : "the heaviest is grey, the other colours repeat";
    pen.fillText(`${view.quantity.label}: ${words}`, line, y, canvas.width - 2 * line);
  } else {
    pen.fillText(view.quantity.label, line, y, canvas.width / 3);
    draw_scale(pen, view.scale, view.quantity.unit, 0.5 * canvas.width, y - 0.3 * line, canvas.width / 4, 0.6 * line);
  }
  save(canvas, `${name_of(view.run.json)} ${view.sequence.json.name} ${view.player.frame}`);
}
