"use strict";

// ── the gas: which event each disc had last, and its free flight since ──

function unpack(name, Type) {
  const element = document.getElementById("data-" + name);
  if (!element) return new Type(0);
  const text = atob(element.textContent.trim());
  const bytes = new Uint8Array(text.length);
  for (let k = 0; k < text.length; k++) bytes[k] = text.charCodeAt(k);
  return new Type(bytes.buffer);
}

class Gas {
  constructor(head) {
    this.head = head;
    this.radius = unpack("radius", Float32Array);
    this.mass = unpack("mass", Float32Array);
    this.start = { position: unpack("position", Float32Array), velocity: unpack("velocity", Float32Array) };
    this.tick = unpack("event_tick", Uint32Array);
    this.disc = unpack("event_disc", Uint32Array);
    this.event = { position: unpack("event_position", Float32Array), velocity: unpack("event_velocity", Float32Array) };
    this.hits = unpack("event_hit", Uint32Array); // rows in which a disc met the piston
    this.number = this.radius.length;
    this.last = new Int32Array(this.number).fill(-1);
    this.row = 0; // events that have happened
    this.x = new Float64Array(this.number);
    this.y = new Float64Array(this.number);
    this.vx = new Float64Array(this.number);
    this.vy = new Float64Array(this.number);
    this.step = Math.max(this.number, 4096);
    this.marks = [this.last.slice()]; // `last` at every step-th row, to go back to
    while (this.row < this.tick.length) {
      this.follow(Math.min(this.row + this.step, this.tick.length));
      if (this.row % this.step === 0) this.marks.push(this.last.slice());
    }
    this.seek(head.start);
  }

  follow(row) {
    for (; this.row < row; this.row++) this.last[this.disc[this.row]] = this.row;
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
      this.last.set(this.marks[mark]);
      this.row = mark * this.step;
    }
    this.follow(row);
    const [gx, gy] = this.head.gravity, [width, height] = this.head.box, [periodicX, periodicY] = this.head.periodic;
    for (let i = 0; i < this.number; i++) {
      const event = this.last[i], from = event < 0 ? this.start : this.event, k = 2 * (event < 0 ? i : event);
      const dt = this.time - (event < 0 ? this.head.start : this.timeOf(this.tick[event]));
      const vx = from.velocity[k], vy = from.velocity[k + 1];
      this.vx[i] = vx + gx * dt;
      this.vy[i] = vy + gy * dt;
      this.x[i] = from.position[k] + vx * dt + gx * dt * dt / 2;
      this.y[i] = from.position[k + 1] + vy * dt + gy * dt * dt / 2;
      if (periodicX) this.x[i] -= Math.floor(this.x[i] / width) * width;
      if (periodicY) this.y[i] -= Math.floor(this.y[i] / height) * height;
    }
  }

  // Where the piston is: touched by the discs that hit it, on a parabola from hit to hit.
  pistonPlace() {
    const { axis, outward, pull, limits, ends } = this.head.piston;
    const knot = k => {
      if (k < 0) return { time: this.head.start, place: ends[0] };
      if (k >= this.hits.length) return { time: this.head.end, place: ends[1] };
      const row = this.hits[k];
      const place = this.event.position[2 * row + axis] + outward * this.radius[this.disc[row]];
      return { time: this.timeOf(this.tick[row]), place };
    };
    const next = firstAfter(this.hits.length, k => knot(k).time, this.time), a = knot(next - 1), b = knot(next);
    const before = this.time - a.time, after = this.time - b.time, step = b.time - a.time;
    if (!(step > 0)) return a.place;
    const place = (b.place * before - a.place * after) / step + pull * before * after / 2;
    return Math.min(Math.max(place, limits[0]), limits[1]);
  }
}

// The first of `number` places with a key, which do not fall from place to place, above a value.
function firstAfter(number, key, value) {
  let low = 0, high = number;
  while (low < high) {
    const middle = (low + high) >>> 1;
    if (key(middle) <= value) low = middle + 1; else high = middle;
  }
  return low;
}

// ── the pictures ──

