// The columns of history.csv and how their rows belong to frames. No elements, no drawing.

const stacked = ["kinetic_translation", "kinetic_rotation", "U_L", "U_B", "U_T", "contact", "dissipated", "released"];

export class History {
  /** `clock` is the column along which the run goes on, `over` the one that curves are drawn over. */
  constructor({ columns, values }, clock = "time", over = clock) {
    this.columns = new Map(columns.map(({ name, unit }, k) => [name, { name, unit: unit ?? "", values: values[k] }]));
    this.rows = values[0]?.length ?? 0;
    this.clock = this.has(clock) ? clock : this.names[0];
    this.over = this.has(over) ? over : this.clock;
  }

  get names() { return [...this.columns.keys()]; }
  has(name) { return this.columns.has(name); }
  column(name) { return this.columns.get(name); }

  /** Presets of the data whose columns are all there, then breaks if there are any, energies and their balance. */
  presets(plots) {
    const any = (names) => names.some((name) => this.column(name).values.some((v) => v));
    const list = plots.filter(({ x, y }) => [x, ...y].every((name) => this.has(name))).map((preset) => this.turned(preset));
    if (this.has("broken") && any(["broken"])) {
      list.push({ title: "Bonds that broke, and fragments", x: this.over, y: ["broken", "fragments"].filter((name) => this.has(name)), added: true });
      if (this.has("released")) list.push({ title: "Energy released by breaks", x: this.over, y: ["released"], added: true });
    }
    const energies = stacked.filter((name) => this.has(name));
    if (any(energies)) list.push({ title: "Energies", x: this.over, y: energies, stacked: true, added: true });
    const causes = this.names.filter((name) => name.startsWith("dissipated.") && any([name]));
    if (causes.length > 1) list.push({ title: "Energy dissipated, by cause", x: this.over, y: causes, stacked: true, added: true });
    if (this.has("balance_error") && any(["balance_error"])) list.push({ title: "Error of the energy balance", x: this.over, y: ["balance_error"], added: true });
    return list;
  }

  /** A curve against anything but time goes to the right and up, as a shortening and the force that makes it are drawn. */
  turned(preset) {
    const backwards = (names) => mostly_negative(names.map((name) => this.column(name).values));
    if ([this.clock, this.over, "step", "time"].includes(preset.x)) return preset;
    return { ...preset, turned: { x: backwards([preset.x]), y: backwards(preset.y) } };
  }

  /** The row whose step is nearest to `step`; the first of equals. */
  row_of_step(step) {
    const steps = this.column("step")?.values;
    return steps ? nearest(steps, step) : null;
  }

  /** Of the balance with this step; null in motion, where frames may be of steps that no row has. */
  load_factor_at(step) {
    const row = this.row_of_step(step);
    return row != null && this.column("step").values[row] === step ? this.column("load_factor")?.values[row] ?? null : null;
  }

  csv(names) {
    const quoted = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
    const lines = [names.map(quoted).join(",")];
    for (let row = 0; row < this.rows; ++row) lines.push(names.map((name) => this.column(name).values[row] ?? "").join(","));
    return `${lines.join("\n")}\n`;
  }
}

/** Index of the ascending value nearest to `wanted`. */
export function nearest(ascending, wanted) {
  let low = 0, high = ascending.length - 1;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (ascending[middle] < wanted) low = middle + 1;
    else high = middle;
  }
  return low > 0 && wanted - ascending[low - 1] < ascending[low] - wanted ? low - 1 : low;
}

/** Running sums over columns, row by row: what a stack draws. A row with a gap has none. */
export function stack(columns) {
  const sums = [];
  columns.forEach((values, k) => sums.push(values.map((v, row) => {
    const below = k ? sums[k - 1][row] : 0;
    return v == null || below == null ? null : below + v;
  })));
  return sums;
}

/** Whether the value of largest size is below zero. */
function mostly_negative(columns) {
  const [low, high] = extent(columns) ?? [0, 0];
  return -low > high;
}

export function extent(arrays) {
  let low = Infinity, high = -Infinity;
  for (const values of arrays) {
    for (const v of values) {
      if (v == null) continue;
      if (v < low) low = v;
      if (v > high) high = v;
    }
  }
  return low <= high ? [low, high] : null;
}
