"use strict";
(() => {
  const all = (selector, root = document) => [...root.querySelectorAll(selector)];

  // What a point of a plot stands for.
  const tip = document.getElementById("tip");
  const show = (mark) => {
    const at = mark.getBoundingClientRect();
    tip.textContent = mark.dataset.tip;
    tip.hidden = false;
    const left = Math.min(at.right + 8, innerWidth - tip.offsetWidth - 8);
    tip.style.left = `${Math.max(left, 8)}px`;
    tip.style.top = `${Math.max(at.top - tip.offsetHeight - 8, 8)}px`;
  };
  for (const mark of all("[data-tip]")) {
    // The browser's own tip, for whoever opens the plot alone, would stand beside ours.
    mark.querySelector("title")?.remove();
    for (const event of ["pointerenter", "focus"]) mark.addEventListener(event, () => show(mark));
    for (const event of ["pointerleave", "blur"]) mark.addEventListener(event, () => (tip.hidden = true));
  }

  // Lines that are shown.
  const lines = all(".plot .line");
  for (const key of all(".plot .key")) {
    const toggle = () => key.parentNode.classList.toggle("hidden");
    key.addEventListener("click", toggle);
    key.addEventListener("keydown", (event) => event.key === "Enter" && toggle());
  }
  const buttons = all("[data-show]");
  for (const button of buttons) {
    button.addEventListener("click", () => {
      const group = button.dataset.show;
      for (const other of buttons) other.setAttribute("aria-pressed", String(other === button));
      for (const line of lines) {
        const shown = group === "" || line.dataset.group === group || line.dataset.group === "base";
        line.classList.toggle("hidden", !shown);
      }
    });
  }

  // Of many lines, what the first kind of choice is about.
  if (lines.length > 40) buttons[2]?.click();

  // A line that the reader points at, in a legend or in the table, stands out in every plot.
  const point = (name) => {
    for (const plot of all(".plot")) plot.classList.toggle("pointed", name !== null);
    for (const line of lines) line.classList.toggle("on", line.dataset.name === name);
  };
  const points_at = (element, name) => {
    element.addEventListener("pointerenter", () => point(name));
    element.addEventListener("pointerleave", () => point(null));
  };
  for (const key of all(".plot .key")) points_at(key, key.parentNode.dataset.name);
  for (const row of all("tbody tr")) {
    const name = row.cells[0].textContent;
    const line = lines.find((line) => line.dataset.name === name);
    if (!line) continue;
    points_at(row, name);
    row.cells[0].style.setProperty("--line", line.getAttribute("stroke"));
    row.classList.add("drawn");
    row.classList.toggle("base", line.dataset.group === "base");
  }

  // The table, sorted by a column; once more turns it round. What is unknown comes last.
  for (const header of all("th")) {
    header.querySelector("button").addEventListener("click", () => {
      const up = header.getAttribute("aria-sort") !== "ascending";
      for (const other of all("th", header.parentNode)) other.removeAttribute("aria-sort");
      header.setAttribute("aria-sort", up ? "ascending" : "descending");
      const body = header.closest("table").tBodies[0];
      const column = header.cellIndex;
      const sign = up ? 1 : -1;
      const key = (row) => {
        const cell = row.cells[column];
        const number = cell.dataset.number;
        if (number === undefined) return cell.textContent;
        return number === "" ? sign * Infinity : Number(number);
      };
      const compare = (a, b) => (typeof a === "string" ? a.localeCompare(b) : a === b ? 0 : a - b);
      const rows = [...body.rows].sort((a, b) => sign * compare(key(a), key(b)));
      body.append(...rows);
    });
  }

  // How much of a strip shows the reference.
  for (const strip of all(".strip")) {
    const slider = strip.querySelector("input");
    const pair = strip.querySelector(".pair");
    const move = () => pair.style.setProperty("--cut", `${slider.value}%`);
    slider.addEventListener("input", move);
    move();
  }
})();
