// Two surfaces to draw on, with the same few calls: a canvas for the player, and SVG for figures.
class CanvasSurface {
  constructor(canvas, width, height) {
    const ratio = window.devicePixelRatio || 1;
    const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
    if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
    canvas.style.width = `${width}px`;
    canvas.style.height = `${height}px`;
    this.context = canvas.getContext("2d");
    this.context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.context.clearRect(0, 0, width, height);
    this.context.lineJoin = this.context.lineCap = "round";
  }
  paint({ fill, stroke, width = 1, alpha = 1, dash = [] }) {
    const c = this.context;
    c.globalAlpha = alpha;
    if (fill) { c.fillStyle = fill; c.fill(); }
    if (stroke) { c.strokeStyle = stroke; c.lineWidth = width; c.setLineDash(dash); c.stroke(); c.setLineDash([]); }
    c.globalAlpha = 1;
  }
  clip({ x, y, width, height }, draw) {
    this.context.save();
    this.context.beginPath();
    this.context.rect(x, y, width, height);
    this.context.clip();
    draw();
    this.context.restore();
  }
  circle([x, y], radius, style) {
    this.context.beginPath();
    this.context.arc(x, y, radius, 0, 2 * Math.PI);
    this.paint(style);
  }
  polygon(points, style) { this.path(points, style, true); }
  line(points, style) { this.path(points, style, false); }
  path(points, style, isClosed) {
    this.context.beginPath();
    points.forEach(([x, y], k) => (k ? this.context.lineTo(x, y) : this.context.moveTo(x, y)));
    if (isClosed) this.context.closePath();
    this.paint(style);
  }
  // `pairs` holds the two ends of many lines of one style.
  segments(pairs, style) {
    this.context.beginPath();
    for (const [[ax, ay], [bx, by]] of pairs) { this.context.moveTo(ax, ay); this.context.lineTo(bx, by); }
    this.paint(style);
  }
  text([x, y], text, { anchor = "start", fill, size = 12, bold = false, upwards = false }) {
    const c = this.context;
    c.save();
    c.translate(x, y);
    if (upwards) c.rotate(-Math.PI / 2);
    c.font = `${bold ? "bold " : ""}${size}px ${FONT}`;
    c.textAlign = anchor === "middle" ? "center" : anchor;
    c.fillStyle = fill;
    c.fillText(text, 0, 0);
    c.restore();
  }
}
const FONT = "Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif";

class SvgSurface {
  constructor(width, height) {
    [this.width, this.height, this.body, this.nClips] = [width, height, [], 0];
  }
  style({ fill = "none", stroke, width = 1, alpha = 1, dash = [] }) {
    const edge = stroke ? ` stroke="${stroke}" stroke-width="${width}"` : "";
    const dashes = dash.length ? ` stroke-dasharray="${dash.join(" ")}"` : "";
    return `fill="${fill}"${edge}${dashes}${alpha < 1 ? ` opacity="${alpha}"` : ""}`;
  }
  list(points) { return points.map(([x, y]) => `${round(x)},${round(y)}`).join(" "); }
  clip({ x, y, width, height }, draw) {
    const box = `x="${round(x)}" y="${round(y)}" width="${round(width)}" height="${round(height)}"`;
    this.body.push(`<svg ${box} viewBox="${round(x)} ${round(y)} ${round(width)} ${round(height)}">`);
    draw();
    this.body.push("</svg>");
  }
  circle([x, y], radius, style) {
    this.body.push(`<circle cx="${round(x)}" cy="${round(y)}" r="${round(radius)}" ${this.style(style)}/>`);
  }
  polygon(points, style) {
    this.body.push(`<polygon points="${this.list(points)}" stroke-linejoin="round" ${this.style(style)}/>`);
  }
  line(points, style) {
    const ends = 'stroke-linejoin="round" stroke-linecap="round"';
    this.body.push(`<polyline points="${this.list(points)}" ${ends} ${this.style(style)}/>`);
  }
  segments(pairs, style) {
    const path = pairs.map(([[ax, ay], [bx, by]]) => `M${round(ax)} ${round(ay)}L${round(bx)} ${round(by)}`).join("");
    this.body.push(`<path d="${path}" ${this.style(style)}/>`);
  }
  text([x, y], text, { anchor = "start", fill, size = 12, bold = false, upwards = false }) {
    const turn = upwards ? ` transform="rotate(-90 ${round(x)} ${round(y)})"` : "";
    const weight = bold ? ' font-weight="bold"' : "";
    const place = `x="${round(x)}" y="${round(y)}" text-anchor="${anchor}" font-size="${size}"`;
    this.body.push(`<text ${place} fill="${fill}"${weight}${turn}>${escapeText(text)}</text>`);
  }
  document() {
    const size = `width="${round(this.width)}" height="${round(this.height)}"`;
    const box = `viewBox="0 0 ${round(this.width)} ${round(this.height)}"`;
    const ground = '<rect width="100%" height="100%" fill="white"/>';
    const open = `<svg xmlns="http://www.w3.org/2000/svg" ${size} ${box} font-family="${FONT}">`;
    return `${open}\n${ground}\n${this.body.join("\n")}\n</svg>\n`;
  }
}
function round(value) { return Math.round(100 * value) / 100; }
function escapeText(text) {
  return String(text).replace(/[&<>"']/g, (c) => `&#${c.charCodeAt(0)};`);
}
