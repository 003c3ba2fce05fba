// Sorts the tables of a report, searches its findings, and asks the 3D view to show the one that is clicked.
// Without this script the page is complete, but fixed.
(() => {
  "use strict";
  const number = (text) => {
    const found = /^[-+]?[\d,]*\.?\d+(e[-+]?\d+)?/.exec(text);
    return found ? Number(found[0].replaceAll(",", "")) : NaN;
  };
  const order = new Intl.Collator("en", { numeric: true });

  function sort(heading) {
    const table = heading.closest("table");
    const column = heading.cellIndex;
    const down = heading.getAttribute("aria-sort") === "ascending";
    for (const other of heading.parentElement.children) other.removeAttribute("aria-sort");
    heading.setAttribute("aria-sort", down ? "descending" : "ascending");
    const isNumber = heading.classList.contains("number");
    const body = table.tBodies[0];
    const rows = [...body.rows].map((row) => {
      const text = row.cells[column]?.textContent ?? "";
      return { row, text, value: isNumber ? number(text) : 0 };
    });
    const sign = down ? -1 : 1;
    const empty = (each) => (isNumber ? Number.isNaN(each.value) : each.text === "");
    rows.sort((a, b) => {
      if (empty(a) || empty(b)) return empty(a) - empty(b); // at the end in both directions
      return sign * (isNumber ? a.value - b.value : order.compare(a.text, b.text));
    });
    body.append(...rows.map((each) => each.row));
  }

  function search(words) {
    const wanted = words.toLowerCase().split(/\s+/).filter(Boolean);
    let count = 0;
    for (const group of document.querySelectorAll("details.findings")) {
      const title = group.querySelector("summary").textContent;
      let here = 0;
      for (const row of group.querySelectorAll("tbody tr")) {
        row.text ??= `${title} ${[...row.cells].map((cell) => cell.textContent).join(" ")}`.toLowerCase();
        row.hidden = !wanted.every((word) => row.text.includes(word));
        here += !row.hidden;
      }
      group.hidden = !here;
      count += here;
      group.before ??= group.open;
      group.open = wanted.length ? here > 0 && here <= 50 : group.before;
      if (!wanted.length) delete group.before;
      const outer = group.parentElement.closest("details");
      if (outer && wanted.length && here) outer.open = true;
    }
    return wanted.length ? `${count} found on this page` : "";
  }

  function show(row) {
    const [x, y, z] = row.dataset.at.split(" ").map(Number);
    const texts = [...row.cells].map((cell) => cell.textContent);
    const titles = [...row.closest("table").tHead.rows[0].cells].map((cell) => cell.textContent);
    const of = (title) => texts[titles.indexOf(title)];
    document.querySelectorAll("tr[aria-current]").forEach((other) => other.removeAttribute("aria-current"));
    row.setAttribute("aria-current", "true");
    const detail = { build: Number(row.dataset.build), at: [x, y, z], triage: row.dataset.triage, name: of("Name"), facts: [of("Verdict"), `at ${of("Position mm")} mm`] };
    document.dispatchEvent(new CustomEvent("show-finding", { detail }));
  }

  const sortable = (target) => {
    const heading = target.closest?.("thead th");
    return heading && heading.closest("table").tBodies[0].rows.length > 1 ? heading : null;
  };
  document.addEventListener("click", (event) => {
    const heading = sortable(event.target);
    if (heading) sort(heading);
    const row = event.target.closest?.("tr[data-at]");
    if (row && !getSelection().toString()) show(row);
  });
  document.addEventListener("keydown", (event) => {
    if (event.key !== "Enter") return;
    const heading = sortable(event.target);
    if (heading) sort(heading);
    else if (event.target.matches?.("tr[data-at]")) show(event.target);
  });
  for (const table of document.querySelectorAll("table")) {
    if (table.tBodies[0]?.rows.length < 2) continue;
    for (const heading of table.tHead?.rows[0].cells ?? []) {
      heading.tabIndex = 0;
      heading.title = "Sort by this column";
    }
  }
  const bar = document.getElementById("search");
  if (bar) {
    const field = bar.querySelector("input");
    let waiting = 0;
    bar.hidden = false;
    field.addEventListener("input", () => {
      clearTimeout(waiting);
      waiting = setTimeout(() => { bar.querySelector("span").textContent = search(field.value); }, 120);
    });
  }
  document.addEventListener("click", (event) => {
    const link = event.target.closest?.('a[href^="#"]');
    const inner = link && document.querySelector(`${link.getAttribute("href")} > details`);
    if (inner) inner.open = true;
  });
})();
