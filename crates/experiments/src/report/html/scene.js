// The room with a drive in it, and the speed over time: on either surface, up to any time.
// The colours of paper; the page recolours what is drawn in them where it is dark.
const PAPER = {
  ink: "#222222", grid: "#e4e4e4", muted: "#6b7280", floor: "#fbfbfb", still: "#c9ccd1", edge: "#7d828a", mover: "#d9730d",
  goal: "#2a7f3f", hit: "#c1272d", start: "#f4b942", body: "#ffffff", ray: "#0072b2",
};
const NIGHT = {
  ...PAPER, ink: "#e8eaed", grid: "#333a44", muted: "#9aa3af", floor: "#171b21", still: "#454c57", edge: "#7d8794",
  goal: "#5cc47a", hit: "#ff6b6b", body: "#20262e", ray: "#6cb8ee",
};
const N_SHADES = 48;

// The colour of a share of the greatest speed.
function shade(stops, share) {
  const at = Math.min(Math.max(share, 0), 1) * (stops.length - 1);
  const k = Math.min(Math.floor(at), stops.length - 2);
  const mix = stops[k].map((from, c) => Math.round(from + (at - k) * (stops[k + 1][c] - from)));
  return `#${mix.map((value) => value.toString(16).padStart(2, "0")).join("")}`;
}
// A line coloured by speed, as stretches of one shade each, over a dark edge.
function colouredLine(surface, points, speeds, top, stops, ink) {
  if (points.length < 2) return;
  surface.line(points, { stroke: ink, width: 4.2 });
  const shades = points.slice(1).map((_, k) => Math.round(((N_SHADES - 1) * (speeds[k] + speeds[k + 1])) / 2 / top));
  for (let from = 0; from < shades.length; ) {
    let to = from + 1;
    while (to < shades.length && shades[to] === shades[from]) to++;
    surface.line(points.slice(from, to + 1), { stroke: shade(stops, shades[from] / (N_SHADES - 1)), width: 2.8 });
    from = to;
  }
}
// About `n` round values from `low` to `high`, with as many decimals as they need.
function ticks(low, high, n) {
  const rough = (high - low) / n;
  const power = 10 ** Math.floor(Math.log10(rough));
  const size = [1, 2, 5, 10].find((factor) => factor * power >= rough * (1 - 1e-9)) * power;
  const decimals = Math.max(0, -Math.floor(Math.log10(size) + 1e-9));
  const values = [];
  for (let k = Math.ceil(low / size - 1e-9); k * size <= high + 1e-9 * (high - low); k++) values.push(k * size);
  return values.map((value) => ({ value, label: value.toFixed(decimals) }));
}
// The upper end of an axis of speeds.
function roundTop(speeds) {
  const top = speeds.reduce((most, speed) => Math.max(most, speed), 0);
  return top > 0 ? Math.ceil(top / 0.25 - 1e-9) * 0.25 : 1;
}

// From metres to a frame of pixels, with y upwards; the frame is the largest of the room's shape that fits.
function viewOf([x, y, width, height], frame) {
  const scale = Math.min(frame.width / width, frame.height / height);
  const [left, top] = [frame.x + (frame.width - scale * width) / 2, frame.y + (frame.height - scale * height) / 2];
  return {
    scale, frame: { x: left, y: top, width: scale * width, height: scale * height },
    point: ([px, py]) => [left + scale * (px - x), top + scale * (y + height - py)],
  };
}
function drawForm(surface, view, form, { x, y, yaw }, style) {
  const [sin, cos] = [Math.sin(yaw), Math.cos(yaw)];
  const moved = ([px, py]) => view.point([x + cos * px - sin * py, y + sin * px + cos * py]);
  if (Array.isArray(form[0])) surface.polygon(form.map(moved), style);
  else surface.circle(moved(form), form[2] * view.scale, style);
}
const NOWHERE = { x: 0, y: 0, yaw: 0 };

