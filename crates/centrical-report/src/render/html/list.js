"use strict";
const text = cell => cell.firstChild ? cell.firstChild.textContent : "";
// The first number of "12.5 ± 0.3".
const numberIn = value => Number((value.match(/[+-]?\d[\d.]*(?:e[+-]?\d+)?/i) || ["NaN"])[0]);
function rowsOf(table) {
  return [...table.tBodies[0].rows].map(row => ({ row, cells: [...row.cells].map(text) }));
}
function sort(table, rows, column, header) {
  const sign = header.getAttribute("aria-sort") === "ascending" ? -1 : 1, number = header.classList.contains("number");
  rows.sort((a, b) => {
    const [x, y] = [a.cells[column], b.cells[column]].map(value => number ? numberIn(value) : value);
    if (number) return Number.isNaN(x) - Number.isNaN(y) || sign * (x - y) || 0;
    return sign * (x < y ? -1 : x > y ? 1 : 0);
  });
  for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
  header.setAttribute("aria-sort", sign > 0 ? "ascending" : "descending");
  table.tBodies[0].append(...rows.map(({ row }) => row));
}
function sortable(table, rows) {
  [...table.tHead.rows[0].cells].forEach((header, column) => {
    if (!header.textContent) return;
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
    const part = field("serial").value.toLowerCase(), words = field("words").value.toLowerCase(), from = field("from").value, to = field("to").value, verdict = field("verdict").value;
    let count = 0;
    for (const { row, cells } of rows) {
      const [date, model, serial, station] = cells;
      const names = serial.toLowerCase().includes(part) && [model, station].some(name => name.toLowerCase().includes(words));
      const is = names && (!from || date >= from) && (!to || date <= to) && (!verdict || cells[5] === verdict);
      row.hidden = !is;
      count += is;
    }
    field("count").textContent = `${count} of ${rows.length}`;
  }
  for (const name of ["serial", "words", "from", "to", "verdict"]) field(name).addEventListener("input", show);
  document.querySelector(".filters").addEventListener("submit", event => event.preventDefault());
  show();
}
for (const table of document.querySelectorAll("table.sortable")) {
  const rows = rowsOf(table);
  sortable(table, rows);
  if (table.id === "list") filtered(rows);
}
