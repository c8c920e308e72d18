// A page that follows a run: asks the program that serves it how the run stands, and for newer data.

const pause = 2000;      // ms between two questions, at least
const rest = 4;          // and so many times what the last new page took: the run and the reader have the machine, too

/** What stands in a page, of this document or of a newer one: {json, data}. */
export function contents(document) {
  return { json: JSON.parse(document.getElementById("run").textContent), data: document.getElementById("data").textContent };
}

async function answer(address) {
  const response = await fetch(address, { cache: "no-store" });
  if (!response.ok) throw new Error(await response.text());
  return response;
}

export class Live {
  /** `version` of the data that are shown; `newer({json, data})` shows others; `say(lines)` how the run stands. */
  constructor(version, newer, say) {
    this.version = version;
    this.newer = newer;
    this.say = say;
  }

  /** Until the run has ended and its last data are shown, or nobody answers any more. */
  async follow() {
    try {
      while (await this.look()) await new Promise((done) => setTimeout(done, Math.max(pause, rest * this.took)));
    } catch (error) {
      const gone = error instanceof TypeError;   // as fetch() says that there was no answer
      this.say([gone ? "vbond watch has ended: this page stays as it is" : error.message]);
    }
  }

  /** Whether there may be more to see. A page that nobody sees waits. */
  async look() {
    this.took = 0;
    if (document.hidden) return true;
    const state = await (await answer("state")).json();
    this.say(state.lines);
    if (state.data === this.version) return state.goes_on;
    const start = performance.now();
    const page = contents(new DOMParser().parseFromString(await (await answer("./")).text(), "text/html"));
    this.version = page.json.live;
    await this.newer(page);
    this.took = performance.now() - start;
    return true;
  }
}
