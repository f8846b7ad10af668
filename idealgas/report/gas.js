"use strict";

// ── the gas: the last event of each disc, and its free flight since then ──

let stored = name => document.getElementById("data-" + name)?.textContent; // numbers as base64 text

function unpack(name, Type) {
  const text = atob((stored(name) ?? "").trim());
  const bytes = new Uint8Array(text.length);
  for (let k = 0; k < text.length; k++) bytes[k] = text.charCodeAt(k);
  return new Type(bytes.buffer);
}

// Times of events in ticks, from the steps between them. The largest 16-bit number stands for the next leap.
function addSteps(steps, leaps) {
  const ticks = new Uint32Array(steps.length);
  let now = 0, leap = 0;
  steps.forEach((step, k) => { ticks[k] = now += step === 65535 ? leaps[leap++] : step; });
  return ticks;
}

class Gas {
  constructor(head) {
    this.head = head;
    this.radius = unpack("radius", Float32Array);
    this.mass = unpack("mass", Float32Array);
    this.species = unpack("species", Uint16Array);
    this.order = unpack("order", Uint8Array); // shades of all discs, instant after instant
    this.start = { position: unpack("position", Float32Array), velocity: unpack("velocity", Float32Array) };
    this.number = this.radius.length;
    this.tick = addSteps(unpack("event_step", Uint16Array), unpack("event_leap", Uint32Array));
    this.disc = unpack("event_disc", this.number > 65536 ? Uint32Array : Uint16Array);
    this.event = { velocity: unpack("event_velocity", Float32Array) };
    this.known = { row: unpack("place_row", Uint32Array), place: unpack("place", Float32Array) };
    this.pistons = head.pistons.map((piston, k) => ({ // with the times at which its position is known
      ...piston, knots: unpack("piston_tick_" + k, Uint32Array), places: unpack("piston_place_" + k, Float32Array),
    }));
    this.row = 0; // number of events that have happened
    this.used = 0; // number of places in `known` before that row
    this.last = new Int32Array(this.number).fill(-1);
    this.from = Float64Array.from(this.start.position); // x and y of each disc at its last event
    this.x = new Float64Array(this.number);
    this.y = new Float64Array(this.number);
    this.vx = new Float64Array(this.number);
    this.vy = new Float64Array(this.number);
    this.step = Math.max(this.number, 4096);
    this.marks = [this.mark()]; // the state at every step-th row, from which earlier times are computed
    while (this.row < this.tick.length) {
      this.follow(Math.min(this.row + this.step, this.tick.length));
      if (this.row % this.step === 0) this.marks.push(this.mark());
    }
    this.seek(head.start);
  }

  mark() { return { used: this.used, last: this.last.slice(), from: this.from.slice() }; }

  // Move each disc to its next events. Where free flight does not lead to its position in the log, `known` has it.
  follow(row) {
    for (; this.row < row; this.row++) {
      const i = this.disc[this.row], isKnown = this.known.row[this.used] === this.row;
      const [x, y] = isKnown ? this.known.place.subarray(2 * this.used) : this.placeAt(i, this.timeOf(this.tick[this.row]));
      this.used += isKnown;
      this.from[2 * i] = x;
      this.from[2 * i + 1] = y;
      this.last[i] = this.row;
    }
  }

  // The time at which the present flight of a disc began, and its velocity at that time.
  begun(i) {
    const event = this.last[i], { velocity } = event < 0 ? this.start : this.event, k = 2 * (event < 0 ? i : event);
    return [event < 0 ? this.head.start : this.timeOf(this.tick[event]), velocity[k], velocity[k + 1]];
  }

  // The position of a disc in its flight at a time, inside the box.
  placeAt(i, time) {
    const [since, vx, vy] = this.begun(i), dt = time - since, [gx, gy] = this.head.gravity;
    const [width, height] = this.head.box, [wrapsX, wrapsY] = this.head.wraps;
    let x = this.from[2 * i] + (vx + gx * dt / 2) * dt, y = this.from[2 * i + 1] + (vy + gy * dt / 2) * dt;
    if (wrapsX) x -= Math.floor(x / width) * width;
    if (wrapsY) y -= Math.floor(y / height) * height;
    return [x, y];
  }

  timeOf(tick) {
    return this.head.start + tick / this.head.ticks * (this.head.end - this.head.start);
  }

  rowAfter(time) {
    const tick = (time - this.head.start) / (this.head.end - this.head.start) * this.head.ticks;
    return firstAfter(this.tick.length, row => this.tick[row], tick);
  }

  seek(time) {
    this.time = Math.min(Math.max(time, this.head.start), this.head.end);
    const row = this.rowAfter(this.time);
    const mark = Math.min(Math.floor(row / this.step), this.marks.length - 1);
    if (row < this.row || row - this.row > this.step) {
      this.row = mark * this.step;
      this.used = this.marks[mark].used;
      this.last.set(this.marks[mark].last);
      this.from.set(this.marks[mark].from);
    }
    this.follow(row);
    const [gx, gy] = this.head.gravity;
    for (let i = 0; i < this.number; i++) {
      const [since, vx, vy] = this.begun(i);
      [this.x[i], this.y[i]] = this.placeAt(i, this.time);
      this.vx[i] = vx + gx * (this.time - since);
      this.vy[i] = vy + gy * (this.time - since);
    }
  }

  // The flight of a disc since its last event in the player: its start, and the positions at `steps` + 1 times until now.
  flight(i, steps) {
    const [since, vx, vy] = this.begun(i), [gx, gy] = this.head.gravity;
    const places = Array.from({ length: steps + 1 }, (_, step) => {
      const dt = (this.time - since) * step / steps;
      return [this.from[2 * i] + (vx + gx * dt / 2) * dt, this.from[2 * i + 1] + (vy + gy * dt / 2) * dt];
    });
    return { since, places };
  }

  // The disc nearest to a point.
  nearest(x, y) {
    let best = 0, least = Infinity;
    for (let i = 0; i < this.number; i++) {
      const away = Math.hypot(this.x[i] - x, this.y[i] - y);
      if (away < least) [best, least] = [i, away];
    }
    return best;
  }

  // Shades of the discs by their local order, at the nearest instant at which it is known.
  orders() {
    const instants = this.order.length / this.number, { start, end } = this.head;
    const k = Math.round((this.time - start) / (end - start) * (instants - 1)) || 0;
    return this.order.subarray(k * this.number, (k + 1) * this.number);
  }

  // Speed relative to a conserved motion of the whole gas; NaN for a disc that has left.
  speed(i) {
    const [x, y] = this.head.flow;
    return Math.hypot(this.vx[i] - x, this.vy[i] - y);
  }

  // The position of a piston, on a parabola between the times at which it is known.
  placeOf({ pull, limits, knots, places }) {
    const knot = k => ({ time: this.timeOf(knots[k]), place: places[k] });
    const last = knots.length - 1, next = Math.min(firstAfter(last, k => knot(k).time, this.time), last);
    const a = knot(next - 1), b = knot(next);
    const before = this.time - a.time, after = this.time - b.time, step = b.time - a.time;
    if (!(step > 0)) return a.place;
    const place = (b.place * before - a.place * after) / step + pull * before * after / 2;
    return Math.min(Math.max(place, limits[0]), limits[1]);
  }
}

// The index of the first of `number` keys in non-decreasing order that is above a value.
function firstAfter(number, key, value) {
  let low = 0, high = number;
  while (low < high) {
    const middle = (low + high) >>> 1;
    if (key(middle) <= value) low = middle + 1; else high = middle;
  }
  return low;
}