function themed() {
  const style = getComputedStyle(document.documentElement);
  const dark = !printing && matchMedia("(prefers-color-scheme: dark)").matches;
  const onPaper = { "--ink": "#1a1a1a", "--panel": "#ffffff" };
  const colour = name => printing ? onPaper[name] : style.getPropertyValue(name).trim();
  return { dark, ink: colour("--ink"), panel: colour("--panel") };
}

// A canvas as wide as the page and `ratio` as high, within limits; inset: what is left free on both sides.
function prepare(canvas, ratio, lowest, tallest) {
  const width = canvas.clientWidth || 600;
  const scale = window.devicePixelRatio || 1;
  const height = Math.min(Math.max(width * ratio, lowest), tallest);
  const inset = Math.max(width - height / ratio, 0) / 2;
  const pixels = [Math.round(width * scale), Math.round(height * scale)];
  if (canvas.width !== pixels[0] || canvas.height !== pixels[1]) {
    [canvas.width, canvas.height] = pixels;
    canvas.style.height = height + "px";
  }
  const pen = canvas.getContext("2d");
  pen.setTransform(scale, 0, 0, scale, 0, 0);
  pen.clearRect(0, 0, width, height);
  return { pen, width, height, inset };
}

const SMALLEST = 1.25; // radius in pixels that any disc is drawn with

class DiscView {
  constructor(canvas, gas) {
    this.canvas = canvas;
    this.gas = gas;
    this.shade = new Uint8Array(gas.number);
  }

  draw() {
    const { gas } = this, { head } = gas, [boxX, boxY] = head.box;
    const { pen, width, height, inset } = prepare(this.canvas, boxY / boxX, 0, 640);
    const theme = themed(), shades = theme.dark ? head.dark : head.light;
    const scale = (width - 2 * inset) / boxX;
    for (let i = 0; i < gas.number; i++) {
      const speed = Math.hypot(gas.vx[i], gas.vy[i]) / head.brightest;
      this.shade[i] = Math.min(Math.floor(speed * shades.length), shades.length - 1);
    }
    pen.fillStyle = theme.panel;
    pen.fillRect(inset, 0, width - 2 * inset, height);
    pen.save();
    pen.beginPath();
    pen.rect(inset, 0, width - 2 * inset, height);
    pen.clip();
    for (let s = 0; s < shades.length; s++) {
      pen.beginPath();
      for (let i = 0; i < gas.number; i++) {
        if (this.shade[i] === s) this.outline(pen, i, inset, height, scale, boxX, boxY);
      }
      pen.fillStyle = shades[s];
      pen.fill();
    }
    pen.restore();
    pen.strokeStyle = theme.ink;
    pen.strokeRect(inset + 0.5, 0.5, width - 2 * inset - 1, height - 1);
    pen.lineWidth = 2;
    for (const wall of head.walls) {
      const [opens, closes] = wall.absent;
      if (opens !== null && gas.time >= opens && (closes === null || gas.time < closes)) continue;
      this.line(pen, wall.from.map(x => x * scale), wall.to.map(x => x * scale), inset, height);
    }
    if (head.piston) {
      pen.lineWidth = 3;
      pen.strokeStyle = head.pistonColour;
      const place = gas.pistonPlace() * scale, along = head.piston.axis === 0;
      this.line(pen, along ? [place, 0] : [0, place], along ? [place, height] : [boxX * scale, place], inset, height);
    }
    pen.lineWidth = 1;
  }

  line(pen, [x0, y0], [x1, y1], inset, height) {
    pen.beginPath();
    pen.moveTo(inset + x0, height - y0);
    pen.lineTo(inset + x1, height - y1);
    pen.stroke();
  }

