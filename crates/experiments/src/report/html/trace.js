"use strict";
// The states of a drive, out of their packing: see `Trace` in the source of the report.
function unpack({ n, origin, step, rays, max_range, n_movers, packed }) {
  const bytes = Uint8Array.from(atob(packed), (c) => c.charCodeAt(0));
  const view = new DataView(bytes.buffer);
  let channel = 0;
  const unsigned = (scale, offset = 0) => {
    const from = 2 * n * channel++;
    return Float64Array.from({ length: n }, (_, k) => offset + scale * view.getUint16(from + 2 * k, true));
  };
  const signed = (scale) => {
    const from = 2 * n * channel++;
    return Float64Array.from({ length: n }, (_, k) => scale * view.getInt16(from + 2 * k, true));
  };
  const place = () => ({ x: unsigned(step, origin[0]), y: unsigned(step, origin[1]), yaw: signed(Math.PI / 32767) });
  const t = unsigned(1e-4);
  for (let k = 1; k < n; k++) t[k] += t[k - 1];
  const trace = {
    n, t, ...place(), speed: signed(1e-3), yawRate: signed(1e-3), commandSpeed: signed(1e-3),
    commandYawRate: signed(1e-3), clearance: unsigned(1e-3), movers: Array.from({ length: n_movers }, place),
    angles: rays.map((angle) => angle / 1000), maxRange: max_range,
  };
  const ranges = bytes.subarray(2 * n * channel);
  trace.range = (k, ray) => (ranges[k * rays.length + ray] / 255) * max_range;
  return trace;
}
// The last state at or before a time.
function stateAt(trace, time) {
  let [low, high] = [0, trace.n - 1];
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (trace.t[middle] <= time + 1e-9) low = middle; else high = middle - 1;
  }
  return low;
}
// Where something is between its states; yaw goes the short way round.
function between(place, k, share) {
  const next = Math.min(k + 1, place.x.length - 1);
  const turn = Math.atan2(Math.sin(place.yaw[next] - place.yaw[k]), Math.cos(place.yaw[next] - place.yaw[k]));
  return {
    x: place.x[k] + share * (place.x[next] - place.x[k]),
    y: place.y[k] + share * (place.y[next] - place.y[k]),
    yaw: place.yaw[k] + share * turn,
  };
}
