// Tables sorted by a column: each head is a button, first for ascending order, then for descending, then for the order as written.
// The rows of a table's body stay together: they are sorted among themselves, and the bodies by the first row of each.
const collator = new Intl.Collator("en", { numeric: true });
const NEXT = { none: "ascending", ascending: "descending", descending: "none" };
// What a cell is sorted by: a number, a text, or nothing where a value is undefined.
function keyOf(cell) {
  const text = cell.dataset.value ?? cell.textContent.trim();
  if (text === "") return null;
  const number = Number(text);
  return Number.isNaN(number) ? text : number;
}
// Numbers come before texts; what is undefined comes last in either direction.
function compare(a, b, direction) {
  if (a === null || b === null) return (a === null) - (b === null);
  const isText = (key) => typeof key === "string";
  const order = isText(a) && isText(b) ? collator.compare(a, b) : isText(a) - isText(b) || a - b;
  return direction === "descending" ? -order : order;
}
function sort(table, written, column, direction) {
  const by = (a, b) => compare(keyOf(a.cells[column]), keyOf(b.cells[column]), direction);
  const bodies = written.map(({ body, rows }) => ({ body, rows: direction === "none" ? rows : [...rows].sort(by) }));
  if (direction !== "none") bodies.sort((a, b) => by(a.rows[0], b.rows[0]));
  bodies.forEach(({ body, rows }) => body.append(...rows));
  table.append(...bodies.map(({ body }) => body));
}
function makeSortable(table) {
  const written = [...table.tBodies].map((body) => ({ body, rows: [...body.rows] }));
  const heads = [...table.tHead.rows[0].cells];
  heads.forEach((head, column) => {
    const button = document.createElement("button");
    [button.type, button.title] = ["button", "Sort by this column; rows of one cell stay together"];
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      const direction = NEXT[head.getAttribute("aria-sort") ?? "none"];
      heads.forEach((other) => other.removeAttribute("aria-sort"));
      if (direction !== "none") head.setAttribute("aria-sort", direction);
      sort(table, written, column, direction);
    });
  });
}
