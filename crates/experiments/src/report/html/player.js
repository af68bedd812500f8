// The player: one drive at a time, from its start to its end.
class Player {
  constructor(data) {
    const element = (id) => document.getElementById(id);
    this.data = data;
    this.canvases = { room: element("room"), strip: element("strip"), action: element("action") };
    this.inputs = { play: element("play"), time: element("time"), rate: element("rate"), rays: element("rays") };
    [this.clock, this.readout, this.root] = [element("clock"), element("readout"), element("player")];
    this.unpacked = new Map();
    [this.time, this.isPlaying, this.frame] = [0, false, 0];
    this.night = window.matchMedia("(prefers-color-scheme: dark)");
    this.night.addEventListener("change", () => this.draw());
    new ResizeObserver(() => this.draw()).observe(this.root);
    this.listen();
  }
  listen() {
    const { play, time, rays } = this.inputs;
    play.addEventListener("click", () => this.toggle());
    time.addEventListener("input", () => { this.stop(); this.seek((this.end * time.value) / time.max); });
    rays.addEventListener("change", () => this.draw());
    this.root.addEventListener("keydown", (event) => this.key(event));
    const scrub = (event) => {
      if (event.buttons === 0 && event.type !== "pointerdown") return;
      const box = this.canvases.strip.getBoundingClientRect();
      this.stop();
      this.seek((this.end * (event.clientX - box.left - this.strip.x)) / this.strip.width);
    };
    this.canvases.strip.addEventListener("pointerdown", (event) => {
      this.canvases.strip.setPointerCapture(event.pointerId);
      scrub(event);
    });
    this.canvases.strip.addEventListener("pointermove", scrub);
  }
  key(event) {
    if (event.target.tagName === "SELECT" || event.ctrlKey || event.metaKey || event.altKey) return;
    const { trace } = this.drive;
    const k = stateAt(trace, this.time);
    const back = this.time > trace.t[k] + 1e-6 ? k : Math.max(0, k - 1);
    const actions = {
      " ": () => this.toggle(),
      ArrowLeft: () => { this.stop(); this.seek(trace.t[back]); },
      ArrowRight: () => { this.stop(); this.seek(trace.t[Math.min(trace.n - 1, k + 1)]); },
      Home: () => { this.stop(); this.seek(0); },
      End: () => { this.stop(); this.seek(this.end); },
      l: () => { this.inputs.rays.checked = !this.inputs.rays.checked; this.draw(); },
    };
    const action = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    // Space presses whatever button or box has the focus.
    const presses = event.key === " " && (event.target.tagName === "BUTTON" || event.target.type === "checkbox");
    if (!action || presses) return;
    event.preventDefault();
    action();
  }
  // The drive of a number, unpacked when it is first wanted.
  get(number) {
    if (!this.unpacked.has(number)) {
      const drive = this.data.drives[number];
      const trace = unpack(drive.trace);
      this.unpacked.set(number, { ...drive, trace, top: roundTop(trace.speed) });
    }
    return this.unpacked.get(number);
  }
  load(number) {
    this.stop();
    this.drive = this.get(number);
    this.end = this.drive.trace.t[this.drive.trace.n - 1];
    this.seek(0);
  }
  toggle() { if (this.isPlaying) this.stop(); else this.play(); }
  play() {
    if (!this.drive) return;
    if (this.time >= this.end) this.time = 0;
    this.isPlaying = true;
    this.showState();
    let before = performance.now();
    const step = (now) => {
      if (!this.isPlaying) return;
      this.time = Math.min(this.end, this.time + ((now - before) / 1000) * Number(this.inputs.rate.value));
      before = now;
      this.draw();
      if (this.time >= this.end) this.stop(); else this.frame = requestAnimationFrame(step);
    };
    this.frame = requestAnimationFrame(step);
  }
  stop() {
    this.isPlaying = false;
    cancelAnimationFrame(this.frame);
    this.showState();
  }
  showState() {
    this.inputs.play.textContent = this.isPlaying ? "Pause" : "Play";
    this.inputs.play.setAttribute("aria-pressed", String(this.isPlaying));
  }
  seek(time) {
    this.time = Math.min(Math.max(time, 0), this.end);
    this.draw();
  }
  draw() {
    if (!this.drive || this.root.clientWidth === 0) return; // not shown, as on paper
    const style = {
      colours: this.night.matches ? NIGHT : PAPER, stops: this.data.viridis, rays: this.inputs.rays.checked,
      isOver: this.time >= this.end,
    };
    this.drawRoom(style);
    this.drawStrip(style);
    this.drawAction(style);
    this.inputs.time.value = this.end > 0 ? (this.inputs.time.max * this.time) / this.end : 0;
    this.inputs.time.setAttribute("aria-valuetext", `${this.time.toFixed(1)} of ${this.end.toFixed(1)} seconds`);
    this.clock.textContent = `${this.time.toFixed(1)} / ${this.end.toFixed(1)} s`;
    this.showNumbers();
  }
  drawRoom(style) {
    const [, , width, height] = this.drive.scene.view;
    const most = Math.max(260, Math.min(620, 0.72 * window.innerHeight));
    const available = this.canvases.room.parentElement.clientWidth;
    const scale = Math.min(available / width, most / height);
    const [w, h] = [Math.max(1, scale * width), Math.max(1, scale * height)];
    const surface = new CanvasSurface(this.canvases.room, w, h);
    drawRoom(surface, viewOf(this.drive.scene.view, { x: 1, y: 1, width: w - 2, height: h - 2 }), this.drive, this.time, style);
  }
  drawStrip(style) {
    const width = this.canvases.strip.parentElement.clientWidth;
    const height = window.innerWidth > 760 ? 250 : 180;
    const surface = new CanvasSurface(this.canvases.strip, width, height);
    this.strip = { x: 52, y: 10, width: width - 64, height: height - 54 };
    const at = drawStrip(surface, this.strip, this.drive, this.time, style);
    const [x] = at(this.time, 0);
    surface.line([[x, this.strip.y], [x, this.strip.y + this.strip.height]], { stroke: style.colours.hit, width: 1.6 });
  }
  // The command that is chosen now: what led to the next state.
  chosen() {
    const { trace } = this.drive;
    const k = Math.min(stateAt(trace, this.time) + 1, trace.n - 1);
    return { speed: trace.commandSpeed[k], yawRate: trace.commandYawRate[k] };
  }
  drawAction(style) {
    const size = window.innerWidth > 760 ? 168 : 140;
    const surface = new CanvasSurface(this.canvases.action, size, size);
    const points = this.drive.set_points;
    if (points && points[1].length > 1) drawSetPoints(surface, size, points, this.chosen(), style.colours);
    else drawBars(surface, size, this.drive.trace, this.chosen(), style.colours);
  }
  showNumbers() {
    const { trace } = this.drive;
    const k = stateAt(trace, this.time);
    const { speed, yawRate } = this.chosen();
    const rows = [
      ["speed", trace.speed[k], "m/s"], ["commanded", speed, "m/s"], ["yaw rate", trace.yawRate[k], "rad/s"],
      ["commanded", yawRate, "rad/s"], ["clearance", trace.clearance[k], "m"],
    ];
    const text = rows.map(([name, value, unit]) => `${name}|${value.toFixed(2)} ${unit}`).join("\n");
    if (this.shown === text) return;
    this.shown = text;
    this.readout.replaceChildren(...rows.map(([name, value, unit]) => {
      const [row, dt, dd] = ["div", "dt", "dd"].map((tag) => document.createElement(tag));
      [dt.textContent, dd.textContent] = [name, `${value.toFixed(2)} ${unit}`];
      row.append(dt, dd);
      return row;
    }));
  }
}
// The table of set-points with the chosen one filled: speeds upwards, turns as seen from above, left to the left.
function drawSetPoints(surface, size, [speeds, yawRates], chosen, colours) {
  const [up, left] = [[...speeds].sort((a, b) => b - a), [...yawRates].sort((a, b) => b - a)];
  const [x0, y0] = [36, 8];
  const [w, h] = [(size - x0 - 4) / left.length, (size - y0 - 38) / up.length];
  const near = (a, b) => Math.abs(a - b) < 2e-3;
  up.forEach((speed, row) => left.forEach((yawRate, column) => {
    const [x, y] = [x0 + column * w + 1, y0 + row * h + 1];
    const isChosen = near(speed, chosen.speed) && near(yawRate, chosen.yawRate);
    const corners = [[x, y], [x + w - 2, y], [x + w - 2, y + h - 2], [x, y + h - 2]];
    surface.polygon(corners, isChosen ? { fill: "#d55e00" } : { fill: colours.still, alpha: 0.45 });
  }));
  const every = Math.ceil(up.length / 8);
  up.forEach((speed, row) => {
    const place = [x0 - 5, y0 + (row + 0.5) * h + 4];
    if (row % every === 0) surface.text(place, String(speed), { anchor: "end", fill: colours.ink, size: 10 });
  });
  const wide = Math.ceil(left.length / 5);
  left.forEach((yawRate, column) => {
    const place = [x0 + (column + 0.5) * w, size - 26];
    if (column % wide === 0) surface.text(place, String(yawRate), { anchor: "middle", fill: colours.ink, size: 10 });
  });
  surface.text([x0 + (size - x0) / 2, size - 10], "yaw rate (rad/s)", { anchor: "middle", fill: colours.muted, size: 10 });
  surface.text([9, y0 + (up.length * h) / 2], "m/s", { anchor: "middle", fill: colours.muted, size: 10, upwards: true });
}
// The commands of who chooses freely, as bars from zero.
function drawBars(surface, size, trace, chosen, colours) {
  const most = (list) => Math.max(1e-6, ...list.map(Math.abs));
  const [top, turn, middle] = [most(trace.commandSpeed), most(trace.commandYawRate), size / 2];
  const box = (x, y, width, height, style) => {
    surface.polygon([[x, y], [x + width, y], [x + width, y + height], [x, y + height]], style);
  };
  const label = (y, text) => surface.text([8, y], text, { fill: colours.muted, size: 10 });
  label(34, `speed, up to ${top.toFixed(2)} m/s`);
  box(8, 42, size - 16, 16, { fill: colours.still, alpha: 0.45 });
  box(8, 42, Math.max(0, (size - 16) * chosen.speed) / top, 16, { fill: "#d55e00" });
  label(94, `yaw rate, up to ${turn.toFixed(2)} rad/s`);
  box(8, 102, size - 16, 16, { fill: colours.still, alpha: 0.45 });
  const reach = ((middle - 8) * chosen.yawRate) / turn; // to the left is positive
  box(Math.min(middle, middle - reach), 102, Math.abs(reach), 16, { fill: "#d55e00" });
  surface.line([[middle, 99], [middle, 121]], { stroke: colours.ink });
}