function drawVehicle(surface, view, scene, pose, style, ink) {
  drawForm(surface, view, scene.footprint, pose, style);
  const reach = Array.isArray(scene.footprint[0]) ? Math.max(...scene.footprint.map(([x]) => x)) : scene.footprint[2];
  const nose = [pose.x + reach * Math.cos(pose.yaw), pose.y + reach * Math.sin(pose.yaw)];
  surface.line([view.point([pose.x, pose.y]), view.point(nose)], { stroke: ink, width: 1.6 });
}
function drawGoal(surface, view, scene, colours) {
  const centre = view.point(scene.goal);
  surface.circle(centre, scene.reach * view.scale, { fill: colours.goal, alpha: 0.15 });
  surface.circle(centre, scene.reach * view.scale, { stroke: colours.goal, width: 1.4, dash: [4, 3] });
  const star = Array.from({ length: 10 }, (_, k) => {
    const [radius, angle] = [k % 2 ? 2.6 : 6.5, (k * Math.PI) / 5];
    return [centre[0] + radius * Math.sin(angle), centre[1] - radius * Math.cos(angle)];
  });
  surface.polygon(star, { fill: colours.goal });
}
// The room at a time: what stands and moves in it, the way so far, the rays, the vehicle.
function drawRoom(surface, view, drive, time, { colours, stops, rays, isOver }) {
  const { scene, trace } = drive;
  const k = stateAt(trace, time);
  const share = k + 1 < trace.n ? (time - trace.t[k]) / (trace.t[k + 1] - trace.t[k]) : 0;
  const pose = between(trace, k, share);
  const { x, y, width, height } = view.frame;
  const walls = [[x, y], [x + width, y], [x + width, y + height], [x, y + height]];
  surface.polygon(walls, { fill: colours.floor });
  surface.clip(view.frame, () => {
    for (const form of scene.obstacles) {
      drawForm(surface, view, form, NOWHERE, { fill: colours.still, stroke: colours.edge });
    }
    scene.movers.forEach((form, number) => {
      const mover = trace.movers[number];
      const way = Array.from({ length: k + 1 }, (_, i) => view.point([mover.x[i], mover.y[i]]));
      surface.line(way, { stroke: colours.mover, width: 1.4, alpha: 0.5 });
      drawForm(surface, view, form, between(mover, k, share), { fill: colours.mover, stroke: colours.mover, alpha: 0.6 });
    });
    drawGoal(surface, view, scene, colours);
    if (rays) drawRays(surface, view, trace, k, colours.ray);
    const edge = { stroke: colours.ink, width: 1.3 };
    const rest = Array.from({ length: trace.n - k }, (_, i) => view.point([trace.x[k + i], trace.y[k + i]]));
    if (rest.length > 1) surface.line(rest, { stroke: colours.muted, width: 1.4, alpha: 0.55, dash: [1, 5] });
    drawVehicle(surface, view, scene, between(trace, 0, 0), { fill: colours.start, ...edge }, "#222222");
    const points = Array.from({ length: k + 1 }, (_, i) => view.point([trace.x[i], trace.y[i]]));
    const speeds = [...trace.speed.slice(0, k + 1), trace.speed[k]];
    colouredLine(surface, [...points, view.point([pose.x, pose.y])], speeds, drive.top, stops, colours.ink);
    drawVehicle(surface, view, scene, pose, { fill: colours.body, ...edge }, colours.ink);
    if (isOver && drive.outcome === "collision") drawCross(surface, view.point([pose.x, pose.y]), colours.hit);
  });
  surface.polygon(walls, { stroke: colours.ink, width: 1.6 });
}
// From where the vehicle stood when it saw them.
function drawRays(surface, view, trace, k, colour) {
  const from = [trace.x[k], trace.y[k]];
  const pairs = [];
  trace.angles.forEach((angle, ray) => {
    const [range, direction] = [trace.range(k, ray), trace.yaw[k] + angle];
    const end = view.point([from[0] + range * Math.cos(direction), from[1] + range * Math.sin(direction)]);
    pairs.push([view.point(from), end]);
    if (range < 0.999 * trace.maxRange) surface.circle(end, 1.8, { fill: colour, alpha: 0.9 });
  });
  surface.segments(pairs, { stroke: colour, width: 1, alpha: 0.35 });
}
function drawCross(surface, [x, y], colour) {
  const arms = [[[x - 7, y - 7], [x + 7, y + 7]], [[x - 7, y + 7], [x + 7, y - 7]]];
  surface.segments(arms, { stroke: colour, width: 2.8 });
}

