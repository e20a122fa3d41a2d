"use strict";
(() => {
const find = selector => document.querySelector(selector);
const findAll = (selector, root = document) => [...root.querySelectorAll(selector)];
const press = (button, is) => button.setAttribute("aria-pressed", is);

// ---- Theme ----

const root = document.documentElement;
function setTheme(theme) { root.dataset.theme = theme; }
setTheme(matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");
const turnTheme = () => setTheme(root.dataset.theme === "dark" ? "light" : "dark");
find("#theme").onclick = turnTheme;

// ---- What is shown ----

const rows = findAll("article");

const views = findAll(".tools [data-view]");
function setView(view) {
  document.body.dataset.view = view;
  views.forEach(button => press(button, button.dataset.view === view));
}
const turnView = () => setView(document.body.dataset.view === "picture" ? "difference" : "picture");
views.forEach(button => { button.onclick = () => setView(button.dataset.view); });

function filter() {
  const words = find("#filter").value.toLowerCase().split(/\s+/).filter(Boolean);
  const mark = find("#verdict").value;
  let count = 0;
  rows.forEach(row => {
    const text = `${row.dataset.name} ${row.textContent}`.toLowerCase();
    const has = words.every(word => text.includes(word));
    row.hidden = !has || (mark !== "" && !row.querySelector(`[data-mark=${mark}]`));
    if (!row.hidden) count++;
  });
  find("#shown").textContent = `${count} of ${rows.length} cases`;
}
find("#filter").oninput = filter;
find("#verdict").onchange = filter;
filter();

// An address leads to its cell, whatever is filtered.
addEventListener("hashchange", () => {
  const cell = document.getElementById(decodeURIComponent(location.hash.slice(1)));
  if (!cell?.closest("article")?.hidden) return;
  find("#filter").value = find("#verdict").value = "";
  filter();
  cell.scrollIntoView();
});

// ---- Two images, one blinking into the other ----

const blink = find("#blink");
const [a, b] = [find("#a"), find("#b")];
let images = [];
let showsB = true;
let kind = "picture";
let timer = null;

function show() {
  const image = images[(showsB ? b : a).value];
  if (!image) return;
  const shown = image.querySelector(kind === "difference" ? "img.difference" : "img") ?? image.querySelector("img");
  find("#stage").src = shown.src;
  find("#stage").alt = shown.alt;
  const verdict = image.closest(".cell").querySelector(".verdict")?.textContent ?? "";
  find("#which").textContent = `${showsB ? "B" : "A"}: ${image.dataset.name} ${verdict}`;
  press(find("#kind"), kind === "difference");
}
function flip() { showsB = !showsB; show(); }
function play(is) {
  clearInterval(timer);
  timer = is ? setInterval(flip, 600) : null;
  press(find("#play"), is);
}
function open(image) {
  const row = image.closest("article");
  images = findAll(".image", row);
  const at = images.indexOf(image);
  for (const select of [a, b])
    select.replaceChildren(...images.map((of, index) => new Option(of.dataset.name, index)));
  a.value = at === 0 ? Math.min(1, images.length - 1) : 0;
  b.value = at;
  showsB = true;
  kind = "picture";
  find("#blink-case").textContent = row.dataset.name;
  show();
  // Whoever asks for less motion flips by hand.
  play(!matchMedia("(prefers-reduced-motion: reduce)").matches);
  blink.showModal();
}
function turn(select, by) {
  select.value = (Number(select.value) + by + images.length) % images.length;
  showsB = select === b;
  show();
}
function turnKind() { kind = kind === "picture" ? "difference" : "picture"; show(); }
findAll(".image").forEach(image => { image.onclick = () => open(image); });
a.onchange = () => { showsB = false; show(); };
b.onchange = () => { showsB = true; show(); };
find("#play").onclick = () => play(timer === null);
find("#flip").onclick = () => { play(false); flip(); };
find("#kind").onclick = turnKind;
blink.onclose = () => play(false);
findAll("[data-close]").forEach(button => { button.onclick = () => button.closest("dialog").close(); });
find("#help-button").onclick = () => find("#help").showModal();

// ---- Keys ----

// The image beside the one with the focus; from nowhere, the first.
function move(right, down) {
  const shown = rows.filter(row => !row.hidden).map(row => findAll(".cell", row));
  const from = document.activeElement?.closest(".cell");
  let y = shown.findIndex(cells => cells.includes(from));
  let x = y < 0 ? 0 : shown[y].indexOf(from);
  if (y < 0) [y, right, down] = [0, 0, 0];
  for (; shown[y]?.[x]; x += right, y += down) {
    if (down !== 0 && shown[y + down]) x = Math.min(x, shown[y + down].length - 1);
    const image = shown[y][x].querySelector(".image");
    if (image && image !== document.activeElement) {
      image.focus();
      image.scrollIntoView({ block: "nearest", inline: "nearest" });
      return;
    }
    if (right === 0 && down === 0) return;
  }
}
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
addEventListener("keydown", event => {
  if (event.ctrlKey || event.altKey || event.metaKey || event.target.matches("input[type=search], select")) return;
  const arrow = ARROWS[event.key];
  const within = find("#help").open ? {} : blink.open
    ? { " ": () => { play(false); flip(); }, p: () => play(timer === null), d: turnKind,
        ArrowLeft: () => turn(b, -1), ArrowRight: () => turn(b, 1), ArrowUp: () => turn(a, -1), ArrowDown: () => turn(a, 1) }
    : { d: turnView, t: turnTheme, "/": () => find("#filter").focus(), "?": () => find("#help").showModal(),
        ...(arrow ? { [event.key]: () => move(...arrow) } : {}) };
  const act = within[event.key];
  if (!act) return;
  event.preventDefault();
  act();
});
})();
