// What makes the page more than paper: links into tables and drives, tips, legends, saved figures.
function buildNavigation() {
  const nav = document.querySelector("nav");
  for (const section of document.querySelectorAll("main > section")) {
    const link = document.createElement("a");
    link.href = `#${section.id}`;
    link.textContent = section.querySelector("h2").textContent;
    nav.append(link);
  }
}
// A link to a number's runs opens their table and marks the number's column.
function openRuns(row, metric) {
  const details = document.getElementById(`runs-${row}`);
  if (!details) return;
  details.open = true;
  details.querySelectorAll("[data-metric]").forEach((cell) => {
    cell.classList.toggle("marked", cell.dataset.metric === metric);
  });
  details.scrollIntoView({ block: "start" });
}
function followLinks(showDrive) {
  let metric;
  document.addEventListener("click", (event) => {
    const link = event.target.closest('a[href^="#"]');
    if (!link) return;
    metric = link.dataset.metric;
    if (link.hash === window.location.hash) follow();
  });
  const follow = () => {
    const [, kind, number] = window.location.hash.match(/^#(runs|drive)-(\d+)$/) || [];
    if (kind === "runs") openRuns(number, metric);
    if (kind === "drive" && showDrive(Number(number))) document.getElementById("drives").scrollIntoView();
  };
  window.addEventListener("hashchange", follow);
  follow();
}
// Most marks of which one tip tells.
const MAX_TIPS = 6;
// Tips of marks at once, and under a finger too.
function showTips() {
  const tip = document.getElementById("tip");
  const texts = new WeakMap();
  document.querySelectorAll(".chart .mark > title").forEach((title) => {
    texts.set(title.parentElement, title.textContent);
    title.parentElement.setAttribute("aria-label", title.textContent);
    title.remove(); // or browsers would show it a second time
  });
  // Of all marks at a place: those that others cover too.
  const textsAt = (x, y) => {
    const marks = document.elementsFromPoint(x, y).map((element) => element.closest(".mark"));
    return [...new Set(marks)].map((mark) => texts.get(mark)).filter(Boolean).slice(0, MAX_TIPS).join("\n");
  };
  const follow = (event) => {
    tip.hidden = !event.target.closest?.(".mark");
    if (tip.hidden) return;
    tip.textContent = textsAt(event.clientX, event.clientY);
    const x = Math.min(event.clientX + 14, document.documentElement.clientWidth - tip.offsetWidth - 6);
    const y = event.clientY + 18 + tip.offsetHeight > window.innerHeight ? event.clientY - tip.offsetHeight - 10 : event.clientY + 18;
    [tip.style.left, tip.style.top] = [`${Math.max(6, x)}px`, `${y}px`];
  };
  document.addEventListener("pointermove", follow);
  document.addEventListener("pointerdown", follow);
}
// A key of a legend hides and shows its lines.
function listenToLegends() {
  for (const key of document.querySelectorAll(".chart .key")) {
    const lines = key.closest("svg").querySelectorAll(`.series[data-key="${key.dataset.key}"]`);
    for (const [name, value] of [["role", "button"], ["tabindex", "0"], ["aria-pressed", "true"]]) key.setAttribute(name, value);
    const toggle = () => {
      const isShown = key.classList.toggle("off");
      key.setAttribute("aria-pressed", String(!isShown));
      lines.forEach((line) => line.classList.toggle("off", isShown));
    };
    key.addEventListener("click", toggle);
    key.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" && event.key !== " ") return;
      event.preventDefault();
      toggle();
    });
  }
}
function save(name, blob) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
// A figure as a file's text: on white, without what is switched off.
function textOf(svg) {
  const copy = svg.cloneNode(true);
  copy.querySelectorAll(".off").forEach((element) => element.remove());
  return new XMLSerializer().serializeToString(copy);
}
function savePng(name, svg) {
  const image = new Image();
  const [width, height] = ["width", "height"].map((side) => Number(svg.getAttribute(side)));
  image.onload = () => {
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [3 * width, 3 * height]; // 288 dots an inch
    canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
    canvas.toBlob((blob) => save(name, blob));
  };
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(textOf(svg))}`;
}
function addSaveButtons() {
  for (const figure of document.querySelectorAll("figure")) {
    const name = figure.dataset.name;
    const button = (kind, action) => {
      const button = document.createElement("button");
      [button.type, button.textContent] = ["button", kind];
      button.setAttribute("aria-label", `Save this figure as ${kind}`);
      button.addEventListener("click", () => action(figure.querySelector(".at-wide > svg")));
      return button;
    };
    const saves = document.createElement("span");
    saves.className = "saves";
    saves.append(
      button("SVG", (svg) => save(`${name}.svg`, new Blob([textOf(svg)], { type: "image/svg+xml" }))),
      button("PNG", (svg) => savePng(`${name}.png`, svg)),
    );
    figure.querySelector(".head").append(saves);
  }
}
function start() {
  const data = JSON.parse(document.getElementById("data").textContent);
  buildNavigation();
  const select = document.getElementById("drive");
  const player = new Player(data);
  const show = (number) => {
    if (!(number in data.drives)) return false;
    select.value = String(number);
    player.load(number);
    const [figure, drive] = [document.getElementById("drive-figure"), player.drive];
    const otherwise = drive.is_as_recorded ? "" : " (went otherwise than recorded)";
    figure.querySelector("h3").textContent = `${data.labels[drive.row]}: ${drive.why}${otherwise}`;
    figure.querySelector(".at-wide").innerHTML = figureOf(drive, data.viridis, false);
    figure.querySelector(".at-narrow").innerHTML = figureOf(drive, data.viridis, true);
    return true;
  };
  const step = (by) => show((Number(select.value) + by + data.drives.length) % data.drives.length);
  select.addEventListener("change", () => show(Number(select.value)));
  document.getElementById("previous").addEventListener("click", () => step(-1));
  document.getElementById("next").addEventListener("click", () => step(1));
  if (!show(0)) document.getElementById("drives").remove();
  showTips();
  listenToLegends();
  addSaveButtons();
  document.querySelectorAll("table.sortable").forEach(makeSortable);
  followLinks(show);
  document.documentElement.dataset.ready = "yes";
}
start();