  outline(pen, i, inset, height, scale, boxX, boxY) {
    const { gas } = this, [periodicX, periodicY] = gas.head.periodic;
    const x = gas.x[i], y = gas.y[i], r = Math.max(gas.radius[i], SMALLEST / scale);
    this.disc(pen, inset + x * scale, height - y * scale, r * scale);
    const imageX = periodicX ? (x < r ? boxX : x > boxX - r ? -boxX : 0) : 0;
    const imageY = periodicY ? (y < r ? boxY : y > boxY - r ? -boxY : 0) : 0;
    if (imageX) this.disc(pen, inset + (x + imageX) * scale, height - y * scale, r * scale);
    if (imageY) this.disc(pen, inset + x * scale, height - (y + imageY) * scale, r * scale);
    if (imageX && imageY) this.disc(pen, inset + (x + imageX) * scale, height - (y + imageY) * scale, r * scale);
  }

  disc(pen, x, y, r) {
    if (r < 1.5) { // a square looks the same and is drawn faster
      pen.rect(x - r, y - r, 2 * r, 2 * r);
    } else {
      pen.moveTo(x + r, y);
      pen.arc(x, y, r, 0, 2 * Math.PI);
    }
  }
}

class SpeedView {
  constructor(canvas, gas) {
    this.canvas = canvas;
    this.gas = gas;
    this.counts = new Float64Array(40);
    this.top = 1.8 * Math.max(...this.law(this.temperature())) || 1;
  }

  temperature() {
    const { gas } = this;
    let energy = 0;
    for (let i = 0; i < gas.number; i++) energy += gas.mass[i] * (gas.vx[i] ** 2 + gas.vy[i] ** 2) / 2;
    return energy / gas.number;
  }

  law(temperature) {
    const { head } = this.gas;
    return Array.from({ length: 201 }, (_, k) => {
      if (!(temperature > 0)) return 0;
      const v = head.fastest * k / 200;
      return head.kinds.reduce((sum, kind) => {
        const share = kind.mass / temperature;
        return sum + kind.share * share * v * Math.exp(-share * v * v / 2);
      }, 0);
    });
  }

  draw() {
    const { gas, counts } = this, { head } = gas;
    const { pen, width, height } = prepare(this.canvas, 0.32, 180, 260);
    const theme = themed(), left = 52, bottom = 48, right = 12, above = 24, strip = 8;
    const shades = theme.dark ? head.dark : head.light;
    const w = width - left - right, h = height - bottom - above;
    const toX = v => left + v / head.fastest * w, toY = f => above + h * (1 - Math.min(f / this.top, 1));
    counts.fill(0);
    for (let i = 0; i < gas.number; i++) {
      const bin = Math.floor(Math.hypot(gas.vx[i], gas.vy[i]) / head.fastest * counts.length);
      if (bin < counts.length) counts[bin]++;
    }
    pen.fillStyle = theme.panel;
    pen.fillRect(left, above, w, h);
    const wide = head.fastest / counts.length;
    pen.fillStyle = head.bars;
    counts.forEach((count, k) => {
      const y = toY(count / gas.number / wide);
      pen.fillRect(toX(k * wide), y, w / counts.length + 0.5, above + h - y);
    });
    const temperature = this.temperature();
    pen.strokeStyle = theme.dark ? theme.ink : head.curve;
    pen.lineWidth = 2;
    pen.beginPath();
    this.law(temperature).forEach((f, k) => pen.lineTo(toX(head.fastest * k / 200), toY(f)));
    pen.stroke();
    shades.forEach((shade, k) => {
      const from = toX(head.brightest * k / shades.length), last = k + 1 === shades.length;
      pen.fillStyle = shade;
      pen.fillRect(from, above + h, (last ? left + w : toX(head.brightest * (k + 1) / shades.length)) - from, strip);
    });
    pen.lineWidth = 1;
    pen.strokeStyle = theme.ink;
    pen.fillStyle = theme.ink;
    pen.font = "12px system-ui, sans-serif";
    pen.strokeRect(left + 0.5, above + 0.5, w, h);
    pen.textAlign = "center";
    const step = roundStep(head.fastest * 60 / w);
    for (let v = 0; v <= head.fastest; v += step) pen.fillText(+v.toPrecision(6), toX(v), above + h + strip + 14);
    pen.fillText("speed (length/time)", left + w / 2, above + h + strip + 32);
    pen.textAlign = "right";
    const rise = roundStep(this.top / 4);
    for (let f = 0; f <= this.top; f += rise) pen.fillText(+f.toPrecision(3), left - 6, toY(f) + 4);
    const key = "bars: discs, line: Maxwell-Boltzmann at ";
    pen.fillText((w > 480 ? key : "") + "T = " + temperature.toPrecision(5), left + w, 15);
    pen.textAlign = "left";
    pen.fillText("density (time/length)", 4, 15);
  }
}

