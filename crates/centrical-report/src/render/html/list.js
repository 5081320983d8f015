"use strict";
const text = cell => cell.firstChild ? cell.firstChild.textContent : "";
function rowsOf(table) {
  return [...table.tBodies[0].rows].map(row => ({ row, cells: [...row.cells].map(text) }));
}
function sort(table, rows, column, header) {
  const sign = header.getAttribute("aria-sort") === "ascending" ? -1 : 1, number = header.classList.contains("number");
  rows.sort((a, b) => {
    const [x, y] = [a.cells[column], b.cells[column]].map(value => number ? Number(value || "NaN") : value);
    if (number) return Number.isNaN(x) - Number.isNaN(y) || sign * (x - y) || 0;
    return sign * (x < y ? -1 : x > y ? 1 : 0);
  });
  for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
  header.setAttribute("aria-sort", sign > 0 ? "ascending" : "descending");
  table.tBodies[0].append(...rows.map(({ row }) => row));
}
function sortable(table, rows) {
  [...table.tHead.rows[0].cells].forEach((header, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = header.textContent;
    header.replaceChildren(button);
    button.addEventListener("click", () => sort(table, rows, column, header));
  });
}
function filtered(rows) {
  const field = name => document.getElementById(name);
  function show() {
    const words = field("words").value.toLowerCase(), from = field("from").value, to = field("to").value, verdict = field("verdict").value;
    let count = 0;
    for (const { row, cells } of rows) {
      const [date, model, serial, station] = cells;
      const names = [serial, model, station].some(name => name.toLowerCase().includes(words));
      const is = names && (!from || date >= from) && (!to || date <= to) && (!verdict || cells[5] === verdict);
      row.hidden = !is;
      count += is;
    }
    field("count").textContent = `${count} of ${rows.length}`;
  }
  for (const name of ["words", "from", "to", "verdict"]) field(name).addEventListener("input", show);
  document.querySelector(".filters").addEventListener("submit", event => event.preventDefault());
  show();
}
for (const table of document.querySelectorAll("table.sortable")) {
  const rows = rowsOf(table);
  sortable(table, rows);
  if (table.id === "list") filtered(rows);
}