// The speed over time; before `time` in its colours, after it faint.
function drawStrip(surface, frame, drive, time, { colours, stops }) {
  const { trace } = drive;
  const end = trace.t[trace.n - 1] || 1;
  const low = Math.min(0, ...trace.speed);
  const at = (t, speed) => [
    frame.x + (frame.width * t) / end,
    frame.y + frame.height - (frame.height * (speed - low)) / (1.04 * drive.top - low),
  ];
  for (const { value, label } of ticks(0, end, Math.max(2, frame.width / 70))) {
    const [x] = at(value, 0);
    surface.line([[x, frame.y], [x, frame.y + frame.height]], { stroke: colours.grid });
    surface.text([x, frame.y + frame.height + 16], label, { anchor: "middle", fill: colours.ink });
  }
  for (const { value, label } of ticks(low, drive.top, Math.max(2, frame.height / 45))) {
    const [, y] = at(0, value);
    surface.line([[frame.x, y], [frame.x + frame.width, y]], { stroke: colours.grid });
    surface.text([frame.x - 7, y + 4], label, { anchor: "end", fill: colours.ink });
  }
  const [left, bottom] = [frame.x, frame.y + frame.height];
  surface.line([[left, frame.y], [left, bottom], [left + frame.width, bottom]], { stroke: colours.ink, width: 1.2 });
  surface.text([left + frame.width / 2, bottom + 34], "time (s)", { anchor: "middle", fill: colours.ink });
  const middle = [left - 40, frame.y + frame.height / 2];
  surface.text(middle, "speed (m/s)", { anchor: "middle", fill: colours.ink, upwards: true });
  const k = stateAt(trace, time);
  const points = Array.from(trace.t, (t, i) => at(t, trace.speed[i]));
  if (k + 1 < trace.n) surface.line(points.slice(k), { stroke: colours.muted, width: 1.4, alpha: 0.7 });
  colouredLine(surface, points.slice(0, k + 1), trace.speed.slice(0, k + 1), drive.top, stops, colours.ink);
  return at;
}
// The legend of the colours.
function drawBar(surface, frame, top, { colours, stops }) {
  const size = frame.height / N_SHADES;
  for (let k = 0; k < N_SHADES; k++) {
    const y = frame.y + frame.height - (k + 1) * size;
    const corners = [[frame.x, y], [frame.x + frame.width, y], [frame.x + frame.width, y + size + 0.5], [frame.x, y + size + 0.5]];
    surface.polygon(corners, { fill: shade(stops, k / (N_SHADES - 1)) });
  }
  for (const { value, label } of ticks(0, top, 5)) {
    const y = frame.y + frame.height - (frame.height * value) / top;
    surface.text([frame.x + frame.width + 6, y + 4], label, { fill: colours.ink });
  }
}
// The whole drive as one figure: the room, the colours, the speed over time, which stands beside the room or, for narrow
// windows, below it.
function figureOf(drive, stops, isNarrow) {
  const most = isNarrow ? { width: 250, height: 400 } : { width: 460, height: 380 };
  const room = Math.min(most.height / drive.scene.view[3], most.width / drive.scene.view[2]);
  const [width, height] = [room * drive.scene.view[2], room * drive.scene.view[3]];
  const strip = isNarrow
    ? { x: 54, y: 34 + height + 92, width: 330, height: 180 }
    : { x: 54 + width + 84 + 66, y: 34, width: 390, height: Math.max(height, 140) };
  const surface = new SvgSurface(strip.x + strip.width + 16, strip.y + strip.height + 52);
  const style = { colours: PAPER, stops, rays: false, isOver: true };
  const [end, frame] = [drive.trace.t[drive.trace.n - 1], { x: 54, y: 34, width, height }];
  drawRoom(surface, viewOf(drive.scene.view, frame), drive, end, style);
  drawMetres(surface, frame, drive.scene.view);
  drawBar(surface, { x: 54 + width + 16, y: 34, width: 12, height }, drive.top, style);
  surface.text([54 + width + 68, 34 + height / 2], "speed (m/s)", { anchor: "middle", fill: PAPER.ink, upwards: true });
  drawStrip(surface, strip, drive, end, style);
  const bold = { anchor: "middle", fill: PAPER.ink, size: 13, bold: true };
  surface.text([54 + width / 2, 20], `seed ${drive.seed}, scenario ${drive.scenario}`, bold);
  surface.text([strip.x + strip.width / 2, strip.y - 14], summaryOf(drive), bold);
  return surface.document();
}
function drawMetres(surface, frame, [x, y, width, height]) {
  for (const { value, label } of ticks(x, x + width, Math.max(2, frame.width / 60))) {
    const at = frame.x + (frame.width * (value - x)) / width;
    surface.text([at, frame.y + frame.height + 17], label, { anchor: "middle", fill: PAPER.ink });
  }
  for (const { value, label } of ticks(y, y + height, Math.max(2, frame.height / 60))) {
    const at = frame.y + frame.height - (frame.height * (value - y)) / height;
    surface.text([frame.x - 7, at + 4], label, { anchor: "end", fill: PAPER.ink });
  }
  const below = [frame.x + frame.width / 2, frame.y + frame.height + 36];
  surface.text(below, "x (m)", { anchor: "middle", fill: PAPER.ink });
  surface.text([frame.x - 38, frame.y + frame.height / 2], "y (m)", { anchor: "middle", fill: PAPER.ink, upwards: true });
}
function summaryOf({ outcome, duration, distance }) {
  const mean = duration > 0 ? ` at ${(distance / duration).toFixed(2)} m/s` : "";
  return `${outcome} after ${duration.toFixed(1)} s: ${distance.toFixed(1)} m${mean}`;
}