function roundStep(size) {
  const power = 10 ** Math.floor(Math.log10(size));
  return power * [1, 2, 5, 10].find(step => power * step >= size * (1 - 1e-9));
}

// ── the player ──

class Player {
  constructor(gas) {
    this.gas = gas;
    this.playing = false;
    this.rate = 1;
    this.scrub = document.getElementById("scrub");
    this.button = document.getElementById("play");
    this.clock = document.getElementById("clock");
    this.rates = document.getElementById("rate");
    this.views = [new SpeedView(document.getElementById("speeds"), gas)];
    if (gas.head.positions) this.views.push(new DiscView(document.getElementById("discs"), gas));
    this.button.addEventListener("click", () => this.toggle());
    this.scrub.addEventListener("input", () => { this.pause(); this.seek(this.at(this.scrub.value / this.scrub.max)); });
    this.rates.addEventListener("change", () => { this.rate = +this.rates.value; });
    document.getElementById("player").addEventListener("keydown", event => this.key(event));
    new ResizeObserver(() => this.draw()).observe(document.getElementById("speeds"));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
    this.draw();
  }

  get time() { return this.gas.time; }

  at(share) { return this.gas.head.start + share * (this.gas.head.end - this.gas.head.start); }

  seek(time) {
    this.gas.seek(time);
    this.draw();
  }

  positions() { return Array.from(this.gas.x, (x, i) => [x, this.gas.y[i]]); }

  draw() {
    const { head, time } = this.gas;
    this.views.forEach(view => view.draw());
    this.scrub.value = this.scrub.max * (time - head.start) / (head.end - head.start);
    this.scrub.setAttribute("aria-valuetext", "t = " + time.toPrecision(5));
    this.clock.textContent = "t = " + time.toPrecision(6);
  }

  toggle() { if (this.playing) this.pause(); else this.play(); }

  play() {
    if (this.time >= this.gas.head.end) this.seek(this.gas.head.start);
    this.playing = true;
    this.button.textContent = "Pause";
    let before = null;
    const frame = now => {
      if (!this.playing) return;
      const seconds = Math.min((now - (before ?? now)) / 1000, 0.25); // a hidden page has no frames: no leap after it
      this.seek(this.time + seconds * this.rate * this.gas.head.speed);
      before = now;
      if (this.time >= this.gas.head.end) this.pause(); else requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  }

  pause() {
    this.playing = false;
    this.button.textContent = "Play";
  }

  key(event) {
    if (event.target === this.rates || event.ctrlKey || event.altKey || event.metaKey) return;
    if (event.target === this.button && event.key === " ") return; // it is a click already
    const second = this.rate * this.gas.head.speed, small = event.shiftKey ? second : second / 25;
    const act = {
      " ": () => this.toggle(),
      ArrowLeft: () => { this.pause(); this.seek(this.time - small); },
      ArrowRight: () => { this.pause(); this.seek(this.time + small); },
      ArrowUp: () => this.faster(1),
      ArrowDown: () => this.faster(-1),
      Home: () => { this.pause(); this.seek(this.gas.head.start); },
      End: () => { this.pause(); this.seek(this.gas.head.end); },
    }[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  }

  faster(steps) {
    const k = this.rates.selectedIndex + steps;
    if (k < 0 || k >= this.rates.options.length) return;
    this.rates.selectedIndex = k;
    this.rate = +this.rates.value;
  }
}

let printing = false;
const head = document.getElementById("data-head");
if (head) {
  window.player = new Player(new Gas(JSON.parse(head.textContent)));
  addEventListener("beforeprint", () => { printing = true; window.player.draw(); });
  addEventListener("afterprint", () => { printing = false; window.player.draw(); });
}
