// Uses the page as a reader would. What came of it is `probe.result`: the checks that failed, the number of drives, and when
// the page had loaded, in milliseconds.
globalThis.probe = { drives: 0 };
const failed = [];
const element = (id) => document.getElementById(id);
const check = (name, isTrue) => { if (!isTrue) failed.push(name); };
const wait = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));
// Until something is so, ten seconds at most: how often a page without a window is painted is not known.
const until = async (isSo) => {
  for (let k = 0; k < 200 && !isSo(); k++) await wait(50);
  return isSo();
};
const seconds = () => Number.parseFloat(element("clock").textContent);
const press = (key) => element("room").dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true }));
const isPainted = (canvas) => {
  // A copy, since reading from the page's own would make them slow, and the browser would say so.
  const copy = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height });
  const context = copy.getContext("2d", { willReadFrequently: true });
  context.drawImage(canvas, 0, 0);
  const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
  return new Set(new Uint32Array(data.buffer)).size > 5;
};
function sortsResults() {
  const table = document.querySelector(".results");
  const heads = [...table.tHead.rows[0].cells];
  const sorted = (title) => {
    const column = heads.findIndex((head) => head.textContent.startsWith(title));
    heads[column].querySelector("button").click();
    return [...table.tBodies].map((body) => [...body.rows].map((row) => row.cells[column].dataset.value ?? row.cells[column].textContent));
  };
  const order = () => [...table.querySelectorAll("tbody tr")].map((row) => row.querySelector("a").hash).join();
  const cells = () => [...table.tBodies].map((body) => new Set([...body.rows].map((row) => row.cells[0].textContent)).size).join();
  const isAscending = (values) => values.every((value, k) => k === 0 || Number(values[k - 1]) <= Number(value));
  const asWritten = order();
  const up = sorted("mean speed");
  check("numbers ascend", up.length === 3 && up.every(isAscending) && isAscending(up.map((cell) => cell[0])));
  check("rows of a cell stay together", cells() === "1,1,1");
  const head = heads.find((head) => head.textContent.startsWith("mean speed"));
  check("the head says so", head.getAttribute("aria-sort") === "ascending");
  const down = sorted("mean speed");
  check("then they descend", isAscending(down.map((cell) => cell[0]).reverse()) && down.every((cell) => isAscending([...cell].reverse())));
  check("which it says too", head.getAttribute("aria-sort") === "descending" && table.querySelectorAll("[aria-sort]").length === 1);
  sorted("mean speed");
  check("then they stand as written", order() === asWritten && !head.hasAttribute("aria-sort"));
  check("names are sorted as texts", sorted("<i>who")[0][0].startsWith("DDQN"));
  const [many, few] = ["10", "9.5"].map((value) => Object.assign(document.createElement("td"), { textContent: value }));
  check("numbers are no texts", compare(keyOf(many), keyOf(few), "ascending") > 0);
  check("what is undefined comes last", [1, "a"].every((key) => ["ascending", "descending"].every((way) => compare(null, key, way) > 0)));
}
const isShown = (e) => e.checkVisibility() && e.getBoundingClientRect().width > 0;
// Every figure shows one of its two pictures, at a size at which words of 12 pixels can be read.
function showsReadableCharts() {
  const isNarrow = document.documentElement.clientWidth <= 760;
  for (const figure of document.querySelectorAll("figure")) {
    const [wide, narrow] = ["wide", "narrow"].map((name) => figure.querySelector(`.at-${name} > svg`));
    check(`${figure.dataset.name} has the picture for the window`, isShown(narrow) === isNarrow && isShown(wide) !== isNarrow);
    const svg = isNarrow ? narrow : wide;
    const { left, right, width } = svg.getBoundingClientRect();
    check(`${figure.dataset.name} is in the window`, left >= 0 && right <= document.documentElement.clientWidth);
    check(`${figure.dataset.name} can be read`, (12 * width) / svg.viewBox.baseVal.width >= 9);
  }
}
// Every level's value is in the window of a phone, and named.
function showsEveryLevel() {
  if (document.documentElement.clientWidth > 760) return;
  const cells = [...document.querySelectorAll("details[open] .settings td")];
  const isWithin = (e) => e.getBoundingClientRect().right <= document.documentElement.clientWidth;
  const isNamed = (e) => getComputedStyle(e, "::before").content.includes(e.dataset.level.slice(0, 3));
  check("settings are in the window", cells.length > 0 && cells.every((e) => isShown(e) && isWithin(e) && isNamed(e)));
}
// A pointer is told of all marks beneath it, covered ones too.
function tellsOfCoveredMarks() {
  const mark = [...document.querySelectorAll("#speed .mark")].find(isShown);
  const twin = mark.parentElement.insertAdjacentElement("afterend", mark.parentElement.cloneNode(true));
  mark.scrollIntoView({ block: "center" });
  const { x, y, width, height } = mark.lastElementChild.getBoundingClientRect();
  const [clientX, clientY] = [x + width / 2, y + height / 2];
  const topmost = document.elementFromPoint(clientX, clientY);
  check("the mark is covered", topmost && !mark.contains(topmost));
  topmost.dispatchEvent(new PointerEvent("pointermove", { clientX, clientY, bubbles: true }));
  const tip = element("tip");
  check("a mark is told of beneath another", !tip.hidden && tip.textContent.includes(mark.getAttribute("aria-label")));
  twin.remove();
}
async function use() {
  check("the page gets ready", document.documentElement.dataset.ready === "yes");
  check("it shows a drive", probe.drives > 0 && document.querySelector("#drive-figure svg"));
  for (const id of ["room", "strip", "action"]) check(`the ${id} is painted`, isPainted(element(id)));
  check("it starts at the start", seconds() === 0);
  element("play").click();
  check("it says that it plays", element("play").textContent === "Pause");
  check("it plays", await until(() => seconds() > 0.3 && Number(element("time").value) > 0));
  element("play").click();
  const paused = seconds();
  await wait(200);
  check("it pauses", seconds() === paused);
  press("Home");
  check("Home goes to the start", seconds() === 0);
  press("ArrowRight");
  check("an arrow goes a step", seconds() > 0 && seconds() <= 1);
  const rays = element("rays").checked;
  press("l");
  check("L switches the lidar", element("rays").checked !== rays);
  element("time").value = element("time").max;
  element("time").dispatchEvent(new Event("input"));
  check("the slider goes to the end", element("clock").textContent.match(/^([\d.]+) \/ \1 s$/));
  const end = seconds();
  element("rate").value = "8";
  press(" ");
  check("it plays again from the start", await until(() => seconds() > 0 && seconds() < end));
  press(" ");
  for (let number = 1; number < probe.drives; number++) {
    element("next").click();
    check(`drive ${number} is shown`, element("drive").value === String(number) && isPainted(element("room")));
  }
  sortsResults();
  const number = document.querySelector(".results a");
  number.click();
  await wait(100);
  const runs = document.querySelector(number.getAttribute("href"));
  check("a number leads to its runs", runs.open && runs.querySelectorAll("td.marked").length > 0);
  const drive = document.querySelector('#runs a[href^="#drive-"]');
  drive.click();
  await wait(100);
  check("a run leads to its drive", `#drive-${element("drive").value}` === drive.hash);
  const key = document.querySelector(".chart .key");
  if (key) {
    key.dispatchEvent(new MouseEvent("click", { bubbles: true }));
    const line = key.closest("svg").querySelector(`.series[data-key="${key.dataset.key}"]`);
    check("a key hides its line", getComputedStyle(line).display === "none");
  }
  showsReadableCharts();
  showsEveryLevel();
  tellsOfCoveredMarks();
  const wide = [...document.querySelectorAll("body *")].filter((e) => !e.closest(".scroll, nav, .skip"));
  const beyond = wide.find((e) => e.getBoundingClientRect().right > document.documentElement.clientWidth + 1);
  check(`nothing is wider than the window: ${beyond?.outerHTML.slice(0, 80)}`, !beyond);
}
probe.result = new Promise((tell) => {
  window.addEventListener("load", async () => {
    const loaded = performance.now();
    probe.drives = element("drive")?.options.length;
    try { await use(); } catch (error) { failed.push(error.stack); }
    tell({ failed, loaded, drives: probe.drives });
  });
});
