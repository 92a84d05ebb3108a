// Tables sorted by a click on a header, filtered by a text.

/**
 * Numbers before texts before nothing.
 * @param {string} a @param {string} b
 */
export function compare(a, b) {
  const rank = (/** @type {string} */ text) => (text === "" ? 2 : Number.isNaN(Number(text)) ? 1 : 0);
  const [x, y] = [rank(a), rank(b)];
  if (x !== y) return x - y;
  return x === 0 ? Number(a) - Number(b) : a.localeCompare(b, undefined, { numeric: true });
}

/**
 * The order of cells; what has no value stays last in both directions.
 * @param {string[]} values @param {boolean} down
 */
export function order(values, down) {
  const places = values.map((_, i) => i);
  return places.sort((i, j) => {
    const [a, b] = [values[i], values[j]];
    const empty = Number(a === "") - Number(b === "");
    return empty || (down ? -1 : 1) * compare(a, b) || i - j;
  });
}

/** Seconds of the units of time that tables use. @type {Record<string, number>} */
const SECONDS = { ns: 1e-9, "µs": 1e-6, ms: 1e-3, s: 1, min: 60, h: 3600 };

/** The number of a text that begins with one, times of different units in seconds, else the text. @param {string} text */
export function quantity(text) {
  const found = /^[+±]?(-?[\d.,]+(?:e[+-]?\d+)?)(?:\s+(\S+))?/.exec(text.trim());
  const number = Number(found?.[1].replaceAll(",", ""));
  if (!found || Number.isNaN(number)) return text.trim();
  return String(number * (SECONDS[found[2] ?? ""] ?? 1));
}

/** @param {HTMLTableCellElement | undefined} cell */
const valueOf = (cell) => (cell ? cell.dataset.value ?? quantity(cell.textContent ?? "") : "");

/** @param {HTMLTableElement} table @returns {boolean} whether it is one to sort */
function sortable(table) {
  const body = table.tBodies[0];
  const heads = [...(table.tHead?.rows[0]?.cells ?? [])];
  // A table of facts, without titles, is in its order.
  if (!body || !heads.length || heads.some((head) => !head.textContent?.trim())) return false;
  heads.forEach((head, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      const down = head.getAttribute("aria-sort") === "ascending";
      for (const other of heads) other.removeAttribute("aria-sort");
      head.setAttribute("aria-sort", down ? "descending" : "ascending");
      const rows = [...body.rows];
      body.append(...order(rows.map((row) => valueOf(row.cells[column])), down).map((i) => rows[i]));
    });
  });
  return true;
}

/** Uses the input that stands before the table, or puts one there where the table is long. @param {HTMLTableElement} table */
function filterable(table) {
  const body = table.tBodies[0];
  const place = table.closest(".scroll") ?? table;
  let input = place.previousElementSibling;
  if (!(input instanceof HTMLInputElement)) {
    if (!body || body.rows.length < 6) return;
    input = document.createElement("input");
    input.setAttribute("type", "search");
    input.setAttribute("placeholder", "Filter rows");
    place.before(input);
  }
  const field = /** @type {HTMLInputElement} */ (input);
  if (!field.labels?.length && !field.hasAttribute("aria-label")) field.setAttribute("aria-label", `Filter rows: ${table.caption?.textContent ?? "table"}`);
  field.classList.add("filter");
  field.addEventListener("input", () => {
    const words = field.value.toLowerCase().split(/\s+/);
    for (const row of body.rows) {
      const text = (row.textContent ?? "").toLowerCase();
      row.hidden = !words.every((word) => text.includes(word));
    }
  });
}

export function linkTables() {
  for (const table of /** @type {NodeListOf<HTMLTableElement>} */ (document.querySelectorAll("table.sortable"))) {
    if (sortable(table)) filterable(table);
  }
  // What scrolls sideways can be scrolled by keyboard too.
  for (const box of document.querySelectorAll(".scroll, figure")) {
    if (box.scrollWidth > box.clientWidth) box.setAttribute("tabindex", "0");
  }
}
