// Tables that are sorted and filtered, buttons that copy, players that start when they are asked to. Without this
// script the page has all its text, tables and figures.

/** What a cell is sorted by: its number, else its text; null where it has none. */
function keyOf(row, column) {
  const cell = row.cells[column];
  if (cell.dataset.sort !== undefined) return Number(cell.dataset.sort);
  const text = cell.textContent.trim();
  return text === "-" || text === "" ? null : text;
}

function compare(a, b) {
  if (typeof a === "number" && typeof b === "number") return a - b;
  return String(a).localeCompare(String(b), "en", {numeric: true});
}

/** Cells without a value stay at the end in both directions; equal ones keep their order. */
function sortBy(table, column, down) {
  const body = table.tBodies[0], sign = down ? -1 : 1;
  const rows = [...body.rows].map((row) => [keyOf(row, column), row]);
  rows.sort(([a], [b]) => (a === null || b === null ? (a === null) - (b === null) : sign * compare(a, b)));
  body.append(...rows.map(([, row]) => row));
  for (const [k, head] of [...table.tHead.rows[0].cells].entries()) {
    if (k === column) head.setAttribute("aria-sort", down ? "descending" : "ascending");
    else head.removeAttribute("aria-sort");
  }
}

function makeSortable(table) {
  for (const [column, head] of [...table.tHead.rows[0].cells].entries()) {
    if (head.textContent === "command") continue;
    const button = document.createElement("button");
    button.type = "button";
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => sortBy(table, column, head.getAttribute("aria-sort") === "ascending"));
  }
}

function makeFiltered(form, table) {
  const rows = [...table.tBodies[0].rows], words = rows.map((row) => row.textContent.toLowerCase());
  const find = form.querySelector("input"), choices = [...form.querySelectorAll("select")], said = form.querySelector("output");
  const apply = () => {
    const text = find.value.trim().toLowerCase();
    let shown = 0;
    rows.forEach((row, k) => {
      const fits = words[k].includes(text)
        && choices.every((choice) => !choice.value || row.cells[choice.dataset.column].textContent.trim() === choice.value);
      row.hidden = !fits;
      shown += fits;
    });
    said.textContent = `${shown} of ${rows.length} shown`;
  };
  form.addEventListener("input", apply);
  form.addEventListener("submit", (event) => event.preventDefault());
  form.addEventListener("reset", () => setTimeout(apply));
  form.hidden = false;
  apply();
}

/** Where the clipboard is not open to a page, the old way through a selection. */
async function copy(text) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const area = Object.assign(document.createElement("textarea"), {value: text});
    document.body.append(area);
    area.select();
    const done = document.execCommand("copy");
    area.remove();
    if (!done) throw new Error("this browser does not let a page copy");
  }
}

async function copyOf(button) {
  try {
    await copy(button.dataset.copy);
    button.textContent = "Copied";
  } catch {
    button.textContent = "Not copied";
  }
  setTimeout(() => { button.textContent = "Copy"; }, 1500);
}

async function inflated(id) {
  const packed = Uint8Array.from(atob(document.getElementById(id).textContent), (c) => c.charCodeAt(0));
  return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"))).text();
}

/** The page of the player, in a frame of its own; the library that draws stands in this page once. */
async function startPlayer(box, button) {
  button.disabled = true;
  const page = await inflated(box.dataset.player), frame = document.createElement("iframe");
  frame.title = `Player: ${box.querySelector("h3").textContent}`;
  frame.sandbox = "allow-scripts";
  frame.srcdoc = page.replace("{{library}}", () => document.getElementById("library").textContent);
  button.replaceWith(frame);
}

for (const box of document.querySelectorAll("[data-table]")) {
  const table = box.querySelector("table"), form = box.querySelector("form");
  makeSortable(table);
  if (form) makeFiltered(form, table);
}
for (const button of document.querySelectorAll("button.copy")) button.hidden = false;
document.addEventListener("click", (event) => {
  const button = event.target.closest("button.copy");
  if (button) copyOf(button);
});
for (const box of document.querySelectorAll("[data-player]")) {
  const button = box.querySelector("button");
  button.hidden = false;
  button.addEventListener("click", () => startPlayer(box, button).catch((error) => {
    console.error(error);
    box.append(Object.assign(document.createElement("p"), {className: "bad", textContent: `The player cannot be started: ${error.message}`}));
  }));
}
/** A link to a section that is folded opens it, and printing opens all. */
function unfold(hash) {
  const box = document.getElementById(hash.slice(1))?.querySelector(":scope > details.fold");
  if (box) box.open = true;
}

window.addEventListener("hashchange", () => unfold(location.hash));
document.addEventListener("click", (event) => {
  const link = event.target.closest("nav a");
  if (link) unfold(link.hash);
});
window.addEventListener("beforeprint", () => {
  for (const box of document.querySelectorAll("details.fold")) box.open = true;
});
unfold(location.hash);
document.documentElement.dataset.ready = "yes";
