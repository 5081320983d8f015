"use strict";
const table = document.getElementById("list"), body = table.tBodies[0];
const rows = [...body.rows].map(row => ({ row, cells: [...row.cells].map(cell => cell.firstChild ? cell.firstChild.textContent : "") }));
const field = name => document.getElementById(name);
let order = { column: -1, sign: 1 };
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
function sort(column, header) {
  order = { column, sign: order.column === column ? -order.sign : 1 };
  const number = column === 4, value = cells => number ? Number(cells[4] || "NaN") : cells[column];
  rows.sort((a, b) => {
    const [x, y] = [value(a.cells), value(b.cells)];
    if (number) return Number.isNaN(x) - Number.isNaN(y) || order.sign * (x - y) || 0;
    return order.sign * (x < y ? -1 : x > y ? 1 : 0);
  });
  for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
  header.setAttribute("aria-sort", order.sign > 0 ? "ascending" : "descending");
  body.append(...rows.map(({ row }) => row));
}
[...table.tHead.rows[0].cells].forEach((header, column) => {
  const button = document.createElement("button");
  button.type = "button";
  button.textContent = header.textContent;
  header.replaceChildren(button);
  button.addEventListener("click", () => sort(column, header));
});
for (const name of ["words", "from", "to", "verdict"]) field(name).addEventListener("input", show);
document.querySelector(".filters").addEventListener("submit", event => event.preventDefault());
show();
